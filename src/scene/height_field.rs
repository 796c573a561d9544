//! The fields of water that a user brings as numbers, and what can be checked of them without the files.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::findings::Findings;
use super::parse::{inner, wrong_type};
use super::ranges::{self, number};
use super::types::HeightFieldKind;

/// Most frames of a height field.
pub const MAX_FRAMES: usize = 4096;

/// Samples over which a bounded field is blended to flat by default.
const RIM_SAMPLES: f64 = 8.0;

/// Fewest samples over which a bounded field is blended to flat: fewer make a step of it.
const LEAST_RIM_SAMPLES: f64 = 2.0;

/// Water whose surface is given by numbers in files: heights or slopes on an even grid, at one moment or several.
///
/// Files are NPY (float16, float32, float64, integers of 16 and 32 bits; C or Fortran order), EXR or PNG of 16 bits; over HTTP they are
/// uploaded to `POST /v1/assets`, in scene files they are paths relative to the scene. The surface is the interpolating cubic spline
/// through the samples, with continuous curvature, for the reference too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HeightField {
    /// Always `height_field`.
    pub kind: HeightFieldKind,
    /// The files, `blake3:…`, in the order of time, all of one size. An NPY of shape (rows, columns) is one frame; one of shape (frames,
    /// rows, columns) counts as so many. 1 … 4096 frames.
    #[schema(min_items = 1, max_items = 4096)]
    pub frames: Vec<String>,
    /// What the numbers are. Default `heights`.
    #[serde(default)]
    pub holds: FieldHolds,
    /// Name of the channel with the heights. Default: the only one, or the first that the file has of `height`, `Height`, `h`, `Y`, `Z`,
    /// `y`. EXR has its own names; PNG has `Y`, `A`, `R`, `G`, `B`; NPY has one channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// Names of the channels with the slopes ∂h/∂x and ∂h/∂z. Default: `slope.x` and `slope.z` (as in a water map of this program, whose first sample lies half a texel within its corner), `x` and `z`, `X` and `Z`, or `R` and `G`. In an NPY of shape (rows,
    /// columns, 2) or (frames, rows, columns, 2) they are `x` and `z`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub channels: Option<[String; 2]>,
    /// Height of 1 in the file, m, −10⁶ … 10⁶, not 0. Default 1; PNG needs `range_m` instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale_m: Option<f64>,
    /// Heights of 0 and 65535 in a PNG or an NPY of unsigned 16-bit integers, m, −10⁵ … 10⁵. The narrower the range, the smaller the steps,
    /// which are lenses too: 0.13 m in 16 bits, 32 samples a metre, change the irradiance 2 m down by 0.2 % in the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub range_m: Option<[f64; 2]>,
    /// Slope of 1 in the file, −10⁶ … 10⁶, not 0. Default 1; PNG needs `slope_range` instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slope_scale: Option<f64>,
    /// Slopes of 0 and 65535 in a PNG or an NPY of unsigned 16-bit integers, −10⁵ … 10⁵.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub slope_range: Option<[f64; 2]>,
    /// Height of the water at rest among the scaled heights, m, −10⁶ … 10⁶; it is subtracted. Default, so that absolute
    /// heights make no plateau: of a bounded field the mean along its edges in all frames, of a periodic one the mean of all samples. No height may then be beyond ±100 m. The heights found from slopes have the mean
    /// 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_m: Option<f64>,
    /// Distance of neighbouring samples, m, 10⁻⁵ … 10³: one number, or those along x and z. The sides of the field are 10⁻² … 10⁴ m long.
    pub sample_m: SampleDistance,
    /// Place (x, z) of the sample with the lowest x and z, m, −10⁸ … 10⁸. Default: the middle of the samples is at (0, 0).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub min_m: Option<[f64; 2]>,
    /// The axis along which a row of the file runs. Default `x`. Slopes are those along the scene's x and z in any case.
    #[serde(default)]
    pub rows_along: RowAxis,
    /// Where the first row of the file lies along the other axis. Default `min`, as in the maps that this program writes; `max` for
    /// pictures whose top is at high z.
    #[serde(default)]
    pub first_row: FirstRow,
    /// What is beyond the samples. Default `bounded`.
    #[serde(default)]
    pub edges: FieldEdges,
    /// Width over which a bounded field is blended to flat within its edges, m, at least two samples and at most half of each side.
    /// Default: eight samples, or half of the shorter side. A warning says how much light enters there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rim_m: Option<f64>,
    /// Frames per second of the scene's time, 10⁻⁶ … 10⁶; needed for more than one frame. Between frames heights are interpolated by a
    /// cubic (Catmull–Rom); at a frame's time the surface is exactly that frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames_per_s: Option<f64>,
    /// Time of the first frame, s, −10¹² … 10¹². Default 0.
    #[serde(default)]
    pub start_s: f64,
    /// What follows the last frame, and precedes the first. Default `hold`.
    #[serde(default)]
    pub after: AfterLast,
}

