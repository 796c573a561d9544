//! Coarse irradiance — finishes a sun's maps when its light is done again with two fifths of the water cells.

use super::desc::{PassDesc, Repeat};
use super::estimate;
use super::irradiance::resolve_steps;
use super::slot::Slot;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "coarse_irradiance",
    repeat: Repeat::CoarseSun,
    reads: &[Slot::Flux, Slot::Energy, Slot::Receivers],
    reads_if_present: &[],
    writes: &[Slot::CoarseIrradiance],
    wanted: |facts| {
        estimate::wanted(facts)?;
        Ok(format!(
            "the light is done again with {} water cells",
            facts.coarse().quality.water_cells
        ))
    },
    steps: |facts, run| resolve_steps("coarse_irradiance_main", facts, run),
};
