//! ꟻLIP: the difference that people see when two pictures alternate on a screen.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "ꟻLIP: A Difference Evaluator for Alternating
//! Images" (2020), computed by its authors' library.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};

use super::display::check_shape;
use super::metrics::{MAX_PIXELS, MetricError};

/// ꟻLIP error of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// Mean of the map, 0 … 1: 0 for equal pictures.
    pub mean: f64,
    /// Error of each pixel, 0 … 1, row by row.
    pub map: Vec<f32>,
}

/// Compares two sRGB pictures of `width` × `height` pixels, seen at 67 pixels per degree (a 0.7 m wide screen of 3840 pixels
/// at 0.7 m).
///
/// # Errors
///
/// [`MetricError::Shape`] and [`MetricError::TooLarge`].
pub fn flip(
    image: &[[u8; 3]],
    truth: &[[u8; 3]],
    width: u32,
    height: u32,
) -> Result<Flip, MetricError> {
    check_shape("image", image.len(), width, height)?;
    check_shape("truth", truth.len(), width, height)?;
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(MetricError::TooLarge { width, height });
    }
    let reference = FlipImageRgb8::with_data(width, height, truth.as_flattened());
    let tested = FlipImageRgb8::with_data(width, height, image.as_flattened());
    let map = nv_flip::flip(reference, tested, DEFAULT_PIXELS_PER_DEGREE).to_vec();
    if let Some(index) = map.iter().position(|v| !v.is_finite()) {
        return Err(MetricError::NotFinite {
            which: "ꟻLIP map",
            index,
            value: f64::from(map[index]),
        });
    }
    let mean = map.iter().map(|v| f64::from(*v)).sum::<f64>() / map.len() as f64;
    Ok(Flip { mean, map })
}
