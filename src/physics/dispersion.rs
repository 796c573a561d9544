//! Dispersion of gravity waves: frequency from wavelength.

use super::constants::GRAVITY_M_PER_S2;

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
