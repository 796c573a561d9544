// Flux through a caustic volume between two of its cuts. Twin of src/physics/interpolated_flux.rs.

// ∫₀^end of a cubic with these Bernstein coefficients: end times the mean of those of its part before `end`.
fn cubic_before(c: vec4f, end: f32) -> f32 {
    let near = mix(c.xyz, c.yzw, vec3f(end));
    let middle = mix(near.xy, near.yz, vec2f(end));
    return 0.25 * end * (c.x + near.x + middle.x + mix(middle.x, middle.y, end));
}

// Quotient, or 2 where it is larger than that or not a number.
fn quotient_below_2(above: f32, below: f32) -> f32 {
    return select(2.0, above / below, abs(above) < 2.0 * abs(below));
}

// ∫₀¹ |area(t)| density(t) dt for area(t) = `upper` (1 − t)² + `mixed` 2 t (1 − t) + `lower` t² and density(t) = `upper_density` (1 − t) +
// `lower_density` t. Areas −1 … 1, densities 0 … 1.
fn interpolated_flux(upper: f32, mixed: f32, lower: f32, upper_density: f32, lower_density: f32) -> f32 {
    let c = vec4f(
        upper * upper_density, (upper * lower_density + 2.0 * mixed * upper_density) / 3.0,
        (2.0 * mixed * lower_density + lower * upper_density) / 3.0, lower * lower_density);
    // Where the area is 0: b² − a c of the quadratic a t² + 2 b t + c.
    let b = mixed - upper;
    let root = sqrt(max(mixed * mixed - upper * lower, 0.0));
    let far = -(b + select(-root, root, b >= 0.0));
    let zeros = clamp(vec2f(quotient_below_2(far, upper - 2.0 * mixed + lower), quotient_below_2(upper, far)), vec2f(0.0), vec2f(1.0));
    // The area keeps its sign between these, also where they are no zeros of it.
    let first = cubic_before(c, min(zeros.x, zeros.y));
    let second = cubic_before(c, max(zeros.x, zeros.y));
    return abs(first) + abs(second - first) + abs(cubic_before(c, 1.0) - second);
}
