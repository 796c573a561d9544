//! The page about plants and what noticed them.

use std::fmt::Write as _;

use super::plants::Plant;
use super::trial::Outcome;

/// A Markdown page: a row for each plant.
pub(crate) fn page(plants: &[&Plant], outcomes: &[Outcome]) -> String {
    let caught = outcomes.iter().filter(|outcome| outcome.is_caught());
    let mut page = format!(
        "# Planted errors\n\nEach of these was put into a copy of the sources, alone, and the tests were run; `make mutants` does \
         it again. {} of {} were caught.\n\n| what | where | instead | caught by |\n|---|---|---|---|\n",
        caught.count(),
        outcomes.len()
    );
    for (plant, outcome) in plants.iter().zip(outcomes) {
        let by = match outcome {
            Outcome::Caught(tests) => {
                let tests: Vec<String> = tests.iter().map(|test| code(test)).collect();
                format!("{}: {}", plant.binary, tests.join(", "))
            }
            other => format!("**{other}**"),
        };
        let (file, from, to) = (code(plant.file), code(plant.from), code(plant.to));
        let _ = writeln!(page, "| {} | {file}: {from} | {to} | {by} |", plant.what);
    }
    page
}

/// Text as it is, in a cell of a table.
fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}
