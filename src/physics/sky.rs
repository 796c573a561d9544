//! Diffuse light of a uniform sky.

use super::fresnel::fresnel_transmittance;

/// Irradiance from a uniform sky of `radiance` (W/(m² sr)) on a surface whose unit normal has the upward component
/// `normal_y`, `depth_m` under flat water that lets `transmittance` through and takes `c_per_m` away along paths
/// `path_factor` times the depth: π L T e^(−c f d) (1 + n_y)/2.
///
/// The view factor (1 + n_y)/2 of a tilted plane to a hemisphere is exact (Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, B-3 limit); one path length for all directions is an approximation, exact for clear water.
pub fn sky_irradiance(
    radiance: f64,
    transmittance: f64,
    c_per_m: f64,
    depth_m: f64,
    path_factor: f64,
    normal_y: f64,
) -> f64 {
    std::f64::consts::PI
        * radiance
        * transmittance
        * (-c_per_m * path_factor * depth_m.max(0.0)).exp()
        * 0.5
        * (1.0 + normal_y)
}

/// Mean path per depth of sky light under flat water of index `eta`: 1/cos θ_t averaged with the transmitted flux,
/// 2 ∫₀¹ T(μ) μ / cos θ_t dμ over 2 ∫₀¹ T(μ) μ dμ (about 1.2 for water).
pub fn sky_path_factor(eta: f64) -> f64 {
    let steps = super::constants::SKY_INTEGRATION_STEPS;
    let (mut flux, mut weighted) = (0.0, 0.0);
    for i in 0..steps {
        let mu = (f64::from(i) + 0.5) / f64::from(steps);
        let weight = mu * fresnel_transmittance(mu, eta);
        let cos_t = (1.0 - (1.0 - mu * mu) / (eta * eta)).max(0.0).sqrt();
        if cos_t > 0.0 {
            flux += weight;
            weighted += weight / cos_t;
        }
    }
    weighted / flux
}