/// What the numbers of a height field are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldHolds {
    /// Heights, in one channel.
    #[default]
    Heights,
    /// Slopes ∂h/∂x and ∂h/∂z, in two channels. The heights are those whose slopes differ least from them, in the mean square; a warning
    /// says if they differ.
    Slopes,
}

/// An axis of the water at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RowAxis {
    /// A row runs along x, towards higher x.
    #[default]
    X,
    /// A row runs along z, towards higher z.
    Z,
}

/// The end of an axis at which the first row of a file lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FirstRow {
    /// At the lowest coordinate.
    #[default]
    Min,
    /// At the highest coordinate.
    Max,
}

/// What is beyond the samples of a height field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldEdges {
    /// Flat water.
    #[default]
    Bounded,
    /// The field again, along x and z: the first sample follows one step after the last.
    Periodic,
}

/// What follows the last frame of a height field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AfterLast {
    /// The last frame stays, and before the first it is the first.
    #[default]
    Hold,
    /// The first frame follows one frame after the last, and so on, before the first too.
    Loop,
}

/// Distance of neighbouring samples, m: one number, or those along x and z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum SampleDistance {
    /// The same along both axes.
    Uniform(f64),
    /// Along x and z.
    PerAxis([f64; 2]),
}

impl<'de> Deserialize<'de> for SampleDistance {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        match value {
            Value::Number(_) => inner(&value).map(Self::Uniform),
            Value::Array(_) => inner(&value).map(Self::PerAxis),
            other => return Err(wrong_type(&other, "a number or an array of length 2")),
        }
        .map_err(serde::de::Error::custom)
    }
}

impl SampleDistance {
    /// Along x and z, m.
    pub fn per_axis_m(self) -> [f64; 2] {
        match self {
            Self::Uniform(distance_m) => [distance_m; 2],
            Self::PerAxis(distances_m) => distances_m,
        }
    }
}

impl HeightField {
    /// Width of the rim of a bounded field of `size` samples along x and z, m.
    pub fn rim_used_m(&self, size: [usize; 2]) -> f64 {
        let step_m = self.sample_m.per_axis_m();
        let half_m = [0, 1].map(|axis| 0.5 * (size[axis] - 1) as f64 * step_m[axis]);
        self.rim_m
            .unwrap_or(RIM_SAMPLES * step_m[0].max(step_m[1]))
            .min(half_m[0])
            .min(half_m[1])
    }
}

