//! `caustica calibrate`: measures this machine for predictions of time and error.

use std::path::PathBuf;

use clap::Args;
use tokio_util::sync::CancellationToken;

use super::error::CliError;
use super::files::{self, Destination};
use super::notes::say;
use super::progress::Progress;
use crate::config::RenderConfig;
use crate::lab::calibrate::{self, MeasureError};
use crate::render::Renderer;

/// Where to write the calibration.
#[derive(Clone, Debug, Args)]
pub struct CalibrateArgs {
    /// File to write (JSON), for `--calibration` or CAUSTICA_CALIBRATION.
    #[arg(short, long, value_name = "FILE", default_value = "calibration.json")]
    pub output: PathBuf,
}

/// Measures and writes a calibration.
///
/// # Errors
///
/// If the GPU fails or gives no times, or if the file cannot be written.
pub fn run(args: &CalibrateArgs, config: &RenderConfig) -> Result<(), CliError> {
    Destination::File(args.output.clone()).check()?;
    let mut renderer = Renderer::new(config)?;
    let progress = Progress::new();
    let calibration = calibrate::calibration(
        &mut |scene| renderer.render(scene, &CancellationToken::new()),
        &|what, part| {
            progress.say(what);
            progress.at(part);
        },
    )
    .map_err(|error| match error {
        MeasureError::Render(error) => CliError::Render(error),
        other => CliError::Study(other.to_string()),
    })?;
    progress.finish();
    files::write_whole(&args.output, files::json(&calibration).as_bytes())?;
    say(format!(
        "{}: {} passes on {}; true errors are at most {:.2} times the estimate\nuse it with --calibration {} or CAUSTICA_CALIBRATION",
        args.output.display(),
        calibration.passes.len(),
        calibration.adapter,
        calibration.error_margin,
        args.output.display(),
    ));
    Ok(())
}
