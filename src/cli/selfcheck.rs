//! `caustica selfcheck`: checks that the GPU of this machine computes correctly.

use clap::Args;

use super::error::CliError;
use super::files;
use super::summary::{adapter, columns};
use crate::config::RenderConfig;
use crate::render::{Renderer, SelfCheck};

/// How to print the result.
#[derive(Clone, Debug, Args)]
pub struct SelfcheckArgs {
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Runs the self-check and prints every check.
///
/// # Errors
///
/// [`CliError::SelfCheck`] if a check is outside its tolerance, [`CliError::Gpu`] if it cannot be run.
pub fn run(args: &SelfcheckArgs, config: &RenderConfig) -> Result<(), CliError> {
    let mut renderer = Renderer::new(config)?;
    let check = renderer.self_check()?;
    if args.json {
        files::print(&files::json(&check))?;
    } else {
        let on = adapter(&renderer.adapter());
        files::print(&format!("{on}\n{}", in_words(&check)))?;
    }
    verdict(&check)
}

/// The result for people: a line for each check.
pub fn in_words(check: &SelfCheck) -> String {
    let rows: Vec<Vec<String>> = check
        .checks
        .iter()
        .map(|item| {
            vec![
                if item.passed { "ok" } else { "FAILED" }.to_owned(),
                item.name.clone(),
                format!("error {:.1e} of {:.1e}", item.error, item.tolerance),
            ]
        })
        .collect();
    columns(&rows, "")
}

/// Fails if a check failed, or if nothing was checked.
pub fn verdict(check: &SelfCheck) -> Result<(), CliError> {
    let all = check.checks.len();
    let failed = check.checks.iter().filter(|item| !item.passed).count();
    if check.passed && failed == 0 && all > 0 {
        Ok(())
    } else {
        Err(CliError::SelfCheck { failed, all })
    }
}
