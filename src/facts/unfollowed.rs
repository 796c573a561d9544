//! Light paths that are possible in a scene but not simulated, judged by the steepest slopes and greatest heights of the waves.

use glam::{DVec2, DVec3};

use super::source::Source;
use super::{BeamSet, SceneFacts};
use crate::physics::refraction::{normal_from_slope, refract_direction};
use crate::stats::Warning;
use crate::waves::Surface;

/// Number of azimuths at which the steepest slopes are evaluated.
const SLOPES: u32 = 64;
/// Number of fractions of each steepest slope that are tested.
const PARTS: u32 = 8;
/// A ray counts as possibly leaving the water if it reaches this share of the needed slope, because other slopes lie between the tested
/// ones.
const NEARLY: f64 = 0.9;

/// Code of the warning that some slopes face away from a light.
pub const WAVES_SHADE_WAVES: &str = "waves_shade_waves";

/// The warning about a light from which some slopes face away; the frame adds the flux.
pub fn waves_shade_waves(light: u32) -> Warning {
    Warning {
        pointer: Some(format!("/lights/{light}")),
        ..Warning::new(
            WAVES_SHADE_WAVES,
            "some wave slopes face away from the light; shadows of waves on waves are not simulated, so water in these shadows is lit",
        )
    }
}

/// Whether slopes of these waves can face away from a light.
pub(super) fn can_face_away(surface: &Surface, light: &BeamSet) -> bool {
    if surface.max_slope() == 0.0 {
        return false;
    }
    match light.source {
        Source::Sun { to_light } => {
            let sideways = DVec2::new(to_light.x, to_light.z);
            surface.max_slope_along(sideways.normalize_or_zero()) * sideways.length() > to_light.y
        }
        Source::Point { position_m } => {
            let foot_m = DVec2::new(position_m.x, position_m.z);
            let farthest_m = (light.window.min - foot_m)
                .abs()
                .max((light.window.max - foot_m).abs())
                .length();
            surface.max_slope() * farthest_m > position_m.y - surface.max_height_m()
        }
        Source::Submerged { .. } => false,
    }
}

/// Whether a ray that these waves refract can leave the water again: it must be flatter than the steepest slope that could fall away
/// under it.
fn may_leave_again(surface: &Surface, light: &BeamSet, ior: f64) -> bool {
    let rim = surface.rim_slopes(SLOPES);
    let to_lights = match light.source {
        Source::Sun { to_light } => vec![to_light],
        // A light between waves may shine at the water from any side, also from below.
        Source::Point { position_m } if position_m.y <= surface.max_height_m() => {
            return surface.max_slope() > 0.0;
        }
        Source::Point { position_m } => {
            let window = light.window;
            let near = DVec2::new(position_m.x, position_m.z).clamp(window.min, window.max);
            let middle = (window.min + window.max) * 0.5;
            let (low, high) = (window.min, window.max);
            [low.x, near.x, middle.x, high.x]
                .into_iter()
                .flat_map(|x| [low.y, near.y, middle.y, high.y].map(|z| DVec3::new(x, 0.0, z)))
                .map(|place_m| (position_m - place_m).normalize_or(DVec3::Y))
                .collect()
        }
        Source::Submerged { .. } => return false,
    };
    let slopes = rim.iter().flat_map(|&slope| {
        (1..=PARTS).map(move |part| slope * (f64::from(part) / f64::from(PARTS)))
    });
    slopes.into_iter().any(|slope| {
        let normal = normal_from_slope(slope.x, slope.y);
        to_lights.iter().any(|&to_light| {
            if normal.dot(to_light) <= 0.0 {
                return false;
            }
            let Some(refracted) = refract_direction(-to_light, normal, ior) else {
                return false;
            };
            let aside = DVec2::new(refracted.x, refracted.z);
            let falls = surface.max_slope_along(aside.normalize_or_zero());
            aside.length() * falls >= NEARLY * -refracted.y
        })
    })
}

/// Light paths that the waves make possible and that are not simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnfollowedPaths {
    /// Slopes face away from a light.
    pub faces_away: bool,
    /// Rays leave the water again.
    pub leaves_again: bool,
    /// Troughs lie below the floor.
    pub bares_floor: bool,
}

impl UnfollowedPaths {
    /// The possible paths in words; empty if there are none.
    pub fn words(self) -> Vec<&'static str> {
        let all = [
            (self.faces_away, "slopes that face away from the light"),
            (self.leaves_again, "rays that leave the water again"),
            (self.bares_floor, "troughs below the floor"),
        ];
        all.into_iter()
            .filter_map(|(is, words)| is.then_some(words))
            .collect()
    }
}

impl SceneFacts {
    /// Light paths that the waves of this scene make possible and that are not simulated.
    pub fn unfollowed_paths(&self) -> UnfollowedPaths {
        let any = |may: &dyn Fn(&BeamSet) -> bool| self.lights.beam_sets.iter().any(may);
        let floor = self.receivers.floor.as_ref();
        UnfollowedPaths {
            faces_away: any(&|light| can_face_away(&self.water.surface, light)),
            leaves_again: any(&|light| may_leave_again(&self.water.surface, light, self.water.ior)),
            bares_floor: floor.is_some_and(|floor| self.water.surface.max_height_m() > -floor.y_m)
                && any(&|light| !matches!(light.source, Source::Submerged { .. })),
        }
    }
}
