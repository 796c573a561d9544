//! EXR: every layer, scene-linear and unexposed, in one part with ZIP compression.

use ::exr::block::lines::LineRefMut;
use ::exr::image::write::samples::{SamplesWriter, WritableSamples};
use ::exr::math::RoundingMode;
use ::exr::meta::attribute::{Chromaticities, LevelMode};
use ::exr::meta::header::Header;
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding as Blocks, Image, ImageAttributes,
    IntegerBounds, Layer as Part, LayerAttributes, SampleType, SmallVec, Text, Vec2, WritableImage,
};
use glam::DMat4;
use half::f16;

use crate::frame::{Frame, FrameKind, Layer};
use crate::scene::{Encoding, ExrPixel};
use crate::stats::Warning;

use super::encode::{EncodeError, Encoded};
use super::exr_header::sort_attributes;
use super::layers::{check, format_in};
use super::metadata::{Metadata, SCENE_HASH_KEY, SCENE_KEY, STATS_KEY, ascii};

/// Media type of EXR.
pub const MEDIA_TYPE: &str = "image/x-exr";

/// Linear light with Rec. 709 primaries, as the Color Interop Forum names it.
pub const COLOR_INTEROP_ID: &str = "lin_rec709_scene";

/// Values that are no colours, likewise.
pub const DATA_INTEROP_ID: &str = "data";

