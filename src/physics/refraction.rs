//! Snell's law and mirror reflection as vectors.

use glam::DVec3;

/// (η cos θ_t)² = (η − 1)(η + 1) + cos² θ_i for incidence cosine `cos_i` (0 … 1) and `eta` = n_to / n_from: accurate also for η
/// near 1 and at grazing incidence. Negative at total internal reflection. Source: Snell's law, sin θ_i = η sin θ_t, squared.
pub fn refracted_square(cos_i: f64, eta: f64) -> f64 {
    (eta - 1.0) * (eta + 1.0) + cos_i * cos_i
}

/// Refracted unit direction of unit `direction` at unit `normal` (against the direction), `eta` = n_to / n_from.
///
/// t = d/η + (cos_i/η − cos_t) n. `None` at total internal reflection. Source: Heckbert, "Writing a Ray Tracer", in
/// Glassner (ed.), An Introduction to Ray Tracing (1989), §4.
pub fn refract_direction(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    let cos_i = -direction.dot(normal);
    let square = refracted_square(cos_i, eta);
    if square < 0.0 {
        return None;
    }
    let cos_t = square.sqrt() / eta;
    Some((direction / eta + normal * (cos_i / eta - cos_t)).normalize())
}

/// Horizontal distance (m) from the foot of a light (the point on the water below it) to where its ray to an underwater point
/// enters flat water.
///
/// The light is `height_m` (0 …) above the water, the point `depth_m` (0 …) under it and `distance_m` (0 …) away from the light's
/// foot: the x in 0 … `distance_m` with x/√(x² + h²) = η (r − x)/√((r − x)² + d²), found by bisection to the last digit. For a
/// point on the surface: `distance_m` itself. Source: Snell's law; Tipprasert's thesis, §4.2.1, eq. 2-8, takes the ray to an
/// object's origin.
pub fn entry_distance(height_m: f64, depth_m: f64, distance_m: f64, eta: f64) -> f64 {
    let sine = |x: f64, y: f64| if x > 0.0 { x / x.hypot(y) } else { 0.0 };
    let (mut low, mut high) = (0.0, distance_m);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if sine(middle, height_m) < eta * sine(distance_m - middle, depth_m) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Mirror direction of unit `direction` at unit `normal`: d − 2 (d·n) n.
pub fn reflect_direction(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// Unit normal (up) of a surface y = h(x, z) with slopes ∂h/∂x and ∂h/∂z.
pub fn normal_from_slope(slope_x: f64, slope_z: f64) -> DVec3 {
    DVec3::new(-slope_x, 1.0, -slope_z).normalize()
}

/// Unit direction towards a light at elevation and azimuth (rad): (cos e cos a, sin e, cos e sin a).
pub fn direction_to_light(elevation_rad: f64, azimuth_rad: f64) -> DVec3 {
    let (sin_e, cos_e) = elevation_rad.sin_cos();
    let (sin_a, cos_a) = azimuth_rad.sin_cos();
    DVec3::new(cos_e * cos_a, sin_e, cos_e * sin_a)
}
