//! Hits — what each ray strikes first: the floor exactly, meshes by marching into their level maps, and by
//! their triangles where those have edges; the nearest wins.

use super::desc::{PassDesc, Repeat};
use super::slot::Slot;
use super::surface::{grid_step, wanted_for_light};

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "hits",
    repeat: Repeat::Light,
    reads: &[Slot::Surface, Slot::Beams, Slot::Receivers],
    reads_if_present: &[Slot::LevelMaps, Slot::Geometry, Slot::Instances],
    writes: &[Slot::Hits],
    wanted: wanted_for_light,
    steps: |facts, run| grid_step("hits_main", facts, run),
};
