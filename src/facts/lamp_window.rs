//! The window of a point light: the water, or for a light under water the directions, through which its light reaches the receivers.

use glam::{DVec2, DVec3};

use super::SceneFacts;
use super::window::{Lit, Rect};
use crate::physics::octahedral::octahedral_place;
use crate::physics::refraction;

/// Cells per side of the grid that is tested.
const SIDE: usize = 16;
/// Largest number of contractions of the window.
const ROUNDS: u32 = 6;
/// Remaining share of the area above which another contraction is not worth its time.
const WORTH: f64 = 0.8;
/// Number of azimuths at which the steepest slopes are evaluated.
const RIM_DIRECTIONS: u32 = 32;
/// Widening of a cell's drift for slopes and places between the tested ones.
const MARGIN: f64 = 0.05;
/// Drift beyond which rays are not traced, metres sideways per metre down.
const FLATTEST: f64 = 1000.0;

/// Bounds of the drift, metres sideways per metre down.
#[derive(Clone, Copy)]
struct Drift {
    low: DVec2,
    high: DVec2,
}

impl Drift {
    fn including(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
}

/// The possible refracted rays of the light at `position_m` at a place of the water.
struct Refractor<'a> {
    facts: &'a SceneFacts,
    position_m: DVec3,
    tilts: Vec<DVec2>,
    levels_m: Vec<f64>,
}

impl Refractor<'_> {
    fn drift_at(&self, place_m: DVec2) -> Option<Drift> {
        let mut bounds: Option<Drift> = None;
        for &level_m in &self.levels_m {
            let from_light = DVec3::new(place_m.x, level_m, place_m.y) - self.position_m;
            let direction = from_light.try_normalize().unwrap_or(-DVec3::Y);
            for tilt in &self.tilts {
                let normal = refraction::normal_from_slope(tilt.x, tilt.y);
                if direction.dot(normal) >= 0.0 {
                    continue; // faces away from the light: nothing enters
                }
                let Some(ray) =
                    refraction::refract_direction(direction, normal, self.facts.water.ior)
                else {
                    continue;
                };
                if ray.y >= -1.0 / FLATTEST {
                    continue; // (nearly) upwards: reaches no receiver
                }
                let d = DVec2::new(ray.x, ray.z) / -ray.y;
                let one = Drift { low: d, high: d };
                bounds = Some(bounds.map_or(one, |b| b.including(one)));
            }
        }
        bounds
    }
}

/// The rectangle of water through which the light at `position_m`, above the water, reaches `receivers`; `None` when none does.
///
/// Starts from everything that any refraction could reach, divides it into cells, drops rows and columns at its sides whose light cannot
/// land on a receiver, and repeats this with the rest.
pub(super) fn water_window(
    facts: &SceneFacts,
    position_m: DVec3,
    receivers: &[Lit],
) -> Option<Rect> {
    let height_m = facts.water.surface.max_height_m();
    let rim = facts.water.surface.rim_slopes(RIM_DIRECTIONS);
    let refractor = Refractor {
        facts,
        position_m,
        tilts: std::iter::once(DVec2::ZERO)
            .chain(rim.iter().flat_map(|&s| [s * 0.5, s]))
            .collect(),
        levels_m: if height_m > 0.0 {
            vec![-height_m, height_m.min(position_m.y - 1e-9)]
        } else {
            vec![0.0]
        },
    };
    let lean = (1.0 / facts.water.ior).asin() + facts.water.surface.max_slope().atan();
    let flattest = if lean < FLATTEST.atan() {
        lean.tan()
    } else {
        FLATTEST
    };
    let mut window = receivers
        .iter()
        .map(|lit| lit.rect().grown(flattest * lit.depths_m(height_m)[1]))
        .reduce(Rect::including)?;
    let foot_m = DVec2::new(position_m.x, position_m.z);
    for _ in 0..ROUNDS {
        let kept = contracted(&refractor, window, foot_m, receivers, height_m)?;
        let shrunk = kept.size().element_product() / window.size().element_product();
        window = kept;
        if shrunk.is_nan() || shrunk > WORTH {
            break;
        }
    }
    // A margin for rounding at the rim, so that no texel at the edge loses light.
    Some(window.grown(1e-5 * window.size().max_element().max(1e-6)))
}

