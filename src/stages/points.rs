//! Points: the places that pixels see, or where the texels of a map lie. Methods that work per point thus serve pictures and maps alike.
//!
//! `camera_hits` fills them from pixels, `texel_points` from the texels of an irradiance map; both for the rows of a band.

use super::Slot;
use crate::facts::SceneFacts;
use crate::gpu_struct;

/// Largest size of a slot with 16 bytes per pixel for one band of the picture, bytes.
pub const BAND_BYTES: u64 = 32 << 20;

gpu_struct! {
    /// A point of `shaders/shared/points.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Point = "Point" {
        position_m: [f32; 3],
        receiver: f32,
        normal: [f32; 3],
        footprint_m: f32,
    }
}

/// The points of a band.
pub static POINTS: Slot = Slot {
    element: Some(Point::LAYOUT),
    ..Slot::buffer(
        "points",
        "position m, receiver, normal and footprint m per pixel or texel",
        |facts| size_of::<Point>() as u64 * points_of_a_band(facts),
    )
};

/// Light on the points of a band.
pub static POINT_IRRADIANCE: Slot =
    Slot::buffer("point_irradiance", "linear RGB per point, W/m²", |facts| {
        16 * points_of_a_band(facts)
    });

/// Columns and rows of the output: the picture's pixels, or the texels of the requested map (of a receiver, or of the water).
pub fn size(facts: &SceneFacts) -> Option<[u32; 2]> {
    if let Some(camera) = &facts.output.camera {
        return Some([camera.width, camera.height]);
    }
    if let Some(map) = &facts.output.water_map {
        return Some([map.width, map.height]);
    }
    match facts.output.receiver? {
        crate::scene::Receiver::Floor(_) => {
            facts.receivers.floor_map.map(|map| [map.width, map.height])
        }
        crate::scene::Receiver::Object(index) => {
            let object = facts.receivers.objects.get(index as usize)?;
            object.wet.then_some([object.map_texels; 2])
        }
    }
}

/// Points of the largest band.
pub(super) fn points_of_a_band(facts: &SceneFacts) -> u64 {
    size(facts).map_or(0, |[width, height]| {
        u64::from(width) * u64::from(band_rows(width, height))
    })
}

/// Rows of a picture or map that are rendered at once.
pub fn band_rows(width: u32, height: u32) -> u32 {
    let rows = BAND_BYTES / (16 * u64::from(width.max(1)));
    u32::try_from(rows)
        .unwrap_or(u32::MAX)
        .clamp(1, height.max(1))
}
