//! The water of a scene.

use glam::{DVec2, DVec3};

use crate::scene::{ResolvedScene, SceneError, Water};
use crate::waves::Surface;

/// The water: its surface at the moment of the frame, and its optics.
#[derive(Clone, Debug)]
pub struct WaterFacts {
    /// The waves around the local origin.
    pub surface: Surface,
    /// Index of refraction.
    pub ior: f64,
    /// Absorption a, 1/m.
    pub absorption_per_m: [f64; 3],
    /// Extinction c = a + b, 1/m.
    pub extinction_per_m: [f64; 3],
}

impl WaterFacts {
    pub(super) fn of(water: &Water, surface: Surface) -> Self {
        Self {
            surface,
            ior: water.ior,
            absorption_per_m: water.absorption_per_m,
            extinction_per_m: std::array::from_fn(|c| {
                water.absorption_per_m[c] + water.scattering_per_m[c]
            }),
        }
    }

    /// Whether the water absorbs or scatters any light.
    pub fn attenuates(&self) -> bool {
        self.extinction_per_m.iter().any(|&c| c > 0.0)
    }

    /// A single band for all colours, for lights without dispersion.
    pub(super) fn band(&self) -> Band {
        Band {
            ior: self.ior,
            absorption_per_m: self.absorption_per_m,
            extinction_per_m: self.extinction_per_m,
            rgb_weight: [1.0; 3],
        }
    }
}

/// The surface of a scene at its moment, around the local origin `origin_m`.
///
/// # Errors
/// As [`Surface::of`].
pub(super) fn surface_around(
    resolved: &ResolvedScene,
    origin_m: DVec3,
) -> Result<Surface, SceneError> {
    Ok(Surface::of(resolved)?.recentred(DVec2::new(origin_m.x, origin_m.z)))
}

/// A band of wavelengths: optics of the water for it, and its weight in each colour channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Index of refraction.
    pub ior: f64,
    /// Absorption a per channel, 1/m.
    pub absorption_per_m: [f64; 3],
    /// Extinction c = a + b per channel, 1/m.
    pub extinction_per_m: [f64; 3],
    /// Share of the light's power in each colour channel that lies in this band, 0 … 1.
    pub rgb_weight: [f64; 3],
}

impl Band {
    /// Number of colour channels to trace: 1 if all have the same extinction, else 3.
    pub fn channels(&self) -> u32 {
        let c = self.extinction_per_m;
        if c[0] == c[1] && c[1] == c[2] { 1 } else { 3 }
    }
}
