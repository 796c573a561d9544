//! Builds level maps before a frame needs them.

use std::sync::Arc;

use tokio_util::sync::CancellationToken;

use super::{RenderError, Renderer};
use crate::cache::{WarmUp, WarmedMap};
use crate::facts::SceneFacts;
use crate::facts::placement::LevelMapKey;
use crate::mesh::Mesh;
use crate::methods;
use crate::plan::{self, Cached as _, Wanted};

impl Renderer {
    /// Builds the level maps that an unrotated, uniformly scaled instance of `mesh` needs under the given suns, as a frame would. Reports
    /// the map of each sun. Maps that are cached already count as used.
    ///
    /// # Errors
    /// As [`Self::render`]; the maps finished by then stay.
    pub fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError> {
        // If all maps are cached nothing is submitted, and only a poll detects a lost device.
        self.gpu.tidy();
        self.gpu.check()?;
        let resolved = wanted.scene_of(mesh)?;
        let facts = methods::facts(&resolved)?;
        let warmed: Vec<WarmedMap> = keys_by_sun(&facts)
            .zip(&wanted.suns)
            .map(|(key, sun)| WarmedMap {
                elevation_deg: sun.elevation_deg,
                azimuth_deg: sun.azimuth_deg,
                texels: key.texels,
                layers: key.layers,
                bytes: key.bytes(),
                cached: self.has_level_map(key),
            })
            .collect();
        let plan = plan::plan_scene(&facts, Wanted::LevelMaps, self)?;
        self.run(&resolved, &facts, &plan, cancel)?;
        Ok(warmed)
    }
}

/// The level map under each sun; the scene has one object.
fn keys_by_sun(facts: &SceneFacts) -> impl Iterator<Item = &LevelMapKey> {
    let boxes = facts
        .lights
        .lit
        .iter()
        .flat_map(|light| light.boxes.iter().flatten());
    boxes.map(|level_box| &level_box.key)
}
