//! Surface — height and slope of the water at the vertices of a sun's window. The pass to copy.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::light::light_uniform;
use super::slot::Slot;
use crate::scene::facts::SceneFacts;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "surface",
    repeat: Repeat::Sun,
    reads: &[Slot::Waves],
    reads_if_present: &[],
    writes: &[Slot::Surface],
    wanted: wanted_for_sun,
    steps: |facts, run| grid_step("surface_main", facts, run),
};

/// Passes that follow a sun are in when there is one and something under water waits for it.
pub(super) fn wanted_for_sun(facts: &SceneFacts) -> Result<String, String> {
    if !facts.has_receiver() {
        return Err("nothing under water is to be lit".to_owned());
    }
    if facts.suns.is_empty() {
        return Err("no sun above the horizon shines into the water".to_owned());
    }
    let waves = facts.surface.components.len();
    Ok(format!(
        "{} sun{} into {}",
        facts.suns.len(),
        if facts.suns.len() == 1 {
            " shines"
        } else {
            "s shine"
        },
        if facts.surface.max_slope() == 0.0 {
            "flat water".to_owned()
        } else {
            format!("water with {waves} wave components")
        },
    ))
}

/// One invocation per grid vertex.
pub(super) fn grid_step(entry: &'static str, facts: &SceneFacts, run: Run<'_>) -> Vec<Step> {
    let Run::Sun { index, wide_sums } = run else {
        return Vec::new();
    };
    let side = facts.quality.water_cells + 1;
    vec![Step {
        entry,
        work: Work::Compute(Groups::Direct([side.div_ceil(64), side, 1])),
        uniforms: vec![("light", light_uniform(facts, index, wide_sums))],
    }]
}
