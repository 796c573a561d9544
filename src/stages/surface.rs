//! Surface — height and slope of the water at the vertices of a beam set's window. The pass to copy.

use super::light::{Light, light_uniform};
use super::queues::in_columns;
use super::{Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::facts::source::Source;
use crate::graph::{BeamSetRun, Origin};

/// The water's surface, as `shaders/shared/water_surface.wgsl` describes it.
pub static WAVES: Slot = Slot {
    origin: Origin::Host,
    ..Slot::buffer(
        "waves",
        "waves with a formula, and spline coefficients of grids m",
        |facts| 16 * facts.water.surface.gpu_element_count() as u64,
    )
};

/// The water grid.
pub static SURFACE: Slot =
    Slot::buffer("surface", "height m and slope per water vertex", |facts| {
        16 * vertices(facts)
    });

/// See the module.
pub static PASS: Pass = Pass {
    name: "surface",
    shader: "stages/surface.wgsl",
    reads: &[&WAVES],
    reads_if_present: &[],
    writes: &[&SURFACE],
    uniforms: &[("light", Light::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| {
        if facts.lights.beam_sets[set.index].is_submerged() {
            // Its rays start at the light and cross no surface.
            return Vec::new();
        }
        grid_step("surface_main", facts, set)
    }),
    work: |facts| cells(facts) * (1.0 + facts.water.surface.gpu_work_per_point()),
};

/// Vertices of the water grid.
pub(super) fn vertices(facts: &SceneFacts) -> u64 {
    (u64::from(facts.quality.water_cells) + 1).pow(2)
}

/// Number of cells of the water grid, as a measure of work.
pub(super) fn cells(facts: &SceneFacts) -> f64 {
    f64::from(facts.quality.water_cells).powi(2)
}

/// The reason why passes that trace light run: a receiver under water needs light, and some light reaches it.
pub fn wanted_for_light(facts: &SceneFacts) -> Result<String, String> {
    if facts.output.is_water_map() {
        return Err("the output is a map of the water, which needs no light".to_owned());
    }
    if !facts.has_receiver() {
        return Err("nothing under water needs light".to_owned());
    }
    if facts.lights.lit.is_empty() {
        return Err("no sun above the horizon and no point light shines into the water".to_owned());
    }
    let sets = &facts.lights.beam_sets;
    let count = |wanted: fn(&Source) -> bool, name: &str, names: &str| {
        let first_sets = (0..sets.len()).filter(|&set| facts.lights.is_first_of_light(set));
        let count = first_sets.filter(|&set| wanted(&sets[set].source)).count();
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
        "light is under water, so its rays cross no surface",
        "lights are under water, so their rays cross no surface",
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
        facts.water.surface.description(),
    );
    Ok(match under {
        Some(under) => format!("{into}; {under}"),
        None => into,
    })
}

/// One invocation per grid vertex.
pub(super) fn grid_step(entry: &'static str, facts: &SceneFacts, set: BeamSetRun) -> Vec<Step> {
    let vertices = (facts.quality.water_cells + 1).pow(2);
    vec![Step::compute(
        entry,
        in_columns(vertices.div_ceil(64)),
        vec![("light", light_uniform(facts, set))],
    )]
}
