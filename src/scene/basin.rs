//! What follows from the fields of ripples: samples and steps of the basin.

use super::waves::{RippleDispersion, Ripples, Walls};
use crate::physics::constants::GRAVITY_M_PER_S2;

/// Fewest samples along a side.
const FEWEST_SAMPLES: usize = 8;

/// Fewest samples across the water beyond an absorbing wall.
const FEWEST_LAYER_SAMPLES: usize = 8;

/// A step in time, as a share of the longest stable one.
const COURANT: f64 = 0.9;

impl Ripples {
    /// Lengths of the sides along x and z, m.
    pub fn sides_m(&self) -> [f64; 2] {
        [0, 1].map(|i| self.max_m[i] - self.min_m[i])
    }

    /// Samples along x and z: `samples` along the longer side, and an even number, at least 8, along the other.
    pub fn side_samples(&self) -> [usize; 2] {
        let sides_m = self.sides_m();
        let longest_m = sides_m[0].max(sides_m[1]);
        sides_m.map(|side_m| {
            if side_m == longest_m {
                return self.samples as usize;
            }
            let pairs = 0.5 * f64::from(self.samples) * side_m / longest_m;
            (2 * pairs.round() as usize).max(FEWEST_SAMPLES)
        })
    }

    /// Distances of the samples along x and z, m.
    pub fn sample_steps_m(&self) -> [f64; 2] {
        let (sides_m, samples) = (self.sides_m(), self.side_samples());
        [0, 1].map(|i| sides_m[i] / samples[i] as f64)
    }

    /// Samples across the water beyond each wall: 0 if the walls do not absorb.
    pub fn layer_samples(&self) -> usize {
        match self.walls {
            Walls::Absorbing => (self.samples as usize / 8).max(FEWEST_LAYER_SAMPLES),
            Walls::Reflecting | Walls::Periodic => 0,
        }
    }

    /// Speed of the waves in shallow water of `depth_m`, m/s; none if they run as in finite depth.
    pub fn shallow_m_per_s(&self, depth_m: Option<f64>) -> Option<f64> {
        match self.dispersion {
            RippleDispersion::Shallow => depth_m.map(|depth_m| (GRAVITY_M_PER_S2 * depth_m).sqrt()),
            RippleDispersion::FiniteDepth => None,
        }
    }

    /// Step in time, s, for waves that run at `speed_m_per_s`: 0.9 of the longest for which finite differences of second order are stable,
    /// 1 / (c √(1/Δx² + 1/Δz²)), the condition of Courant, Friedrichs and Lewy. Infinite for a speed of 0. With `refinement` times as many
    /// samples along the sides it is that much shorter.
    pub fn time_step_s(&self, speed_m_per_s: f64, refinement: u32) -> f64 {
        let [x_m, z_m] = self.sample_steps_m();
        COURANT / (speed_m_per_s * x_m.recip().hypot(z_m.recip()) * f64::from(refinement))
    }

    /// The time of the first drop, s.
    pub fn first_drop_s(&self) -> Option<f64> {
        self.drops
            .iter()
            .map(|drop| drop.at_s)
            .min_by(f64::total_cmp)
    }

    /// Samples that have to be moved one step, from the first drop to `time_s`, all together; 0 for basins that need no steps.
    pub fn sample_steps(&self, depth_m: Option<f64>, time_s: f64) -> f64 {
        let (Some(speed_m_per_s), Some(first_s)) =
            (self.shallow_m_per_s(depth_m), self.first_drop_s())
        else {
            return 0.0;
        };
        if self.obstacles.is_empty() {
            return 0.0;
        }
        let steps = ((time_s - first_s).max(0.0) / self.time_step_s(speed_m_per_s, 1)).ceil();
        let [x, z] = self
            .side_samples()
            .map(|count| count + 2 * self.layer_samples());
        steps * (x as f64) * (z as f64)
    }
}
