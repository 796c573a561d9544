//! All error measures of one image against the truth.

use super::study::ErrorFigures;
use crate::accuracy::LinearImage;
use crate::accuracy::display::{check_shape, display_linear, display_rgb};
use crate::accuracy::flip::flip;
use crate::accuracy::luv::luv_distance;
use crate::accuracy::metrics::{MetricError, percentile_error, relative_l1, rmse, total_flux_bias};

/// Measures `image` against `truth`.
///
/// - `compared`: one per pixel, row by row; only marked pixels are compared. The others are black in both pictures, so that they
///   add no difference to their neighbours, and may hold any value.
/// - `shadow_edge`: one per pixel, the neighbourhood of a mesh's shadow edge; [`ErrorFigures::shadow_edge_share`] is the share
///   of Σ|E − truth| inside, 0 where there is no error at all.
/// - `white_w_m2`: irradiance of a dry horizontal surface, W/m², for the pictures ([`crate::accuracy::display`]).
///
/// [`ErrorFigures::estimated`] is left absent: only the render knows it.
///
/// # Errors
///
/// See [`MetricError`]. A truth without light is [`MetricError::BlackTruth`].
pub fn error_figures(
    image: &LinearImage,
    truth: &LinearImage,
    compared: &[bool],
    shadow_edge: Option<&[bool]>,
    white_w_m2: f64,
) -> Result<ErrorFigures, MetricError> {
    let (width, height) = (truth.width, truth.height);
    check_shape("truth", truth.rgb.len(), width, height)?;
    check_shape("image", image.rgb.len(), width, height)?;
    check_shape("mask of what is compared", compared.len(), width, height)?;
    if let Some(edge) = shadow_edge {
        check_shape("mask of the shadow edge", edge.len(), width, height)?;
    }
    let count = compared.iter().filter(|c| **c).count();
    if count == 0 {
        return Err(MetricError::NothingCompared);
    }

    // 1. Numbers: the compared pixels only.
    let (values, true_values) = (picked(image, compared), picked(truth, compared));
    let mut figures = ErrorFigures {
        relative_l1: relative_l1(&values, &true_values)?,
        rmse_w_m2: rmse(&values, &true_values)?,
        flux_bias: total_flux_bias(&values, &true_values)?,
        p99: percentile_error(&values, &true_values, 99.0)?,
        shadow_edge_share: shadow_edge.map(|edge| edge_share(image, truth, compared, edge)),
        ..ErrorFigures::default()
    };

    // 2. Pictures: the whole frame, black where nothing is compared.
    let (image, truth) = (blanked(image, compared), blanked(truth, compared));
    figures.luv_distance = luv_distance(
        &display_linear(&image, white_w_m2)?,
        &display_linear(&truth, white_w_m2)?,
        compared,
    )?;
    let shown = display_rgb(&image, white_w_m2)?;
    let map = flip(&shown, &display_rgb(&truth, white_w_m2)?, width, height)?.map;
    let inside = map.iter().zip(compared).filter(|(_, c)| **c);
    figures.flip = inside.map(|(error, _)| f64::from(*error)).sum::<f64>() / count as f64;
    Ok(figures)
}

/// The values of the compared pixels, channel by channel.
fn picked(image: &LinearImage, compared: &[bool]) -> Vec<f64> {
    let pixels = image.rgb.iter().zip(compared).filter(|(_, c)| **c);
    pixels.flat_map(|(pixel, _)| *pixel).collect()
}

/// The picture with black where nothing is compared.
fn blanked(image: &LinearImage, compared: &[bool]) -> LinearImage {
    let pixels = image.rgb.iter().zip(compared);
    LinearImage {
        rgb: pixels
            .map(|(pixel, c)| if *c { *pixel } else { [0.0; 3] })
            .collect(),
        ..*image
    }
}

/// Share of Σ|E − truth| inside `edge`; all values that count are finite by now.
fn edge_share(image: &LinearImage, truth: &LinearImage, compared: &[bool], edge: &[bool]) -> f64 {
    let (mut inside, mut all) = (0.0, 0.0);
    for (((a, b), compared), edge) in image.rgb.iter().zip(&truth.rgb).zip(compared).zip(edge) {
        if !compared {
            continue;
        }
        let error: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
        all += error;
        if *edge {
            inside += error;
        }
    }
    if all > 0.0 { inside / all } else { 0.0 }
}
