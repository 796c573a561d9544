//! Measures a calibration: renders and times some small scenes, and compares them with the float64 reference.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::accuracy::metrics::{MetricError, relative_l1};
use crate::assets::MeshStore;
use crate::calibration::Calibration;
use crate::calibration::PassRate;
use crate::config::Limits;
use crate::facts::SceneFacts;
use crate::frame::Frame;
use crate::mesh::MeshError;
use crate::methods;
use crate::reference::{ReferenceError, ReferenceSettings, irradiance_map};
use crate::scene::{LayerName, ResolvedScene, Scene, SceneError};
use crate::stages::level_map;
use crate::tuning::cost::fit_rate;

/// Timed runs of each scene, after one that warms up.
const RUNS: usize = 5;
/// Relative L1 error of the truth that estimates are compared with.
const TRUTH_ERROR: f64 = 2e-3;
/// Numbers of cells at which estimates are compared with the truth.
const JUDGED_CELLS: [u32; 3] = [64, 128, 256];
/// Errors above this are ignored: such few cells do not resolve the scene, and are not requested in practice.
const JUDGED_BELOW: f64 = 0.1;
/// Added to the largest measured ratio, because other scenes differ.
const CAUTION: f64 = 1.1;

const SINE_POOL: &str = include_str!("../../scenes/sine_pool.json");
const STEEP_POOL: &str = include_str!("../../scenes/steep_pool.json");
const POOL: &str = include_str!("../../scenes/pool.json");
const BOX: &[u8] = include_bytes!("../../scenes/meshes/box.obj");

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError<E: std::error::Error> {
    /// A render failed.
    #[error("{0}")]
    Render(E),
    /// A built-in scene is refused: a defect, or limits too narrow for it.
    #[error("a built-in scene is refused: {0}")]
    Scene(#[from] SceneError),
    /// The built-in mesh is refused.
    #[error("the built-in mesh is refused: {0}")]
    Mesh(#[from] MeshError),
    /// There is no truth.
    #[error("the float64 reference failed: {0}")]
    Reference(#[from] ReferenceError),
    /// A map cannot be compared.
    #[error("a map cannot be compared: {0}")]
    Metric(#[from] MetricError),
    /// The adapter does not time passes.
    #[error("this adapter does not report the times of passes, so it cannot be calibrated")]
    Untimed,
}

/// Measures; `render` renders a frame, `progress` gets the next step and the finished part.
///
/// # Errors
/// [`MeasureError`].
pub fn calibration<E: std::error::Error>(
    render: &mut dyn FnMut(&ResolvedScene) -> Result<Frame, E>,
    progress: &dyn Fn(&str, f64),
) -> Result<Calibration, MeasureError<E>> {
    let timed = timed_scenes();
    let mut measured: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    let mut besides = Vec::new();
    let mut adapter = String::new();
    for (index, value) in timed.iter().enumerate() {
        progress("timing passes", 0.5 * index as f64 / timed.len() as f64);
        let scene = resolved(value.clone())?;
        let facts = methods::facts(&scene)?;
        let mut runs: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        // Warm frames do not build level maps, so those passes are timed in the frames that do.
        let first = render(&scene).map_err(MeasureError::Render)?.stats;
        for pass in first
            .passes
            .iter()
            .filter(|pass| pass.name.starts_with(level_map::PASS.name))
        {
            let each = pass.gpu_ms.map(|ms| ms / f64::from(pass.runs.max(1)));
            runs.entry(pass.name.clone()).or_default().extend(each);
        }
        for _ in 0..RUNS {
            let stats = render(&scene).map_err(MeasureError::Render)?.stats;
            let mut passes_ms = 0.0;
            for pass in &stats.passes {
                let Some(ms) = pass.gpu_ms else { continue };
                passes_ms += ms;
                let each = ms / f64::from(pass.runs.max(1));
                runs.entry(pass.name.clone()).or_default().push(each);
            }
            besides.push((stats.time_ms.total - passes_ms).max(0.0));
            adapter = format!("{}, {}", stats.adapter.name, stats.adapter.driver);
        }
        for (pass, times) in runs {
            measured
                .entry(pass.clone())
                .or_default()
                .push((work(&pass, &facts), median(times)));
        }
    }
    if measured.is_empty() {
        return Err(MeasureError::Untimed);
    }
    let passes: BTreeMap<String, PassRate> = measured
        .iter()
        .map(|(pass, measured)| (pass.clone(), fit_rate(measured)))
        .collect();
    let margin = margin(render, progress)?;
    Ok(Calibration::new(adapter, median(besides), passes, margin))
}

/// The largest factor by which a frame's true error exceeds its estimate.
fn margin<E: std::error::Error>(
    render: &mut dyn FnMut(&ResolvedScene) -> Result<Frame, E>,
    progress: &dyn Fn(&str, f64),
) -> Result<f64, MeasureError<E>> {
    let mut largest: f64 = 1.0;
    for (index, text) in [SINE_POOL, STEEP_POOL].into_iter().enumerate() {
        progress("comparing estimates", 0.5 + 0.25 * index as f64);
        let value = scene_value(text);
        let settings = ReferenceSettings {
            target_error: Some(TRUTH_ERROR),
            ..ReferenceSettings::default()
        };
        let truth = irradiance_map(&resolved(value.clone())?, &settings, &|_| {})?;
        for cells in JUDGED_CELLS {
            let mut value = value.clone();
            value["quality"] = json!({ "water_cells": cells, "estimate_error": true });
            let frame = render(&resolved(value)?).map_err(MeasureError::Render)?;
            let image = &frame.layers[&LayerName::Irradiance].data;
            let error = relative_l1(image, truth.irradiance.as_flattened())?;
            let estimate = frame.stats.accuracy.and_then(|a| a.estimated_error);
            if let Some(estimate) = estimate.filter(|e| *e > 0.0 && error < JUDGED_BELOW) {
                largest = largest.max(error / estimate);
            }
        }
    }
    Ok(largest * CAUTION)
}

/// Scenes whose passes are timed: each driver of [`work`] varies.
fn timed_scenes() -> Vec<Value> {
    let mut all = Vec::new();
    for (cells, texels) in [
        (32, 64),
        (32, 256),
        (128, 256),
        (256, 512),
        (512, 256),
        (1024, 256),
    ] {
        let mut value = scene_value(SINE_POOL);
        value["quality"] = json!({ "water_cells": cells, "estimate_error": true });
        value["output"]["width"] = json!(texels);
        value["output"]["height"] = json!(texels);
        all.push(value);
    }
    // So steep that light leaves the water again.
    for cells in [64, 256] {
        let mut value = scene_value(SINE_POOL);
        value["quality"] = json!({ "water_cells": cells });
        value["water"]["waves"] =
            json!([{ "kind": "sine", "amplitude_m": 0.6, "wavelength_m": 1, "direction_deg": 20 }]);
        value["floor"]["depth_m"] = json!(4);
        all.push(value);
    }
    for (boxes, cells, levels) in [
        (1, 64, 2),
        (1, 256, 4),
        (4, 128, 4),
        (9, 256, 5),
        (9, 512, 4),
    ] {
        let mut value = scene_value(SINE_POOL);
        value["quality"] = json!({ "water_cells": cells, "split_levels": levels });
        let objects = (0..boxes).map(|i| {
            let (x, z) = (f64::from(i % 3) - 1.0, f64::from(i / 3) - 1.0);
            json!({ "mesh": "box", "translation_m": [0.6 * x, -1.2, 0.6 * z], "scale": 0.25 })
        });
        value["objects"] = objects.collect();
        value["water"]["absorption_per_m"] = json!([0.3, 0.1, 0.05]);
        all.push(value);
    }
    for (width, height) in [(160, 90), (640, 360)] {
        let mut value = scene_value(POOL);
        value["output"]["width"] = json!(width);
        value["output"]["height"] = json!(height);
        all.push(value);
    }
    all
}

fn scene_value(text: &str) -> Value {
    serde_json::from_str(text).expect("a scene of the repository is JSON")
}

fn resolved<E: std::error::Error>(mut value: Value) -> Result<ResolvedScene, MeasureError<E>> {
    let limits = Limits::default();
    let store = MeshStore::new(&limits);
    let id = store.insert_obj(BOX, &[])?.mesh.id.clone();
    let objects = value.get_mut("objects").and_then(Value::as_array_mut);
    for object in objects.into_iter().flatten() {
        object["mesh"] = json!(id);
    }
    let scene = Scene::from_value(value)?;
    Ok(methods::resolve(scene, &limits, &store)?)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Units of work of one run of a pass; 0 for a pass that is not known.
fn work(pass: &str, facts: &SceneFacts) -> f64 {
    let passes = methods::all_passes();
    let found = passes.into_iter().find(|known| known.name == pass);
    found.map_or(0.0, |pass| (pass.work)(facts))
}
