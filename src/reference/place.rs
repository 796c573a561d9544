//! A scene in local coordinates, for the truths of views and objects.

use std::cell::LazyCell;

use glam::{DVec2, DVec3};

use super::checks::{check_surface, check_water, point_lights, suns};
use super::light::{PlacedLight, Source};
use super::occluders::Occluders;
use super::sky::Sky;
use super::window::LampDrift;
use super::{REFINEMENT, ReferenceError};
use crate::scene::ResolvedScene;
use crate::waves::{Surface, SurfacePoint};

/// The floor, local coordinates, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Floor {
    /// Height (negative).
    pub(super) y_m: f64,
    /// Lower corner (x, z).
    min_m: DVec2,
    /// Upper corner (x, z).
    max_m: DVec2,
    /// Diffuse reflectance.
    pub(super) albedo: [f64; 3],
}

impl Floor {
    /// Whether it lies above or below `p_m`, or there.
    pub(super) fn spans(&self, p_m: DVec3) -> bool {
        let p_m = DVec2::new(p_m.x, p_m.z);
        p_m.cmpge(self.min_m).all() && p_m.cmple(self.max_m).all()
    }
}

/// Water, floor, meshes and lights around a local origin on the water at rest.
pub(super) struct Place {
    /// World position of the local origin, m.
    pub(super) origin_m: DVec3,
    /// The waves.
    pub(super) surface: Surface,
    /// Index of refraction.
    pub(super) ior: f64,
    /// Extinction, 1/m.
    pub(super) extinction_per_m: [f64; 3],
    /// The floor.
    pub(super) floor: Option<Floor>,
    /// All skies.
    pub(super) sky: Sky,
    /// Meshes, in the same coordinates.
    pub(super) occluders: Occluders,
    /// Suns above the horizon and point lights above the floor that contribute to the output; suns come first.
    pub(super) lights: Vec<PlacedLight>,
    /// Largest second derivative of the water's height along any direction, 1/m.
    bend_per_m: f64,
    /// Largest third derivative, 1/m².
    twist_per_m2: f64,
    /// Steepest slope that the water can have.
    pub(super) steepest: f64,
}

impl Place {
    /// The scene around `middle_m`, world (x, z). The requested points should be near it, so that they are accurate far from the
    /// world's origin too.
    pub(super) fn of(resolved: &ResolvedScene, middle_m: DVec2) -> Result<Self, ReferenceError> {
        let scene = &resolved.scene;
        let extinction_per_m = check_water(&scene.water)?;
        let (suns, lamps) = (suns(scene)?, point_lights(scene)?);
        let surface = Surface::refined(resolved, REFINEMENT)?.recentred(middle_m);
        check_surface(&surface)?;
        let occluders = Occluders::of(resolved, middle_m)?;
        let origin_m = DVec3::new(middle_m.x, scene.water.level_m, middle_m.y);
        let ior = scene.water.ior;
        let floor = scene.floor.as_ref().map(|floor| {
            let center_m = DVec2::from(floor.center_m) - middle_m;
            let half_m = DVec2::from(floor.size_m) * 0.5;
            Floor {
                y_m: -floor.depth_m,
                min_m: center_m - half_m,
                max_m: center_m + half_m,
                albedo: floor.albedo,
            }
        });
        let drift = LazyCell::new(|| LampDrift::of(&surface, ior));
        let suns = suns
            .into_iter()
            .map(|sun| (Source::of_sun(sun), sun.irradiance_w_m2));
        let lamps = lamps.into_iter().map(|lamp| {
            let source = Source::of_lamp(lamp, origin_m, &surface);
            (source, lamp.intensity_w_sr)
        });
        let is_buried = |source: &Source| match (source, &floor) {
            (Source::Lamp { position_m, .. }, Some(floor)) => position_m.y <= floor.y_m,
            _ => false,
        };
        let lights = suns
            .chain(lamps)
            .filter(|(source, power)| !is_buried(source) && power.iter().any(|&e| e > 0.0))
            .map(|(source, power)| PlacedLight {
                source,
                power,
                drift: source.is_lamp_in_air().then(|| *drift),
            })
            .collect();
        Ok(Self {
            origin_m,
            ior,
            extinction_per_m,
            floor,
            sky: Sky::of(scene, extinction_per_m),
            occluders,
            lights,
            bend_per_m: surface.max_second_derivative_per_m(),
            twist_per_m2: surface.max_third_derivative_per_m2(),
            steepest: surface.max_slope(),
            surface,
        })
    }

    /// Height and slope at `water_m`, and the largest second derivative along any direction within `radius_m`, 1/m.
    pub(super) fn curved(&self, water_m: DVec2, radius_m: f64) -> (SurfacePoint, f64) {
        let (at, curvature) = self.surface.curved_at(water_m.x, water_m.y);
        let within_m = curvature.largest_per_m() + self.twist_per_m2 * radius_m;
        (at, self.bend_per_m.min(within_m))
    }

    /// Height of `p_m` over the water.
    pub(super) fn over_water_m(&self, p_m: DVec3) -> f64 {
        p_m.y - self.surface.at(p_m.x, p_m.z).height_m
    }

    /// Irradiance of the skies on a surface with unit `normal` at `p_m`, W/m²: in the air the half of the sky it faces, under
    /// water as if that were flat.
    pub(super) fn sky_w_m2(&self, p_m: DVec3, normal: DVec3, dry: bool) -> [f64; 3] {
        if dry {
            self.sky.in_air_w_m2(normal.y)
        } else {
            self.sky.under_water_w_m2(-p_m.y, normal.y)
        }
    }

    /// First parameter t > 0 at which the ray `from_m` + t `direction` (unit), that starts on `side` (1 above, −1 below) of the
    /// water, crosses it.
    ///
    /// Every step is the longest that cannot cross the surface: as far as the steepest slope allows, or as far as the parabola from the
    /// local derivative and the strongest curvature, a lower bound of the height, stays positive. The latter converges like Newton's
    /// method from the safe side, so that the last digits are exact and no crest is skipped.
    pub(super) fn meet_water(&self, from_m: DVec3, direction: DVec3, side: f64) -> Option<f64> {
        /// Steps after which a ray that neither meets the water nor leaves the layer of waves is given up.
        const MOST_STEPS: u32 = 100_000;
        let crest_m = self.surface.max_height_m();
        let mut t = 0.0;
        let gap_m = side * from_m.y - crest_m;
        if gap_m > 0.0 {
            if side * direction.y >= 0.0 {
                return None;
            }
            t = gap_m / direction.y.abs();
        }
        let level2 = direction.x * direction.x + direction.z * direction.z;
        let rate = direction.y.abs() + self.steepest * level2.sqrt();
        let bend = self.bend_per_m * level2;
        for _ in 0..MOST_STEPS {
            let p = from_m + direction * t;
            let SurfacePoint { height_m, slope } = self.surface.at(p.x, p.z);
            let f = side * (p.y - height_m);
            if f <= 1e-14 * (1.0 + p.abs().max_element()) {
                return Some(t);
            }
            if side * p.y > crest_m && side * direction.y >= 0.0 {
                return None;
            }
            let per_t = side * (direction.y - slope.x * direction.x - slope.y * direction.z);
            let root = (per_t * per_t + 2.0 * bend * f).sqrt();
            let along_parabola = if per_t < 0.0 {
                2.0 * f / (root - per_t)
            } else if bend > 0.0 {
                (per_t + root) / bend
            } else {
                return None;
            };
            t += along_parabola.max(f / rate);
        }
        None
    }
}
