//! Spreading of the light below a threshold depth.
//!
//! Rays that meet at a focus part again below it, but the eikonal field keeps them together. So below a threshold depth the field is
//! replaced: the slice at the threshold is the start, at rest, of a wave simulation in the plane, with depth as time. Light that is
//! concentrated there opens into a cone; `speed` is the tangent of its half-angle. Damping slows the spreading down. The sum of a slice is
//! kept. No threshold suits all foci at once, as the paper shows.
//!
//! Source: Mercier, §3.3 and figures 5 and 6.

use super::{FrontError, Grid};

/// Spreading below a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dissipation {
    /// Depth in the model below which the light spreads, m.
    pub threshold_m: f64,
    /// How fast it spreads: metres to the side per metre of depth in the model, 0 … 10.
    pub speed: f64,
    /// How fast the spreading slows down, per metre of depth in the model, 0 … 1000.
    pub damping_per_m: f64,
}

/// What the simulation did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dissipated {
    /// Slices that were replaced.
    pub slices: usize,
    /// Of the sum of the replaced values: how much was added because waves went below 0.
    pub raised: f64,
}

/// Factors of the simulation that are the same in every step.
struct Step {
    /// (speed · step / h)² along x and z.
    gains: [f64; 2],
    /// damping · step / 2.
    loss: f64,
}

impl Dissipation {
    /// Replaces the slices of `values` (x fastest, then z, then depth) below the threshold.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn apply(&self, grid: &Grid, values: &mut [f32]) -> Result<Dissipated, FrontError> {
        for (setting, value, most, accepted) in [
            ("threshold_m", self.threshold_m, f64::MAX, "0 and more"),
            ("speed", self.speed, 10.0, "0 to 10"),
            ("damping_per_m", self.damping_per_m, 1000.0, "0 to 1000"),
        ] {
            if !(0.0..=most).contains(&value) {
                return Err(FrontError::Setting {
                    setting,
                    value,
                    accepted,
                });
            }
        }
        let step_m = grid.step_m;
        let first = ((self.threshold_m - grid.origin_m.z) / step_m.z)
            .ceil()
            .max(0.0);
        let mut done = Dissipated {
            slices: 0,
            raised: 0.0,
        };
        if first >= grid.size[2] as f64 {
            return Ok(done);
        }
        // The limit of Courant, with a margin.
        let per_slice = self.speed * step_m.z * (step_m.x.powi(-2) + step_m.y.powi(-2)).sqrt();
        let parts = (per_slice / 0.8).ceil().max(1.0);
        let part_m = step_m.z / parts;
        let step = Step {
            gains: [step_m.x, step_m.y].map(|h| (self.speed * part_m / h).powi(2)),
            loss: 0.5 * self.damping_per_m * part_m,
        };
        let slice = grid.slice();
        let (head, below) = values.split_at_mut((first as usize + 1) * slice);
        let mut now: Vec<f64> = head[first as usize * slice..]
            .iter()
            .map(|v| f64::from(*v))
            .collect();
        let mut next = vec![0.0; slice];
        // At rest: the first step goes half as far as the others would, from a state before that equals it.
        let mut before = now.clone();
        step.advance(grid.size, &now, &before, &mut next);
        for (before, next) in before.iter_mut().zip(&next) {
            *before += 0.5 * (next - *before);
        }
        let (mut raised, mut sum) = (0.0, 0.0);
        for target in below.chunks_mut(slice) {
            for _ in 0..parts as usize {
                step.advance(grid.size, &now, &before, &mut next);
                std::mem::swap(&mut before, &mut now);
                std::mem::swap(&mut now, &mut next);
            }
            for (target, value) in target.iter_mut().zip(&now) {
                raised += (-value).max(0.0);
                sum += value.max(0.0);
                *target = value.max(0.0) as f32;
            }
            done.slices += 1;
        }
        if sum > 0.0 {
            done.raised = raised / sum;
        }
        Ok(done)
    }
}

impl Step {
    /// One step of the damped wave equation; the edges mirror.
    fn advance(&self, size: [usize; 3], now: &[f64], before: &[f64], next: &mut [f64]) {
        let [nx, nz, _] = size;
        for j in 0..nz {
            let row = |j: usize| &now[j * nx..][..nx];
            let (here, up, down) = (row(j), row(j.saturating_sub(1)), row((j + 1).min(nz - 1)));
            for i in 0..nx {
                let value = here[i];
                let across = here[i.saturating_sub(1)] + here[(i + 1).min(nx - 1)] - 2.0 * value;
                let along = up[i] + down[i] - 2.0 * value;
                let pull = self.gains[0] * across + self.gains[1] * along;
                let old = before[j * nx + i];
                next[j * nx + i] =
                    (2.0 * value - (1.0 - self.loss) * old + pull) / (1.0 + self.loss);
            }
        }
    }
}
