//! `caustica accuracy`: error against time of a scene, as tables, plots and pictures.

use std::path::{Path, PathBuf};

use clap::Args;
use tokio_util::sync::CancellationToken;

use super::error::CliError;
use super::notes::{say, say_notes};
use super::progress::Progress;
use super::scene_file;
use super::scene_flags::SceneArgs;
use super::summary::columns;
use crate::config::{Limits, RenderConfig};
use crate::lab::study::dial::Dial;
use crate::lab::study::report::{ReportError, write_study};
use crate::lab::study::study::Study;
use crate::lab::study::sweep::{self, Refusal, StudyError, SweepSettings, run_study};
use crate::reference::{ReferenceError, TruthSettings, truth};
use crate::render::{RenderError, Renderer};
use crate::scene::ResolvedScene;

/// What to sweep, and where to write the study.
#[derive(Clone, Debug, Args)]
pub struct AccuracyArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A dial of `quality` and its values: `water_cells=64..1024` (doubling), `split_levels=0..4` (counting), `a,b,c`. May be
    /// given several times. Without it, the dials that matter to the scene are swept.
    #[arg(long, value_name = "NAME=VALUES")]
    pub dial: Vec<String>,
    /// Sweep all combinations of the dials instead of one dial at a time.
    #[arg(long)]
    pub grid: bool,
    /// Timed runs of each setting; settings that take over a second get three.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,
    /// Largest relative L1 error of the float64 reference, by its own estimate.
    #[arg(long, default_value_t = 2e-3, value_parser = truth_error, value_name = "ERROR")]
    pub truth_error: f64,
    /// Folder to write to; created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
}

/// Reads `--truth-error`.
pub(super) fn truth_error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if (1e-6..=0.1).contains(&error) => Ok(error),
        _ => Err("accepted: a number, 0.000001 … 0.1".to_owned()),
    }
}

/// Computes the reference, sweeps the dials, writes the study, and prints a summary to stderr.
///
/// # Errors
///
/// A bad scene or dial, a scene without a truth, a GPU that fails, a folder that cannot be written.
pub fn run(args: &AccuracyArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let scene = scene_file::load(&args.scene, None, limits)?;
    let resolved = &scene.resolved;
    let settings = SweepSettings {
        dials: dials(args, resolved)?,
        grid: args.grid,
        runs: args.runs,
    };
    // Check this before the reference is computed, which may take minutes.
    sweep::check(resolved, &settings, limits).map_err(|error| refused(args, error))?;
    std::fs::create_dir_all(&args.output).map_err(|e| CliError::write(&args.output, e))?;
    say_notes(&scene.notes);
    let progress = Progress::new();
    progress.say("the float64 truth");
    let truth_settings = TruthSettings {
        target_error: Some(args.truth_error),
        disk: config.truth_cache.clone().or_else(cache_folder),
        ..TruthSettings::default()
    };
    let truth = truth(
        resolved,
        &truth_settings,
        &|part| progress.at(part),
        &|| false,
    )
    .map_err(|error| no_truth(args, &error))?;
    let mut renderer = Renderer::new(config)?;
    let never = CancellationToken::new();
    let mut render = |scene: ResolvedScene| {
        renderer
            .render(&scene, &never)
            .map_err(|error| match error {
                RenderError::OverBudget { .. } => Refusal::Setting(error),
                _ => Refusal::All(error),
            })
    };
    let name = args.scene.scene.file_stem().map(|s| s.to_string_lossy());
    let name = name.filter(|name| name != "-").unwrap_or_default();
    let (study, images) = run_study(
        resolved,
        &name,
        &truth,
        &settings,
        limits,
        &mut render,
        &mut |done, total, what| {
            progress.at(done as f64 / total.max(1) as f64);
            if done < total {
                progress.say(&format!("{} of {total}: {what}", done + 1));
            }
            true
        },
    )
    .map_err(|error| refused(args, error))?;
    progress.say("tables and plots");
    let files = write_study(&args.output, &study, &images).map_err(not_written)?;
    progress.finish();
    say(in_words(&study));
    for file in files {
        say(file.display().to_string());
    }
    Ok(())
}

fn dials(args: &AccuracyArgs, resolved: &ResolvedScene) -> Result<Vec<Dial>, CliError> {
    if args.dial.is_empty() {
        return Ok(Dial::for_scene(resolved));
    }
    args.dial
        .iter()
        .map(|text| Dial::parse(text).map_err(|e| CliError::Usage(format!("--dial {text}: {e}"))))
        .collect()
}

/// The folder of the user's caches.
pub(super) fn cache_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("XDG_CACHE_HOME")
        .map(PathBuf::from)
        .filter(|path| path.is_absolute())
        .or_else(|| std::env::var_os("HOME").map(|home| Path::new(&home).join(".cache")))?;
    Some(folder.join("caustica").join("truth"))
}

fn no_truth(args: &AccuracyArgs, error: &ReferenceError) -> CliError {
    CliError::Study(format!(
        "{}: no float64 truth: {error}",
        args.scene.scene.display()
    ))
}

fn not_written(error: ReportError) -> CliError {
    match error {
        ReportError::Write { path, reason } => CliError::write(&path, reason),
        other => CliError::Study(other.to_string()),
    }
}

fn refused(args: &AccuracyArgs, error: StudyError<RenderError>) -> CliError {
    match error {
        StudyError::Render(error) => CliError::Render(error),
        StudyError::Scene(error) => CliError::Scene {
            file: args.scene.scene.display().to_string(),
            error,
        },
        other => CliError::Study(other.to_string()),
    }
}

/// The study for a terminal: a line for each setting, with a star if no other setting is both faster and more accurate.
pub fn in_words(study: &Study) -> String {
    let mut text = format!(
        "{}, on {}\ntruth: {:.1e} rays, its own error {:.3} %, {:.0} s{}\n",
        study.truth.what,
        study.adapter.name,
        study.truth.rays as f64,
        100.0 * study.truth.relative_error,
        study.truth.seconds,
        if study.truth.from_disk {
            " (kept from before)"
        } else {
            ""
        },
    );
    let mut rows = vec![
        ["setting", "L1", "estimated", "ms", "peak", ""]
            .map(str::to_owned)
            .to_vec(),
    ];
    for point in study.sweeps.iter().flat_map(|sweep| &sweep.points) {
        let dials: Vec<String> = point
            .dials
            .iter()
            .map(|(name, value)| format!("{name} {}", value.to_string().trim_matches('"')))
            .collect();
        rows.push(vec![
            dials.join(", "),
            format!("{:.4} %", 100.0 * point.error.relative_l1),
            point
                .error
                .estimated
                .map_or_else(String::new, |e| format!("{:.4} %", 100.0 * e)),
            format!("{:.1}", point.cost.wall_ms.median),
            super::summary::bytes(point.cost.peak_bytes),
            if point.on_pareto_front { "*" } else { "" }.to_owned(),
        ]);
    }
    text.push_str(&columns(&rows, "  "));
    text.push('\n');
    for sweep in &study.sweeps {
        if let Some(order) = sweep.order {
            text.push_str(&format!("{}: order {order:.2}\n", sweep.dial));
        }
        if let Some(factor) = sweep.factor_per_level {
            text.push_str(&format!("{}: error ÷ {factor:.2} per level\n", sweep.dial));
        }
    }
    for warning in &study.warnings {
        text.push_str(&format!("warning: {}\n", warning.message));
    }
    text
}
