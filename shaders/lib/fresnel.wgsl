// Fresnel reflection, unpolarised light. Twin of src/physics/fresnel.rs.

// Reflectance for incidence cosine `cos_i` (0 … 1) and relative index `eta` = n_to / n_from; 1 at total reflection.
fn fresnel_reflectance(cos_i: f32, eta: f32) -> f32 {
    let sin2_t = max(1.0 - cos_i * cos_i, 0.0) / (eta * eta);
    if sin2_t >= 1.0 { return 1.0; }
    let cos_t = sqrt(1.0 - sin2_t);
    let s_sum = cos_i + eta * cos_t;
    let p_sum = eta * cos_i + cos_t;
    if s_sum <= 0.0 || p_sum <= 0.0 { return 1.0; }
    let r_s = (cos_i - eta * cos_t) / s_sum;
    let r_p = (eta * cos_i - cos_t) / p_sum;
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// Transmittance T = 1 − R without the cancellation near grazing.
fn fresnel_transmittance(cos_i: f32, eta: f32) -> f32 {
    let sin2_t = max(1.0 - cos_i * cos_i, 0.0) / (eta * eta);
    if sin2_t >= 1.0 || cos_i <= 0.0 { return 0.0; }
    let cos_t = sqrt(1.0 - sin2_t);
    let s_sum = cos_i + eta * cos_t;
    let p_sum = eta * cos_i + cos_t;
    return 2.0 * eta * cos_i * cos_t * (1.0 / (s_sum * s_sum) + 1.0 / (p_sum * p_sum));
}
