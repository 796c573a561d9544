//! Surface — height and slope of the water at the vertices of a light's window. The pass to copy.

use super::desc::{PassDesc, Repeat, Run, Step, Work};
use super::light::light_uniform;
use super::slot::{self, Slot};
use crate::facts::SceneFacts;
use crate::facts::source::Source;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "surface",
    repeat: Repeat::Light,
    reads: &[Slot::Waves],
    reads_if_present: &[],
    writes: &[Slot::Surface],
    wanted: wanted_for_light,
    steps: |facts, run| match run {
        // Its rays start at the light and pass no surface.
        Run::Light { index, .. }
            if matches!(facts.lights[index].source, Source::Submerged { .. }) =>
        {
            Vec::new()
        }
        _ => grid_step("surface_main", facts, run),
    },
};

/// Passes that follow a light are in when there is one and something under water waits for it.
pub(super) fn wanted_for_light(facts: &SceneFacts) -> Result<String, String> {
    if !facts.has_receiver() {
        return Err("nothing under water is to be lit".to_owned());
    }
    if facts.lights.is_empty() {
        return Err("no sun above the horizon and no point light shines into the water".to_owned());
    }
    let count = |wanted: fn(&Source) -> bool, name: &str, names: &str| {
        let count = facts.lights.iter().filter(|s| wanted(&s.source)).count();
        match count {
            0 => None,
            1 => Some(format!("1 {name}")),
            _ => Some(format!("{count} {names}")),
        }
    };
    let over: Vec<String> = [
        count(|s| matches!(s, Source::Sun { .. }), "sun", "suns"),
        count(
            |s| matches!(s, Source::Point { .. }),
            "point light",
            "point lights",
        ),
    ]
    .into_iter()
    .flatten()
    .collect();
    let under = count(
        |s| matches!(s, Source::Submerged { .. }),
        "light shines under the water, through no surface",
        "lights shine under the water, through no surface",
    );
    if over.is_empty() {
        return Ok(under.unwrap_or_default());
    }
    let into = format!(
        "{} {} into {}",
        over.join(" and "),
        if over.len() == 1 && over[0].starts_with("1 ") {
            "shines"
        } else {
            "shine"
        },
        facts.surface.description(),
    );
    Ok(match under {
        Some(under) => format!("{into}; {under}"),
        None => into,
    })
}

/// One invocation per grid vertex.
pub(super) fn grid_step(entry: &'static str, facts: &SceneFacts, run: Run<'_>) -> Vec<Step> {
    let Run::Light { index, wide_sums } = run else {
        return Vec::new();
    };
    let vertices = (facts.quality.water_cells + 1).pow(2);
    vec![Step {
        entry,
        work: Work::Compute(slot::in_columns(vertices.div_ceil(64))),
        uniforms: vec![("light", light_uniform(facts, index, wide_sums))],
    }]
}
