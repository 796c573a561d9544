//! `caustica accuracy` and `caustica compare`: error against time of a scene, as tables, plots and pictures. The one sweeps dials, the other
//! compares methods, each at settings of its own.

use std::path::{Path, PathBuf};

use clap::Args;
use tokio_util::sync::CancellationToken;

use super::error::CliError;
use super::notes::{say, say_notes};
use super::progress::Progress;
use super::scene_file::{self, SceneFile};
use super::scene_flags::SceneArgs;
use super::summary::columns;
use crate::config::{Limits, RenderConfig};
use crate::lab::study::comparison::{self, METHOD_DIAL};
use crate::lab::study::dial::Dial;
use crate::lab::study::points::{Points, with_points};
use crate::lab::study::report::{ReportError, method_conclusions, write_study};
use crate::lab::study::study::{Point, Study, Sweep};
use crate::lab::study::sweep::{self, Refusal, StudyError, SweepSettings, run_study};
use crate::lab::study::words::named_setting;
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
    /// given several times. Without it, the dials that matter to the scene are swept. `method` as the only dial, without `--grid`, is
    /// what `caustica compare` does.
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
    let settings = SweepSettings {
        dials: dials(args, &scene.resolved)?,
        grid: args.grid,
        rungs: comparison::DEFAULT_RUNGS,
        runs: args.runs,
    };
    let asked = Asked {
        file: &args.scene.scene,
        truth_error: args.truth_error,
        folder: &args.output,
    };
    study_of(&scene, &asked, &settings, config, limits)
}

/// Which methods to compare, at what, and where to write the study.
#[derive(Clone, Debug, Args)]
pub struct CompareArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Methods, separated by commas: `all` (every method with every word of its dials), `photon`, `photon:all` (with every word),
    /// `photon:search=exact` (with this value of a dial; several are separated by commas).
    #[arg(long, default_value = comparison::ALL, value_name = "METHODS")]
    pub methods: String,
    /// Points to compare at: `map`, texels of a map of the floor, or `view`, what the camera sees. Default: those of the scene's own
    /// output. A map that the scene does not ask for shows a square of the floor around where the camera looks, in 256 × 256 texels.
    #[arg(long, value_enum)]
    pub points: Option<Points>,
    /// Settings of each method: with 4 those of 64, 128, 256 and 512 water cells, its other dials in proportion.
    #[arg(long, default_value_t = comparison::DEFAULT_RUNGS, value_parser = clap::value_parser!(u32).range(2..=6))]
    pub settings: u32,
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

/// Compares methods, each at settings of its own, with the reference and with each other: as [`run`], with one plot and one sheet of
/// pictures of all.
///
/// # Errors
///
/// As [`run`], and an unknown method.
pub fn compare(args: &CompareArgs, config: &RenderConfig, limits: &Limits) -> Result<(), CliError> {
    let mut scene = scene_file::load(&args.scene, None, limits)?;
    let file = &args.scene.scene;
    if let Some(points) = args.points {
        scene.resolved = with_points(&scene.resolved, points, limits).map_err(|error| {
            let file = file.display().to_string();
            CliError::Scene { file, error }
        })?;
    }
    let names = comparison::split_list(&args.methods);
    let dial = Dial::new(METHOD_DIAL, names)
        .map_err(|error| CliError::Usage(format!("--methods {}: {error}", args.methods)))?;
    let settings = SweepSettings {
        dials: vec![dial],
        grid: false,
        rungs: args.settings,
        runs: args.runs,
    };
    let asked = Asked {
        file,
        truth_error: args.truth_error,
        folder: &args.output,
    };
    study_of(&scene, &asked, &settings, config, limits)
}

/// What a study is made from, and where it goes.
struct Asked<'a> {
    file: &'a Path,
    truth_error: f64,
    folder: &'a Path,
}

fn study_of(
    scene: &SceneFile,
    asked: &Asked<'_>,
    settings: &SweepSettings,
    config: &RenderConfig,
    limits: &Limits,
) -> Result<(), CliError> {
    let resolved = &scene.resolved;
    // Check this before the reference is computed, which may take minutes.
    sweep::check(resolved, settings, limits).map_err(|error| refused(asked, error))?;
    std::fs::create_dir_all(asked.folder).map_err(|e| CliError::write(asked.folder, e))?;
    say_notes(&scene.notes);
    let progress = Progress::new();
    progress.say("the float64 truth");
    let truth_settings = TruthSettings {
        target_error: Some(asked.truth_error),
        disk: config.truth_cache.clone().or_else(cache_folder),
        ..TruthSettings::default()
    };
    let truth = truth(
        resolved,
        &truth_settings,
        &|part| progress.at(part),
        &|| false,
    )
    .map_err(|error| no_truth(asked, &error))?;
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
    let name = asked.file.file_stem().map(|s| s.to_string_lossy());
    let name = name.filter(|name| name != "-").unwrap_or_default();
    let (study, images) = run_study(
        resolved,
        &name,
        &truth,
        settings,
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
    .map_err(|error| refused(asked, error))?;
    progress.say("tables and plots");
    let files = write_study(asked.folder, &study, &images).map_err(not_written)?;
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

fn no_truth(asked: &Asked<'_>, error: &ReferenceError) -> CliError {
    CliError::Study(format!(
        "{}: no float64 truth: {error}",
        asked.file.display()
    ))
}

fn not_written(error: ReportError) -> CliError {
    match error {
        ReportError::Write { path, reason } => CliError::write(&path, reason),
        other => CliError::Study(other.to_string()),
    }
}

fn refused(asked: &Asked<'_>, error: StudyError<RenderError>) -> CliError {
    match error {
        StudyError::Render(error) => CliError::Render(error),
        StudyError::Scene(error) => CliError::Scene {
            file: asked.file.display().to_string(),
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
    for sweep in &study.sweeps {
        for point in &sweep.points {
            rows.push(row(sweep, point));
        }
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
    for sentence in method_conclusions(study)
        .iter()
        .filter(|_| study.is_comparison())
    {
        text.push_str(&format!("{sentence}\n"));
    }
    for warning in &study.warnings {
        text.push_str(&format!("warning: {}\n", warning.message));
    }
    text
}

fn row(sweep: &Sweep, point: &Point) -> Vec<String> {
    let dials = point.dials.iter();
    let dials: Vec<String> = dials
        .map(|(name, value)| format!("{name} {}", value.to_string().trim_matches('"')))
        .collect();
    let setting = match sweep.series {
        Some(_) => named_setting(sweep, point),
        None => dials.join(", "),
    };
    vec![
        setting,
        format!("{:.4} %", 100.0 * point.error.relative_l1),
        point
            .error
            .estimated
            .map_or_else(String::new, |e| format!("{:.4} %", 100.0 * e)),
        format!("{:.1}", point.cost.wall_ms.median),
        super::summary::bytes(point.cost.peak_bytes),
        if point.on_pareto_front { "*" } else { "" }.to_owned(),
    ]
}
