// Snell's law and mirror reflection as vectors. Twin of src/physics/refraction.rs.

// Refracted unit direction (xyz) and 1, or zeros at total internal reflection; `eta` = n_to / n_from.
fn refract_direction(direction: vec3f, normal: vec3f, eta: f32) -> vec4f {
    let cos_i = -dot(direction, normal);
    let sin2_t = max(1.0 - cos_i * cos_i, 0.0) / (eta * eta);
    if sin2_t >= 1.0 { return vec4f(0.0); }
    let cos_t = sqrt(1.0 - sin2_t);
    return vec4f(normalize(direction / eta + normal * (cos_i / eta - cos_t)), 1.0);
}

// Mirror direction.
fn reflect_direction(direction: vec3f, normal: vec3f) -> vec3f {
    return direction - normal * (2.0 * dot(direction, normal));
}

// Unit normal (up) of y = h(x, z) with slopes ∂h/∂x and ∂h/∂z.
fn normal_from_slope(slope_x: f32, slope_z: f32) -> vec3f {
    return normalize(vec3f(-slope_x, 1.0, -slope_z));
}
