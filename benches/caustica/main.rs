//! `make bench`: measures the cost of Caustica on this machine and writes tables, also as `out/bench.md` and `out/bench.json`.
//!
//! `cargo bench --bench caustica -- --quick` is the short form. Every figure is the median of several warm runs with the
//! smallest and the largest beside it, since other work on the machine shows first in the largest.
//!
//! `frames` measures rendering, `instances` many objects, `savings` skipped or kept work, `accuracy` the estimate of a frame's error,
//! `pieces` long dispatches, `water` seas and basins, `files` encoding, `service` HTTP. `spread` summarises runs, `memory` reads the system's figures, `report`
//! writes the tables.

mod accuracy;
mod files;
mod frames;
mod instances;
mod memory;
mod pieces;
mod report;
mod savings;
mod service;
mod spread;
mod water;

use std::error::Error;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use caustica::cli::summary;
use caustica::config::RenderConfig;
use caustica::render::Renderer;

use report::Report;

/// The duration of measurements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Time for one row of a table, beyond the least number of runs.
    pub row: Duration,
    /// Least runs behind a figure.
    pub least_runs: usize,
    /// Time for one row of the table of the service.
    pub service_row: Duration,
    /// Target error of the float64 truth, relative L1.
    pub truth_error: f64,
}

const FULL: Effort = Effort {
    row: Duration::from_secs(4),
    least_runs: 3,
    service_row: Duration::from_secs(8),
    truth_error: 1e-3,
};

const QUICK: Effort = Effort {
    row: Duration::from_millis(200),
    least_runs: 1,
    service_row: Duration::from_millis(500),
    truth_error: 1e-2,
};

/// All benchmarks; arguments select some.
const ROOMS: [&str; 7] = [
    "frames",
    "instances",
    "savings",
    "estimates",
    "pieces",
    "water",
    "service",
];

fn main() -> ExitCode {
    let mut quick = false;
    let mut rooms: Vec<&str> = Vec::new();
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--quick" => quick = true,
            // Cargo adds this argument.
            "--bench" => {}
            other => {
                let Some(room) = ROOMS.into_iter().find(|room| *room == other) else {
                    eprintln!(
                        "error: unknown argument {other}; --quick is accepted, and any of {}",
                        ROOMS.join(", ")
                    );
                    return ExitCode::from(2);
                };
                rooms.push(room);
            }
        }
    }
    if rooms.is_empty() {
        rooms = ROOMS.to_vec();
    }
    match run(if quick { QUICK } else { FULL }, quick, &rooms) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(effort: Effort, quick: bool, rooms: &[&str]) -> Result<(), Box<dyn Error>> {
    let started = Instant::now();
    let mut report = Report::default();
    let renderer = Renderer::new(&RenderConfig::default())?;
    let adapter = renderer.adapter();
    report.fact("version", env!("CARGO_PKG_VERSION"));
    report.fact("adapter", &summary::adapter(&adapter));
    report.fact("software", &adapter.software.to_string());
    report.fact("cores", &cores());
    report.fact("form", if quick { "quick" } else { "full" });

    drop(renderer);
    // If something fails, the results so far are still printed.
    let measured = measure(&mut report, effort, rooms);
    report.fact("took", &format!("{:.0} s", started.elapsed().as_secs_f64()));
    println!("{}", report.markdown());
    for path in report.write("out")? {
        eprintln!("{}", path.display());
    }
    measured
}

/// Puts the tables of `rooms` into the report.
fn measure(report: &mut Report, effort: Effort, rooms: &[&str]) -> Result<(), Box<dyn Error>> {
    let mut stages = Vec::new();
    // Each scene gets its own renderer, so that one scene's memory does not count for another.
    let new_renderer = || Renderer::new(&RenderConfig::default());
    if rooms.contains(&"frames") {
        let sines = frames::sine_pool(&mut new_renderer()?, effort)?;
        let pool = frames::teapot_pool(&mut new_renderer()?, effort)?;
        report.tables.extend([sines.table, pool.table]);
        report.tables.push(files::encoding(&pool.frame, effort)?);
        stages.extend(sines.memory.into_iter().chain(pool.memory));
    }
    if rooms.contains(&"instances") {
        report.tables.push(instances::instances(effort)?);
    }
    if rooms.contains(&"savings") {
        report.tables.push(savings::savings(effort)?);
    }
    if rooms.contains(&"estimates") {
        let table = accuracy::estimates(&mut new_renderer()?, effort)?;
        report.tables.push(table);
    }
    if rooms.contains(&"pieces") {
        report.tables.push(pieces::pieces(effort)?);
    }
    if rooms.contains(&"water") {
        report.tables.push(water::water(effort)?);
    }
    if rooms.contains(&"service") {
        let service = service::requests(effort)?;
        report.tables.push(service.table);
        stages.push(service.memory);
    }
    if !stages.is_empty() {
        report.tables.push(memory::table(&stages));
    }
    Ok(())
}

fn cores() -> String {
    std::thread::available_parallelism().map_or_else(|_| "unknown".to_owned(), |n| n.to_string())
}
