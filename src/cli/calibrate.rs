//! `caustica calibrate`: measures what predictions of time and error rest on, on this machine.

use std::io::IsTerminal;
use std::path::PathBuf;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use tokio_util::sync::CancellationToken;

use super::error::CliError;
use super::files;
use crate::config::RenderConfig;
use crate::render::Renderer;
use crate::tuning::measure::{self, MeasureError};

/// Where the calibration goes.
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
/// When the GPU fails, gives no times, or the file cannot be written.
pub fn run(args: &CalibrateArgs, config: &RenderConfig) -> Result<(), CliError> {
    files::check_place(&args.output)?;
    let mut renderer = Renderer::new(config)?;
    let bar = bar();
    let calibration = measure::calibration(
        &mut |scene| renderer.render(scene, &CancellationToken::new()),
        &|what, part| {
            bar.set_message(what.to_owned());
            bar.set_position((1000.0 * part) as u64);
        },
    )
    .map_err(|error| match error {
        MeasureError::Render(error) => CliError::Render(error),
        other => CliError::Study(other.to_string()),
    })?;
    bar.finish_and_clear();
    files::write_whole(&args.output, files::json(&calibration).as_bytes())?;
    eprintln!(
        "{}: {} passes on {}; true errors are at most {:.2} times the estimate\nuse it with --calibration {} or CAUSTICA_CALIBRATION",
        args.output.display(),
        calibration.passes.len(),
        calibration.adapter,
        calibration.error_margin,
        args.output.display(),
    );
    Ok(())
}

/// A bar of a thousand steps on stderr, if a person looks at it.
pub(super) fn bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {percent}% {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000).with_style(style)
}
