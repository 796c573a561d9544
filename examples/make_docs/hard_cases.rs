//! Writes `docs/hard-cases.md` with its thumbnails: the suite, run here.

use std::error::Error;

use caustica::cli::hard_cases::{HardCasesArgs, run};
use caustica::config::RenderConfig;
use caustica::lab::hard_cases::Settings;

/// What the page is called on the command line.
pub(crate) const NAME: &str = "hard_cases";

/// Runs the suite and writes the page; cases that do not end as expected are on it, and then an error.
pub(crate) fn write() -> Result<(), Box<dyn Error>> {
    let args = HardCasesArgs {
        only: Vec::new(),
        output: Some("docs".into()),
        renders: Settings::default().renders,
    };
    Ok(run(&args, &RenderConfig::default())?)
}
