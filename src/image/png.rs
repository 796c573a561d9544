//! PNG: one picture for the screen, sRGB, 8 or 16 bits per channel; or the normals of the water.

use std::f64::consts::FRAC_1_PI;

use ::png::{BitDepth, ColorType, Compression, EncodingError, SrgbRenderingIntent};
use rayon::prelude::*;

use crate::frame::{Frame, FrameKind, Layer};
use crate::scene::{Encoding, LayerName, ToneCurve};
use crate::stats::Warning;

use super::encode::{EncodeError, Encoded};
use super::layers::{check, format_of};
use super::metadata::{Metadata, SCENE_HASH_KEY, SCENE_KEY, STATS_KEY};
use super::normal_map;
use super::tone::{code, display, srgb_from_linear};

/// Media type of PNG.
pub const MEDIA_TYPE: &str = "image/png";

/// Largest exposure factor, with which even the largest f32 stays finite in f64.
const MAX_SCALE: f64 = 1e200;

/// Writes the shown layer of `frame`.
///
/// # Errors
/// See [`EncodeError`].
pub fn encode(
    frame: &Frame,
    encoding: &Encoding,
    metadata: &Metadata,
) -> Result<Encoded, EncodeError> {
    let depth = match encoding.png_bits {
        8 => BitDepth::Eight,
        16 => BitDepth::Sixteen,
        bits => return Err(EncodeError::PngBits { bits }),
    };
    let (name, layer) = shown(frame)?;
    check(frame, name, layer)?;
    let (pixels, lost) = if frame.kind == FrameKind::WaterMap {
        let pixels = normal_map::codes(layer, encoding.png_bits);
        (pixels, Lost::default())
    } else {
        let screen = Screen {
            curve: encoding.tone_curve,
            scale: scale(frame)?,
            depth,
        };
        screen.pixels(frame, layer)
    };
    let warnings = warnings(frame, name, lost);
    let bytes = file(frame, depth, &pixels, metadata, &warnings)?;
    Ok(Encoded {
        bytes,
        media_type: MEDIA_TYPE,
        warnings,
    })
}

/// The layer that a PNG shows.
fn shown(frame: &Frame) -> Result<(LayerName, &Layer), EncodeError> {
    let name = match frame.kind {
        FrameKind::IrradianceMap => LayerName::Irradiance,
        FrameKind::View => LayerName::Radiance,
        FrameKind::WaterMap => LayerName::Water,
    };
    match frame.layers.get(&name) {
        Some(layer) => Ok((name, layer)),
        None => Err(EncodeError::NothingToShow {
            present: words(frame.layers.keys()),
        }),
    }
}

/// Factor from the values of the shown layer to display light.
fn scale(frame: &Frame) -> Result<f64, EncodeError> {
    let scale = frame.stats.exposure.scale;
    if !(0.0..=MAX_SCALE).contains(&scale) {
        return Err(EncodeError::Exposure { scale });
    }
    // Irradiance is shown as the radiance of a white, diffuse surface.
    Ok(match frame.kind {
        FrameKind::IrradianceMap => scale * FRAC_1_PI,
        FrameKind::View | FrameKind::WaterMap => scale,
    })
}

/// Numbers of pixels that lost information.
#[derive(Clone, Copy, Debug, Default)]
struct Lost {
    clipped: u64,
    negative: u64,
}

/// The conversion of linear light into codes.
struct Screen {
    curve: ToneCurve,
    scale: f64,
    depth: BitDepth,
}

impl Screen {
    /// RGB codes in PNG's byte order, row by row from the top.
    fn pixels(&self, frame: &Frame, layer: &Layer) -> (Vec<u8>, Lost) {
        let width = frame.width as usize;
        let bytes_per_pixel = match self.depth {
            BitDepth::Sixteen => 6,
            _ => 3,
        };
        let mut out = vec![0; width * frame.height as usize * bytes_per_pixel];
        let lost = out
            .par_chunks_mut(width * bytes_per_pixel)
            .zip(layer.data.par_chunks(width * layer.channels))
            .map(|(codes, values)| self.row(codes, values, layer.channels))
            .reduce(Lost::default, |a, b| Lost {
                clipped: a.clipped + b.clipped,
                negative: a.negative + b.negative,
            });
        (out, lost)
    }

    fn row(&self, codes: &mut [u8], values: &[f32], channels: usize) -> Lost {
        let mut lost = Lost::default();
        let bytes_per_pixel = codes.len() / (values.len() / channels);
        for (out, value) in codes
            .chunks_exact_mut(bytes_per_pixel)
            .zip(values.chunks_exact(channels))
        {
            let exposed = [value[0], value[1], value[2]].map(|v| f64::from(v) * self.scale);
            let shown = display(self.curve, exposed);
            lost.clipped += u64::from(shown.clipped);
            lost.negative += u64::from(shown.negative);
            let signal = shown.rgb.map(srgb_from_linear);
            if self.depth == BitDepth::Sixteen {
                for (pair, s) in out.chunks_exact_mut(2).zip(signal) {
                    pair.copy_from_slice(&code(s, u16::MAX).to_be_bytes());
                }
            } else {
                for (byte, s) in out.iter_mut().zip(signal) {
                    *byte = code(s, 255) as u8;
                }
            }
        }
        lost
    }
}

fn warnings(frame: &Frame, name: LayerName, lost: Lost) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let pixels = u64::from(frame.width) * u64::from(frame.height);
    if lost.clipped > 0 {
        warnings.push(Warning::new(
            "png_clipped",
            format!(
                "{} of {pixels} pixels are brighter than white and were clipped; tone curve pbr_neutral or a lower exposure keeps them",
                lost.clipped
            ),
        ));
    }
    if lost.negative > 0 {
        warnings.push(Warning::new(
            "png_negative",
            format!(
                "{} of {pixels} pixels have a negative value, shown as 0",
                lost.negative
            ),
        ));
    }
    if frame.layers.len() > 1 {
        let left_out = frame.layers.keys().filter(|other| **other != name);
        warnings.push(Warning::new(
            "png_layers_left_out",
            format!(
                "PNG holds {} only, left out: {}; format exr holds all layers",
                format_of(name).word,
                words(left_out)
            ),
        ));
    }
    warnings
}

fn words<'a>(names: impl Iterator<Item = &'a LayerName>) -> String {
    let words: Vec<&str> = names.map(|name| format_of(*name).word).collect();
    words.join(", ")
}

fn file(
    frame: &Frame,
    depth: BitDepth,
    pixels: &[u8],
    metadata: &Metadata,
    warnings: &[Warning],
) -> Result<Vec<u8>, EncodeError> {
    let failed = |error: EncodingError| EncodeError::Format {
        format: "PNG",
        reason: error.to_string(),
    };
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, frame.width, frame.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(depth);
    if frame.kind != FrameKind::WaterMap {
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    }
    // `Fast` because a client waits for the answer: a noisy 960 x 540 picture takes 6 ms and 1.2 MB, with `Balanced` 126 ms and
    // 0.6 MB.
    encoder.set_compression(Compression::Fast);
    let mut texts = vec![
        (SCENE_HASH_KEY, metadata.scene_hash.clone()),
        (STATS_KEY, metadata.stats_json(warnings)),
    ];
    texts.extend(frame.scene.clone().map(|scene| (SCENE_KEY, scene)));
    encoder
        .add_text_chunk("Software".to_owned(), metadata.software())
        .map_err(failed)?;
    for (key, text) in texts {
        encoder
            .add_itxt_chunk(key.to_owned(), text)
            .map_err(failed)?;
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}
