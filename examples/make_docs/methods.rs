//! `docs/methods.md`: every method on several scenes, each at settings of its own, and the papers' figures beside ours. The measured fronts
//! go to `src/calibration/frontiers.json`, on which the planner's advice is based.

use std::error::Error;
use std::path::Path;

use caustica::calibration::frontiers::{Frontiers, MeasuredMethod, MeasuredScene, MeasuredSetting};
use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::{Limits, RenderConfig};
use caustica::lab::study::comparison::{ALL, DEFAULT_RUNGS, METHOD_DIAL};
use caustica::lab::study::dial::Dial;
use caustica::lab::study::equal_time::{is_twin, limit_ms, method_front, methods};
use caustica::lab::study::error_images::method_images;
use caustica::lab::study::plot::error_against_time;
use caustica::lab::study::points::{Points, with_points};
use caustica::lab::study::report::to_csv;
use caustica::lab::study::study::Study;
use caustica::lab::study::sweep::{Refusal, SweepSettings, run_study};
use caustica::reference::{TruthSettings, truth};
use caustica::render::{RenderError, Renderer};
use caustica::scene::ResolvedScene;
use caustica::tuning::method::kind_of;
use tokio_util::sync::CancellationToken;

use crate::{methods_page, papers};

/// The argument that writes this page only. With names of scenes after it, only their files are written, and their part is printed.
pub(crate) const NAME: &str = "methods";
/// Timed runs of each setting.
const RUNS: u32 = 3;
/// Where the measured fronts go.
const FRONTIERS: &str = "src/calibration/frontiers.json";

/// A scene of the page.
#[derive(Debug)]
pub(crate) struct Scene {
    /// File name without `.json`; also the name of its files.
    pub name: &'static str,
    /// What is difficult about it.
    pub about: &'static str,
    /// Where methods are compared.
    pub points: Points,
    /// Fields of the output, as JSON pointer and text.
    pub output: &'static [(&'static str, &'static str)],
    /// Relative L1 error of the truth.
    pub truth_error: f64,
}

/// Size of the maps: small, so that the page is made in minutes, and a tile of the pictures.
const MAP: [(&str, &str); 2] = [("/output/width", "192"), ("/output/height", "192")];

/// In the order of the page.
pub(crate) const SCENES: [Scene; 8] = [
    Scene {
        name: "flat",
        about: "Flat water with absorption: the result is one number.",
        points: Points::Map,
        output: &[],
        truth_error: 1e-5,
    },
    Scene {
        name: "sine_pool",
        about: "Three sines over a floor below the first focus: plain caustics.",
        points: Points::Map,
        output: &MAP,
        truth_error: 1e-3,
    },
    Scene {
        name: "steep_pool",
        about: "Deep and folded: four steep sines over a floor at 4 m depth, where the light has folded over itself several times.",
        points: Points::Map,
        output: &MAP,
        truth_error: 1.5e-3,
    },
    Scene {
        name: "low_sun",
        about: "A sun 12° above the horizon: long paths, and long, thin footprints.",
        points: Points::Map,
        output: &MAP,
        truth_error: 1.5e-3,
    },
    Scene {
        name: "sea_jonswap",
        about: "A sea under a wind of 5 m/s (JONSWAP) over a floor at 4 m depth, with waves down to the spacing of its samples.",
        points: Points::Map,
        output: &[],
        truth_error: 2e-3,
    },
    Scene {
        name: "teapot_floor",
        about: "The floor under a teapot: caustics with the shadow of a mesh in them.",
        points: Points::Map,
        output: &MAP,
        truth_error: 2e-3,
    },
    Scene {
        name: "teapot_pool",
        about: "The same pool as a camera sees it through the waves, compared at its pixels, the teapot's included.",
        points: Points::View,
        output: &[("/output/width", "192"), ("/output/height", "108")],
        truth_error: 5e-3,
    },
    Scene {
        name: "lamp_pool",
        about: "Lamps above and under the water, a low sun and two meshes: not every method can do it.",
        points: Points::Map,
        output: &[],
        truth_error: 3e-3,
    },
];

/// Measurements of a scene.
#[derive(Debug)]
pub(crate) struct Chapter {
    pub scene: &'static Scene,
    pub study: Study,
    measured: Option<MeasuredScene>,
}

