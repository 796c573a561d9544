//! The dials, and targets for error or time from which the program chooses them.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::dials::MethodChoice;
use super::parse::integer;
use super::ranges::{
    Bounces, Layers, LevelMapTexels, MapTexels, PixelSamples, SplitLevels, WaterCells,
};

/// The dials that trade accuracy for time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Quality {
    /// The method that carries light to the receivers: its name, or an object with the name as `kind` and the method's own dials.
    #[serde(skip_serializing_if = "MethodChoice::is_default")]
    pub method: MethodChoice,
    /// Water cells along each side of a light's window (the water that can light the receivers), 2 … 2048. Default 256.
    /// The error falls with the square of this number.
    #[serde(deserialize_with = "integer::<WaterCells, _>")]
    #[schema(minimum = 2, maximum = 2048)]
    pub water_cells: u32,
    /// Texels along the longer side of the floor's irradiance map in a view, 16 … 4096. Default 512.
    #[serde(deserialize_with = "integer::<MapTexels, _>")]
    #[schema(minimum = 16, maximum = 4096)]
    pub map_texels: u32,
    /// Texels along each side of a mesh's level map and of its irradiance map, a power of two, 16 … 2048. Default 256.
    #[serde(deserialize_with = "integer::<LevelMapTexels, _>")]
    #[schema(minimum = 16, maximum = 2048)]
    pub level_map_texels: u32,
    /// Number of surfaces of a mesh, counted along the light from the nearest, that have an irradiance map each, 1 … 4. Default
    /// 1: the surface visible from the light through flat water. Further layers show light that only tilted rays carry there,
    /// such as light on the far sides of objects under steep waves.
    #[serde(deserialize_with = "integer::<Layers, _>")]
    #[schema(minimum = 1, maximum = 4)]
    pub layers: u32,
    /// Texels of an object's level map and irradiance map per pixel of its size in the picture, 0 … 16. The number of texels
    /// along a side is rounded up to a power of two, within 16 … `level_map_texels`; the number of reference planes is reduced in
    /// proportion. An object outside the picture gets 16 texels and still casts its shadow. Default 0: every object gets
    /// `level_map_texels`. Views only.
    #[schema(minimum = 0, maximum = 16)]
    pub level_of_detail: f64,
    /// How often a beam is halved whose corners end on different receivers, 0 … 8. Default 2. Only the parts that still straddle
    /// receivers are halved again, so each further level about doubles the time spent on shadow edges and halves their width.
    #[serde(deserialize_with = "integer::<SplitLevels, _>")]
    #[schema(minimum = 0, maximum = 8)]
    pub split_levels: u32,
    /// Target for the relative L1 error of the irradiance, 0.0001 … 0.5. The program then chooses `water_cells`, `map_texels`,
    /// `level_map_texels` (except for the map of a mesh) and `split_levels` and ignores the given values; `stats.accuracy.chosen`
    /// lists the chosen ones. To choose, it makes trial renders of the light with increasing numbers of cells, until their
    /// estimated error can be trusted; their time is added to that of the frame (`stats.time_ms.plan`). Not with
    /// `time_budget_ms`. Default: absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.0001, maximum = 0.5)]
    pub target_error: Option<f64>,
    /// Maximum time of the frame, ms, 0.1 … 3 600 000, on the machine that was calibrated. The program then chooses the same
    /// dials as for `target_error`, for the smallest predicted error. The time to choose is not included: it is that of a trial
    /// render of the light with half the cells (`stats.time_ms.plan`). Not with `target_error`. Default: absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0.1, maximum = 3_600_000.0)]
    pub time_budget_ms: Option<f64>,
    /// Whether the frame estimates its own error (`stats.accuracy.estimated_error`) by computing the light a second time with two
    /// fifths of the water cells along each side, or fewer. Default false.
    pub estimate_error: bool,
    /// Camera rays along each side of a pixel, 1 … 8. Default 1. Views only. More rays smooth edges; the time of the camera's
    /// passes grows with the square of this number. Only radiance is averaged: the other layers are those of the pixel's centre.
    #[serde(deserialize_with = "integer::<PixelSamples, _>")]
    #[schema(minimum = 1, maximum = 8)]
    pub pixel_samples: u32,
    /// How often a camera ray may meet the water, 0 … 4. Default 1. Views only. Each time it splits into a ray that goes through the water
    /// and one that is mirrored, if the scene has something that both can show; so the time of the camera's passes may double with
    /// each. 0: the ray goes through once, and the water mirrors only the sky. What is cut off is reported.
    #[serde(deserialize_with = "integer::<Bounces, _>")]
    #[schema(minimum = 0, maximum = 4)]
    pub bounces: u32,
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
            bounces: 1,
        }
    }
}
