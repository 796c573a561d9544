//! Beams — refracted ray and transmittance under each vertex of the water grid.

use super::desc::{PassDesc, Repeat};
use super::slot::Slot;
use super::surface::{grid_step, wanted_for_light};

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "beams",
    repeat: Repeat::Light,
    reads: &[Slot::Surface],
    reads_if_present: &[],
    writes: &[Slot::Beams],
    wanted: wanted_for_light,
    steps: |facts, run| grid_step("beams_main", facts, run),
};
