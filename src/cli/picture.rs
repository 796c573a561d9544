//! One frame, from a resolved scene to the bytes of its file.

use std::time::Instant;

use tokio_util::sync::CancellationToken;

use super::error::CliError;
use crate::image::{Metadata, encode};
use crate::render::{Prepared, Renderer};
use crate::stats::Stats;

/// An image file in memory, and its stats.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The bytes of the PNG or EXR file.
    pub bytes: Vec<u8>,
    /// Pixels along x and y.
    pub size: [u32; 2],
    /// Cost, energy, warnings.
    pub stats: Stats,
}

/// Renders and encodes; `start` is when the work for this frame began.
///
/// # Errors
///
/// [`CliError::Render`] and [`CliError::Encode`].
pub fn make(
    renderer: &mut Renderer,
    prepared: &Prepared,
    start: Instant,
) -> Result<Picture, CliError> {
    let mut frame = renderer.render_prepared(prepared, &CancellationToken::new())?;
    let encode_start = Instant::now();
    let encoding = prepared.resolved().scene.output.encoding();
    let encoded = encode(&frame, &encoding, &Metadata::of(&frame.stats))?;
    frame.stats.warnings.extend(encoded.warnings);
    frame.stats.time_ms.encode = milliseconds_since(encode_start);
    frame.stats.time_ms.total = milliseconds_since(start);
    Ok(Picture {
        bytes: encoded.bytes,
        size: [frame.width, frame.height],
        stats: frame.stats,
    })
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}
