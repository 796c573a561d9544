//! The tiles of a contact sheet: a render, its signed errors and their visibility.

use super::colour_map::{diverging, magma};
use super::plot::PlotError;
use super::resize::Fit;
use super::sheet::Tile;
use super::study::StudyImages;
use crate::accuracy::LinearImage;
use crate::accuracy::display::{display_linear, display_rgb};
use crate::accuracy::flip::flip;
use crate::accuracy::metrics::MetricError;
use crate::image::tone::{code, srgb_from_linear};

/// Errors of one image, value by value.
pub(super) struct Column<'a> {
    pub(super) image: &'a LinearImage,
    /// Mean of the channels' E − truth, relative to the mean of the truth.
    signed: Vec<[f64; 1]>,
    flip: Vec<[f64; 1]>,
}

impl<'a> Column<'a> {
    pub(super) fn new(
        image: &'a LinearImage,
        images: &StudyImages,
        mean_w_m2: f64,
    ) -> Result<Self, PlotError> {
        let (truth, white) = (&images.truth, images.white_w_m2);
        let shown = (display_rgb(image, white)?, display_rgb(truth, white)?);
        let map = flip(&shown.0, &shown.1, truth.width, truth.height)?.map;
        let pairs = image.rgb.iter().zip(&truth.rgb);
        let signed = pairs.map(|(a, b)| {
            let sum: f64 = a.iter().zip(b).map(|(a, b)| a - b).sum();
            [sum / 3.0 / mean_w_m2]
        });
        Ok(Self {
            image,
            signed: signed.collect(),
            flip: map.iter().map(|v| [f64::from(*v)]).collect(),
        })
    }

    fn size(&self) -> (usize, usize) {
        (self.image.width as usize, self.image.height as usize)
    }

    pub(super) fn signed_tile(&self, fit: Fit, scale: f64) -> Tile {
        tile(&self.signed, self.size(), fit, |[v]| diverging(v / scale))
    }

    pub(super) fn flip_tile(&self, fit: Fit) -> Tile {
        tile(&self.flip, self.size(), fit, |[v]| magma(v))
    }

    /// 99th percentile of the absolute signed error.
    fn extent(&self) -> f64 {
        let mut errors: Vec<f64> = self.signed.iter().map(|[v]| v.abs()).collect();
        let index = (errors.len() * 99 / 100).min(errors.len() - 1);
        *errors.select_nth_unstable_by(index, f64::total_cmp).1
    }
}

/// End of the signed scale, as a share of the truth's mean: the middle one of the settings' 99th percentiles, rounded up to 1,
/// 2 or 5. So coarse settings are clipped and fine ones are still visible.
pub(super) fn scale(columns: &[Column]) -> f64 {
    let mut extents: Vec<f64> = columns.iter().map(Column::extent).collect();
    extents.sort_by(f64::total_cmp);
    let middle = extents[(extents.len() - 1) / 2].max(1e-6);
    let power = 10f64.powi(middle.log10().floor() as i32);
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    let above = steps.into_iter().find(|step| *step >= middle);
    above.unwrap_or(10.0 * power)
}

/// Mean over all values, W/m².
pub(super) fn mean(truth: &LinearImage) -> Result<f64, PlotError> {
    let sum: f64 = truth.rgb.as_flattened().iter().sum();
    if sum > 0.0 && sum.is_finite() {
        Ok(sum / truth.rgb.as_flattened().len() as f64)
    } else if sum.is_finite() {
        Err(MetricError::BlackTruth.into())
    } else {
        // Reports which value is not finite.
        let all = display_linear(truth, 1.0);
        Err(all.err().unwrap_or(MetricError::BlackTruth).into())
    }
}

/// The map as a picture. Light is averaged before the curve, not after.
pub(super) fn picture(image: &LinearImage, white_w_m2: f64, fit: Fit) -> Result<Tile, PlotError> {
    let light = display_linear(image, white_w_m2)?;
    let size = (image.width as usize, image.height as usize);
    Ok(tile(&light, size, fit, |pixel| {
        pixel.map(|v| code(srgb_from_linear(v), 255) as u8)
    }))
}

fn tile<const N: usize>(
    values: &[[f64; N]],
    (width, height): (usize, usize),
    fit: Fit,
    colour: impl Fn([f64; N]) -> [u8; 3],
) -> Tile {
    let fitted = fit.apply(values, width, height);
    Tile {
        width: fit.size(width),
        height: fit.size(height),
        pixels: fitted.into_iter().map(colour).collect(),
    }
}
