//! Ripples in basins, by their modes.

use super::grid::Heights;
use crate::scene::{Ripples, Scene};

/// The basin at `scene.time_s` with its mirror images, with `refinement` times `ripples.samples` samples along the longer side.
pub(super) fn heights(ripples: &Ripples, scene: &Scene, refinement: u32) -> Heights {
    let _ = (scene, refinement);
    let samples = 2 * ripples.samples as usize;
    Heights {
        heights_m: vec![0.0; samples * samples],
        size: [samples; 2],
        step_m: glam::DVec2::ONE,
        corner_m: glam::DVec2::ZERO,
        shortest_wave_m: f64::INFINITY,
        description: String::new(),
    }
}
