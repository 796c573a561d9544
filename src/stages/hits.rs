//! Hits — what each ray strikes first: the floor exactly, meshes by marching into their level maps, and by
//! their triangles where those have edges; the nearest wins.

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
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| grid_step("hits_main", facts, set)),
    // A ray looks at the objects over its way, which the hierarchy over them finds: between some and all of a row of them.
    work: |facts| cells(facts) * (1.0 + (facts.wet_objects().count() as f64).sqrt()),
};
