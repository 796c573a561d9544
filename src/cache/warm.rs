//! Requests to build level maps before a frame needs them.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::ToSchema;

use crate::kept::Kept;
use crate::mesh::Mesh;
use crate::scene::{ResolvedScene, Scene, SceneError};

/// The direction of a sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmSun {
    /// Height above the horizon, degrees, above 0 and at most 90.
    pub elevation_deg: f64,
    /// Azimuth, degrees from +X towards +Z.
    pub azimuth_deg: f64,
}

/// A request for the level maps of a mesh that an unrotated, uniformly scaled instance needs under these suns.
#[derive(Clone, Debug, PartialEq)]
pub struct WarmUp {
    /// The suns; not empty.
    pub suns: Vec<WarmSun>,
    /// `quality.level_map_texels` of the frames to come.
    pub texels: u32,
    /// `quality.layers` of those frames.
    pub layers: u32,
    /// Index of refraction of their water.
    pub ior: f64,
}

/// A level map that is ready for the frames to come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WarmedMap {
    /// Height of its sun above the horizon, degrees.
    pub elevation_deg: f64,
    /// Azimuth of its sun, degrees from +X towards +Z.
    pub azimuth_deg: f64,
    /// Texels along each side.
    pub texels: u32,
    /// Layers, nearest first.
    pub layers: u32,
    /// GPU memory it takes, bytes.
    pub bytes: u64,
    /// Whether it was there already.
    pub cached: bool,
}

impl WarmUp {
    /// A scene that needs exactly these level maps: an irradiance map of the mesh in flat water.
    ///
    /// # Errors
    /// When a value is out of its range.
    pub fn scene_of(&self, mesh: &Arc<Mesh>) -> Result<ResolvedScene, SceneError> {
        let suns: Vec<Value> = self
            .suns
            .iter()
            .map(|sun| {
                json!({
                    "kind": "sun",
                    "elevation_deg": sun.elevation_deg,
                    "azimuth_deg": sun.azimuth_deg,
                    "irradiance_w_m2": [1, 1, 1],
                })
            })
            .collect();
        // The mesh must be under the surface; its depth does not matter for light from infinity.
        let middle = mesh.origin_m;
        let depth_m = 1.0 + f64::from(mesh.max_m.y);
        let scene = Scene::from_value(json!({
            "water": { "ior": self.ior },
            "lights": suns,
            "objects": [{
                "mesh": mesh.id,
                "translation_m": [-middle.x, -middle.y - depth_m, -middle.z],
            }],
            "quality": { "level_map_texels": self.texels, "layers": self.layers },
            "output": { "kind": "irradiance_map", "receiver": 0 },
        }))?;
        Ok(ResolvedScene {
            scene,
            meshes: vec![Arc::clone(mesh)],
            fields: BTreeMap::new(),
            kept: Kept::default(),
        })
    }
}
