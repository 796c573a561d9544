//! Irradiance shown as a picture, by one fixed rule, so that the perceptual metrics of different settings compare.
//!
//! v = clamp(E / (white · [`SHOWN_WHITE`]), 0, 1) for each channel, then the sRGB curve. No exposure that depends on the image:
//! the same irradiance always has the same colour. Values above are clipped, so an error inside a highlight that is white in
//! both pictures is invisible here; the linear metrics include it.

use super::metrics::MetricError;
use crate::image::tone::{code, srgb_from_linear};

/// Irradiance shown as white, as a multiple of that of a dry horizontal surface. Two: open water then lies at middle
/// brightness, and a caustic may be twice as bright as dry land before it is cut.
pub const SHOWN_WHITE: f64 = 2.0;

/// Linear irradiance by texel or pixel, row 0 at min z (maps) or at the top (views).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearImage {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB, W/m²; 0 where nothing is compared.
    pub rgb: Vec<[f64; 3]>,
}

/// Linear display light, 0 … 1 per channel, pixel by pixel.
///
/// `white_w_m2`: irradiance of a dry horizontal surface in the open, W/m², finite and above 0.
///
/// # Errors
///
/// [`MetricError::Shape`], [`MetricError::White`], and [`MetricError::NotFinite`] with the index of the value.
pub fn display_linear(image: &LinearImage, white_w_m2: f64) -> Result<Vec<[f64; 3]>, MetricError> {
    check_shape("image", image.rgb.len(), image.width, image.height)?;
    if !(white_w_m2.is_finite() && white_w_m2 > 0.0) {
        return Err(MetricError::White(white_w_m2));
    }
    let shown_white_w_m2 = white_w_m2 * SHOWN_WHITE;
    if let Some(index) = image.rgb.as_flattened().iter().position(|v| !v.is_finite()) {
        return Err(MetricError::NotFinite {
            which: "image",
            index,
            value: image.rgb.as_flattened()[index],
        });
    }
    let shown = |pixel: &[f64; 3]| pixel.map(|e| (e / shown_white_w_m2).clamp(0.0, 1.0));
    Ok(image.rgb.iter().map(shown).collect())
}

/// sRGB codes 0 … 255, pixel by pixel.
///
/// # Errors
///
/// Those of [`display_linear`].
pub fn display_rgb(image: &LinearImage, white_w_m2: f64) -> Result<Vec<[u8; 3]>, MetricError> {
    let linear = display_linear(image, white_w_m2)?;
    let codes = |pixel: &[f64; 3]| pixel.map(|v| code(srgb_from_linear(v), 255) as u8);
    Ok(linear.iter().map(codes).collect())
}

/// Refuses a picture whose pixels do not fill its frame.
pub(crate) fn check_shape(
    which: &'static str,
    pixels: usize,
    width: u32,
    height: u32,
) -> Result<(), MetricError> {
    if pixels == 0 || pixels as u64 != u64::from(width) * u64::from(height) {
        return Err(MetricError::Shape {
            which,
            width,
            height,
            pixels,
        });
    }
    Ok(())
}
