//! The `stats` of every answer: the cost and the trustworthiness of a frame.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Everything measured about one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Stats {
    /// Program version.
    pub version: String,
    /// `blake3:…` of the canonical scene.
    pub scene_hash: String,
    /// The adapter it ran on.
    pub adapter: AdapterStats,
    /// The method that carried the light.
    pub method: MethodStats,
    /// Passes that ran, in order.
    pub passes: Vec<PassStats>,
    /// Passes that did not run, and why.
    pub absent: Vec<AbsentPass>,
    /// Wall times, ms.
    pub time_ms: TimeStats,
    /// Memory, bytes.
    pub memory: MemoryStats,
    /// One account per light that shines into or under the water.
    pub energy: Vec<EnergyAccount>,
    /// One entry per light and object whose light was placed by reference planes; absent otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneStats>,
    /// One entry per beam set whose light was looked up in a kept field; absent otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<FieldStats>,
    /// Estimated accuracy; absent unless `quality` requests it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<AccuracyStats>,
    /// How radiance becomes display values.
    pub exposure: ExposureStats,
    /// The camera of a view, as vision and graphics programs state it; absent for irradiance maps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraStats>,
    /// Everything that was clamped, skipped, sub-sampled or not simulated.
    pub warnings: Vec<Warning>,
}

/// A camera as matrices, row by row. They multiply column vectors: p_camera = M (x, y, z, 1).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct CameraStats {
    /// Matrix K, pixels: (u, v, 1) ~ K (X, Y, Z) in OpenCV's camera coordinates. The middle of the first pixel is at (½, ½); for
    /// functions that count from the middle of the first pixel, as OpenCV's do, subtract ½ from the last column's first two values.
    /// Absent for an orthographic camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 3, max_items = 3)]
    pub k_px: Option<[[f64; 3]; 3]>,
    /// Scale of an orthographic camera, pixels/m: u = width/2 + scale · X, v = height/2 + scale · Y. Absent for a perspective camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixels_per_m: Option<f64>,
    /// World to OpenCV's camera coordinates, m: X right, Y down, Z ahead.
    #[schema(min_items = 4, max_items = 4)]
    pub world_to_camera_opencv: [[f64; 4]; 4],
    /// World to OpenGL's camera coordinates, m: X right, Y up, Z backwards.
    #[schema(min_items = 4, max_items = 4)]
    pub world_to_camera_opengl: [[f64; 4]; 4],
}

/// The method that carried the light of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct MethodStats {
    /// Its name, as in `quality.method`.
    pub name: String,
    /// Its publication.
    pub paper: String,
    /// Whether the light that lands is the light its rays carried. If not, an energy account that does not close is no defect.
    pub conserves_energy: bool,
}

/// The adapter a frame ran on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AdapterStats {
    /// Adapter name.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`.
    pub backend: String,
    /// Driver name and version.
    pub driver: String,
    /// Whether the adapter is a software driver on the CPU.
    pub software: bool,
}

/// A pass that ran.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PassStats {
    /// Pass name.
    pub name: String,
    /// Why it ran.
    pub reason: String,
    /// Number of runs (per light, per level map, per band of the picture).
    pub runs: u32,
    /// GPU time of all runs, ms; absent if the adapter has no usable timestamps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpu_ms: Option<f64>,
}

/// A pass that was not needed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AbsentPass {
    /// Pass name.
    pub name: String,
    /// Why it was not needed.
    pub reason: String,
}

/// Wall times, ms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimeStats {
    /// Waiting for the GPU thread.
    pub queue: f64,
    /// Computing facts and plan. With `quality.target_error` or `quality.time_budget_ms` also choosing the dials, trial renders
    /// included.
    pub plan: f64,
    /// Uploading data and recording commands.
    pub upload: f64,
    /// From submission until the GPU was done. Time spent on recording meanwhile is not subtracted.
    pub gpu: f64,
    /// Copying results to the host.
    pub readback: f64,
    /// PNG or EXR encoding.
    pub encode: f64,
    /// From arrival to the encoded file.
    pub total: f64,
}

/// Memory, bytes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MemoryStats {
    /// Peak of the frame as planned.
    pub planned_peak_bytes: u64,
    /// Peak of the frame as measured, by the program's own accounting of GPU allocations.
    pub peak_bytes: u64,
    /// The limit a plan is checked against.
    pub budget_bytes: u64,
    /// Bytes allocated by the GPU's allocator at the end of the frame, other resources included; absent if not requested or not
    /// reported by the backend.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allocated_bytes: Option<u64>,
    /// The level-map cache.
    pub level_maps: CacheStats,
    /// The kept fields of light.
    #[serde(default)]
    pub fields: CacheStats,
}

/// A cache: hits, misses and evictions of this frame; entries and bytes after it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CacheStats {
    /// Entries found.
    pub hits: u64,
    /// Entries built.
    pub misses: u64,
    /// Entries evicted to make room.
    pub evictions: u64,
    /// Entries held after the frame.
    pub entries: u64,
    /// Bytes held after the frame.
    pub bytes: u64,
    /// Maximum number of bytes held.
    pub budget_bytes: u64,
}

/// Where the power of one light went, W per channel. Each term is summed where the light goes; none is found by subtraction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EnergyAccount {
    /// Index into `lights`.
    pub light: u32,
    /// Falls on the simulated piece of water. For a point light under water: emitted in the simulated directions.
    pub emitted_w: [f64; 3],
    /// Lands on receiver maps.
    pub landed_w: [f64; 3],
    /// Absorbed on the path to a receiver.
    pub absorbed_w: [f64; 3],
    /// Scattered out of the beams on the path to a receiver.
    pub scattered_w: [f64; 3],
    /// Reflected at the surface.
    pub reflected_w: [f64; 3],
    /// Falls beside the maps.
    pub left_region_w: [f64; 3],
    /// Meets no receiver at all (nothing below, or refracted away from everything).
    pub missed_w: [f64; 3],
    /// Closure of the account: |emitted − sum of the other terms| / emitted, the largest of the channels; 0 if nothing is
    /// emitted.
    pub closure: f64,
}

