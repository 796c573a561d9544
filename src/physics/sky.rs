//! Diffuse light of a uniform sky.

use super::fresnel::fresnel_transmittance;

/// Irradiance from a uniform sky of `radiance` (W/(m² sr)) on a surface whose unit normal has the upward component `normal_y`,
/// `depth_m` under flat water with transmittance `transmittance` and extinction `c_per_m`, along paths of `path_factor` times the
/// depth: π L T e^(−c f d) F(n_y), F from [`cone_share`] with `sin2_cone` = 1/n² under water (the whole sky stands in a cone of
/// the critical angle there) and 1 in air.
///
/// One path length and one transmittance for all directions is an approximation. It is exact for horizontal surfaces in clear
/// water.
pub fn sky_irradiance(
    radiance: f64,
    transmittance: f64,
    c_per_m: f64,
    depth_m: f64,
    path_factor: f64,
    normal_y: f64,
    sin2_cone: f64,
) -> f64 {
    std::f64::consts::PI
        * radiance
        * transmittance
        * (-c_per_m * path_factor * depth_m.max(0.0)).exp()
        * cone_share(normal_y, sin2_cone)
}

/// Irradiance from an evenly bright cone around the zenith on a plane whose unit normal has the upward component `normal_y`, as
/// a share of that on a horizontal one; `sin2_cone` (1/16 … 1: indices up to 4) is the square of the sine of the cone's half angle.
///
/// n_y if the whole cone is above the plane, 0 if none of it is; in between, with σ the half angle, x = cot σ, s = sin θ, y = −x
/// n_y / s: ((n_y acos y − x s √(1−y²)) sin²σ + atan2(s √(1−y²), x)) / (π sin²σ). The hemisphere, sin²σ = 1, gives (1 + n_y)/2.
/// Source: Lagarde & de Rousiers, "Moving Frostbite to PBR" (2014), listing 8, after Snyder (1996).
pub fn cone_share(normal_y: f64, sin2_cone: f64) -> f64 {
    let sin_cone = sin2_cone.sqrt();
    if normal_y >= sin_cone {
        return normal_y;
    }
    if normal_y <= -sin_cone {
        return 0.0;
    }
    let x = ((1.0 - sin2_cone) / sin2_cone).sqrt();
    let sin_tilt = (1.0 - normal_y * normal_y).max(0.0).sqrt();
    let y = (-x * normal_y / sin_tilt).clamp(-1.0, 1.0);
    let reach = sin_tilt * (1.0 - y * y).max(0.0).sqrt();
    ((normal_y * y.acos() - x * reach) * sin2_cone + reach.atan2(x))
        / (std::f64::consts::PI * sin2_cone)
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
