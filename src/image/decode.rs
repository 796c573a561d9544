//! Reads image files for comparisons: exact numbers, no colour management.

use std::collections::BTreeMap;
use std::io::Cursor;

use ::exr::prelude::{AttributeValue, ReadChannels, ReadLayers};
use ::png::{BitDepth, ColorType, Transformations};

/// Why bytes are not an image that can be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Not a file of this format, or damaged.
    #[error("not a readable {format} file: {reason}")]
    Unreadable {
        /// `PNG` or `EXR`.
        format: &'static str,
        /// The library's message.
        reason: String,
    },
    /// A PNG with another colour type or bit depth.
    #[error("PNG with {found} cannot be compared; RGB with 8 or 16 bits per channel is accepted")]
    PngKind {
        /// Colour type and bits found.
        found: String,
    },
}

/// An EXR file as numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct DecodedExr {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Samples by full channel name, row by row from the top; half and integer samples become f32.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Whether a channel is stored as half, by full channel name.
    pub is_half: BTreeMap<String, bool>,
    /// Custom attributes with text values.
    pub texts: BTreeMap<String, String>,
}

/// A PNG file as numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedPng {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Bits per channel, 8 or 16.
    pub bits: u32,
    /// R, G, B codes, row by row from the top: 0 … 255 or 0 … 65535.
    pub rgb: Vec<u16>,
    /// tEXt and iTXt entries by keyword.
    pub texts: BTreeMap<String, String>,
}

/// Reads the first part of an EXR file at full resolution.
///
/// # Errors
/// [`DecodeError::Unreadable`].
pub fn decode_exr(bytes: &[u8]) -> Result<DecodedExr, DecodeError> {
    let image = ::exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| unreadable("EXR", error.to_string()))?;
    let part = &image.layer_data;
    let mut channels = BTreeMap::new();
    let mut is_half = BTreeMap::new();
    for channel in &part.channel_data.list {
        let name = channel.name.to_string();
        let half = matches!(channel.sample_data, ::exr::image::FlatSamples::F16(_));
        is_half.insert(name.clone(), half);
        channels.insert(name, channel.sample_data.values_as_f32().collect());
    }
    let mut texts = BTreeMap::new();
    for others in [&image.attributes.other, &part.attributes.other] {
        texts.extend(others.iter().filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        }));
    }
    Ok(DecodedExr {
        width: side("EXR", part.size.0)?,
        height: side("EXR", part.size.1)?,
        channels,
        is_half,
        texts,
    })
}

/// Reads an RGB PNG file without changing its codes.
///
/// # Errors
/// [`DecodeError::Unreadable`], or [`DecodeError::PngKind`] for palettes, grey, alpha and other bit depths.
pub fn decode_png(bytes: &[u8]) -> Result<DecodedPng, DecodeError> {
    let failed = |error: ::png::DecodingError| unreadable("PNG", error.to_string());
    let mut decoder = ::png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(failed)?;
    let size = reader
        .output_buffer_size()
        .ok_or_else(|| unreadable("PNG", "too large for this machine".to_owned()))?;
    let mut data = vec![0; size];
    let frame = reader.next_frame(&mut data).map_err(failed)?;
    // Text chunks may also follow the picture.
    reader.finish().map_err(failed)?;

    let (bits, rgb) = match (frame.color_type, frame.bit_depth) {
        (ColorType::Rgb, BitDepth::Eight) => (8, data.iter().map(|b| u16::from(*b)).collect()),
        (ColorType::Rgb, BitDepth::Sixteen) => {
            let pairs = data.chunks_exact(2);
            (
                16,
                pairs.map(|b| u16::from_be_bytes([b[0], b[1]])).collect(),
            )
        }
        (color, depth) => {
            let found = format!("{color:?} of {} bits", depth as u8);
            return Err(DecodeError::PngKind { found });
        }
    };
    let info = reader.info();
    let mut texts = BTreeMap::new();
    for chunk in &info.uncompressed_latin1_text {
        texts.insert(chunk.keyword.clone(), chunk.text.clone());
    }
    for chunk in &info.utf8_text {
        let text = chunk.get_text().map_err(failed)?;
        texts.insert(chunk.keyword.clone(), text);
    }
    Ok(DecodedPng {
        width: frame.width,
        height: frame.height,
        bits,
        rgb,
        texts,
    })
}

fn side(format: &'static str, pixels: usize) -> Result<u32, DecodeError> {
    u32::try_from(pixels).map_err(|_| unreadable(format, format!("{pixels} pixels along a side")))
}

fn unreadable(format: &'static str, reason: String) -> DecodeError {
    DecodeError::Unreadable { format, reason }
}
