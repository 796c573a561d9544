//! Which piece of the water, or which directions, of a point light reach the receivers.

use glam::{DVec2, DVec3};

use super::SceneFacts;
use super::window::{Lit, Rect};
use crate::physics::octahedral::octahedral_place;
use crate::physics::refraction;

/// Cells per side of the grid that is looked at.
const SIDE: usize = 16;
/// Most times that the window is contracted.
const ROUNDS: u32 = 6;
/// Part of the old area above which another round is not worth it.
const WORTH: f64 = 0.8;
/// Directions in which the steepest tilts are looked up.
const RIM_DIRECTIONS: u32 = 32;
/// Widening of a cell's drift for what lies between the tilts and corners looked at.
const MARGIN: f64 = 0.05;
/// Metres sideways per metre down beyond which light is not followed.
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

/// What the light at `position_m` meets at a place of the water: which ways its rays can go on.
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
            let way = DVec3::new(place_m.x, level_m, place_m.y) - self.position_m;
            let direction = way.try_normalize().unwrap_or(-DVec3::Y);
            for tilt in &self.tilts {
                let normal = refraction::normal_from_slope(tilt.x, tilt.y);
                if direction.dot(normal) >= 0.0 {
                    continue; // looks away from the light: nothing comes through
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
/// Starts from all that any refraction could reach, looks at a grid of cells, drops those whose light cannot land on a
/// receiver, and does so again with what is left.
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
    // A margin against rounding at the rim, so that no texel at the edge misses a sliver.
    Some(window.grown(1e-5 * window.size().max_element().max(1e-6)))
}

/// What is left of `window` when cells whose light lands on no receiver are dropped at its sides.
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

/// Even lines from `low` to `high`, and one through `foot`: between lines the drift rises or falls without a turn.
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

/// The octahedral places of the directions in which the light at `position_m`, under water, meets `receivers`; all of them when one
/// reaches higher than the light.
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
        // Between the planes through the light each face is seen as on a flat side of the octahedron: corners are extremes.
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
