// Snell's law and mirror reflection as vectors. Twin of src/physics/refraction.rs.

// (η cos θ_t)² = (η − 1)(η + 1) + cos² θ_i for incidence cosine `cos_i` and `eta` = n_to / n_from. This form has no cancellation for η near
// 1 or grazing light. Negative at total internal reflection.
fn refracted_square(cos_i: f32, eta: f32) -> f32 {
    return (eta - 1.0) * (eta + 1.0) + cos_i * cos_i;
}

// Refracted unit direction (xyz) and 1, or zeros at total internal reflection; `eta` = n_to / n_from.
fn refract_direction(direction: vec3f, normal: vec3f, eta: f32) -> vec4f {
    let cos_i = -dot(direction, normal);
    let square = refracted_square(cos_i, eta);
    if square < 0.0 { return vec4f(0.0); }
    return vec4f(normalize(direction + normal * (cos_i - sqrt(square))), 1.0);
}

// Mirror direction.
fn reflect_direction(direction: vec3f, normal: vec3f) -> vec3f {
    return direction - normal * (2.0 * dot(direction, normal));
}

// Unit normal (up) of y = h(x, z) with slopes ∂h/∂x and ∂h/∂z, at most 10¹⁸ so that their squares are finite.
fn normal_from_slope(slope_x: f32, slope_z: f32) -> vec3f {
    return normalize(vec3f(-slope_x, 1.0, -slope_z));
}
