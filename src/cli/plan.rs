//! `caustica plan`: which passes would run, why, and the memory they would hold.

use std::fmt::Write;

use clap::Args;

use tokio_util::sync::CancellationToken;

use super::error::CliError;
use super::scene_flags::SceneArgs;
use super::summary::{bytes, columns, percent, predicted};
use super::{files, notes, scene_file};
use crate::config::{Limits, RenderConfig};
use crate::plan::Plan;
use crate::plan::{NothingCached, Wanted, plan_scene};
use crate::render::{Prepared, RenderError, Renderer};
use crate::stats::{ChosenDials, MethodAdvice};

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
/// A bad scene, or a plan over the memory budget.
pub fn run(args: &PlanArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let scene = scene_file::load(&args.scene, None, limits)?;
    notes::say_notes(&scene.notes);
    let prepared = Prepared::new(scene.resolved).map_err(RenderError::from)?;
    let plan = if prepared.asks_for_dials() {
        // Dials are chosen by trial renders.
        Renderer::new(config)?.plan_prepared(&prepared, &CancellationToken::new())?
    } else {
        // Plan as if nothing were cached: no device is opened, so this works on any machine.
        let empty = NothingCached {
            arena_bytes: config.level_map_budget_bytes(),
            field_arena_bytes: config.field_budget_bytes(),
        };
        plan_scene(prepared.facts(), Wanted::Frame, &empty)
            .map_err(RenderError::from)?
            .report
    };
    let budget_bytes = config.memory_budget_bytes();
    if plan.peak_bytes > budget_bytes {
        return Err(RenderError::OverBudget {
            what: "the frame at its peak (CAUSTICA_MEMORY_BUDGET_MIB)".to_owned(),
            needed_bytes: plan.peak_bytes,
            budget_bytes,
        }
        .into());
    }
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
    let slots = plan.slots.iter().map(|slot| {
        let mut holds = slot.holds.clone();
        if let Some(owner) = &slot.shares {
            let _ = write!(holds, " (in the memory of {owner})");
        }
        vec![slot.name.clone(), bytes(slot.bytes), holds]
    });
    let chosen = plan.chosen.iter().flat_map(dials);
    let methods = plan.method_choice.iter().flat_map(method);
    let sections: [(&str, Vec<Vec<String>>); 5] = [
        ("Chosen dials", chosen.collect()),
        ("Method for this error", methods.collect()),
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

/// The advised method, what to expect of it, and why not the others.
fn method(advice: &MethodAdvice) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![row(&advice.method, advice.reason.clone())];
    if !advice.dials.is_empty() {
        let dials = advice.dials.iter();
        let dials: Vec<String> = dials
            .map(|(name, value)| format!("{name} {}", value.to_string().trim_matches('"')))
            .collect();
        rows.push(row("dials", dials.join(", ")));
    }
    rows.push(row(
        "expected",
        format!(
            "error {}, {:.0} ms, from {}",
            percent(advice.expected_error),
            advice.expected_ms,
            advice.source
        ),
    ));
    let others = advice.others.iter();
    rows.extend(others.map(|other| row(&format!("not {}", other.method), other.reason.clone())));
    rows
}

/// Chosen dials, what they are predicted to give, and why.
fn dials(chosen: &ChosenDials) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    vec![
        row("water_cells", chosen.water_cells.to_string()),
        row("map_texels", chosen.map_texels.to_string()),
        row("level_map_texels", chosen.level_map_texels.to_string()),
        row("split_levels", chosen.split_levels.to_string()),
        row("predicted", predicted(chosen)),
        row("reason", chosen.reason.clone()),
    ]
}
