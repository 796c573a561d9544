//! What a frame cost and how trustworthy it is: the `stats` of every answer.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Everything measured about one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Stats {
    /// Program version.
    pub version: String,
    /// `blake3:…` of the canonical scene.
    pub scene_hash: String,
    /// Where it ran.
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
    /// One entry per light and object that got its light by planes; absent otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub planes: Vec<PlaneStats>,
    /// How near the truth it is thought to be; absent unless `quality` asks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<AccuracyStats>,
    /// How radiance becomes display values.
    pub exposure: ExposureStats,
    /// Whatever was clamped, skipped, sub-sampled or not simulated.
    pub warnings: Vec<Warning>,
}

/// The method that carried the light of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(default)]
pub struct MethodStats {
    /// Its name, as in `quality.method`.
    pub name: String,
    /// Where it was published.
    pub paper: String,
    /// Whether the light that lands is what its rays carried; where not, open energy accounts are no defect.
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
    /// Whether a CPU does the work.
    pub software: bool,
}

/// A pass that ran.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PassStats {
    /// Pass name.
    pub name: String,
    /// Why it is in.
    pub reason: String,
    /// How often it ran (per light, per level map, per band of the picture).
    pub runs: u32,
    /// GPU time of all runs, ms; absent when the adapter has no usable timestamps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpu_ms: Option<f64>,
}

/// A pass that was not needed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AbsentPass {
    /// Pass name.
    pub name: String,
    /// Why it is out.
    pub reason: String,
}

/// Wall times, ms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TimeStats {
    /// Waiting for the GPU thread.
    pub queue: f64,
    /// Facts and plan; with `quality.target_error` or `quality.time_budget_ms` also choosing the dials, looks at the light included.
    pub plan: f64,
    /// Uploads and recording.
    pub upload: f64,
    /// From submission until the GPU was done; what was recorded meanwhile is not taken off.
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
    /// What the plan said the frame would hold at its peak.
    pub planned_peak_bytes: u64,
    /// What it did hold, by the program's own accounting of GPU allocations.
    pub peak_bytes: u64,
    /// The limit a plan is checked against.
    pub budget_bytes: u64,
    /// What the GPU's allocator had given out at the end of the frame, other resources included; absent where nobody asked or the
    /// backend does not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allocated_bytes: Option<u64>,
    /// Level-map cache.
    pub level_maps: CacheStats,
}

/// A cache, for this frame (hits, misses, evictions) and as it stands after it (entries, bytes).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CacheStats {
    /// Found.
    pub hits: u64,
    /// Built.
    pub misses: u64,
    /// Thrown out to make room.
    pub evictions: u64,
    /// Held now.
    pub entries: u64,
    /// Held now, bytes.
    pub bytes: u64,
    /// At most, bytes.
    pub budget_bytes: u64,
}

/// Where one light's power went, W per channel; each term is summed where it happens, none by subtraction.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct EnergyAccount {
    /// Index into `lights`.
    pub light: u32,
    /// Falls on the simulated piece of water; of a point light under water what goes in the simulated directions.
    pub emitted_w: [f64; 3],
    /// Arrives on receiver maps.
    pub landed_w: [f64; 3],
    /// Absorbed on the way to a receiver.
    pub absorbed_w: [f64; 3],
    /// Scattered out of the beams on the way to a receiver.
    pub scattered_w: [f64; 3],
    /// Reflected at the surface.
    pub reflected_w: [f64; 3],
    /// Passes the edges of the maps.
    pub left_region_w: [f64; 3],
    /// Meets no receiver at all (nothing below, or refracted away from everything).
    pub missed_w: [f64; 3],
    /// |emitted − all the rest| / emitted, the largest of the channels; 0 when nothing is emitted.
    pub closure: f64,
}

/// What placing light on an object by planes took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlaneStats {
    /// Index into `lights`.
    pub light: u32,
    /// Index into `objects`.
    pub object: u32,
    /// Planes that were asked for by the dial of the method, fewer where level of detail made the map smaller.
    pub specified: u32,
    /// Planes that were used.
    pub used: u32,
    /// Pieces of the object's box that hold them.
    pub sub_boxes: u32,
    /// Beams that go under water.
    pub beams: u32,
    /// Beams that may reach the object, which are cut with its planes.
    pub beams_kept: u32,
}

/// How near the truth a frame is thought to be, and which dials were chosen for that.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AccuracyStats {
    /// Relative L1 error of the irradiance, estimated from the same light done with two fifths of the water cells or fewer
    /// (`quality.estimate_error`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
    /// The dials that `quality.target_error` or `quality.time_budget_ms` were turned into.
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
    /// Relative L1 error they are predicted to give.
    pub predicted_error: f64,
    /// Time that a frame is predicted to take with them, warm, ms; choosing is not in it.
    pub predicted_ms: f64,
    /// Whether what was asked for is predicted to be met; otherwise these are the best that can be had.
    pub meets: bool,
    /// How the choice was made, in a sentence.
    pub reason: String,
}

/// How radiance becomes display values: display = tone_curve(radiance · scale).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ExposureStats {
    /// Radiance of a perfect white, horizontal, dry surface under the scene's suns and skies, and of one that faces each point light in the
    /// middle of what is looked at, at the height of the floor (at least 0.1 m away), W/(m² sr); it is shown as 1 at 0 EV.
    pub white_radiance: f64,
    /// Requested stops.
    pub ev: f64,
    /// Factor applied (PNG only).
    pub scale: f64,
}

/// Something the reader of the picture should know.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Warning {
    /// Stable word for programs.
    pub code: String,
    /// Sentence for people.
    pub message: String,
    /// JSON pointer to the cause, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pointer: Option<String>,
    /// Flux concerned, W per channel: measured by the frame, or estimated before it from a sample of rays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flux_w: Option<[f64; 3]>,
}

impl Warning {
    /// Codes of warnings without a flux: nothing is lost (`sums_done_again`), or what they tell of is no light on its way but
    /// dials, pixels, layers, values of a file, or what surfaces reflect. All others say in a frame how much flux is concerned.
    pub const WITHOUT_FLUX: [&'static str; 16] = [
        "calibrated_elsewhere",
        "half_clamped",
        "half_flushed",
        "mesh_material_clamped",
        "mesh_missing_material",
        "mesh_mtl_ignored",
        "pixels_along_water",
        "pixels_outside_map",
        "further_layers_stay_dark",
        "png_clipped",
        "png_layers_left_out",
        "png_negative",
        "setting_left_out",
        "sums_done_again",
        "target_error_not_met",
        "time_budget_not_met",
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
