//! Hits — the first receiver that each ray hits. The floor is intersected exactly; meshes by marching into their level maps, and by
//! their triangles where a level map has an edge. The nearest hit wins.

use super::beams::BEAMS;
use super::level_map::LEVEL_MAPS;
use super::light::Light;
use super::objects::{GEOMETRY, INSTANCES};
use super::receivers::RECEIVERS;
use super::surface::{SURFACE, cells, grid_step, vertices, wanted_for_light};
use super::{Pass, Slot, Steps};

/// Where rays end.
pub static HITS: Slot = Slot::buffer(
    "hits",
    "map coordinates texels, path m, receiver per water vertex",
    |facts| 16 * vertices(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "hits",
    shader: "stages/hits.wgsl",
    reads: &[&SURFACE, &BEAMS, &RECEIVERS],
    reads_if_present: &[&LEVEL_MAPS, &GEOMETRY, &INSTANCES],
    writes: &[&HITS],
    uniforms: &[("light", Light::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| grid_step("hits_main", facts, set)),
    // A ray tests the objects that the hierarchy finds along it: about the square root of their number.
    work: |facts| cells(facts) * (1.0 + (facts.wet_objects().count() as f64).sqrt()),
};
