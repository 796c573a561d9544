//! Heights on an even grid, as the kinds of water that are computed on one give them to [`super::spline`].

use glam::DVec2;

use super::spline::Spline;

/// What is beyond the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edges {
    /// The same again, along x and z.
    Repeats,
    /// Water at rest.
    Flat,
}

/// Heights on an even grid.
#[derive(Clone, Debug)]
pub(super) struct Heights {
    /// What is beyond the samples.
    pub(super) edges: Edges,
    /// Heights, m, row by row along x.
    pub(super) heights_m: Vec<f64>,
    /// Numbers of samples along x and z.
    pub(super) size: [usize; 2],
    /// Distances of the samples along x and z, m.
    pub(super) step_m: DVec2,
    /// Place (x, z) of the first sample, m.
    pub(super) corner_m: DVec2,
    /// Length of the shortest wave, m.
    pub(super) shortest_wave_m: f64,
    /// Share of the mean square slope that the surface through the samples misses, 0 … 1.
    pub(super) slope_lost: f64,
    /// What it is, for plans: "a jonswap sea", "a basin with 3 drops".
    pub(super) description: String,
}

/// Water on a grid: the surface, and what is told of it.
#[derive(Debug)]
pub(super) struct Computed {
    pub(super) spline: Spline,
    /// See [`Heights::shortest_wave_m`].
    pub(super) shortest_wave_m: f64,
    /// See [`Heights::slope_lost`].
    pub(super) slope_lost: f64,
    /// See [`Heights::description`].
    pub(super) description: String,
}

impl From<Heights> for Computed {
    fn from(heights: Heights) -> Self {
        let through = match heights.edges {
            Edges::Repeats => Spline::through,
            Edges::Flat => Spline::in_flat_water,
        };
        let Heights {
            heights_m,
            size,
            step_m,
            corner_m,
            ..
        } = heights;
        Self {
            spline: through(heights_m, size, step_m, corner_m),
            shortest_wave_m: heights.shortest_wave_m,
            slope_lost: heights.slope_lost,
            description: heights.description,
        }
    }
}
