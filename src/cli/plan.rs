//! `caustica plan`: what would run, why, and how much memory it would hold.

use std::fmt::Write;

use clap::Args;

use super::error::CliError;
use super::scene_flags::SceneArgs;
use super::summary::{bytes, columns};
use super::{files, scene_file};
use crate::config::{Limits, RenderConfig};
use crate::plan::Plan;
use crate::render::Renderer;

/// What to plan.
#[derive(Clone, Debug, Args)]
pub struct PlanArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print JSON, as `POST /v1/plan` answers.
    #[arg(long)]
    pub json: bool,
}

/// Prints the plan of a scene.
///
/// # Errors
///
/// A bad scene, no adapter, or a plan over the memory budget.
pub fn run(args: &PlanArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let scene = scene_file::load(&args.scene, None, limits)?;
    let plan = Renderer::new(config)?.plan(&scene.resolved)?;
    if args.json {
        files::print(&files::json(&plan))
    } else {
        files::print(&in_words(&plan))
    }
}

/// A plan for people: a line for each pass, slot and warning.
pub fn in_words(plan: &Plan) -> String {
    let mut text = String::new();
    let passes = plan.passes.iter().map(|pass| {
        let runs = format!("{} ×", pass.runs);
        vec![pass.name.clone(), runs, pass.reason.clone()]
    });
    let absent = plan
        .absent
        .iter()
        .map(|pass| vec![pass.name.clone(), pass.reason.clone()]);
    let slots = plan
        .slots
        .iter()
        .map(|slot| vec![slot.name.clone(), bytes(slot.bytes), slot.holds.clone()]);
    let sections: [(&str, Vec<Vec<String>>); 3] = [
        ("Passes", passes.collect()),
        ("Not needed", absent.collect()),
        ("Memory", slots.collect()),
    ];
    for (title, rows) in sections {
        if !rows.is_empty() {
            let _ = writeln!(text, "{title}\n{}", columns(&rows, "  "));
        }
    }
    let _ = writeln!(text, "Peak: {}", bytes(plan.peak_bytes));
    for warning in &plan.warnings {
        let _ = writeln!(text, "Warning ({}): {}", warning.code, warning.message);
    }
    text
}
