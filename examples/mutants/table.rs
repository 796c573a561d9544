//! The page about plants and what noticed them.

use std::fmt::Write as _;

use super::plants::Plant;
use super::shader_plants::ShaderPlant;
use super::shader_trial::Noticed;
use super::trial::Outcome;

/// A Markdown page: a row for each plant.
pub(crate) fn page(
    shader_plants: &[&ShaderPlant],
    noticed: &[Noticed],
    plants: &[&Plant],
    outcomes: &[Outcome],
) -> String {
    let in_shaders = noticed.iter().filter(|n| n.missing.is_empty()).count();
    let in_rust = outcomes
        .iter()
        .filter(|outcome| outcome.is_caught())
        .count();
    let mut page = format!(
        "# Planted errors\n\nEach of these was put into the project, alone, and its tests were run; `make mutants` does it again. \
         {} of {} were caught.\n",
        in_shaders + in_rust,
        noticed.len() + outcomes.len()
    );
    page.push_str(
        "\n## In shaders, against the hard cases\n\nThe hard cases of one family were run with each, those that are known to fail \
         left out. Bold: cases that had to notice and did not.\n\n\
         | family | what | where | instead | cases that turned red |\n|---|---|---|---|---|\n",
    );
    for (plant, noticed) in shader_plants.iter().zip(noticed) {
        let red: Vec<String> = noticed.red.iter().map(|name| code(name)).collect();
        let mut by = format!("{} of {}", red.len(), noticed.of);
        if !red.is_empty() {
            let _ = write!(by, ": {}", red.join(", "));
        }
        for name in &noticed.missing {
            let _ = write!(by, ", **not {name}**");
        }
        let (file, from, to) = (code(plant.file), code(plant.from), code(plant.to));
        let _ = writeln!(
            page,
            "| {} | {} | {file}: {from} | {to} | {by} |",
            plant.family, plant.what
        );
    }
    page.push_str(
        "\n## In Rust, against the tests\n\n| what | where | instead | caught by |\n|---|---|---|---|\n",
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

/// Text as it is, in a cell of a table: on one line.
fn code(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    format!("`{}`", words.join(" ").replace('|', "\\|"))
}