/// Writes the page, its pictures and the fronts; with names of scenes, only the files of these, and prints their part.
pub(crate) fn write(only: &[String]) -> Result<(), Box<dyn Error>> {
    let wanted = |name: &str| only.is_empty() || only.iter().any(|o| o == name);
    let mut chapters = Vec::new();
    for scene in SCENES.iter().filter(|scene| wanted(scene.name)) {
        eprintln!("{} …", scene.name);
        chapters.push(chapter(scene)?);
    }
    let papers = match wanted(papers::NAME) {
        true => papers::section()?,
        false => String::new(),
    };
    let page = methods_page::write(&chapters, &papers);
    if !only.is_empty() {
        println!("{page}");
        return Ok(());
    }
    std::fs::write("docs/methods.md", page)?;
    eprintln!("docs/methods.md");
    let adapter = chapters.first().map_or_else(String::new, |chapter| {
        let adapter = &chapter.study.adapter;
        format!("{}, {} CPU cores", adapter.name, chapter.study.cores)
    });
    let measured = chapters.into_iter().filter_map(|chapter| chapter.measured);
    let frontiers = Frontiers::new(adapter, measured.collect());
    std::fs::write(FRONTIERS, serde_json::to_string_pretty(&frontiers)? + "\n")?;
    eprintln!("{FRONTIERS}");
    Ok(())
}

/// A scene of the repository with fields of its output changed, at points of comparison.
pub(crate) fn load(
    name: &str,
    points: Points,
    output: &[(&str, &str)],
) -> Result<ResolvedScene, Box<dyn Error>> {
    let changes = output.iter();
    let changes = changes.map(|(pointer, text)| ((*pointer).to_owned(), (*text).to_owned()));
    let args = SceneArgs {
        scene: format!("scenes/{name}.json").into(),
        overrides: SceneOverrides(changes.collect()),
    };
    let limits = Limits::default();
    let resolved = scene_file::load(&args, None, &limits)?.resolved;
    Ok(with_points(&resolved, points, &limits)?)
}

fn chapter(scene: &'static Scene) -> Result<Chapter, Box<dyn Error>> {
    let resolved = load(scene.name, scene.points, scene.output)?;
    let settings = TruthSettings {
        target_error: Some(scene.truth_error),
        disk: Some("out/truth".into()),
        ..TruthSettings::default()
    };
    let truth = truth(&resolved, &settings, &|_| {}, &|| false)?;
    // Each scene gets its own renderer, so that one scene's memory does not count for another.
    let mut renderer = Renderer::new(&RenderConfig::default())?;
    let sweeps = SweepSettings {
        dials: vec![Dial::new(METHOD_DIAL, vec![ALL.to_owned()])?],
        grid: false,
        rungs: DEFAULT_RUNGS,
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
    let folder = Path::new("docs/methods").join(scene.name);
    std::fs::create_dir_all(&folder)?;
    let limit_ms = limit_ms(&study).ok_or("nothing was measured")?;
    std::fs::write(
        folder.join("error_time.svg"),
        error_against_time(&study)?.svg,
    )?;
    std::fs::write(
        folder.join("methods.png"),
        method_images(&study, &images, limit_ms)?,
    )?;
    std::fs::write(folder.join("study.csv"), to_csv(&study))?;
    Ok(Chapter {
        measured: measured(scene, &resolved, &study)?,
        scene,
        study,
    })
}

/// The fronts of a scene, for the planner.
fn measured(
    scene: &Scene,
    resolved: &ResolvedScene,
    study: &Study,
) -> Result<Option<MeasuredScene>, Box<dyn Error>> {
    let facts = caustica::methods::facts(resolved)?;
    let Some(kind) = kind_of(resolved, &facts) else {
        return Ok(None);
    };
    let first = methods(study).first().copied().unwrap_or_default();
    let of_method = |name: &&str| {
        // The times of a method that does the same as the first differ from its times by chance only.
        let measured = if is_twin(study, name) { first } else { name };
        let front = method_front(study, measured).into_iter();
        let settings = front.map(|standing| {
            let dials = standing.point.dials.iter();
            let dials = dials.filter(|(name, _)| *name != METHOD_DIAL);
            MeasuredSetting {
                dials: dials.map(|(n, value)| (n.clone(), value.clone())).collect(),
                error: standing.error(),
                ms: standing.ms(),
            }
        });
        MeasuredMethod {
            method: (*name).to_owned(),
            // An error of 0 has no place on a power law.
            settings: settings.filter(|setting| setting.error > 0.0).collect(),
        }
    };
    let measured = methods(study).iter().map(of_method).collect::<Vec<_>>();
    Ok(Some(MeasuredScene {
        scene: scene.name.to_owned(),
        kind,
        methods: measured
            .into_iter()
            .filter(|method| !method.settings.is_empty())
            .collect(),
    }))
}
