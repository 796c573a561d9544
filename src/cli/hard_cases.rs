//! `caustica hard-cases`: runs the scenes that break caustics renderers on this machine.

use std::path::PathBuf;

use clap::Args;

use super::error::CliError;
use super::files;
use super::progress::bar;
use super::summary::{adapter, columns};
use crate::config::RenderConfig;
use crate::lab::hard_cases::{self, Case, Outcome, Settings, Truths, page};
use crate::output_files;
use crate::render::Renderer;

/// Which cases to run, and where to write the page.
#[derive(Clone, Debug, Args)]
pub struct HardCasesArgs {
    /// Run only cases whose name or family contains one of these words. Default: all.
    #[arg(value_name = "WORD")]
    pub only: Vec<String>,
    /// Folder for the page (`hard-cases.md`) and its pictures; created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Frames of the case `thousands_of_small_renders`.
    #[arg(long, env = "CAUSTICA_RENDERS", default_value_t = Settings::default().renders, value_name = "COUNT")]
    pub renders: u32,
}

/// Runs the suite, prints a line for each case, and writes the page if requested.
///
/// # Errors
///
/// [`CliError::HardCases`] if a case does not end as expected, [`CliError::Gpu`] if none can be run.
pub fn run(args: &HardCasesArgs, config: &RenderConfig) -> Result<(), CliError> {
    let cases: Vec<&'static Case> = hard_cases::all()
        .filter(|case| is_wanted(case, &args.only))
        .collect();
    if cases.is_empty() {
        return Err(CliError::Usage(format!(
            "no case has a name or family that contains {}",
            args.only.join(" or ")
        )));
    }
    let mut renderer = Renderer::new(config)?;
    let on = adapter(&renderer.adapter());
    let progress = bar();
    let mut outcomes = Vec::new();
    let mut truths = Truths::default();
    let settings = Settings {
        renders: args.renders,
        is_alone: true,
    };
    for (number, case) in cases.iter().copied().enumerate() {
        progress.set_position((1000 * number / cases.len()) as u64);
        progress.set_message(case.name);
        outcomes.push(hard_cases::run_with(
            case,
            &mut renderer,
            &mut truths,
            settings,
        ));
    }
    progress.finish_and_clear();
    files::print(&format!("{on}\n{}", in_words(&outcomes)))?;
    if let Some(folder) = &args.output {
        write(folder, &outcomes, &on)?;
    }
    let failed = outcomes.iter().filter(|o| !o.verdict.is_expected()).count();
    if failed > 0 {
        return Err(CliError::HardCases {
            failed,
            all: outcomes.len(),
        });
    }
    Ok(())
}

fn is_wanted(case: &Case, words: &[String]) -> bool {
    let holds = |word: &String| case.name.contains(word.as_str()) || case.family.name() == word;
    words.is_empty() || words.iter().any(holds)
}

/// The outcomes for people: a line for each.
pub fn in_words(outcomes: &[Outcome]) -> String {
    let rows: Vec<Vec<String>> = outcomes
        .iter()
        .map(|outcome| {
            let figure = outcome
                .figure
                .map_or_else(String::new, |figure| format!("{figure:.1e}"));
            vec![
                if outcome.verdict.is_expected() {
                    "ok"
                } else {
                    "FAILED"
                }
                .to_owned(),
                outcome.case.family.name().to_owned(),
                outcome.case.name.to_owned(),
                format!("{figure} of {:e}", outcome.case.bound),
                outcome.failure.clone().unwrap_or_default(),
            ]
        })
        .collect();
    columns(&rows, "")
}

fn write(folder: &std::path::Path, outcomes: &[Outcome], on: &str) -> Result<(), CliError> {
    let pictures = folder.join("hard-cases");
    std::fs::create_dir_all(&pictures).map_err(|e| CliError::write(&pictures, e))?;
    let picture_of = |outcome: &Outcome| pictures.join(format!("{}.png", outcome.case.name));
    let page_path = folder.join("hard-cases.md");
    let mut paths: Vec<PathBuf> = outcomes.iter().map(picture_of).collect();
    paths.push(page_path.clone());
    output_files::clear_leftovers(paths.iter().map(PathBuf::as_path));
    for outcome in outcomes {
        if let Some(bytes) = page::thumbnail(outcome) {
            files::write_whole(&picture_of(outcome), &bytes?)?;
        }
    }
    let text = page::markdown(outcomes, on, "hard-cases");
    files::write_whole(&page_path, text.as_bytes())
}
