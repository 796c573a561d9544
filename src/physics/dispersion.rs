//! Dispersion of waves on water: frequency from wavelength.

use super::constants::{GRAVITY_M_PER_S2, SURFACE_TENSION_N_PER_M, WATER_DENSITY_KG_PER_M3};

/// Angular frequency ω, rad/s, of wave number `k_per_m` (above 0) in water of `depth_m`; infinite depth: ω² = g k,
/// else ω² = g k tanh(k d). Source: Lamb, Hydrodynamics, 6th ed., §228–229.
pub fn angular_frequency(k_per_m: f64, depth_m: f64) -> f64 {
    let factor = if depth_m.is_finite() {
        (k_per_m * depth_m).tanh()
    } else {
        1.0
    };
    (GRAVITY_M_PER_S2 * k_per_m * factor).sqrt()
}

/// Angular frequency ω, rad/s, of wave number `k_per_m` (above 0) in water of `depth_m` (may be infinite), and group speed dω/dk, m/s,
/// under gravity and surface tension: ω² = (g k + σ k³/ρ) tanh(k d). Both are 0 for a depth of 0. Source: Lamb, Hydrodynamics,
/// 6th ed., §267.
pub fn with_surface_tension(k_per_m: f64, depth_m: f64) -> (f64, f64) {
    let tension = SURFACE_TENSION_N_PER_M / WATER_DENSITY_KG_PER_M3 * k_per_m * k_per_m;
    let deep = (GRAVITY_M_PER_S2 + tension) * k_per_m;
    let deep_slope = GRAVITY_M_PER_S2 + 3.0 * tension;
    let (factor, factor_slope) = if depth_m.is_finite() {
        let factor = (k_per_m * depth_m).tanh();
        (factor, depth_m * (1.0 - factor * factor))
    } else {
        (1.0, 0.0)
    };
    let omega = (deep * factor).sqrt();
    if omega > 0.0 {
        let slope = deep_slope * factor + deep * factor_slope;
        (omega, slope / (2.0 * omega))
    } else {
        (0.0, 0.0)
    }
}

/// Angular frequency ω of [`with_surface_tension`] alone, rad/s; 0 for a wave number of 0.
pub fn angular_frequency_with_surface_tension(k_per_m: f64, depth_m: f64) -> f64 {
    with_surface_tension(k_per_m, depth_m).0
}
