//! What a study of a scene found: error and cost of each setting, in numbers (`Study`) and in pictures (`StudyImages`).

use crate::accuracy::LinearImage;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use crate::stats::{AdapterStats, Warning};

/// Error against time of one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Study {
    /// Program version.
    pub version: String,
    /// A name for people: the scene file's, or empty.
    pub scene: String,
    /// `blake3:…` of the canonical scene.
    pub scene_hash: String,
    /// Where the renders ran.
    pub adapter: AdapterStats,
    /// CPU cores of the machine.
    pub cores: u32,
    /// What the renders are compared with.
    pub truth: TruthFigures,
    /// One sweep per dial, a single one over all combinations, or one per series of a comparison of methods.
    pub sweeps: Vec<Sweep>,
    /// Methods of a comparison that cannot render the scene, with their reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeftOut>,
    /// What was skipped, clamped or could not be measured.
    pub warnings: Vec<Warning>,
}

impl Study {
    /// Whether it compares methods, each at settings of its own.
    pub fn is_comparison(&self) -> bool {
        self.sweeps.iter().any(|sweep| sweep.series.is_some())
    }
}

/// The float64 reference behind a study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TruthFigures {
    /// What is compared, as a sentence: which receiver, how many texels or pixels.
    pub what: String,
    /// Values compared along x.
    pub width: u32,
    /// Values compared along y (or z).
    pub height: u32,
    /// Rays that were counted.
    pub rays: u64,
    /// Relative L1 error of the truth by its own estimate: two independent halves.
    pub relative_error: f64,
    /// Time it took, s; that of the first time when it comes from the disk.
    pub seconds: f64,
    /// Whether it was read from the disk.
    pub from_disk: bool,
    /// Share of the compared values that lie within two texels (for a view: pixels) of a mesh's shadow edge; absent where no mesh shades
    /// the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadow_edge_area: Option<f64>,
}

/// The settings of one sweep, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Sweep {
    /// What varies: a dial of `quality`, or several joined by ` × `. In a comparison the method, with words that are not its defaults.
    pub dial: String,
    /// The method, in a comparison.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub series: Option<SeriesOf>,
    /// What was measured at each setting.
    pub points: Vec<Point>,
    /// Order of convergence: the error falls as the dial (in a comparison `scale`) to minus this power. Fitted to the settings whose error is at least three
    /// times the truth's; absent where the dial is no number or counts halvings, or fewer than two settings remain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<f64>,
    /// For a dial that counts halvings (`split_levels`), instead of an order: the factor by which the error falls per level, 0 included.
    /// Fitted to the same settings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor_per_level: Option<f64>,
}

/// The method of a series in a comparison.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct SeriesOf {
    /// Its name.
    pub method: String,
    /// The dial whose value names a setting.
    pub chief: String,
}

/// A method of a comparison that cannot render the scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LeftOut {
    /// The series, as [`Sweep::dial`].
    pub series: String,
    /// Its method.
    pub method: String,
    /// Why.
    pub reason: String,
}

/// One setting of the dials.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Point {
    /// The dials that this sweep sets, with their values.
    pub dials: BTreeMap<String, Value>,
    /// In a comparison, where on the method's ladder: its numbers are in proportion to this, 1 with 256 water cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// How far it is from the truth.
    pub error: ErrorFigures,
    /// What it costs.
    pub cost: CostFigures,
    /// Whether no other setting of the study is both faster and nearer to the truth.
    pub on_pareto_front: bool,
    /// Warnings of the render.
    pub warnings: Vec<Warning>,
}

/// How far an image is from the truth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ErrorFigures {
    /// Σ|E − truth| / Σ truth, over all texels and channels.
    pub relative_l1: f64,
    /// Root mean square error, W/m².
    pub rmse_w_m2: f64,
    /// (Σ E − Σ truth) / Σ truth.
    pub flux_bias: f64,
    /// 99th percentile of |E − truth|, relative to the mean of the truth.
    pub p99: f64,
    /// Mean ꟻLIP error, 0 … 1, of the maps shown as pictures.
    pub flip: f64,
    /// Mean distance in CIE Luv of the maps shown as pictures (Tipprasert 2006, eq. 2-9).
    pub luv_distance: f64,
    /// Share of the L1 error within two texels (for a view: pixels) of a mesh's shadow edge; absent where no mesh shades the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shadow_edge_share: Option<f64>,
    /// The render's own estimate of its relative L1 error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimated: Option<f64>,
}

/// What a setting costs: warm runs, pipelines and level maps there already. In a comparison of methods each run shows the water a moment
/// later, so that nothing of its light is there already.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CostFigures {
    /// Runs behind the figures.
    pub runs: u32,
    /// From the scene to the linear result, ms.
    pub wall_ms: SpreadMs,
    /// From submission to the end of readback, ms.
    pub gpu_ms: SpreadMs,
    /// Each pass, in order, ms.
    pub passes: Vec<PassCost>,
    /// Most GPU memory held, bytes.
    pub peak_bytes: u64,
}

/// Median of some runs, and how far they spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SpreadMs {
    /// Median, ms.
    pub median: f64,
    /// Smallest, ms.
    pub min: f64,
    /// Largest, ms.
    pub max: f64,
}

/// Cost of a pass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PassCost {
    /// Pass name.
    pub name: String,
    /// All its runs in a frame, ms.
    pub ms: SpreadMs,
}

/// The pictures behind a study's figures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyImages {
    /// The truth.
    pub truth: LinearImage,
    /// One per point, sweep by sweep.
    pub points: Vec<Vec<LinearImage>>,
    /// Irradiance, W/m², that is shown as white: that of a dry horizontal surface in the open.
    pub white_w_m2: f64,
}
