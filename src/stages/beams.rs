//! Beams — refracted direction and transmittance under each vertex of the water grid.

use super::light::Light;
use super::surface::{SURFACE, cells, grid_step, vertices, wanted_for_light};
use super::{Pass, Slot, Steps};

/// Rays under the grid.
pub static BEAMS: Slot = Slot::buffer(
    "beams",
    "refracted direction and transmittance per water vertex",
    |facts| 16 * vertices(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "beams",
    shader: "stages/beams.wgsl",
    reads: &[&SURFACE],
    reads_if_present: &[],
    writes: &[&BEAMS],
    uniforms: &[("light", Light::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| grid_step("beams_main", facts, set)),
    work: cells,
};