/// The work of placing light on an object by reference planes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlaneStats {
    /// Index into `lights`.
    pub light: u32,
    /// Index into `objects`.
    pub object: u32,
    /// Planes that the method's dial requests; fewer if level of detail made the map smaller.
    pub specified: u32,
    /// Planes used.
    pub used: u32,
    /// Pieces of the object's box that hold them.
    pub sub_boxes: u32,
    /// Beams that go under water.
    pub beams: u32,
    /// Beams that may reach the object: these are intersected with its planes.
    pub beams_kept: u32,
}

/// A field of light on horizontal slices.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FieldStats {
    /// Index into `lights`.
    pub light: u32,
    /// Slices.
    pub slices: u32,
    /// Texels of a slice along x.
    pub width: u32,
    /// Texels of a slice along z.
    pub height: u32,
    /// Lower corner of its box, m.
    pub min_m: [f64; 3],
    /// Upper corner of its box, m.
    pub max_m: [f64; 3],
    /// GPU memory that it takes, bytes.
    pub bytes: u64,
    /// Whether it was kept from an earlier frame.
    pub was_kept: bool,
    /// Largest closure of the accounts of its slices: of each slice, |emitted − reflected − lost above it − beside it − through it| /
    /// emitted.
    pub closure: f64,
    /// Flux down through each slice within the box, lowest first, W.
    pub through_w: Vec<[f64; 3]>,
}

/// The estimated accuracy of a frame, and the dials chosen for it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AccuracyStats {
    /// Relative L1 error of the irradiance, estimated by computing the light a second time with two fifths of the water cells
    /// along each side, or fewer (`quality.estimate_error`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
    /// The dials chosen for `quality.target_error` or `quality.time_budget_ms`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<ChosenDials>,
}

/// Dials chosen by the program.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ChosenDials {
    /// `quality.water_cells`.
    pub water_cells: u32,
    /// `quality.map_texels`.
    pub map_texels: u32,
    /// `quality.level_map_texels`.
    pub level_map_texels: u32,
    /// `quality.split_levels`.
    pub split_levels: u32,
    /// Predicted relative L1 error.
    pub predicted_error: f64,
    /// Predicted time of a warm frame, ms, without the time to choose.
    pub predicted_ms: f64,
    /// Whether the target is predicted to be met. If not, these are the best dials available.
    pub meets: bool,
    /// How the choice was made, one sentence.
    pub reason: String,
}

/// The method that the planner would choose for a wanted error. A render uses the method that the scene names.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MethodAdvice {
    /// Its name.
    pub method: String,
    /// Its dials, where they are not those in `chosen`: they met the error on every measured scene of this kind.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(value_type = BTreeMap<String, Object>)]
    pub dials: BTreeMap<String, serde_json::Value>,
    /// Why this one, one sentence without full stop.
    pub reason: String,
    /// Expected relative L1 error.
    pub expected_error: f64,
    /// Expected time of a warm frame, ms.
    pub expected_ms: f64,
    /// What the expectation is based on.
    pub source: String,
    /// Why not the other methods.
    pub others: Vec<OtherMethod>,
}

/// A method that the planner would not choose.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct OtherMethod {
    /// Its name.
    pub method: String,
    /// Why not.
    pub reason: String,
}

/// How radiance becomes display values: display = tone_curve(radiance · scale).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExposureStats {
    /// Radiance that is shown as 1 at 0 EV, W/(m² sr): that of a perfectly white, dry surface, horizontal under the scene's suns
    /// and skies, and facing each point light from the middle of the viewed region at the height of the floor (at least 0.1 m
    /// from the light).
    pub white_radiance: f64,
    /// Requested exposure, stops.
    pub ev: f64,
    /// Factor applied to radiance (PNG only).
    pub scale: f64,
}

/// Something that a user of the picture should know.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Warning {
    /// Stable code for programs.
    pub code: String,
    /// Sentence for people.
    pub message: String,
    /// JSON pointer to the cause, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pointer: Option<String>,
    /// Flux concerned, W per channel: measured in the frame, or estimated before it from sampled rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flux_w: Option<[f64; 3]>,
}

impl Warning {
    /// Codes of warnings without a flux: either no light is lost (`sums_done_again`), or they concern dials, pixels, layers,
    /// values of a file, the shape of the water or what surfaces reflect, not light on its path. In a frame, all other warnings state the flux concerned.
    pub const WITHOUT_FLUX: [&'static str; 23] = [
        "calibrated_elsewhere",
        "half_clamped",
        "half_flushed",
        "height_field_coarse_numbers",
        "mesh_material_clamped",
        "mesh_missing_material",
        "mesh_mtl_ignored",
        "obstacle_outside_basin",
        "pixels_along_water",
        "pixels_outside_map",
        "further_layers_stay_dark",
        "png_clipped",
        "png_layers_left_out",
        "png_negative",
        "rays_cut_off",
        "sea_without_waves",
        "setting_left_out",
        "slopes_are_no_gradient",
        "sums_done_again",
        "target_error_not_met",
        "time_budget_not_met",
        "water_map_coarse",
        "waves_smoothed",
    ];

    /// A warning without pointer and flux.
    pub fn new(code: &str, message: impl Into<String>) -> Self {
        Self {
            code: code.to_owned(),
            message: message.into(),
            ..Self::default()
        }
    }
}