/// Checks everything that does not depend on the files.
pub(super) fn check(findings: &mut Findings, waves: &HeightField, at: &dyn Fn(&str) -> String) {
    if waves.frames.is_empty() {
        findings.invalid(at("frames"), "there is no frame", "at least one file");
    }
    findings.count(&at("frames"), "frames", waves.frames.len(), MAX_FRAMES);
    let empty = waves.frames.iter().position(String::is_empty);
    if let Some(index) = empty {
        findings.invalid(
            at(&format!("frames/{index}")),
            "the id is empty",
            "`blake3:…`",
        );
    }
    unsuitable(findings, waves, at);
    for (field, scale) in [
        ("scale_m", waves.scale_m),
        ("slope_scale", waves.slope_scale),
    ] {
        if let Some(scale) = scale
            && findings.number(at(field), scale, &ranges::FIELD_SCALE)
            && scale == 0.0
        {
            findings.invalid(at(field), "0 makes the water flat", "another number");
        }
    }
    for (field, range) in [
        ("range_m", waves.range_m),
        ("slope_range", waves.slope_range),
    ] {
        if let Some([low, high]) = range
            && findings.numbers(&at(field), &[low, high], &ranges::FIELD_RANGE)
            && low == high
        {
            let accepted = "two different numbers, those of 0 and of 65535";
            findings.invalid(at(field), "the range is empty", accepted);
        }
    }
    if let Some(rest_m) = waves.rest_m {
        findings.number(at("rest_m"), rest_m, &ranges::REST_HEIGHT);
    }
    let distances = &ranges::SAMPLE_DISTANCE;
    let is_spaced = match waves.sample_m {
        SampleDistance::Uniform(m) => findings.number(at("sample_m"), m, distances),
        SampleDistance::PerAxis(m) => findings.numbers(&at("sample_m"), &m, distances),
    };
    if let Some(min_m) = waves.min_m {
        findings.numbers(&at("min_m"), &min_m, &ranges::COORDINATE);
    }
    if let Some(rim_m) = waves.rim_m
        && findings.number(at("rim_m"), rim_m, &ranges::TILE_OR_LESS)
        && is_spaced
    {
        let [x_m, z_m] = waves.sample_m.per_axis_m();
        let least_m = LEAST_RIM_SAMPLES * x_m.max(z_m);
        if rim_m < least_m {
            findings.invalid(
                at("rim_m"),
                format!("{} m is a step in the water, not a rim", number(rim_m)),
                format!("at least {} m, two samples", number(least_m)),
            );
        }
    }
    if let Some(rate) = waves.frames_per_s {
        findings.number(at("frames_per_s"), rate, &ranges::FRAME_RATE);
    }
    findings.number(at("start_s"), waves.start_s, &ranges::TIME);
}

/// Fields that do not go together.
fn unsuitable(findings: &mut Findings, waves: &HeightField, at: &dyn Fn(&str) -> String) {
    let is_slopes = waves.holds == FieldHolds::Slopes;
    let (word, others) = match waves.holds {
        FieldHolds::Heights => (
            "heights",
            [
                ("channels", waves.channels.is_some(), "`channel`"),
                ("slope_scale", waves.slope_scale.is_some(), "`scale_m`"),
                ("slope_range", waves.slope_range.is_some(), "`range_m`"),
                ("", false, ""),
            ],
        ),
        FieldHolds::Slopes => (
            "slopes",
            [
                ("channel", waves.channel.is_some(), "`channels`"),
                ("scale_m", waves.scale_m.is_some(), "`slope_scale`"),
                ("range_m", waves.range_m.is_some(), "`slope_range`"),
                (
                    "rest_m",
                    waves.rest_m.is_some(),
                    "nothing: the mean of the heights is 0",
                ),
            ],
        ),
    };
    for (field, is_given, instead) in others {
        if is_given {
            let detail = format!("a field that holds {word} has no `{field}`");
            findings.invalid(at(field), detail, format!("{instead}, or another `holds`"));
        }
    }
    let (scale, range, name) = if is_slopes {
        (waves.slope_scale, waves.slope_range, "slope_scale")
    } else {
        (waves.scale_m, waves.range_m, "scale_m")
    };
    if scale.is_some() && range.is_some() {
        let detail = "the numbers are scaled twice, by a scale and by a range";
        findings.invalid(at(name), detail, "one of the two");
    }
    if waves.edges == FieldEdges::Periodic && waves.rim_m.is_some() {
        let detail = "a periodic field has no rim";
        findings.invalid(
            at("rim_m"),
            detail,
            "no `rim_m`, or `\"edges\": \"bounded\"`",
        );
    }
}
