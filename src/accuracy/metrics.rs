//! Error of an image against a truth, over all channels of all texels.
//!
//! Images are flat slices of the same length, f32 or f64 (`as_flattened()` of RGB triples). A value that is not finite is an
//! error, never a figure: a NaN must not look like a good image.

/// Why there is no figure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// The images do not have the same size.
    #[error("the image has {image} values, the truth {truth}; they must have the same size")]
    SizeMismatch {
        /// Values of the image.
        image: usize,
        /// Values of the truth.
        truth: usize,
    },
    /// Nothing to compare.
    #[error("the images are empty")]
    Empty,
    /// A value is NaN or infinite.
    #[error("value {index} of the {which} is {value}; all values must be finite")]
    NotFinite {
        /// `image` or `truth`.
        which: &'static str,
        /// Where.
        index: usize,
        /// What.
        value: f64,
    },
    /// The truth is 0 everywhere.
    #[error(
        "the truth is zero everywhere, so a relative error has no meaning; some light must reach what is compared"
    )]
    BlackTruth,
    /// An invalid percentile.
    #[error("the percentile is {0}; it must be in 0 … 100")]
    Percentile(f64),
    /// The pixels do not fill the picture.
    #[error("the {which} holds {pixels} pixels; {width} × {height} are needed, at least one")]
    Shape {
        /// `image`, `truth` or a mask.
        which: &'static str,
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// What it holds.
        pixels: usize,
    },
    /// More than the ꟻLIP library can address.
    #[error(
        "{width} × {height} pixels are too many for the ꟻLIP metric; it takes {MAX_PIXELS} at most"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The mask marks no pixel.
    #[error("no pixel is compared; the mask must hold at least one")]
    NothingCompared,
    /// The irradiance of white is invalid.
    #[error("the irradiance of white is {0} W/m²; it must be finite and above 0")]
    White(f64),
}

/// Pixels that a picture for ꟻLIP may have: a square of 8192.
pub const MAX_PIXELS: u64 = 8192 * 8192;

/// Σ|image − truth| / Σ|truth|.
pub fn relative_l1<A, B>(image: &[A], truth: &[B]) -> Result<f64, MetricError>
where
    A: Copy + Into<f64>,
    B: Copy + Into<f64>,
{
    let pairs = pairs(image, truth)?;
    let difference: f64 = pairs.iter().map(|(a, b)| (a - b).abs()).sum();
    Ok(difference / total(&pairs)?)
}

/// Root of the mean square of image − truth, in the images' unit.
pub fn rmse<A, B>(image: &[A], truth: &[B]) -> Result<f64, MetricError>
where
    A: Copy + Into<f64>,
    B: Copy + Into<f64>,
{
    let pairs = pairs(image, truth)?;
    let squares: f64 = pairs.iter().map(|(a, b)| (a - b) * (a - b)).sum();
    Ok((squares / pairs.len() as f64).sqrt())
}

/// (Σ image − Σ truth) / Σ|truth|: above 0 when the image holds more light than the truth.
pub fn total_flux_bias<A, B>(image: &[A], truth: &[B]) -> Result<f64, MetricError>
where
    A: Copy + Into<f64>,
    B: Copy + Into<f64>,
{
    let pairs = pairs(image, truth)?;
    let surplus: f64 = pairs.iter().map(|(a, b)| a - b).sum();
    Ok(surplus / total(&pairs)?)
}

/// The `percentile`-th percentile (0 … 100, nearest rank) of |image − truth|, relative to the mean of |truth|; 100 is the
/// largest error.
pub fn percentile_error<A, B>(image: &[A], truth: &[B], percentile: f64) -> Result<f64, MetricError>
where
    A: Copy + Into<f64>,
    B: Copy + Into<f64>,
{
    if !(0.0..=100.0).contains(&percentile) {
        return Err(MetricError::Percentile(percentile));
    }
    let pairs = pairs(image, truth)?;
    let mean = total(&pairs)? / pairs.len() as f64;
    let mut errors: Vec<f64> = pairs.iter().map(|(a, b)| (a - b).abs()).collect();
    let rank = (percentile / 100.0 * errors.len() as f64).ceil() as usize;
    let index = rank.clamp(1, errors.len()) - 1;
    let (_, error, _) = errors.select_nth_unstable_by(index, f64::total_cmp);
    Ok(*error / mean)
}

/// Order of convergence: minus the least-squares slope of log error over log n, so 2 when the error falls with n⁻².
///
/// Takes (n, error) with both above 0; other points are left out. NaN when fewer than two different n remain.
pub fn convergence_order(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(n, error)| *n > 0.0 && *error > 0.0 && n.is_finite() && error.is_finite())
        .map(|(n, error)| (n.ln(), error.ln()))
        .collect();
    let count = logs.len() as f64;
    let mean_n = logs.iter().map(|(n, _)| n).sum::<f64>() / count;
    let mean_error = logs.iter().map(|(_, error)| error).sum::<f64>() / count;
    let (mut both, mut square) = (0.0, 0.0);
    for (n, error) in &logs {
        both += (n - mean_n) * (error - mean_error);
        square += (n - mean_n) * (n - mean_n);
    }
    if square > 0.0 {
        -both / square
    } else {
        f64::NAN
    }
}

/// Both images value by value, all finite.
fn pairs<A, B>(image: &[A], truth: &[B]) -> Result<Vec<(f64, f64)>, MetricError>
where
    A: Copy + Into<f64>,
    B: Copy + Into<f64>,
{
    if image.len() != truth.len() {
        return Err(MetricError::SizeMismatch {
            image: image.len(),
            truth: truth.len(),
        });
    }
    if image.is_empty() {
        return Err(MetricError::Empty);
    }
    image
        .iter()
        .zip(truth)
        .enumerate()
        .map(|(index, (a, b))| {
            let (a, b) = ((*a).into(), (*b).into());
            for (which, value) in [("image", a), ("truth", b)] {
                if !value.is_finite() {
                    return Err(MetricError::NotFinite {
                        which,
                        index,
                        value,
                    });
                }
            }
            Ok((a, b))
        })
        .collect()
}

fn total(pairs: &[(f64, f64)]) -> Result<f64, MetricError> {
    let total: f64 = pairs.iter().map(|(_, b)| b.abs()).sum();
    if total > 0.0 {
        Ok(total)
    } else {
        Err(MetricError::BlackTruth)
    }
}
