//! Encodes a frame into the bytes of a file.

use crate::frame::Frame;
use crate::scene::{Encoding, ImageFormat};
use crate::stats::Warning;

use super::metadata::Metadata;
use super::{exr, png};

/// An image file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoded {
    /// The file.
    pub bytes: Vec<u8>,
    /// `image/png` or `image/x-exr`.
    pub media_type: &'static str,
    /// Warnings about lost information (clipped, clamped, left out). The file's metadata has them too.
    pub warnings: Vec<Warning>,
}

/// Why a frame cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// A value is NaN or infinite.
    #[error(
        "layer {layer}, pixel ({x}, {y}), value {channel} of the pixel is {value}; only finite numbers can be written"
    )]
    NonFinite {
        /// The layer, by its name in a scene.
        layer: &'static str,
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
        /// Index within the pixel, from 0.
        channel: usize,
        /// The value.
        value: f32,
    },
    /// A layer has the wrong number of values or channels.
    #[error(
        "layer {layer} holds {values} values in {channels} channels; {width} x {height} pixels of {wanted_channels} channels are needed"
    )]
    Shape {
        /// The layer, by its name in a scene.
        layer: &'static str,
        /// Channels found.
        channels: usize,
        /// Values found.
        values: usize,
        /// Frame width, pixels.
        width: u32,
        /// Frame height, pixels.
        height: u32,
        /// Channels needed.
        wanted_channels: usize,
    },
    /// The frame has no pixels or no layers.
    #[error("the frame is empty: {width} x {height} pixels, {layers} layers")]
    Empty {
        /// Frame width, pixels.
        width: u32,
        /// Frame height, pixels.
        height: u32,
        /// Number of layers.
        layers: usize,
    },
    /// The frame has no layer that PNG can show.
    #[error(
        "PNG shows layer radiance (or irradiance or water of a map), the frame holds {present} only"
    )]
    NothingToShow {
        /// The layers of the frame.
        present: String,
    },
    /// The exposure factor is not usable.
    #[error("exposure factor {scale} cannot be applied; 0 ... 1e200 are accepted")]
    Exposure {
        /// The factor found in the frame's statistics.
        scale: f64,
    },
    /// This bit depth is not supported.
    #[error("PNG with {bits} bits per channel cannot be written; 8 and 16 are accepted")]
    PngBits {
        /// Bits requested.
        bits: u32,
    },
    /// A text cannot be stored in the file.
    #[error("metadata {name} cannot be stored: it has characters outside Latin-1")]
    Text {
        /// Name of the entry.
        name: &'static str,
    },
    /// The encoder library failed.
    #[error("the {format} encoder failed: {reason}")]
    Format {
        /// `PNG` or `EXR`.
        format: &'static str,
        /// Its message.
        reason: String,
    },
}

/// Writes a frame as `encoding` says, with `metadata` inside.
///
/// PNG: layer radiance (or the irradiance of a map), exposed by `frame.stats.exposure.scale`, tone-mapped, sRGB; the
/// exposure in stops is part of that scale and `encoding.exposure_ev` is not applied again; of a map of the water, its normals. EXR: every layer, linear and
/// unexposed. Both contain the scene if the frame does.
///
/// # Errors
/// See [`EncodeError`]; nothing non-finite is ever written.
pub fn encode(
    frame: &Frame,
    encoding: &Encoding,
    metadata: &Metadata,
) -> Result<Encoded, EncodeError> {
    if frame.width == 0 || frame.height == 0 || frame.layers.is_empty() {
        return Err(EncodeError::Empty {
            width: frame.width,
            height: frame.height,
            layers: frame.layers.len(),
        });
    }
    match encoding.format {
        ImageFormat::Png => png::encode(frame, encoding, metadata),
        ImageFormat::Exr => exr::encode(frame, encoding, metadata),
    }
}
