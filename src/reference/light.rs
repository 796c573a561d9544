//! A sun or point light in local coordinates, and its ray through a place on the water.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::place::Place;
use super::rings::Rings;
use super::window::{LampDrift, LightWindow, Target, window_of};
use crate::physics::refraction::{
    direction_to_light, entry_distance, normal_from_slope, refract_direction,
};
use crate::scene::{PointLight, Sun};
use crate::waves::{Surface, SurfacePoint};

/// Least projected area of a square towards the light as a share of its area, for the number of rays: light that only grazes it under
/// flat water may still hit it under waves.
const LEAST_AREA: f64 = 0.25;

/// Least height and depth for which a point light's path through flat water is computed, m.
const TINY_M: f64 = 1e-6;

/// Where light comes from, local coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// A sun.
    Sun {
        /// Unit direction to it.
        to_light: DVec3,
    },
    /// A point light.
    Lamp {
        /// Where it is, m.
        position_m: DVec3,
        /// Whether it is under the water at its place, or on it.
        submerged: bool,
    },
}

impl Source {
    /// A sun.
    pub(super) fn of_sun(sun: &Sun) -> Self {
        Self::Sun {
            to_light: direction_to_light(
                sun.elevation_deg.to_radians(),
                sun.azimuth_deg.to_radians(),
            ),
        }
    }

    /// A point light under or over `surface`, around the local origin `origin_m`.
    pub(super) fn of_lamp(lamp: &PointLight, origin_m: DVec3, surface: &Surface) -> Self {
        let position_m = DVec3::from(lamp.position_m) - origin_m;
        let water_m = surface.at(position_m.x, position_m.z).height_m;
        Self::Lamp {
            position_m,
            submerged: position_m.y <= water_m,
        }
    }

    /// Whether it is a point light above the water.
    pub(super) fn is_lamp_in_air(&self) -> bool {
        matches!(
            self,
            Self::Lamp {
                submerged: false,
                ..
            }
        )
    }

    /// Unit direction under flat water of the ray that reaches `target_m`; `None` where no ray enters the water.
    pub(super) fn flat_direction(&self, target_m: DVec3, ior: f64) -> Option<DVec3> {
        match *self {
            Self::Sun { to_light } => refract_direction(-to_light, DVec3::Y, ior),
            Self::Lamp {
                position_m,
                submerged: true,
            } => Some((target_m - position_m).normalize_or(-DVec3::Y)),
            Self::Lamp {
                position_m,
                submerged: false,
            } => {
                let aside_m = DVec2::new(target_m.x - position_m.x, target_m.z - position_m.z);
                let distance_m = aside_m.length();
                let depth_m = (-target_m.y).max(TINY_M);
                let height_m = position_m.y.max(TINY_M);
                let under_m = distance_m - entry_distance(height_m, depth_m, distance_m, ior);
                let sideways_m = aside_m.normalize_or_zero() * under_m;
                DVec3::new(sideways_m.x, -depth_m, sideways_m.y).try_normalize()
            }
        }
    }
}

/// A light that contributes to the output.
pub(super) struct PlacedLight {
    /// Where its light comes from.
    pub(super) source: Source,
    /// W/m² on a plane facing the sun, or W/sr of the point light.
    pub(super) power: [f64; 3],
    /// How far waves deflect the rays of a point light above the water.
    pub(super) drift: Option<LampDrift>,
}

/// A ray just under the water.
pub(super) struct Bent {
    pub(super) from_m: DVec3,
    /// Unit direction.
    pub(super) direction: DVec3,
    /// Flux per horizontal area of water and per power of the light: (n·l)/n_y, of a point light also 1/r² .
    pub(super) facing: f64,
    /// Cosine of the incidence.
    pub(super) cos_i: f64,
}

impl PlacedLight {
    /// Unit direction to the light from `p_m`, and the distance, m; infinite to a sun.
    pub(super) fn toward(&self, p_m: DVec3) -> (DVec3, f64) {
        match self.source {
            Source::Sun { to_light } => (to_light, f64::INFINITY),
            Source::Lamp { position_m, .. } => {
                let way_m = position_m - p_m;
                let distance_m = way_m.length();
                (way_m / distance_m, distance_m)
            }
        }
    }