/// The bounding rectangle of the cells of `window` whose light can land on a receiver.
fn contracted(
    refractor: &Refractor<'_>,
    window: Rect,
    foot_m: DVec2,
    receivers: &[Lit],
    height_m: f64,
) -> Option<Rect> {
    let xs = lines(window.min.x, window.max.x, foot_m.x);
    let zs = lines(window.min.y, window.max.y, foot_m.y);
    let drifts: Vec<Vec<Option<Drift>>> = zs
        .iter()
        .map(|&z| {
            xs.iter()
                .map(|&x| refractor.drift_at(DVec2::new(x, z)))
                .collect()
        })
        .collect();
    let mut kept: Option<Rect> = None;
    for j in 0..zs.len() - 1 {
        for i in 0..xs.len() - 1 {
            let corners = [
                drifts[j][i],
                drifts[j][i + 1],
                drifts[j + 1][i],
                drifts[j + 1][i + 1],
            ];
            let Some(drift) = corners.into_iter().flatten().reduce(Drift::including) else {
                continue;
            };
            let cell = Rect {
                min: DVec2::new(xs[i], zs[j]),
                max: DVec2::new(xs[i + 1], zs[j + 1]),
            };
            let wide = (drift.high - drift.low) * MARGIN;
            let (low, high) = (drift.low - wide, drift.high + wide);
            let lands = receivers.iter().any(|lit| {
                let [shallow, deep] = lit.depths_m(height_m);
                let min = cell.min + (low * shallow).min(low * deep);
                let max = cell.max + (high * shallow).max(high * deep);
                let rect = lit.rect();
                min.cmple(rect.max).all() && max.cmpge(rect.min).all()
            });
            if lands {
                kept = Some(kept.map_or(cell, |k| k.including(cell)));
            }
        }
    }
    kept
}

/// Evenly spaced lines from `low` to `high`, and one through `foot`, so that the drift is monotonic between lines.
fn lines(low: f64, high: f64, foot: f64) -> Vec<f64> {
    let mut all: Vec<f64> = (0..=SIDE)
        .map(|i| low + (high - low) * i as f64 / SIDE as f64)
        .collect();
    if foot > low && foot < high {
        all.push(foot);
        all.sort_by(f64::total_cmp);
    }
    all
}

/// Bounds of the directions, in octahedral coordinates, in which the light at `position_m` under water reaches `receivers`; all
/// directions if a receiver reaches higher than the light.
pub(super) fn direction_window(position_m: DVec3, receivers: &[Lit]) -> Option<Rect> {
    let all = Rect {
        min: DVec2::NEG_ONE,
        max: DVec2::ONE,
    };
    let mut window: Option<Rect> = None;
    for lit in receivers {
        let (low, high) = (lit.min - position_m, lit.max - position_m);
        if high.y >= 0.0 {
            return Some(all);
        }
        // Split at the coordinate planes through the light, each part of a face maps to one flat side of the octahedron, so its corners
        // are its extremes.
        let ends = |low: f64, high: f64| {
            [low, high]
                .into_iter()
                .chain((low < 0.0 && high > 0.0).then_some(0.0))
        };
        for x in ends(low.x, high.x) {
            for z in ends(low.z, high.z) {
                for y in [low.y, high.y] {
                    let p = octahedral_place(DVec3::new(x, y, z));
                    let dot = Rect { min: p, max: p };
                    window = Some(window.map_or(dot, |w| w.including(dot)));
                }
            }
        }
    }
    window.map(|w| {
        let w = w.grown(1e-5 * w.size().max_element().max(1e-6));
        Rect {
            min: w.min.max(all.min),
            max: w.max.min(all.max),
        }
    })
}
