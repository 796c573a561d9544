//! The cost of files: the same frame in every format.

use caustica::frame::Frame;
use caustica::image::{EncodeError, Metadata, encode};
use caustica::scene::{Encoding, ExrPixel, ImageFormat, ToneCurve};

use crate::Effort;
use crate::report::{Cell, Table};
use crate::spread::repeat;

/// Encodes a frame in each format.
///
/// # Errors
/// When the frame cannot be written.
pub(crate) fn encoding(frame: &Frame, effort: Effort) -> Result<Table, EncodeError> {
    eprintln!("encoding …");
    let mut table = Table::new(
        "Files",
        &format!(
            "Teapot pool, {} × {}; ms, median (smallest..largest).",
            frame.width, frame.height
        ),
        &["format", "encode", "MB"],
    );
    let metadata = Metadata::of(&frame.stats);
    let formats = [
        ("PNG, 8 bit", ImageFormat::Png, 8),
        ("PNG, 16 bit", ImageFormat::Png, 16),
        ("EXR, half, ZIP", ImageFormat::Exr, 8),
    ];
    for (name, format, png_bits) in formats {
        let encoding = Encoding {
            embed_scene: true,
            format,
            png_bits,
            exposure_ev: 0.0,
            tone_curve: ToneCurve::default(),
            exr_pixel: ExrPixel::Half,
        };
        let (sizes, times) = repeat(effort, || {
            encode(frame, &encoding, &metadata).map(|file| file.bytes.len())
        })?;
        let size = sizes.last().copied().unwrap_or_default();
        table.rows.push(vec![
            Cell::text(name),
            Cell::Runs(times),
            Cell::figure(size as f64 / 1e6),
        ]);
    }
    Ok(table)
}