    /// Irradiance per power of a plane that faces the light, `distance_m` away, W/m².
    pub(super) fn facing_w_m2(&self, distance_m: f64) -> f64 {
        match self.source {
            Source::Sun { .. } => 1.0,
            Source::Lamp { .. } => 1.0 / (distance_m * distance_m),
        }
    }

    /// The ray that enters at `water_m`; `None` where the water faces away from the light.
    pub(super) fn bend(&self, place: &Place, water_m: DVec2) -> Option<Bent> {
        let SurfacePoint { height_m, slope } = place.surface.at(water_m.x, water_m.y);
        let from_m = DVec3::new(water_m.x, height_m, water_m.y);
        let (l, distance_m) = self.toward(from_m);
        let facing = l.y - slope.x * l.x - slope.y * l.z;
        // Not above 0 either where the light is on the water itself.
        if facing.is_nan() || facing <= 0.0 {
            return None;
        }
        let normal = normal_from_slope(slope.x, slope.y);
        let cos_i = normal.dot(l).clamp(0.0, 1.0);
        Some(Bent {
            from_m,
            direction: -l / place.ior + normal * turn(cos_i, place.ior),
            facing: facing * self.facing_w_m2(distance_m),
            cos_i,
        })
    }

    /// The water whose light can reach `target`.
    pub(super) fn window(&self, place: &Place, target: Target) -> LightWindow {
        match (self.source, &self.drift) {
            (Source::Sun { to_light }, _) => {
                window_of(&place.surface, to_light, place.ior, &[target])
            }
            (Source::Lamp { position_m, .. }, Some(drift)) => {
                drift.window(place.surface.max_height_m(), position_m, &[target])
            }
            _ => LightWindow::empty(),
        }
    }

    /// Rings on the water around the foot of a point light above it, in units of what lights a square of `square_m2` around `p_m`
    /// with unit `normal` under flat water: the square then gets the rays of every unit.
    ///
    /// A ray that enters at ρ lands at r(ρ) = ρ + D ρ/g, g² = (n² − 1)ρ² + n²h², so that water of (ρ/r)(dρ/dr) lights a level
    /// unit of area.
    pub(super) fn rings(
        &self,
        place: &Place,
        position_m: DVec3,
        (p_m, normal, square_m2): (DVec3, DVec3, f64),
    ) -> Rings {
        let (surface, n) = (&place.surface, place.ior);
        let foot_m = DVec2::new(position_m.x, position_m.z);
        let water_m = surface.at(foot_m.x, foot_m.y).height_m;
        let h = (position_m.y - water_m).max(f64::MIN_POSITIVE.sqrt());
        let depth_m = (water_m - p_m.y).max(0.0);
        let aside_m = DVec2::new(p_m.x, p_m.z) - foot_m;
        let distance_m = aside_m.length();
        let rho_m = entry_distance(h, depth_m, distance_m, n);
        let g = ((n * n - 1.0) * rho_m * rho_m + n * n * h * h).sqrt();
        let per_level = 1.0 / ((1.0 + depth_m / g) * (1.0 + depth_m * n * n * h * h / (g * g * g)));
        let under_m = aside_m.normalize_or_zero() * (distance_m - rho_m);
        let flat = DVec3::new(under_m.x, -depth_m, under_m.y).normalize_or(-DVec3::Y);
        let shown = (flat.dot(normal) / flat.y).abs().max(LEAST_AREA);
        let rings = Rings::around(foot_m, h);
        let share = square_m2 * shown * per_level / rings.area_m2(rho_m);
        rings.in_units_of(DVec2::splat(share.sqrt().min(FRAC_PI_2)))
    }
}

/// g(c) = c/η − cos θ_t, the factor of the normal in the refracted direction −l/η + g n, for c = cos θ_i.
pub(super) fn turn(cos_i: f64, ior: f64) -> f64 {
    cos_i / ior - (1.0 - (1.0 - cos_i * cos_i) / (ior * ior)).max(0.0).sqrt()
}
