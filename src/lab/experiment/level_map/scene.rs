//! The scene of a shape: its map under waves and one sun, the same for every shape.

use std::sync::Arc;

use serde_json::json;

use super::measure::ExperimentError;
use crate::config::Limits;
use crate::lab::shapes::Shape;
use crate::methods::planes::{SLICING, SMART};
use crate::methods::reference_planes::PLANES;
use crate::methods::{self, Method, level_map, planes, volumetric};
use crate::scene::{MethodChoice, ResolvedScene, Scene};

/// Largest extent of the shape, m.
const EXTENT_M: f64 = 0.6;

/// How light is placed on the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// The given number of planes, with a slice image for each.
    Volumetric(u32),
    /// The given number of reference planes on a level map.
    Uniform(u32),
    /// Of the given number of reference planes, those with a surface near them.
    Smart(u32),
    /// Light at the points where marched rays hit.
    Hit,
}

/// A shape of the catalogue 1 m under short waves that focus on it: its irradiance map of `texels`², lit through `water_cells`².
///
/// # Errors
/// [`ExperimentError::Shape`] for an unknown name.
pub fn scene(name: &str, water_cells: u32, texels: u32) -> Result<ResolvedScene, ExperimentError> {
    let shape = Shape::named(name).ok_or_else(|| ExperimentError::Shape(name.to_owned()))?;
    let mesh = shape
        .mesh()
        .map_err(|error| ExperimentError::Scene(error.to_string()))?;
    let mesh = Arc::new(mesh);
    let extent = f64::from((mesh.max_m - mesh.min_m).max_element());
    let value = json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": 0.012, "wavelength_m": 0.5, "direction_deg": 20 },
            { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.37, "direction_deg": 110, "phase_deg": 40 },
            { "kind": "sine", "amplitude_m": 0.004, "wavelength_m": 0.23, "direction_deg": 65, "phase_deg": 200 }
        ] },
        "lights": [{ "kind": "sun", "elevation_deg": 65, "azimuth_deg": 30, "irradiance_w_m2": [1000, 1000, 1000] }],
        "objects": [{ "mesh": mesh.id, "translation_m": [0, -1, 0], "scale": EXTENT_M / extent }],
        "quality": { "water_cells": water_cells, "level_map_texels": texels },
        "output": { "kind": "irradiance_map", "receiver": 0 }
    });
    let refused = |error: crate::scene::SceneError| ExperimentError::Scene(error.to_string());
    let scene = Scene::from_value(value).map_err(refused)?;
    methods::resolve(scene, &Limits::default(), |id: &str| {
        (id == mesh.id).then(|| mesh.clone())
    })
    .map_err(refused)
}

impl Technique {
    /// The scene with this technique.
    pub fn of(self, scene: &ResolvedScene) -> ResolvedScene {
        let slices = |method: &Method, count| MethodChoice::named(method.name).with(&PLANES, count);
        let choice = match self {
            Self::Volumetric(count) => slices(&volumetric::METHOD, count),
            Self::Uniform(count) => slices(&planes::METHOD, count),
            Self::Smart(count) => slices(&planes::METHOD, count).with(&SLICING, SMART),
            Self::Hit => MethodChoice::named(level_map::METHOD.name),
        };
        let mut scene = scene.clone();
        scene.scene.quality.method = methods::shortest(&choice);
        scene
    }
}
