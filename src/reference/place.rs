//! A scene in local coordinates, as the engines for views and objects need it.

use std::cell::OnceCell;

use glam::{DVec2, DVec3};

use super::ReferenceError;
use super::checks::{check_surface, check_water, point_lights, suns};
use super::light::PlacedLight;
use super::occluders::Occluders;
use super::window::LampDrift;
use crate::facts::SceneFacts;
use crate::facts::source::Source;
use crate::physics::sky::sky_irradiance;
use crate::scene::{Light, ResolvedScene};
use crate::waves::SurfacePoint;

/// Water, meshes and lights around the local origin of [`SceneFacts`].
pub(super) struct Place {
    /// Camera, floor and sky, as the scene says.
    pub(super) facts: SceneFacts,
    /// Meshes, in the same coordinates.
    pub(super) occluders: Occluders,
    /// Suns above the horizon and point lights above the floor that the output counts: first the suns.
    pub(super) lights: Vec<PlacedLight>,
    /// Largest second derivative of the water's height along any direction, 1/m.
    pub(super) bend_per_m: f64,
    /// Largest third derivative, 1/m².
    pub(super) twist_per_m2: f64,
    /// Steepest slope that the water can have.
    pub(super) steepest: f64,
}

impl Place {
    pub(super) fn of(resolved: &ResolvedScene) -> Result<Self, ReferenceError> {
        let scene = &resolved.scene;
        check_water(&scene.water)?;
        let (suns, lamps) = (suns(scene)?, point_lights(scene)?);
        let facts =
            SceneFacts::of(resolved).map_err(|error| ReferenceError::Scene(error.to_string()))?;
        check_surface(&facts.surface)?;
        let occluders = Occluders::of(resolved, DVec2::new(facts.origin_m.x, facts.origin_m.z))?;
        let suns = suns.into_iter().cloned().map(Light::Sun);
        let counted = suns.chain(lamps.into_iter().cloned().map(Light::Point));
        let drift = OnceCell::new();
        let lights = counted
            .filter_map(|light| Source::of(&light, facts.origin_m, &facts.surface))
            .filter(|(source, power)| {
                let floor_y_m = facts.floor.as_ref().map(|floor| floor.y_m);
                let lamp_y_m = source.position_m().map(|p| p.y);
                let buried = lamp_y_m
                    .zip(floor_y_m)
                    .is_some_and(|(lamp, floor)| lamp <= floor);
                !buried && power.iter().any(|&e| e > 0.0)
            })
            .map(|(source, power)| PlacedLight {
                source,
                power,
                drift: matches!(source, Source::Point { .. })
                    .then(|| *drift.get_or_init(|| LampDrift::of(&facts.surface, facts.ior))),
            })
            .collect();
        Ok(Self {
            steepest: facts.surface.max_slope(),
            bend_per_m: facts.surface.max_second_derivative_per_m(),
            twist_per_m2: facts.surface.max_third_derivative_per_m2(),
            facts,
            occluders,
            lights,
        })
    }

    /// Height and slope at `water_m`, and the largest second derivative along any direction within `radius_m`, 1/m.
    pub(super) fn curved(&self, water_m: DVec2, radius_m: f64) -> (SurfacePoint, f64) {
        let (at, curvature) = self.facts.surface.curved_at(water_m.x, water_m.y);
        let within_m = curvature.largest_per_m() + self.twist_per_m2 * radius_m;
        (at, self.bend_per_m.min(within_m))
    }

    /// Height of `p_m` over the water.
    pub(super) fn over_water_m(&self, p_m: DVec3) -> f64 {
        p_m.y - self.facts.surface.at(p_m.x, p_m.z).height_m
    }

    /// Irradiance of the skies on a surface with unit `normal` at `p_m`, W/m²: in the air the half of the sky it faces, under
    /// water as if that were flat.
    pub(super) fn sky_w_m2(&self, p_m: DVec3, normal: DVec3, dry: bool) -> [f64; 3] {
        let facts = &self.facts;
        std::array::from_fn(|c| {
            let radiance = facts.sky_radiance[c];
            if dry {
                sky_irradiance(radiance, 1.0, 0.0, 0.0, 1.0, normal.y, 1.0)
            } else {
                sky_irradiance(
                    radiance,
                    facts.sky_transmittance,
                    facts.extinction_per_m[c],
                    -p_m.y,
                    facts.sky_path_factor,
                    normal.y,
                    1.0 / (facts.ior * facts.ior),
                )
            }
        })
    }

    /// First parameter t > 0 at which the ray `from_m` + t `direction` (unit), that starts on `side` (1 above, −1 below) of the
    /// water, crosses it.
    ///
    /// Every step is the longest that cannot pass the surface: as far as the steepest slope allows, or, with the derivative here
    /// and the strongest curvature, as far as the parabola below the height stays positive. The latter turns into Newton's
    /// method from the safe side, so that the last digits are exact and no crest is jumped.
    pub(super) fn meet_water(&self, from_m: DVec3, direction: DVec3, side: f64) -> Option<f64> {
        /// Steps after which a ray that neither meets the water nor leaves the layer of waves is given up.
        const MOST_STEPS: u32 = 100_000;
        let crest_m = self.facts.surface.max_height_m();
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
            let SurfacePoint { height_m, slope } = self.facts.surface.at(p.x, p.z);
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
