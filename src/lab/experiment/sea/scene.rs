//! The sea and the floor under it.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::measure::SeaError;
use crate::config::Limits;
use crate::methods;
use crate::scene::{ResolvedScene, Scene};

/// Elevation of the sun, degrees.
pub(super) const SUN_ELEVATION_DEG: f64 = 70.0;
/// Index of refraction of sea water.
pub(super) const SEA_IOR: f64 = 1.34;
/// Direction of the wind, degrees from the sun's azimuth.
pub(super) const WIND_DIRECTION_DEG: f64 = 30.0;

/// Side of the tile of long waves, m.
pub(super) const LONG_TILE_M: f64 = 31.0;
/// Where the tile of long waves ends and that of short waves begins, m.
pub(super) const SPLIT_M: f64 = 0.6;
/// Side of the tile of short waves, m. 31 / 2.9 is no whole number, so the two together do not repeat after 31 m.
pub(super) const SHORT_TILE_M: f64 = 2.9;
/// The shortest wave, m.
pub(super) const SHORTEST_M: f64 = 0.05;
/// Samples along the side of each tile: more than eight for the shortest wave of each.
const SAMPLES: u32 = 512;

/// Water cells per shortest wave; with fewer than eight, a warning says so.
const CELLS_PER_WAVE: f64 = 10.0;
/// Fewest water cells.
const FEWEST_CELLS: u32 = 64;

/// The smallest texel, m: the size of a small detector.
const SMALLEST_TEXEL_M: f64 = 0.005;
/// Texels grow with the depth, so that the image of the sun's disc, 7 mm wide per metre, has between three and four of them.
const TEXEL_PER_DEPTH: f64 = 0.002;

/// A wind and a depth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Wind 10 m above the sea, m/s.
    pub wind_m_s: f64,
    /// Depth of the floor, m.
    pub depth_m: f64,
}

/// Side of a texel (of a detector) at a depth, m.
pub fn texel_m(depth_m: f64) -> f64 {
    (TEXEL_PER_DEPTH * depth_m).max(SMALLEST_TEXEL_M)
}

/// What of a scene changes from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) seed: u32,
    pub(super) time_s: f64,
    /// Texels along each side of the map, and the size of one.
    pub(super) texels: u32,
    pub(super) texel_m: f64,
    pub(super) water_cells: u32,
}

/// The waves under a wind: two Elfouhaily seas, of long and of short waves.
fn waves(wind_m_s: f64, seed: u32) -> Value {
    let sea = |tile_m: f64, shortest_m: f64, longest_m: f64, seed: u32| {
        json!({
            "kind": "spectrum", "model": "elfouhaily", "wind_speed_m_s": wind_m_s, "wind_direction_deg": WIND_DIRECTION_DEG,
            "tile_m": tile_m, "samples": SAMPLES, "min_wavelength_m": shortest_m, "max_wavelength_m": longest_m, "seed": seed
        })
    };
    // No wave is in both: a wave of the very length is in neither tile's list of lengths.
    json!([
        sea(LONG_TILE_M, SPLIT_M, LONG_TILE_M, 2 * seed),
        sea(SHORT_TILE_M, SHORTEST_M, SPLIT_M, 2 * seed + 1),
    ])
}

fn resolved(scene: Value) -> Result<ResolvedScene, SeaError> {
    let refused = |error: crate::scene::SceneError| SeaError::Scene(error.to_string());
    let scene = Scene::from_value(scene).map_err(refused)?;
    methods::resolve(scene, &Limits::default(), |_: &str| None).map_err(refused)
}

/// The map of irradiance on the floor at a place, `texels` × `texels` texels of [`texel_m`], under the sea of `seed` at `time_s`.
///
/// # Errors
/// [`SeaError::Scene`] for what a scene may not say.
pub fn scene(
    place: Place,
    texels: u32,
    water_cells: u32,
    seed: u32,
    time_s: f64,
) -> Result<ResolvedScene, SeaError> {
    let view = View {
        seed,
        time_s,
        texels,
        texel_m: texel_m(place.depth_m),
        water_cells,
    };
    of_view(place, view)
}

/// Water cells along each side of the light's window that the shortest wave needs at a place, at most `view.water_cells`.
pub(super) fn water_cells(place: Place, view: View) -> Result<u32, SeaError> {
    let facts = methods::facts(&of_view(place, view)?);
    let facts = facts.map_err(|error| SeaError::Scene(error.to_string()))?;
    let spans_m = facts.lights.beam_sets.iter().map(|set| set.span_m(1));
    let span_m = spans_m.fold(0.0, f64::max);
    let needed = (span_m * CELLS_PER_WAVE / SHORTEST_M).ceil() as u32;
    Ok(needed.max(FEWEST_CELLS).min(view.water_cells))
}

/// The same with another size of texels.
pub(super) fn of_view(place: Place, view: View) -> Result<ResolvedScene, SeaError> {
    let side_m = f64::from(view.texels) * view.texel_m;
    resolved(json!({
        "water": { "waves": waves(place.wind_m_s, view.seed), "ior": SEA_IOR },
        "floor": { "depth_m": place.depth_m, "size_m": [side_m, side_m] },
        "lights": [{ "kind": "sun", "elevation_deg": SUN_ELEVATION_DEG, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": view.water_cells },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": view.texels, "height": view.texels },
        "time_s": view.time_s
    }))
}

/// The map of the water itself over a tile of the long waves.
pub(super) fn water(wind_m_s: f64, texels: u32) -> Result<ResolvedScene, SeaError> {
    resolved(json!({
        "water": { "waves": waves(wind_m_s, 0), "ior": SEA_IOR },
        "output": {
            "kind": "water_map", "min_m": [0, 0], "max_m": [LONG_TILE_M, LONG_TILE_M], "width": texels, "height": texels
        }
    }))
}
