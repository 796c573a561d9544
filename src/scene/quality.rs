//! The dials, and asking for accuracy or time instead of setting them.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::dials::MethodChoice;
use super::parse::integer;
use super::ranges::{Layers, LevelMapTexels, MapTexels, PixelSamples, SplitLevels, WaterCells};

/// The dials that trade accuracy for time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Quality {
    /// How light is carried to the receivers: the name of a method, or an object of its name, as `kind`, and its own dials.
    #[serde(skip_serializing_if = "MethodChoice::is_default")]
    pub method: MethodChoice,
    /// Water cells along each side of a light's window, 2 … 2048. Default 256. The error falls with its square.
    #[serde(deserialize_with = "integer::<WaterCells, _>")]
    #[schema(minimum = 2, maximum = 2048)]
    pub water_cells: u32,
    /// Texels along the longer side of the floor's irradiance map of a view, 16 … 4096. Default 512.
    #[serde(deserialize_with = "integer::<MapTexels, _>")]
    #[schema(minimum = 16, maximum = 4096)]
    pub map_texels: u32,
    /// Texels along each side of a mesh's level map and of its irradiance map, a power of two, 16 … 2048. Default 256.
    #[serde(deserialize_with = "integer::<LevelMapTexels, _>")]
    #[schema(minimum = 16, maximum = 2048)]
    pub level_map_texels: u32,
    /// Surfaces of a mesh along the light that have maps of their own, nearest first, 1 … 4. Default 1: what the light direction sees
    /// through flat water. More show what only tilted rays reach, as the far sides of objects under steep waves.
    #[serde(deserialize_with = "integer::<Layers, _>")]
    #[schema(minimum = 1, maximum = 4)]
    pub layers: u32,
    /// Texels of an object's maps per pixel of its size on the picture, 0 … 16: its level map and irradiance map then have the power
    /// of two of texels at or above that, 16 … `level_map_texels`, and as many fewer reference planes; what is outside the picture gets 16 and
    /// still casts its shadow.
    /// Default 0: every object gets `level_map_texels`. Views only.
    #[schema(minimum = 0, maximum = 16)]
    pub level_of_detail: f64,
    /// How often beams that straddle receivers are halved, 0 … 8. Default 2. Only the parts that still straddle are halved on, so
    /// each further level about doubles the time for shadow edges and halves their width.
    #[serde(deserialize_with = "integer::<SplitLevels, _>")]
    #[schema(minimum = 0, maximum = 8)]
    pub split_levels: u32,
    /// Relative L1 error of the irradiance to stay under, 0.0001 … 0.5: the program then chooses the dials above itself, and those
    /// that are given do not count (`stats.accuracy.chosen` has what they became). Choosing looks at the light, with ever more cells
    /// until what they see can be believed, and comes on top (`stats.time_ms.plan`). Not with `time_budget_ms`. Default: absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.0001, maximum = 0.5)]
    pub target_error: Option<f64>,
    /// Time to stay under, ms, 0.1 … 3 600 000, on the machine that the calibration is of: the program then chooses the dials above
    /// for the least error it predicts. It is that of the frame; choosing comes on top: a look at the light with half the cells, in
    /// `stats.time_ms.plan`. Not with `target_error`. Default: absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.1, maximum = 3_600_000.0)]
    pub time_budget_ms: Option<f64>,
    /// Whether the frame estimates its own error (`stats.accuracy.estimated_error`) by doing the light a second time with two fifths of the
    /// water cells or fewer. Default false.
    pub estimate_error: bool,
    /// Rays per pixel of a view along each side, 1 … 8. Default 1. Smooths edges; the camera's passes cost its square. Layers
    /// other than radiance are never averaged: they are those of the pixel's middle.
    #[serde(deserialize_with = "integer::<PixelSamples, _>")]
    #[schema(minimum = 1, maximum = 8)]
    pub pixel_samples: u32,
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            method: MethodChoice::default(),
            water_cells: 256,
            map_texels: 512,
            level_map_texels: 256,
            layers: 1,
            level_of_detail: 0.0,
            split_levels: 2,
            target_error: None,
            time_budget_ms: None,
            estimate_error: false,
            pixel_samples: 1,
        }
    }
}
