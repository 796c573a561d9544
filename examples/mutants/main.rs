//! Plants wrong signs in a copy of the project, one at a time, and sees that the tests notice each.
//!
//! `make mutants` runs all and writes `docs/mutants.md`; each takes a build, so minutes. With words behind it
//! (`cargo run --release --example mutants -- refract.rs`) only the plants run whose file or description holds one of them, and
//! nothing is written. Exit code 1 if one survives.
//!
//! * `plants`: what is planted;
//! * `tree`: the copy it is planted in;
//! * `trial`: building and testing that;
//! * `table`: what came of it.

mod plants;
mod table;
mod tree;
mod trial;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use plants::Plant;
use tree::Tree;
use trial::{Outcome, Workshop};

/// The page that a full run writes.
const PAGE: &str = "docs/mutants.md";

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether every plant was noticed.
fn run() -> Result<bool, Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |plant: &&Plant| {
        let holds = |word: &String| plant.file.contains(word) || plant.what.contains(word);
        words.is_empty() || words.iter().any(holds)
    };
    let plants: Vec<&Plant> = plants::ALL.iter().filter(is_wanted).collect();
    if plants.is_empty() {
        return Err(format!(
            "no plant's file or description holds {}",
            words.join(" or ")
        )
        .into());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let tree = Tree::copy(root)?;
    let workshop = Workshop::of(&tree);
    // Tests that fail anyway would notice everything.
    for binary in ["cpu", "gpu"] {
        let here = plants.iter().filter(|plant| plant.binary == binary);
        let tests: Vec<&str> = here.flat_map(|plant| plant.tests).copied().collect();
        if tests.is_empty() {
            continue;
        }
        eprintln!("as it is, {binary} …");
        match workshop.test(binary, &tests)? {
            Outcome::Survived => {}
            other => return Err(format!("without any plant: {other}").into()),
        }
    }
    let mut outcomes = Vec::new();
    for (number, plant) in plants.iter().enumerate() {
        eprintln!("{} of {}: {}", number + 1, plants.len(), plant.what);
        let planted = tree.plant(plant)?;
        let outcome = workshop.test(plant.binary, plant.tests);
        planted.remove()?;
        let outcome = outcome?;
        eprintln!("  {outcome}");
        outcomes.push(outcome);
    }
    let page = table::page(&plants, &outcomes);
    println!("{page}");
    if words.is_empty() {
        std::fs::write(root.join(PAGE), &page)?;
    }
    Ok(outcomes.iter().all(Outcome::is_caught))
}
