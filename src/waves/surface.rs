//! The water surface at one time, for all kinds of water.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::row::{RowKind, Rows};
use super::sines::Sines;
use crate::physics::refraction;
use crate::scene::Scene;

/// Height and slope of the water at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// y − level, m.
    pub height_m: f64,
    /// (∂h/∂x, ∂h/∂z).
    pub slope: DVec2,
}

/// Second derivatives of the height at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// ∂²h/∂x², 1/m.
    pub xx_per_m: f64,
    /// ∂²h/∂x∂z, 1/m.
    pub xz_per_m: f64,
    /// ∂²h/∂z², 1/m.
    pub zz_per_m: f64,
}

impl Curvature {
    /// Largest magnitude of the second derivative along any horizontal direction, 1/m: the larger eigenvalue of the symmetric
    /// matrix, by magnitude.
    pub fn largest_per_m(&self) -> f64 {
        let Self {
            xx_per_m: xx,
            xz_per_m: xz,
            zz_per_m: zz,
        } = *self;
        (0.5 * (xx + zz)).abs() + (0.5 * (xx - zz)).hypot(xz)
    }
}

/// The water surface at one time. Heights are relative to the water at rest, (x, z) to an origin on it.
///
/// The bounds hold for every height and slope that [`Self::at`] and [`Self::rows`] return, for this surface and for any recentred
/// copy.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    kind: Kind,
}

/// The kind of water.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// A sum of sines; flat water has none.
    Sines(Sines),
}

impl Surface {
    /// The surface of `scene` at `scene.time_s`; the origin is that of the scene.
    pub fn of(scene: &Scene) -> Self {
        Self {
            kind: Kind::Sines(Sines::of(scene)),
        }
    }

    /// The same surface with (x, z) = (0, 0) moved to `origin_m`.
    pub fn recentred(&self, origin_m: DVec2) -> Self {
        let kind = match &self.kind {
            Kind::Sines(sines) => Kind::Sines(sines.recentred(origin_m)),
        };
        Self { kind }
    }

    /// Height and slope at (x, z), m.
    pub fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        match &self.kind {
            Kind::Sines(sines) => sines.at(x_m, z_m),
        }
    }

    /// Height, slope and curvature at (x, z), m. Height and slope equal those of [`Self::at`] except for rounding.
    pub fn curved_at(&self, x_m: f64, z_m: f64) -> (SurfacePoint, Curvature) {
        match &self.kind {
            Kind::Sines(sines) => sines.curved_at(x_m, z_m),
        }
    }

    /// Height and slope along rows of points that are `step_m`, (x, z), apart. Much faster than [`Self::at`] for many points, and
    /// equal except for rounding.
    pub fn rows(&self, step_m: DVec2) -> Rows {
        let kind = match &self.kind {
            Kind::Sines(sines) => RowKind::Sines(sines.rows(step_m)),
        };
        Rows { kind }
    }

    /// Whether the following bounds and the shortest wave depend on time. If not, they are equal to the bit at all times.
    pub fn bounds_change_with_time(&self) -> bool {
        match &self.kind {
            // Only phases change with time, not amplitudes and wavelengths.
            Kind::Sines(_) => false,
        }
    }

    /// Upper bound of |height|, m.
    pub fn max_height_m(&self) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.max_height_m(),
        }
    }

    /// Upper bound of the slope along the horizontal unit vector `u`.
    pub fn max_slope_along(&self, u: DVec2) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.max_slope_along(u),
        }
    }

    /// Upper bound of the slope in any direction; 0 for flat water only.
    pub fn max_slope(&self) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.max_slope(),
        }
    }

    /// Upper bound of the magnitude of the second derivative along any direction, 1/m.
    pub fn max_second_derivative_per_m(&self) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.max_derivative(2),
        }
    }

    /// Upper bound of the magnitude of the third derivative along any direction, 1/m².
    pub fn max_third_derivative_per_m2(&self) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.max_derivative(3),
        }
    }

    /// The extreme slopes: for each of `directions` evenly spaced directions, from x towards z, a slope that no slope of the
    /// surface exceeds along that direction. Empty for flat water.
    pub fn rim_slopes(&self, directions: u32) -> Vec<DVec2> {
        if self.max_slope() == 0.0 {
            return Vec::new();
        }
        (0..directions)
            .map(|i| {
                let u = DVec2::from_angle(TAU * f64::from(i) / f64::from(directions));
                match &self.kind {
                    Kind::Sines(sines) => sines.rim_slope(u),
                }
            })
            .collect()
    }

    /// Length of the shortest wave, m; infinite for flat water.
    pub fn shortest_wave_m(&self) -> f64 {
        match &self.kind {
            Kind::Sines(sines) => sines.shortest_wave_m(),
        }
    }

    /// The kind of water in words, for sentences such as "the sun shines into …".
    pub fn description(&self) -> String {
        if self.max_slope() == 0.0 {
            return "flat water".to_owned();
        }
        match &self.kind {
            Kind::Sines(sines) => sines.description(),
        }
    }

    /// Number of [`Self::gpu_elements`]. The time to evaluate a point on the GPU grows with it.
    pub fn gpu_element_count(&self) -> usize {
        match &self.kind {
            Kind::Sines(sines) => sines.gpu_element_count(),
        }
    }

    /// The data from which the GPU evaluates the surface: elements of 16 bytes, laid out as the shaders' `Wave`.
    pub fn gpu_elements(&self) -> Vec<[f32; 4]> {
        match &self.kind {
            Kind::Sines(sines) => sines.gpu_elements(),
        }
    }
}

/// Unit normal (up) at a surface point.
pub fn normal(point: SurfacePoint) -> DVec3 {
    refraction::normal_from_slope(point.slope.x, point.slope.y)
}
