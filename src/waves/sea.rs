//! Seas from wave spectra.

use super::grid::Heights;
use crate::scene::{Scene, SpectrumWaves};

/// The sea at `scene.time_s` on its tile, whose first sample is at (0, 0), with `refinement` times `waves.samples` samples along each side.
pub(super) fn heights(waves: &SpectrumWaves, scene: &Scene, refinement: u32) -> Heights {
    let samples = (waves.samples * refinement) as usize;
    let step_m = waves.tile_m / samples as f64;
    let _ = scene;
    Heights {
        heights_m: vec![0.0; samples * samples],
        size: [samples; 2],
        step_m: glam::DVec2::splat(step_m),
        corner_m: glam::DVec2::ZERO,
        shortest_wave_m: f64::INFINITY,
        description: String::new(),
    }
}
