// Fresnel reflection, unpolarised light. Twin of src/physics/fresnel.rs.
#import "lib/refraction.wgsl"

// Reflectance for incidence cosine `cos_i` (0 … 1) and relative index `eta` = n_to / n_from (1/4 … 4); 1 at total reflection and
// along the boundary.
fn fresnel_reflectance(cos_i: f32, eta: f32) -> f32 {
    let square = refracted_square(cos_i, eta);
    if cos_i <= 0.0 || square < 0.0 { return 1.0; }
    if eta == 1.0 { return 0.0; }
    let eta_cos_t = sqrt(square);
    let r_s = (cos_i - eta_cos_t) / (cos_i + eta_cos_t);
    let p_i = eta * eta * cos_i;
    let r_p = (p_i - eta_cos_t) / (p_i + eta_cos_t);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// Transmittance T = 1 − R without the cancellation near grazing.
fn fresnel_transmittance(cos_i: f32, eta: f32) -> f32 {
    let square = refracted_square(cos_i, eta);
    if cos_i <= 0.0 || square < 0.0 { return 0.0; }
    if eta == 1.0 { return 1.0; }
    let eta_cos_t = sqrt(square);
    let s_sum = cos_i + eta_cos_t;
    let p_sum = eta * cos_i + eta_cos_t / eta;
    // Do not multiply cos_i · eta_cos_t first: at grazing incidence that product is subnormal, and GPUs flush it to zero.
    return 2.0 * cos_i * (eta_cos_t / (s_sum * s_sum) + eta_cos_t / (p_sum * p_sum));
}
