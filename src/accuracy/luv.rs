//! Mean distance in CIE Luv: the measure of Tipprasert (2006), eq. 2-9.
//!
//! The thesis gives neither its white nor its scaling of Luv (it names 580 as the distance of red and blue). Here: sRGB
//! primaries and D65 white, CIE 1976 L\*u\*v\* with L\* of 0 … 100; red and blue are 250 apart, black and white 100.

use super::metrics::MetricError;

/// XYZ from linear sRGB, white at Y = 1. Source: B. Lindbloom, "RGB/XYZ Matrices", from the primaries and the D65 white of
/// IEC 61966-2-1.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// CIE 1976 L\*u\*v\* of linear sRGB light, 0 … 1 per channel. L\* is 0 … 100; white is (100, 0, 0), black (0, 0, 0).
///
/// Source: CIE 15:2004, 8.2.2, with the exact constants 216/24389 and 24389/27.
pub fn luv_from_linear_srgb(rgb: [f64; 3]) -> [f64; 3] {
    const DARK: f64 = 216.0 / 24389.0;
    const DARK_SLOPE: f64 = 24389.0 / 27.0;

    let xyz = xyz(rgb);
    let Some((u, v)) = chromaticity(xyz) else {
        return [0.0; 3];
    };
    let white = self::xyz([1.0; 3]);
    let (u_white, v_white) = chromaticity(white).expect("white is not black");
    let y = xyz[1] / white[1];
    let lightness = if y > DARK {
        116.0 * y.cbrt() - 16.0
    } else {
        DARK_SLOPE * y
    };
    [
        lightness,
        13.0 * lightness * (u - u_white),
        13.0 * lightness * (v - v_white),
    ]
}

/// Mean Euclidean distance in CIE Luv over the pixels that `compared` marks; 0 for equal pictures.
///
/// `image` and `truth` are linear sRGB light, 0 … 1 per channel ([`super::display::display_linear`]).
///
/// # Errors
///
/// [`MetricError::SizeMismatch`] in pixels, [`MetricError::NotFinite`] with the index of the pixel, and
/// [`MetricError::NothingCompared`].
pub fn luv_distance(
    image: &[[f64; 3]],
    truth: &[[f64; 3]],
    compared: &[bool],
) -> Result<f64, MetricError> {
    for other in [truth.len(), compared.len()] {
        if image.len() != other {
            return Err(MetricError::SizeMismatch {
                image: image.len(),
                truth: other,
            });
        }
    }
    let (mut sum, mut count) = (0.0, 0u64);
    for (index, ((a, b), _)) in image
        .iter()
        .zip(truth)
        .zip(compared)
        .enumerate()
        .filter(|(_, (_, compared))| **compared)
    {
        for (which, pixel) in [("image", a), ("truth", b)] {
            if let Some(value) = pixel.iter().copied().find(|v| !v.is_finite()) {
                return Err(MetricError::NotFinite {
                    which,
                    index,
                    value,
                });
            }
        }
        let (a, b) = (luv_from_linear_srgb(*a), luv_from_linear_srgb(*b));
        let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        sum += square.sqrt();
        count += 1;
    }
    if count == 0 {
        return Err(MetricError::NothingCompared);
    }
    Ok(sum / count as f64)
}

fn xyz(rgb: [f64; 3]) -> [f64; 3] {
    XYZ_FROM_RGB.map(|row| row.iter().zip(rgb).map(|(a, b)| a * b).sum())
}

/// CIE 1976 u′, v′; black has none.
fn chromaticity([x, y, z]: [f64; 3]) -> Option<(f64, f64)> {
    let sum = x + 15.0 * y + 3.0 * z;
    (sum > 0.0).then(|| (4.0 * x / sum, 9.0 * y / sum))
}
