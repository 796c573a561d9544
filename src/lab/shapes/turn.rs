//! Sine and cosine that are the same to the last bit on every machine: those of the system's mathematics library are not,
//! and a mesh's id hashes every digit of its coordinates. Sums and products are exact in IEEE 754, so polynomials do.

use std::f64::consts::TAU;

/// Sine and cosine of an angle in turns (1 = 360°), within 10⁻¹⁵; exact at quarter turns.
///
/// Taylor's polynomials up to the 17th power around the nearest quarter turn; what is left out is under 10⁻¹⁹.
pub(super) fn sin_cos(turns: f64) -> (f64, f64) {
    let within = turns - turns.floor();
    let quarter = (4.0 * within).round();
    let x = TAU * (within - 0.25 * quarter);
    let series = |first: f64, from: u32| {
        let (mut term, mut sum) = (first, first);
        for step in (from..from + 16).step_by(2) {
            term *= -x * x / (f64::from(step) * f64::from(step + 1));
            sum += term;
        }
        sum
    };
    let (sin, cos) = (series(x, 2), series(1.0, 1));
    match quarter as u32 {
        1 => (cos, -sin),
        2 => (-sin, -cos),
        3 => (-cos, sin),
        _ => (sin, cos),
    }
}
