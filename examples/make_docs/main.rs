//! Writes `docs/accuracy.md` (the effect of each dial on the example scenes, measured by the program itself), `docs/level-maps.md`
//! (the thesis's experiments with our measurements), `docs/sea.md` (sunlight under the sea), `docs/hard-cases.md`, `docs/waves.md`
//! (each kind of water) and `docs/methods.md` (every method on several scenes). The arguments `accuracy`, `level_maps`, `sea`, `hard_cases`,
//! `waves` and `methods` write only that page; names of scenes print the text about them, after `methods` that of its page.
//!
//! `make docs` runs it. Truths are kept in `out/truth`, so a second run only renders. Times are of the machine that it runs on, which
//! the page names.

mod hard_cases;
mod layers;
mod level_maps;
mod methods;
mod methods_page;
mod page;
mod papers;
mod residual;
mod scenes;
mod sea;
mod targets;
mod waves;

use std::error::Error;
use std::path::Path;

use caustica::config::{Limits, RenderConfig};
use caustica::lab::study::comparison;
use caustica::lab::study::report::write_study;
use caustica::lab::study::sweep::{Refusal, SweepSettings, run_study};
use caustica::reference::{TruthSettings, truth};
use caustica::render::{RenderError, Renderer};
use tokio_util::sync::CancellationToken;

use page::Chapter;

/// The argument that writes the page of dials only.
const ACCURACY: &str = "accuracy";
/// Timed runs of each setting.
const RUNS: u32 = 5;

fn main() -> Result<(), Box<dyn Error>> {
    let only: Vec<String> = std::env::args().skip(1).collect();
    let mut chapters = Vec::new();
    if let Some((methods::NAME, rest)) =
        only.split_first().map(|(name, rest)| (name.as_str(), rest))
    {
        return methods::write(rest);
    }
    if only.is_empty() {
        methods::write(&[])?;
    }
    if only.is_empty() || only.iter().any(|name| name == level_maps::NAME) {
        eprintln!("{} …", level_maps::NAME);
        level_maps::write()?;
    }
    if only.is_empty() || only.iter().any(|name| name == sea::NAME) {
        eprintln!("{} …", sea::NAME);
        sea::write()?;
    }
    if only.is_empty() || only.iter().any(|name| name == hard_cases::NAME) {
        eprintln!("{} …", hard_cases::NAME);
        hard_cases::write()?;
    }
    if only.is_empty() || only.iter().any(|name| name == waves::NAME) {
        eprintln!("{} …", waves::NAME);
        waves::write()?;
    }
    let is_whole_page = only.is_empty() || only.iter().any(|name| name == ACCURACY);
    let wanted = |name: &str| is_whole_page || only.iter().any(|o| o == name);
    for scene in scenes::ALL.iter().filter(|scene| wanted(scene.name)) {
        eprintln!("{} …", scene.name);
        let resolved = scenes::load(scene.name)?;
        let settings = TruthSettings {
            target_error: Some(scene.truth_error),
            disk: Some("out/truth".into()),
            ..TruthSettings::default()
        };
        let truth = truth(&resolved, &settings, &|_| {}, &|| false)?;
        // Each scene gets its own renderer, so that one scene's memory does not count for another.
        let mut renderer = Renderer::new(&RenderConfig::default())?;
        let sweeps = SweepSettings {
            dials: scene.dials(&resolved)?,
            grid: false,
            rungs: comparison::DEFAULT_RUNGS,
            runs: RUNS,
        };
        let (study, images) = run_study(
            &resolved,
            scene.name,
            &truth,
            &sweeps,
            &Limits::default(),
            &mut |scene| {
                renderer
                    .render(&scene, &CancellationToken::new())
                    .map_err(|error| match error {
                        RenderError::OverBudget { .. } => Refusal::Setting(error),
                        _ => Refusal::All(error),
                    })
            },
            &mut |done, total, what| {
                eprintln!("  {done} of {total}: {what}");
                true
            },
        )?;
        let targets = targets::measure(&mut renderer, &resolved, &truth, RUNS)?;
        let folder = Path::new("docs/accuracy").join(scene.name);
        write_study(&folder, &study, &images)?;
        drop_copies(&folder)?;
        chapters.push(Chapter {
            scene,
            study,
            targets,
        });
    }
    if is_whole_page {
        std::fs::write("docs/accuracy.md", page::write(&chapters))?;
        eprintln!("docs/accuracy.md");
    } else if !chapters.is_empty() {
        println!("{}", page::write(&chapters));
    }
    Ok(())
}

/// Keeps the page's files small: plots as vector graphics, error images for the cells only, and reports without links to missing
/// files.
fn drop_copies(folder: &Path) -> Result<(), Box<dyn Error>> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let is_png = path.extension().is_some_and(|extension| extension == "png");
        if is_png && name.as_deref() != Some("errors_water_cells.png") {
            std::fs::remove_file(path)?;
        }
    }
    let report = folder.join("study.md");
    let text = std::fs::read_to_string(&report)?;
    let kept: Vec<&str> = text
        .lines()
        .filter(|line| {
            let target = line.strip_prefix("![").and_then(|rest| {
                let (_, target) = rest.split_once("](")?;
                target.strip_suffix(')')
            });
            target.is_none_or(|target| folder.join(target).is_file())
        })
        .collect();
    std::fs::write(report, kept.join("\n") + "\n")?;
    Ok(())
}