/// Rec. ITU-R BT.709 primaries and white point D65, CIE xy.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// Writes all layers of `frame`.
///
/// # Errors
/// See [`EncodeError`].
pub fn encode(
    frame: &Frame,
    encoding: &Encoding,
    metadata: &Metadata,
) -> Result<Encoded, EncodeError> {
    let mut channels: SmallVec<[AnyChannel<Plane<'_>>; 4]> = SmallVec::new();
    let mut warnings = Vec::new();
    let mut holds = Vec::new();
    for (name, layer) in &frame.layers {
        check(frame, *name, layer)?;
        let format = format_in(frame, *name);
        let is_half = format.follows_exr_pixel && encoding.exr_pixel == ExrPixel::Half;
        if is_half {
            warnings.extend(half_warnings(format.word, layer));
        }
        holds.push(format.holds);
        channels.extend(
            format
                .exr_channels
                .iter()
                .enumerate()
                .map(|(index, channel)| {
                    let plane = Plane {
                        layer,
                        index,
                        is_half,
                        width: frame.width as usize,
                    };
                    AnyChannel::new(*channel, plane)
                }),
        );
    }

    let size = Vec2(frame.width as usize, frame.height as usize);
    let mut shared = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let is_light = frame.kind != FrameKind::WaterMap;
    shared.chromaticities = is_light.then_some(REC_709);
    let color_interop_id = if is_light {
        COLOR_INTEROP_ID
    } else {
        DATA_INTEROP_ID
    };
    shared.pixel_aspect = frame
        .projection
        .as_ref()
        .map_or(1.0, |p| p.pixel_aspect() as f32);
    let stats = metadata.stats_json(&warnings);
    let scene = frame.scene.as_deref().map(ascii);
    let texts = [
        (SCENE_HASH_KEY, Some(metadata.scene_hash.as_str())),
        (STATS_KEY, Some(stats.as_str())),
        (SCENE_KEY, scene.as_deref()),
        ("colorInteropID", Some(color_interop_id)),
    ];
    for (key, value) in texts {
        let Some(value) = value else { continue };
        let value = AttributeValue::Text(text(key, value)?);
        shared.other.insert(text(key, key)?, value);
    }
    warnings.extend(coarse_camera(frame));
    let own = LayerAttributes {
        software_name: Some(text("software", &metadata.software())?),
        comments: Some(text("comments", &format!("linear; {}", holds.join("; ")))?),
        ..camera_attributes(frame)
    };

    let part = Part::new(
        size,
        own,
        Blocks::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Vec::new();
    Image::new(shared, part)
        .write()
        .to_buffered(std::io::Cursor::new(&mut bytes))
        .map_err(|error| failed(error.to_string()))?;
    sort_attributes(&mut bytes).map_err(|reason| failed(reason.to_owned()))?;
    Ok(Encoded {
        bytes,
        media_type: MEDIA_TYPE,
        warnings,
    })
}

/// Distance by which the camera of the header may be off without a warning, m.
const COARSE_CAMERA_M: f64 = 1e-3;

/// The warning that the header's camera is off, because OpenEXR stores matrices in single precision.
fn coarse_camera(frame: &Frame) -> Option<Warning> {
    let projection = frame.projection.as_ref()?;
    let stored = projection.world_to_camera().as_mat4().as_dmat4();
    let off_m = stored.transform_point3(projection.eye_m).length();
    (off_m > COARSE_CAMERA_M).then(|| {
        Warning::new(
            "exr_camera_coarse",
            format!(
                "worldToCamera and worldToNDC of the EXR header are off by {off_m:.3} m, because they are single precision and the camera is far from the world's origin; camera in caustica:stats is exact"
            ),
        )
    })
}

/// The camera, as the OpenEXR standard attributes have it: camera space is left-handed with z along the view, and matrices multiply
/// row vectors.
fn camera_attributes(frame: &Frame) -> LayerAttributes {
    let Some(projection) = &frame.projection else {
        return LayerAttributes::default();
    };
    // The columns of a matrix for column vectors are the rows of that for row vectors.
    let for_rows = |matrix: DMat4| Some(matrix.to_cols_array().map(|v| v as f32));
    let angles = projection.field_of_view_deg();
    let (window_width, window_center) = projection.screen_window();
    LayerAttributes {
        screen_window_width: window_width as f32,
        screen_window_center: Vec2(window_center.x as f32, window_center.y as f32),
        world_to_camera: for_rows(projection.world_to_camera()),
        world_to_normalized_device: for_rows(projection.world_to_ndc()),
        horizontal_field_of_view: angles.map(|[x, _]| x as f32),
        vertical_field_of_view: angles.map(|[_, y]| y as f32),
        ..LayerAttributes::default()
    }
}

fn failed(reason: String) -> EncodeError {
    EncodeError::Format {
        format: "EXR",
        reason,
    }
}

fn text(name: &'static str, value: &str) -> Result<Text, EncodeError> {
    Text::new_or_none(value).ok_or(EncodeError::Text { name })
}

/// Nearest half, within its finite range.
fn to_half(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}

/// Warnings about values that a layer loses when it is written as half.
fn half_warnings(word: &str, layer: &Layer) -> Vec<Warning> {
    let largest = f16::MAX.to_f32();
    let clamped = layer.data.iter().filter(|v| v.abs() > largest).count();
    let flushed = layer
        .data
        .iter()
        .filter(|v| **v != 0.0 && to_half(**v).to_f32() == 0.0)
        .count();
    let values = layer.data.len();
    let mut warnings = Vec::new();
    if clamped > 0 {
        warnings.push(Warning::new(
            "half_clamped",
            format!(
                "{clamped} of {values} values of {word} are beyond 65504, the largest half, and were written as that; exr_pixel float keeps them"
            ),
        ));
    }
    if flushed > 0 {
        warnings.push(Warning::new(
            "half_flushed",
            format!(
                "{flushed} of {values} values of {word} are below 3e-8, too small for half, and were written as 0; exr_pixel float keeps them"
            ),
        ));
    }
    warnings
}

/// One channel of a layer, read in place: large frames are not copied.
struct Plane<'a> {
    layer: &'a Layer,
    /// Index of the value within each pixel.
    index: usize,
    is_half: bool,
    /// Width, pixels.
    width: usize,
}

impl<'s, 'a: 's> WritableSamples<'s> for Plane<'a> {
    type Writer = &'s Self;

    fn sample_type(&self) -> SampleType {
        if self.is_half {
            SampleType::F16
        } else {
            SampleType::F32
        }
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'s self, _header: &Header) -> &'s Self {
        self
    }
}

impl SamplesWriter for &Plane<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let first = line.location.position.y() * self.width + line.location.position.x();
        let value = |i: usize| self.layer.data[(first + i) * self.layer.channels + self.index];
        if self.is_half {
            line.write_samples(|i| to_half(value(i)))
        } else {
            line.write_samples(value)
        }
        .expect("the library hands out a line with room for its samples");
    }
}
