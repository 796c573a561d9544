//! PNG of 16 bits per channel.

use std::io::Cursor;

use ::png::{BitDepth, ColorType, Limits, Transformations};

use super::error::FieldError;
use super::samples::Samples;
use super::{Read, check_claim};

pub(super) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Most bytes of chunks beside the picture.
const OTHER_BYTES: usize = 1 << 20;

pub(super) fn read(bytes: &[u8]) -> Result<Read, FieldError> {
    let failed = |error: ::png::DecodingError| FieldError::unreadable("PNG", error.to_string());
    let limits = Limits {
        bytes: bytes.len() + OTHER_BYTES,
    };
    let mut decoder = ::png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::IDENTITY);
    let header = decoder.read_header_info().map_err(failed)?;
    let size = [header.width, header.height];
    let (color, depth) = (header.color_type, header.bit_depth);
    let names: &[&str] = match color {
        ColorType::Grayscale => &["Y"],
        ColorType::GrayscaleAlpha => &["Y", "A"],
        ColorType::Rgb => &["R", "G", "B"],
        ColorType::Rgba => &["R", "G", "B", "A"],
        ColorType::Indexed => &[],
    };
    if depth != BitDepth::Sixteen || names.is_empty() {
        let found = match color {
            ColorType::Indexed => "a palette".to_owned(),
            _ => format!(
                "{} bits per channel, whose steps would show as caustics",
                depth as u8
            ),
        };
        return Err(FieldError::NumberType {
            format: "PNG",
            found,
            accepted: "16 bits per channel, without a palette; or NPY or EXR",
        });
    }
    check_claim("PNG", size.map(u64::from), names.len() as u64, bytes.len())?;
    let mut reader = decoder.read_info().map_err(failed)?;
    let buffer = reader
        .output_buffer_size()
        .ok_or_else(|| FieldError::unreadable("PNG", "too large for this machine"))?;
    let mut data = vec![0; buffer];
    reader.next_frame(&mut data).map_err(failed)?;
    // The rest is read so that a truncated file is noticed.
    reader.finish().map_err(failed)?;
    let channels = names.iter().enumerate().map(|(channel, name)| {
        let pixels = data.chunks_exact(2 * names.len());
        let values =
            pixels.map(|pixel| u16::from_be_bytes([pixel[2 * channel], pixel[2 * channel + 1]]));
        ((*name).to_owned(), Samples::U16(values.collect()))
    });
    Ok(Read {
        size: size.map(|side| side as usize),
        frames: 1,
        channels: channels.collect(),
    })
}
