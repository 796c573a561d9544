//! Light on paths that are not followed, computed in f64 point by point. The warnings' flux is compared with it.

use glam::DVec3;

use crate::facts::SceneFacts;
use crate::facts::source::Source;
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::refraction::refract_direction;
use crate::waves::{SurfacePoint, normal};

/// Points along each side of the window.
const SIDE: u32 = 400;
/// Steps along the shortest wave.
const STEPS_PER_WAVE: f64 = 500.0;

/// Flux (W) under a sun of 1 W/m² that enters the water and leaves it again. Each ray is followed in small steps until it is below the
/// deepest trough or at the floor.
pub(super) fn flux_leaving_again_w(facts: &SceneFacts) -> f64 {
    let surface = &facts.water.surface;
    let floor_y_m = facts
        .receivers
        .floor
        .as_ref()
        .map_or(f64::NEG_INFINITY, |floor| floor.y_m);
    let bottom_m = floor_y_m.max(-surface.max_height_m());
    let step_m = surface.shortest_wave_m() / STEPS_PER_WAVE;
    over_window(facts, |start, water, to_light| {
        let up = normal(water);
        let Some(direction) = refract_direction(-to_light, up, facts.water.ior) else {
            return 0.0;
        };
        let comes_out = (1..)
            .map(|k| start + direction * (step_m * f64::from(k)))
            .take_while(|p| p.y > bottom_m)
            .any(|p| surface.at(p.x, p.z).height_m < p.y);
        if comes_out {
            transmitted(facts, up, to_light)
        } else {
            0.0
        }
    })
}

/// Flux (W) that slopes facing away from a sun of 1 W/m² would have to subtract.
pub(super) fn flux_turned_away_w(facts: &SceneFacts) -> f64 {
    over_window(facts, |_, water, to_light| {
        let up = normal(water);
        (-up.dot(to_light) / up.y).max(0.0)
    })
}

/// Flux (W) under a sun of 1 W/m² through water that lies below the floor.
pub(super) fn flux_below_floor_w(facts: &SceneFacts) -> f64 {
    let floor_y_m = facts
        .receivers
        .floor
        .as_ref()
        .map_or(f64::NEG_INFINITY, |floor| floor.y_m);
    over_window(facts, |start, water, to_light| {
        if start.y < floor_y_m {
            transmitted(facts, normal(water), to_light)
        } else {
            0.0
        }
    })
}

/// Flux that enters water with normal `up`, per horizontal area.
fn transmitted(facts: &SceneFacts, up: DVec3, to_light: DVec3) -> f64 {
    let cos_i = up.dot(to_light).max(0.0);
    cos_i / up.y * fresnel_transmittance(cos_i, facts.water.ior)
}

/// The integral of `value` over the window of the first sun, m².
fn over_window(facts: &SceneFacts, value: impl Fn(DVec3, SurfacePoint, DVec3) -> f64) -> f64 {
    let light = &facts.lights.beam_sets[0];
    let Source::Sun { to_light } = light.source else {
        return 0.0;
    };
    let cell = light.window.size() / f64::from(SIDE);
    let mut sum = 0.0;
    for j in 0..SIDE {
        for i in 0..SIDE {
            let x = light.window.min.x + (f64::from(i) + 0.5) * cell.x;
            let z = light.window.min.y + (f64::from(j) + 0.5) * cell.y;
            let water = facts.water.surface.at(x, z);
            sum += value(DVec3::new(x, water.height_m, z), water, to_light);
        }
    }
    sum * cell.x * cell.y
}
