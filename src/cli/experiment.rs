//! `caustica experiment`: repeats published experiments. `sea` has a file of its own.

pub mod sea;

use std::cell::RefCell;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use tokio_util::sync::CancellationToken;

use super::accuracy::cache_folder;
use super::error::CliError;
use super::notes::say;
use super::progress::bar;
use crate::config::RenderConfig;
use crate::lab::experiment::level_map::{self, ExperimentError, Settings};
use crate::lab::shapes;
use crate::reference::{TruthSettings, truth};
use crate::render::Renderer;

/// Planes of the default run.
const PLANES: &str = "3,5,9,17,25,33,50,67,84,101";

/// Which experiment.
#[derive(Clone, Debug, Args)]
pub struct ExperimentArgs {
    /// Which experiment.
    #[command(subcommand)]
    pub which: Which,
}

/// Which experiment.
#[derive(Clone, Debug, Subcommand)]
pub enum Which {
    /// Compares level maps with slice images, smart with uniform slicing, and both with exact ray hits (Tipprasert 2006, ch. 5).
    LevelMap(LevelMapArgs),
    /// Measures how sunlight on a floor under the sea fluctuates with depth and wind, beside what was measured at sea.
    Sea(sea::SeaArgs),
}

/// What to measure, and where to write it.
#[derive(Clone, Debug, Args)]
pub struct LevelMapArgs {
    /// Shapes of the catalogue, separated by commas, or `all`.
    #[arg(long, default_value = "all", value_name = "NAMES")]
    pub meshes: String,
    /// Numbers of planes, 2 … 1024: `a,b,c`, or `a..b` for every one from a to b.
    #[arg(long, default_value = PLANES, value_name = "LIST")]
    pub planes: String,
    /// Timed runs of each setting; the methods are interleaved.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub runs: u32,
    /// Water cells along each side of the light's window.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(2..=2048))]
    pub water_cells: u32,
    /// Texels along each side of the maps: 16, 32 … 2048.
    #[arg(long, default_value_t = 128, value_parser = texels)]
    pub texels: u32,
    /// Measure no errors. This saves the float64 reference, which takes most of the time.
    #[arg(long)]
    pub no_truth: bool,
    /// Largest relative L1 error of the float64 reference, by its own estimate.
    #[arg(long, default_value_t = 3e-3, value_parser = super::accuracy::truth_error, value_name = "ERROR")]
    pub truth_error: f64,
    /// Folder to write to; created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
}

/// Reads `--texels`.
fn texels(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(texels) if texels.is_power_of_two() && (16..=2048).contains(&texels) => Ok(texels),
        _ => Err("accepted: a power of two, 16 … 2048".to_owned()),
    }
}

/// Reads `--planes`.
///
/// # Errors
/// [`CliError::Usage`] with what is accepted.
pub fn planes(text: &str) -> Result<Vec<u32>, CliError> {
    let refused = || {
        CliError::Usage(format!(
            "--planes {text}: accepted: a,b,c or a..b with numbers 2 … 1024"
        ))
    };
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| refused());
    let list: Vec<u32> = match text.split_once("..") {
        Some((low, high)) => (number(low)?..=number(high)?).collect(),
        None => text.split(',').map(number).collect::<Result<_, _>>()?,
    };
    let fits = !list.is_empty() && list.iter().all(|planes| (2..=1024).contains(planes));
    if fits { Ok(list) } else { Err(refused()) }
}

/// Reads `--meshes`.
///
/// # Errors
/// [`CliError::Usage`] with the existing names.
pub fn meshes(text: &str) -> Result<Vec<String>, CliError> {
    let all = || shapes::ALL.iter().map(|shape| shape.name.to_owned());
    if text.trim() == "all" {
        return Ok(all().collect());
    }
    let names = text.split(',').map(|name| name.trim().to_owned());
    names
        .map(|name| match shapes::Shape::named(&name) {
            Some(_) => Ok(name),
            None => Err(CliError::Usage(format!(
                "--meshes: there is no shape `{name}`; accepted: all, {}",
                all().collect::<Vec<_>>().join(", ")
            ))),
        })
        .collect()
}

/// Runs the experiment and writes the results.
///
/// # Errors
/// An invalid name or list, a GPU that fails, a folder that cannot be written.
pub fn run(args: &ExperimentArgs, config: &RenderConfig) -> Result<(), CliError> {
    match &args.which {
        Which::LevelMap(args) => run_level_map(args, config),
        Which::Sea(args) => sea::run(args, config),
    }
}

fn run_level_map(args: &LevelMapArgs, config: &RenderConfig) -> Result<(), CliError> {
    let settings = Settings {
        meshes: meshes(&args.meshes)?,
        planes: planes(&args.planes)?,
        runs: args.runs,
        water_cells: args.water_cells,
        texels: args.texels,
    };
    std::fs::create_dir_all(&args.output).map_err(|e| CliError::write(&args.output, e))?;
    let renderer = RefCell::new(Renderer::new(config)?);
    renderer.borrow_mut().watch_allocator(true);
    let never = CancellationToken::new();
    let progress = bar();
    let truth_settings = TruthSettings {
        target_error: Some(args.truth_error),
        disk: config.truth_cache.clone().or_else(cache_folder),
        ..TruthSettings::default()
    };
    let found = level_map::measure(
        &settings,
        &mut |scene| Ok(renderer.borrow_mut().render(scene, &never)?),
        &mut |scene| {
            let wanted = !args.no_truth;
            let found = wanted.then(|| truth(scene, &truth_settings, &|_| {}, &|| false));
            Ok(found.transpose()?)
        },
        &mut |done, total, what| {
            progress.set_position((1000 * done / total.max(1)) as u64);
            progress.set_message(what.to_owned());
        },
    )
    .map_err(failed)?;
    progress.finish_and_clear();
    for file in level_map::write(&args.output, &found).map_err(failed)? {
        say(file.display().to_string());
    }
    Ok(())
}

fn failed(error: ExperimentError) -> CliError {
    match error {
        ExperimentError::Render(error) => CliError::Render(error),
        ExperimentError::Write { path, reason } => CliError::write(&path, reason),
        other => CliError::Study(other.to_string()),
    }
}
