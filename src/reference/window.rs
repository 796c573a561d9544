//! The window: the rectangle of water that can light a map.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use crate::physics::refraction::{direction_to_light, normal_from_slope, refract_direction};
use crate::waves::Surface;

/// Directions that are sampled on the boundary of the possible slopes.
const RIM_DIRECTIONS: u32 = 64;
/// Shares of the steepest slope that are sampled.
const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Part of the window's size added on each side.
const MARGIN: f64 = 0.02;
/// Metres sideways per metre down beyond which light is not followed: only water steeper than 41° can bend light so flat.
const FLATTEST: f64 = 16.0;

/// A rectangle of water at rest, local coordinates, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightWindow {
    /// Lower corner (x, z).
    pub min_m: DVec2,
    /// Upper corner (x, z).
    pub max_m: DVec2,
}

impl LightWindow {
    /// The empty window.
    pub(super) fn empty() -> Self {
        Self {
            min_m: DVec2::INFINITY,
            max_m: DVec2::NEG_INFINITY,
        }
    }

    /// Whether a point lies in it.
    pub(super) fn contains(&self, point_m: DVec2) -> bool {
        point_m.cmpge(self.min_m).all() && point_m.cmple(self.max_m).all()
    }

    fn include(&mut self, point_m: DVec2) {
        self.min_m = self.min_m.min(point_m);
        self.max_m = self.max_m.max(point_m);
    }
}

/// A box that light may have to reach, local coordinates, m; y up from the water at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    pub(super) min_m: DVec3,
    pub(super) max_m: DVec3,
}

/// The water whose light can reach the rectangle from `min_m` to `max_m`, `depth_m` below the water at rest.
///
/// Projects the rectangle back along the directions that the water's slopes can refract to; 2 % wider on each side.
pub fn light_window(
    surface: &Surface,
    to_light: DVec3,
    ior: f64,
    depth_m: f64,
    min_m: DVec2,
    max_m: DVec2,
) -> LightWindow {
    let floor = Target {
        min_m: DVec3::new(min_m.x, -depth_m, min_m.y),
        max_m: DVec3::new(max_m.x, -depth_m, max_m.y),
    };
    window_of(surface, to_light, ior, &[floor])
}

/// The water whose light can reach any of `targets`; targets entirely above the crests are ignored.
pub(super) fn window_of(
    surface: &Surface,
    to_light: DVec3,
    ior: f64,
    targets: &[Target],
) -> LightWindow {
    let offsets = offsets_per_depth(surface, to_light, ior);
    let crest_m = surface.max_height_m();
    let mut window = LightWindow::empty();
    for target in targets.iter().filter(|t| t.min_m.y <= crest_m) {
        let shallow_m = (-crest_m - target.max_m.y).max(0.0);
        let deep_m = (crest_m - target.min_m.y).max(0.0);
        for offset in &offsets {
            for drop_m in [shallow_m, deep_m] {
                let shift_m = *offset * drop_m;
                window.include(DVec2::new(target.min_m.x, target.min_m.z) - shift_m);
                window.include(DVec2::new(target.max_m.x, target.max_m.z) - shift_m);
            }
        }
    }
    let margin_m = (window.max_m - window.min_m) * MARGIN;
    LightWindow {
        min_m: window.min_m - margin_m,
        max_m: window.max_m + margin_m,
    }
}

/// Angles of incidence at which a point light's refraction is sampled, and directions of the light.
const INCIDENCES: u32 = 32;
const AZIMUTHS: u32 = 16;

/// How far the waves turn the rays of a point light above them, metres sideways per metre down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LampDrift {
    /// Largest deviation of a ray from its path under flat water.
    aside: f64,
    /// Largest sideways distance of a ray.
    farthest: f64,
}

impl LampDrift {
    /// Over all incidences, also from below the horizon: the flank of a wave can face a light that is lower.
    pub(super) fn of(surface: &Surface, ior: f64) -> Self {
        let mut drift = Self {
            aside: 0.0,
            farthest: 0.0,
        };
        let wavy = surface.max_slope() > 0.0;
        let grazing = FRAC_PI_2 * 0.9999;
        let steepest = grazing + surface.max_slope().atan();
        for i in 0..=INCIDENCES {
            let incidence = steepest * f64::from(i) / f64::from(INCIDENCES);
            for j in 0..if wavy { AZIMUTHS } else { 1 } {
                let azimuth = TAU * f64::from(j) / f64::from(AZIMUTHS);
                let to_light = direction_to_light(FRAC_PI_2 - incidence, azimuth);
                let level = direction_to_light(FRAC_PI_2 - incidence.min(grazing), azimuth);
                let Some(flat) = refract_direction(-level, DVec3::Y, ior) else {
                    continue;
                };
                let sideways = DVec2::new(flat.x, flat.z);
                let flat = sideways / (-flat.y).max(sideways.length() / FLATTEST);
                for offset in offsets_per_depth(surface, to_light, ior) {
                    drift.farthest = drift.farthest.max(offset.length());
                    drift.aside = drift.aside.max((offset - flat).length());
                }
            }
        }
        drift
    }

    /// The water whose light from `position_m`, above it, can reach any of `targets`, under crests of `crest_m`.
    ///
    /// Under flat water every ray continues away from the point under the light, so light that lands in a target entered between the
    /// two. Waves deflect it by at most the largest deviation over all incidences.
    pub(super) fn window(
        &self,
        crest_m: f64,
        position_m: DVec3,
        targets: &[Target],
    ) -> LightWindow {
        let foot_m = DVec2::new(position_m.x, position_m.z);
        let mut between = LightWindow::empty();
        let mut near = LightWindow::empty();
        for target in targets.iter().filter(|t| t.min_m.y <= crest_m) {
            let deep_m = (crest_m - target.min_m.y).max(0.0);
            let corners = [
                DVec2::new(target.min_m.x, target.min_m.z),
                DVec2::new(target.max_m.x, target.max_m.z),
            ];
            for corner_m in corners {
                for side in [DVec2::NEG_ONE, DVec2::ONE] {
                    near.include(corner_m + side * (1.02 * self.farthest * deep_m));
                    between.include(corner_m + side * (1.02 * self.aside * deep_m));
                    between.include(foot_m + side * (1.02 * self.aside * deep_m));
                }
            }
        }
        LightWindow {
            min_m: between.min_m.max(near.min_m),
            max_m: between.max_m.min(near.max_m),
        }
    }
}

/// Metres sideways (x, z) per metre down of the refracted light, for a sample of all slopes that the surface can have.
fn offsets_per_depth(surface: &Surface, to_light: DVec3, ior: f64) -> Vec<DVec2> {
    let rim = surface.rim_slopes(RIM_DIRECTIONS);
    let mut slopes = vec![DVec2::ZERO];
    for share in SHARES {
        slopes.extend(rim.iter().map(|slope| *slope * share));
    }
    slopes
        .into_iter()
        .filter_map(|slope| {
            let normal = normal_from_slope(slope.x, slope.y);
            if normal.dot(to_light) <= 0.0 {
                return None;
            }
            let t = refract_direction(-to_light, normal, ior)?;
            let sideways = DVec2::new(t.x, t.z);
            let down = (-t.y).max(sideways.length() / FLATTEST);
            Some(sideways / down)
        })
        .collect()
}
