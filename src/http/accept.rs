//! Content negotiation: the representation that the client prefers (RFC 9110, 12.5.1).

use axum::http::{HeaderMap, header};

use super::error::ApiError;
use crate::scene::ImageFormat;

/// The representation of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Representation {
    /// The image file itself.
    Image,
    /// JSON with the file in base64 and the stats.
    Json,
}

/// Picks the representation that the `Accept` header prefers; the image if both are equal or there is no header.
///
/// # Errors
/// [`ApiError::NotAcceptable`] if both are excluded.
pub fn choose(headers: &HeaderMap, format: ImageFormat) -> Result<Representation, ApiError> {
    let image_type = media_type(format);
    Ok(match best(headers, &[image_type, "application/json"])? {
        "application/json" => Representation::Json,
        _ => Representation::Image,
    })
}

/// Picks the media type that the `Accept` header prefers; the first of several equals, or if there is no header.
///
/// # Errors
/// [`ApiError::NotAcceptable`] if all are excluded.
pub fn best<'a>(headers: &HeaderMap, offered: &[&'a str]) -> Result<&'a str, ApiError> {
    let ranges: Vec<&str> = headers
        .get_all(header::ACCEPT)
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .map(str::trim)
        .filter(|range| !range.is_empty())
        .collect();
    let mut best: Option<(&'a str, f32)> = None;
    for media_type in offered {
        let weight = if ranges.is_empty() {
            1.0
        } else {
            quality(&ranges, media_type)
        };
        if weight > best.map_or(0.0, |(_, weight)| weight) {
            best = Some((media_type, weight));
        }
    }
    best.map(|(media_type, _)| media_type)
        .ok_or_else(|| ApiError::NotAcceptable {
            offered: offered.join(", "),
        })
}

/// Media type of an image file.
pub fn media_type(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "image/png",
        ImageFormat::Exr => "image/x-exr",
    }
}

/// Weight of a media type: that of the most specific range that covers it, 0 if none does.
fn quality(ranges: &[&str], media_type: &str) -> f32 {
    let main_type = media_type.split('/').next().unwrap_or_default();
    ranges
        .iter()
        .filter_map(|range| {
            let mut parts = range.split(';').map(str::trim);
            let pattern = parts.next().unwrap_or_default().to_ascii_lowercase();
            let specificity = match pattern.as_str() {
                "*/*" => 1,
                exact if exact == media_type => 3,
                wild if wild.strip_suffix("/*") == Some(main_type) => 2,
                _ => return None,
            };
            let weight = parts
                .find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")))
                .map_or(1.0, |text| text.trim().parse().unwrap_or(0.0));
            Some((specificity, weight))
        })
        .max_by_key(|(specificity, _)| *specificity)
        .map_or(0.0, |(_, weight)| weight)
}
