//! The page about the plants and the tests that caught them.

use std::fmt::Write as _;

use caustica::lab::hard_cases::{Case, Family};

use super::plants::Plant;
use super::shader_plants::ShaderPlant;
use super::shader_trial::{Noticed, tried};
use super::trial::Outcome;

/// A Markdown page: a row for each plant.
pub(crate) fn page(
    shader_plants: &[&ShaderPlant],
    noticed: &[Noticed],
    plants: &[&Plant],
    outcomes: &[Outcome],
) -> String {
    let in_shaders = noticed.iter().filter(|n| n.is_exact()).count();
    let in_rust = outcomes
        .iter()
        .filter(|outcome| outcome.is_caught())
        .count();
    let mut page = format!(
        "# Planted errors\n\nEach of these errors was planted in the project, one at a time, and the tests were run. `make \
        mutants` repeats this. \
         {} of {} were caught.\n",
        in_shaders + in_rust,
        noticed.len() + outcomes.len()
    );
    page.push_str(
        "\n## In shaders, against the hard cases\n\nEach error was tested with the hard cases of all families, except those \
        about the device and those that are known to fail. Each plant lists the cases that must fail; no other case may fail. \
        Deviations are in bold.\n\n\
         | family | error | place | planted | cases that failed |\n|---|---|---|---|---|\n",
    );
    for (plant, noticed) in shader_plants.iter().zip(noticed) {
        let mut by: Vec<String> = Vec::new();
        for family in Family::ALL {
            let of_family = |case: &&'static Case| case.family == family;
            let red: Vec<String> = (noticed.red.iter().copied().filter(of_family))
                .map(|case| code(case.name))
                .collect();
            if !red.is_empty() {
                let of = tried().filter(of_family).count();
                by.push(format!(
                    "{} {} of {of}: {}",
                    family.name(),
                    red.len(),
                    red.join(", ")
                ));
            }
        }
        by.extend(noticed.missing.iter().map(|name| format!("**not {name}**")));
        let unexpected = noticed.unexpected.iter();
        by.extend(unexpected.map(|name| format!("**{name} is not expected**")));
        let by = by.join("; ");
        let (file, from, to) = (code(plant.file), code(plant.from), code(plant.to));
        let _ = writeln!(
            page,
            "| {} | {} | {file}: {from} | {to} | {by} |",
            plant.family, plant.what
        );
    }
    page.push_str(
        "\n## In Rust, against the tests\n\nErrors that hard cases must catch were tested with all hard cases: the listed ones \
        failed, and no other.\n\n\
         | error | place | planted | caught by |\n|---|---|---|---|\n",
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

/// Code in a cell of a table, on one line.
fn code(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    format!("`{}`", words.join(" ").replace('|', "\\|"))
}
