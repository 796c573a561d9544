//! The texels rays are counted in.

use glam::DVec2;

use super::ReferenceError;
use crate::scene::{Output, Receiver, Scene};

/// The map on the floor. Coordinates here and in all of the reference are local: (0, 0) is the map's lower corner and y = 0
/// the water at rest, so that a map far from the world's origin is as exact as one near it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FloorMap {
    /// World (x, z) of the lower corner, m.
    pub(super) origin_m: DVec2,
    /// Texels along x.
    pub(super) width: usize,
    /// Texels along z.
    pub(super) height: usize,
    /// Size of a texel, m.
    pub(super) texel_m: DVec2,
    /// Floor below the water at rest, m.
    pub(super) depth_m: f64,
    /// What of the map is floor, local, m: light beyond does not count.
    lit_min_m: DVec2,
    lit_max_m: DVec2,
    texels_per_m: DVec2,
}

impl FloorMap {
    /// The map that `scene` asks for.
    pub(super) fn of(scene: &Scene) -> Result<Self, ReferenceError> {
        let Output::IrradianceMap(output) = &scene.output else {
            return Err(ReferenceError::NotAFloorMap);
        };
        if !matches!(output.receiver, Receiver::Floor(_)) {
            return Err(ReferenceError::NotAFloorMap);
        }
        if output.include_sky {
            return Err(ReferenceError::IncludesSky);
        }
        let floor = scene.floor.as_ref().ok_or(ReferenceError::NoFloor)?;
        let center_m = DVec2::from(floor.center_m);
        let half_m = DVec2::from(floor.size_m) * 0.5;
        let (floor_min_m, floor_max_m) = (center_m - half_m, center_m + half_m);
        let min_m = output.min_m.map_or(floor_min_m, DVec2::from);
        let max_m = output.max_m.map_or(floor_max_m, DVec2::from);
        let (width, height) = (output.width.unwrap_or(512), output.height.unwrap_or(512));
        let size_m = max_m - min_m;
        if !size_m.is_finite() || size_m.min_element() <= 0.0 || width == 0 || height == 0 {
            return Err(ReferenceError::EmptyMap {
                min_m: min_m.into(),
                max_m: max_m.into(),
                width,
                height,
            });
        }
        if !floor.depth_m.is_finite() || floor.depth_m < 0.0 {
            return Err(ReferenceError::Figure {
                what: "floor.depth_m",
                value: floor.depth_m,
                accepted: "0 or more would be accepted",
            });
        }
        let texels = DVec2::new(f64::from(width), f64::from(height));
        Ok(Self {
            origin_m: min_m,
            width: width as usize,
            height: height as usize,
            texel_m: size_m / texels,
            depth_m: floor.depth_m,
            lit_min_m: (floor_min_m - min_m).max(DVec2::ZERO),
            lit_max_m: (floor_max_m - min_m).min(size_m),
            texels_per_m: texels / size_m,
        })
    }

    /// Upper corner of the map, local, m.
    pub(super) fn size_m(&self) -> DVec2 {
        self.texel_m * DVec2::new(self.width as f64, self.height as f64)
    }

    /// Texels of the map.
    pub(super) fn len(&self) -> usize {
        self.width * self.height
    }

    /// The texel a local point on the floor lies in.
    #[inline]
    pub(super) fn texel_at(&self, x_m: f64, z_m: f64) -> Option<usize> {
        let lit = x_m >= self.lit_min_m.x
            && x_m < self.lit_max_m.x
            && z_m >= self.lit_min_m.y
            && z_m < self.lit_max_m.y;
        if !lit {
            return None;
        }
        // Rounding may lift a point just below the upper edge onto it.
        let column = ((x_m * self.texels_per_m.x) as usize).min(self.width - 1);
        let row = ((z_m * self.texels_per_m.y) as usize).min(self.height - 1);
        Some(row * self.width + column)
    }
}
