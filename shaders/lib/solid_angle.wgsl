// Solid angles of triangles. Twin of src/physics/solid_angle.rs.

// Angle of the point (x, y) from the x axis, rad, above −π, at most π; 0 at the origin; coordinates up to 10³⁷. An own polynomial, because
// WGSL allows an error of 4096 ulp in atan2; coefficients of the single-precision Cephes library (Moshier 1992) on ±tan(π/8).
fn point_angle(y: f32, x: f32) -> f32 {
    let rise = abs(y);
    let run = abs(x);
    if rise == 0.0 && run == 0.0 { return 0.0; }
    var base = 0.0;
    var ratio = 0.0;
    if rise > 2.4142135 * run {
        base = 1.5707964;
        ratio = -run / rise;
    } else if rise > 0.41421357 * run {
        base = 0.78539819;
        ratio = (rise - run) / (rise + run);
    } else {
        ratio = rise / run;
    }
    let r2 = ratio * ratio;
    let series = (((8.05374449538e-2 * r2 - 1.38776856032e-1) * r2 + 1.99777106478e-1) * r2 - 3.33329491539e-1) * r2 * ratio + ratio;
    let first = base + series;
    let upper = select(first, 3.1415927 - first, x < 0.0);
    return select(upper, -upper, y < 0.0);
}

// Solid angle of the triangle with corners a, a + ab, a + ac, seen from the origin, sr, −2π … 2π; positive if ab × ac points away from the
// origin. Lengths 10⁻⁶ … 10⁶, or 0.
fn solid_angle(a: vec3f, ab: vec3f, ac: vec3f) -> f32 {
    let b = a + ab;
    let c = a + ac;
    let a_m = length(a);
    let b_m = length(b);
    let c_m = length(c);
    let triple = dot(a, cross(ab, ac));
    let sum = a_m * b_m * c_m + dot(a, b) * c_m + dot(a, c) * b_m + dot(b, c) * a_m;
    return 2.0 * point_angle(triple, sum);
}
