//! The damping band around a wave simulation.
//!
//! Source: Mercier, §4 (a band whose damping grows inwards); the term |σ'| is ours.

use super::{Grid, WavePlan};

/// What the damping band leaves of the amplitude of a wave that crosses it at a right angle and comes back.
const BAND_LEAVES: f64 = 1e-4;

/// Power with which damping grows into the band.
const BAND_POWER: i32 = 2;

/// The damping band along one axis.
///
/// With damping σ that depends on the position x alone, φ_tt + 2 σ φ_t + (σ² − |σ'|) φ = φ_xx lets f(t − x) e^(−∫σ dx) pass
/// outwards exactly, whatever σ is: nothing turns back at a right angle. σ² − |σ'| − ∂²/∂x² is the square of ∂/∂x + σ, so
/// nothing grows. Damping by 2 σ φ_t alone, as in the paper, sent an eighth of a wave of 6 cells back from a band of 8. A step is
/// taken on φ e^(σt), so that it is stable for every σ.
pub(super) struct Band {
    /// e^(−σ · step), by cell.
    pub(super) left: Vec<f32>,
    /// |σ'| · step² / 4, by cell.
    pub(super) gain: Vec<f32>,
}

impl Band {
    pub(super) fn of(grid: &Grid, plan: &WavePlan, axis: usize) -> Self {
        let (n, band) = (plan.size[axis], plan.band[axis]);
        let width_m = band as f64 * grid.step_m[axis];
        let power = f64::from(BAND_POWER);
        let into = |i: usize| {
            let outside = band.saturating_sub(i).max((i + band + 1).saturating_sub(n));
            if outside == 0 {
                return (1.0, 0.0);
            }
            let share = (outside as f64 - 0.5) / band as f64;
            let most_per_m = (power + 1.0) * -BAND_LEAVES.ln() / (2.0 * width_m);
            let damping_per_m = most_per_m * share.powi(BAND_POWER);
            let growth = most_per_m * power * share.powi(BAND_POWER - 1) / width_m;
            let left = (-damping_per_m * plan.step_m).exp();
            (left as f32, (0.25 * growth * plan.step_m.powi(2)) as f32)
        };
        let (left, gain) = (0..n).map(into).unzip();
        Self { left, gain }
    }
}
