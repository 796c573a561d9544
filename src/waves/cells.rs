//! The samples of a basin that is not solved by its modes: those of the basin itself, and of the water around it if walls absorb.

use glam::DVec2;

use crate::scene::{Ripples, Walls};

/// An even grid. Samples stand in the middle of their cells; between them are the faces.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// Samples along x and z, those of the water around the basin included.
    pub(super) size: [usize; 2],
    /// Distances of the samples along x and z, m.
    pub(super) step_m: [f64; 2],
    /// Place of the first sample, m.
    pub(super) first_m: [f64; 2],
    /// Samples of the water beyond each side.
    pub(super) layer: usize,
    /// Whether the last sample has the first one as its neighbour.
    pub(super) wraps: bool,
}

impl Cells {
    /// The grid of `ripples` with `refinement` times as many samples along the sides.
    pub(super) fn of(ripples: &Ripples, refinement: u32) -> Self {
        let times = refinement as usize;
        let step_m = ripples
            .sample_steps_m()
            .map(|step_m| step_m / f64::from(refinement));
        let layer = times * ripples.layer_samples();
        let first_m = [0, 1].map(|i| match ripples.walls {
            Walls::Periodic => ripples.min_m[i],
            Walls::Reflecting => ripples.min_m[i] + 0.5 * step_m[i],
            Walls::Absorbing => ripples.min_m[i] - (layer as f64 - 0.5) * step_m[i],
        });
        Self {
            size: ripples
                .side_samples()
                .map(|count| times * count + 2 * layer),
            step_m,
            first_m,
            layer,
            wraps: ripples.walls == Walls::Periodic,
        }
    }

    /// Number of samples.
    pub(super) fn count(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Place of a sample along an axis, m.
    pub(super) fn place_m(&self, axis: usize, index: usize) -> f64 {
        self.first_m[axis] + index as f64 * self.step_m[axis]
    }

    /// Place of the first sample, m.
    pub(super) fn corner_m(&self) -> DVec2 {
        DVec2::from_array(self.first_m)
    }

    /// How far `index`, which need not be whole, is outside of the basin along an axis, as a share of the water beyond its wall.
    pub(super) fn outside(&self, axis: usize, index: f64) -> f64 {
        if self.layer == 0 {
            return 0.0;
        }
        let layer = self.layer as f64;
        let low = layer - 0.5 - index;
        let high = index - (self.size[axis] as f64 - layer - 0.5);
        low.max(high).max(0.0) / layer
    }

    /// Multiplies heights by a factor that falls from 1 at the basin's rim to 0 where the water around it ends. Slopes and curvatures of
    /// the factor are continuous.
    pub(super) fn fade(&self, heights_m: &mut [f64]) {
        if self.layer == 0 {
            return;
        }
        let factors = [0, 1].map(|axis| {
            (0..self.size[axis])
                .map(|index| falling(self.outside(axis, index as f64)))
                .collect::<Vec<f64>>()
        });
        for (row, factor_z) in heights_m.chunks_exact_mut(self.size[0]).zip(&factors[1]) {
            for (height_m, factor_x) in row.iter_mut().zip(&factors[0]) {
                *height_m *= factor_x * factor_z;
            }
        }
    }
}

/// 1 up to 0, 0 from 1 on, and between them a polynomial with two continuous derivatives.
pub(super) fn falling(share: f64) -> f64 {
    let u = share.clamp(0.0, 1.0);
    1.0 - u * u * u * (10.0 + u * (6.0 * u - 15.0))
}
