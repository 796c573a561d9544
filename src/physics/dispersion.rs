//! Dispersion of waves: frequency from wavelength.

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

/// Angular frequency ω, rad/s, of wave number `k_per_m` (at least 0) in water of `depth_m`, of waves that gravity and surface tension
/// drive: ω² = (g k + σ k³/ρ) tanh(k d); infinite depth: without the tanh. Source: Lamb, Hydrodynamics, 6th ed., §267.
pub fn angular_frequency_with_surface_tension(k_per_m: f64, depth_m: f64) -> f64 {
    let factor = if depth_m.is_finite() {
        (k_per_m * depth_m).tanh()
    } else {
        1.0
    };
    let tension_m3_per_s2 = SURFACE_TENSION_N_PER_M / WATER_DENSITY_KG_PER_M3;
    let driving = k_per_m * (GRAVITY_M_PER_S2 + tension_m3_per_s2 * k_per_m * k_per_m);
    (driving * factor).sqrt()
}
