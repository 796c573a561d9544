//! Writes the experiment's files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::csv::to_csv;
use super::markdown::to_markdown;
use super::measure::ExperimentError;
use super::study::{Experiment, MeshResult, TechniqueFigures};
use crate::lab::study::plot::{LineChart, Plot, PlotError, error_against_time, lines};
use crate::lab::study::study::{CostFigures, ErrorFigures, Point, Study, Sweep, TruthFigures};
use crate::output_files::{self, clear_leftovers};

/// Shapes with a section of their own on the page: those of the thesis's tables.
pub const FEATURED: [&str; 3] = ["teapot", "dolphin", "sphere"];

/// File of the plot of time against planes.
pub(super) fn time_file(mesh: &str, extension: &str) -> String {
    format!("{mesh}_time.{extension}")
}

/// File of the plot of error against time.
pub(super) fn error_file(mesh: &str, extension: &str) -> String {
    format!("{mesh}_error.{extension}")
}

/// Time against planes and, with a truth, error against time of a shape, by file name without its end.
///
/// # Errors
/// [`PlotError`].
pub fn plots(experiment: &Experiment, mesh: &MeshResult) -> Result<Vec<(String, Plot)>, PlotError> {
    let stem = |file: String| file.trim_end_matches('.').to_owned();
    let line = |name: &str, of: &dyn Fn(&super::PlanePoint) -> f64| {
        let points = mesh.planes.iter().map(|p| (f64::from(p.planes), of(p)));
        (name.to_owned(), points.collect())
    };
    let chart = LineChart {
        title: format!("Time against planes: {}", mesh.name),
        subtitle: format!(
            "{} · {}² water cells · {}² texels",
            experiment.adapter.name, experiment.water_cells, experiment.texels
        ),
        x_title: "planes".to_owned(),
        y_title: "time of a frame on the GPU (ms)".to_owned(),
        lines: vec![
            line("volumetric", &|p| p.volumetric.ms.median),
            line("level map, uniform", &|p| p.uniform.ms.median),
            line("level map, smart", &|p| p.smart.ms.median),
        ],
        remarks: Vec::new(),
    };
    let mut all = vec![(stem(time_file(&mesh.name, "")), lines(&chart)?)];
    if mesh.truth_error.is_some() {
        let study = error_study(experiment, mesh);
        all.push((
            stem(error_file(&mesh.name, "")),
            error_against_time(&study)?,
        ));
    }
    Ok(all)
}

/// The shape's errors and times as a study of the accuracy module, which draws them.
fn error_study(experiment: &Experiment, mesh: &MeshResult) -> Study {
    let point = |value: u32, figures: &TechniqueFigures| Point {
        dials: BTreeMap::from([("value".to_owned(), json!(value))]),
        error: ErrorFigures {
            relative_l1: figures.error.unwrap_or_default(),
            ..ErrorFigures::default()
        },
        cost: CostFigures {
            runs: experiment.runs,
            wall_ms: figures.ms,
            gpu_ms: figures.ms,
            ..CostFigures::default()
        },
        ..Point::default()
    };
    let sweep = |name: &str, points: Vec<Point>| Sweep {
        dial: name.to_owned(),
        points,
        ..Sweep::default()
    };
    let planes = |of: &dyn Fn(&super::PlanePoint) -> TechniqueFigures| {
        mesh.planes
            .iter()
            .map(|p| point(p.planes, &of(p)))
            .collect()
    };
    let hits = |of: &dyn Fn(u32) -> bool| {
        let wanted = mesh.hits.iter().filter(|h| of(h.split_levels));
        wanted.map(|h| point(h.water_cells, &h.figures)).collect()
    };
    let mut study = Study {
        scene: mesh.name.clone(),
        adapter: experiment.adapter.clone(),
        truth: TruthFigures {
            what: "irradiance on the mesh".to_owned(),
            relative_error: mesh.truth_error.unwrap_or_default(),
            ..TruthFigures::default()
        },
        sweeps: vec![
            sweep("hits, water cells", hits(&|levels| levels > 0)),
            sweep("hits, beams not split", hits(&|levels| levels == 0)),
            sweep("smart planes", planes(&|p| p.smart)),
            sweep("uniform planes", planes(&|p| p.uniform)),
            sweep("volumetric planes", planes(&|p| p.volumetric)),
        ],
        ..Study::default()
    };
    mark_front(&mut study);
    study
}

/// Marks the points for which no other point is both faster and more accurate.
fn mark_front(study: &mut Study) {
    let all: Vec<(f64, f64)> = study
        .sweeps
        .iter()
        .flat_map(|sweep| &sweep.points)
        .map(|p| (p.cost.wall_ms.median, p.error.relative_l1))
        .collect();
    for point in study.sweeps.iter_mut().flat_map(|sweep| &mut sweep.points) {
        let (ms, error) = (point.cost.wall_ms.median, point.error.relative_l1);
        let beaten = |&(m, e): &(f64, f64)| m <= ms && e <= error && (m < ms || e < error);
        point.on_pareto_front = !all.iter().any(beaten);
    }
}

/// Writes `level_maps.json`, `.csv`, `.md` and the plots of every shape into `folder`, which must be there; returns what was written.
///
/// # Errors
/// [`ExperimentError::Plot`], [`ExperimentError::Write`].
pub fn write(folder: &Path, experiment: &Experiment) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut files = Vec::new();
    let mut put = |name: &str, bytes: &[u8]| -> Result<(), ExperimentError> {
        let path = folder.join(name);
        clear_leftovers([path.as_path()]);
        output_files::write(&path, bytes).map_err(|reason| ExperimentError::Write {
            path: path.clone(),
            reason,
        })?;
        files.push(path);
        Ok(())
    };
    let mut json = serde_json::to_string_pretty(experiment).expect("results always serialise");
    json.push('\n');
    put("level_maps.json", json.as_bytes())?;
    put("level_maps.csv", to_csv(experiment).as_bytes())?;
    put("level_maps.md", to_markdown(experiment, "").as_bytes())?;
    for mesh in &experiment.meshes {
        for (stem, plot) in plots(experiment, mesh)? {
            put(&format!("{stem}.svg"), plot.svg.as_bytes())?;
            put(&format!("{stem}.png"), &plot.png)?;
        }
    }
    Ok(files)
}
