//! One step of the wave equation on a segment of a row.

use super::{Grid, WavePlan, WaveSettings};

/// Cells of a segment.
pub(super) const SEGMENT: usize = 32;

/// Factors of a step.
///
/// With second differences D and λ = step / h along each axis:
/// φ⁺ = 4 (1 + λₓ² Dₓ/4)(1 + λ_z² D_z/4)(1 + λ_d² D_d/4) φ − 2 φ − φ⁻. It is stable as long as every λ ≤ 1, and for λ = 1 exact along
/// the axis, however short the wave: a pulse of one cell stays one. The usual scheme with seven points needs λ² ≤ 1/3 in cubes, and
/// pulses of a few cells fall apart in it.
///
/// Source: Kowalczyk and van Walstijn, "Room acoustics simulation using 3-D compact explicit FDTD schemes", IEEE Trans. Audio,
/// Speech and Language Processing 19 (2011), the interpolated wideband scheme; for unequal steps extended by the same product.
pub(super) struct Step {
    /// λ²/4 along x.
    side_x: f32,
    /// Weights of the nine rows around: by depth, then z. Four times the product of two axes.
    rows: [[f32; 3]; 3],
    pub(super) strides: [usize; 3],
    clamped: bool,
    silent: f32,
}

impl Step {
    pub(super) fn of(
        grid: &Grid,
        plan: &WavePlan,
        settings: &WaveSettings,
        strides: [usize; 3],
    ) -> Self {
        let ratios = grid.step_m.recip() * plan.step_m;
        let [side_x, side_z, side_d] = (0.25 * ratios * ratios).to_array().map(|side| side as f32);
        let taps = |side: f32| [side, 1.0 - 2.0 * side, side];
        Self {
            side_x,
            rows: taps(side_d).map(|d| taps(side_z).map(|z| 4.0 * d * z)),
            strides,
            clamped: settings.clamped,
            silent: settings.silent as f32,
        }
    }

    /// The next state of a segment, over the state before, and whether waves are in it.
    #[inline]
    pub(super) fn segment(
        &self,
        now: &[f32],
        place: usize,
        next: &mut [f32],
        [lefts, gains]: [&[f32]; 2],
        [left, gain]: [f32; 2],
    ) -> bool {
        let count = next.len();
        let [_, row, slice] = self.strides;
        // The nine rows, with a cell before and after the segment.
        let mut sums = [0.0_f32; SEGMENT + 2];
        let sums = &mut sums[..count + 2];
        let first = place - 1 - row - slice;
        for (d, weights) in self.rows.iter().enumerate() {
            for (z, weight) in weights.iter().enumerate() {
                let values = &now[first + d * slice + z * row..][..count + 2];
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += weight * value;
                }
            }
        }
        let here = &now[place..][..count];
        let (side, middle) = (self.side_x, 1.0 - 2.0 * self.side_x);
        let floor = if self.clamped { 0.0 } else { f32::NEG_INFINITY };
        let (mut most, mut most_now) = (0.0_f32, 0.0_f32);
        for i in 0..count {
            let value = here[i];
            let spread = middle * sums[i + 1] + side * (sums[i] + sums[i + 2]);
            let left = left * lefts[i];
            let moved = (1.0 + gain + gains[i]) * spread - 2.0 * value;
            let new = (left * (moved - left * next[i])).max(floor);
            next[i] = new;
            most = most.max(new.abs());
            most_now = most_now.max(value.abs());
        }
        most.max(most_now) > self.silent
    }
}
