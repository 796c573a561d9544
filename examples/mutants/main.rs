//! Plants errors in the project, one at a time, and checks that tests or hard cases catch each.
//!
//! Errors in shaders are planted in memory, and the hard cases of all families are rendered with each: a minute per error. Errors in Rust
//! are planted in a copy of the sources, all inactive. The tests are built there once and run with one plant active at a time.
//!
//! `make mutants` runs all and writes `docs/mutants.md`. With arguments (`cargo run --release --example mutants -- refract.rs`)
//! only plants run whose file or description contains one of them, and nothing is written. The exit code is 1 if a plant is not caught, or
//! if an unrelated case fails.
//!
//! * `shader_plants`, `plants`: the planted errors;
//! * `shader_trial`: rendering with planted shaders;
//! * `tree`: the copy of the sources for errors in Rust;
//! * `trial`: building and testing that copy;
//! * `table`: the page of results.

mod plants;
mod shader_plants;
mod shader_trial;
mod table;
mod tree;
mod trial;

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use plants::Plant;
use shader_plants::ShaderPlant;
use shader_trial::{Bench, Noticed};
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

/// Whether every plant was caught.
fn run() -> Result<bool, Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |file: &str, what: &str| {
        let holds = |word: &String| file.contains(word) || what.contains(word);
        words.is_empty() || words.iter().any(holds)
    };
    let in_shaders = shader_plants::ALL.iter();
    let in_shaders: Vec<&ShaderPlant> = in_shaders.filter(|p| is_wanted(p.file, p.what)).collect();
    let in_rust = plants::ALL.iter();
    let in_rust: Vec<&Plant> = in_rust.filter(|p| is_wanted(p.file, p.what)).collect();
    if in_shaders.is_empty() && in_rust.is_empty() {
        return Err(format!(
            "no plant's file or description contains {}",
            words.join(" or ")
        )
        .into());
    }
    let noticed = plant_shaders(&in_shaders)?;
    let outcomes = plant_rust(&in_rust)?;
    let page = table::page(&in_shaders, &noticed, &in_rust, &outcomes);
    println!("{page}");
    if words.is_empty() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        std::fs::write(root.join(PAGE), &page)?;
    }
    let all_noticed = noticed.iter().all(Noticed::is_exact);
    Ok(all_noticed && outcomes.iter().all(Outcome::is_caught))
}

fn plant_shaders(plants: &[&ShaderPlant]) -> Result<Vec<Noticed>, Box<dyn Error>> {
    let mut bench = Bench::default();
    let mut all = Vec::new();
    for (number, plant) in plants.iter().enumerate() {
        eprintln!(
            "shaders, {} of {}: {}",
            number + 1,
            plants.len(),
            plant.what
        );
        let noticed = bench.try_plant(plant)?;
        let red: Vec<&str> = noticed.red.iter().map(|case| case.name).collect();
        eprintln!("  red: {}", red.join(", "));
        if !noticed.missing.is_empty() {
            eprintln!("  NOT CAUGHT by {}", noticed.missing.join(", "));
        }
        if !noticed.unexpected.is_empty() {
            eprintln!("  NOT EXPECTED: {}", noticed.unexpected.join(", "));
        }
        all.push(noticed);
    }
    Ok(all)
}

fn plant_rust(plants: &[&Plant]) -> Result<Vec<Outcome>, Box<dyn Error>> {
    if plants.is_empty() {
        return Ok(Vec::new());
    }
    let tree = Tree::copy(Path::new(env!("CARGO_MANIFEST_DIR")), plants::ALL)?;
    let workshop = Workshop::of(&tree);
    let mut programs = BTreeMap::new();
    // Tests that fail without a plant would seem to catch everything.
    for binary in ["cpu", "gpu"] {
        let here = plants.iter().filter(|plant| plant.binary == binary);
        let tests: Vec<&str> = here.flat_map(|plant| plant.tests).copied().collect();
        if tests.is_empty() {
            continue;
        }
        eprintln!("as it is, {binary} …");
        let program = workshop.build(binary)??;
        match workshop.run(&program, &tests, None)? {
            Outcome::Survived => {}
            other => return Err(format!("without any plant: {other}").into()),
        }
        programs.insert(binary, program);
    }
    let mut outcomes = Vec::new();
    for (number, plant) in plants.iter().enumerate() {
        eprintln!("Rust, {} of {}: {}", number + 1, plants.len(), plant.what);
        let place = plants::ALL
            .iter()
            .position(|other| other.what == plant.what);
        let awake = place.map(|place| place + 1);
        let outcome = workshop.run(&programs[plant.binary], plant.tests, awake)?;
        eprintln!("  {outcome}");
        outcomes.push(outcome);
    }
    Ok(outcomes)
}
