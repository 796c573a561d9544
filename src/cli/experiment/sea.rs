//! `caustica experiment sea`.

use std::path::PathBuf;

use clap::Args;
use tokio_util::sync::CancellationToken;

use crate::cli::error::CliError;
use crate::cli::notes::say;
use crate::cli::progress::bar;
use crate::config::RenderConfig;
use crate::lab::experiment::sea::{self, SeaError, Settings};
use crate::render::Renderer;

/// What to measure, and where to write it.
#[derive(Clone, Debug, Args)]
pub struct SeaArgs {
    /// Depths of the floor, m, 0.1 … 100, separated by commas.
    #[arg(long, default_value = "0.5,1,2,5,10,25", value_name = "LIST")]
    pub depths: String,
    /// Winds 10 m above the sea, m/s, 1 … 20, separated by commas.
    #[arg(long, default_value = "2,5,7,10,15", value_name = "LIST")]
    pub winds: String,
    /// Maps for each depth and wind, each of a sea of its own.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub moments: u32,
    /// Length of the time series for each depth down to 5 m and each wind, s, 0.008 … 3600; there are 500 frames for each second.
    #[arg(long, default_value_t = 0.12, value_parser = seconds)]
    pub seconds: f64,
    /// Texels along each side of a map; each is a detector.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(16..=1024))]
    pub texels: u32,
    /// Most water cells along each side of the light's window; fewer are used where the shortest wave needs fewer.
    #[arg(long, default_value_t = 1024, value_parser = clap::value_parser!(u32).range(64..=2048))]
    pub water_cells: u32,
    /// Folder to write to; created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
}

/// Reads `--seconds`.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.008..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("accepted: a number, 0.008 … 3600".to_owned()),
    }
}

/// Reads a list of numbers of a flag; they come out ascending.
///
/// # Errors
/// [`CliError::Usage`] with what is accepted.
pub fn numbers(flag: &str, text: &str, [least, most]: [f64; 2]) -> Result<Vec<f64>, CliError> {
    let read = |text: &str| {
        let number = text.trim().parse::<f64>().ok();
        number.filter(|number| (least..=most).contains(number))
    };
    let list: Option<Vec<f64>> = text.split(',').map(read).collect();
    let mut list = list.unwrap_or_default();
    list.sort_by(f64::total_cmp);
    let is_sound = !list.is_empty() && list.windows(2).all(|pair| pair[0] < pair[1]);
    if is_sound {
        Ok(list)
    } else {
        Err(CliError::Usage(format!(
            "{flag} {text}: accepted: different numbers, {least} … {most}, separated by commas"
        )))
    }
}

impl SeaArgs {
    /// What is measured.
    ///
    /// # Errors
    /// [`CliError::Usage`] for an invalid list.
    pub fn settings(&self) -> Result<Settings, CliError> {
        Ok(Settings {
            depths_m: numbers("--depths", &self.depths, [0.1, 100.0])?,
            winds_m_s: numbers("--winds", &self.winds, [1.0, 20.0])?,
            moments: self.moments,
            seconds: self.seconds,
            texels: self.texels,
            water_cells: self.water_cells,
        })
    }
}

/// Runs the study and writes the results.
///
/// # Errors
/// An invalid list, a GPU that fails, a folder that cannot be written.
pub fn run(args: &SeaArgs, config: &RenderConfig) -> Result<(), CliError> {
    let settings = args.settings()?;
    std::fs::create_dir_all(&args.output).map_err(|e| CliError::write(&args.output, e))?;
    let mut renderer = Renderer::new(config)?;
    renderer.time_by_host(false);
    let never = CancellationToken::new();
    let progress = bar();
    let found = sea::measure(
        &settings,
        &mut |scene| Ok(renderer.render(scene, &never)?),
        &mut |done, total, what| {
            progress.set_position((1000 * done / total.max(1)) as u64);
            progress.set_message(what.to_owned());
        },
    )
    .map_err(failed)?;
    progress.finish_and_clear();
    for file in sea::write(&args.output, &found).map_err(failed)? {
        say(file.display().to_string());
    }
    Ok(())
}

fn failed(error: SeaError) -> CliError {
    match error {
        SeaError::Render(error) => CliError::Render(error),
        SeaError::Write { path, reason } => CliError::write(&path, reason),
        other => CliError::Study(other.to_string()),
    }
}
