//! Windows: the rectangle of water whose light can reach the receivers. Also the part of the floor that a camera sees.

use glam::{DVec2, DVec3};

use super::source::Source;
use super::{CameraFacts, SceneFacts};
use crate::physics::refraction;

/// Number of azimuths at which the steepest slopes are evaluated.
const RIM_DIRECTIONS: u32 = 64;
/// Farther than anything in a scene, m.
pub(super) const EVERYWHERE_M: f64 = 1e9;
/// Widening for slopes between the evaluated ones.
const MARGIN: f64 = 0.01;
/// f32 rounding error of a ray's end point, as a share of its coordinates and depth: eight spacings of numbers near 1.
const F32_ROUNDINGS: f64 = 8.0 * f32::EPSILON as f64;
/// Rays per side of the picture that search for the visible floor.
const VIEW_SAMPLES: u32 = 33;

/// A horizontal rectangle, local (x, z) in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Lower corner.
    pub min: DVec2,
    /// Upper corner.
    pub max: DVec2,
}

impl Rect {
    /// Extent, m.
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    pub(super) fn including(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether a point lies in it.
    pub(super) fn holds(&self, at: DVec2) -> bool {
        at.cmpge(self.min).all() && at.cmple(self.max).all()
    }

    /// Intersection with another rectangle; `None` if it is empty.
    pub(super) fn within(self, other: Self) -> Option<Self> {
        let both = Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        };
        both.min.cmplt(both.max).all().then_some(both)
    }

    /// Distance of a 3D point from the rectangle on the water at rest, m.
    pub(super) fn distance_m(&self, p: DVec3) -> f64 {
        let at = DVec2::new(p.x, p.z);
        let aside = (self.min - at).max(at - self.max).max(DVec2::ZERO);
        aside.length().hypot(p.y)
    }

    pub(super) fn grown(self, by: f64) -> Self {
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }
}

/// The bounds of a receiver that needs light, local, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lit {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Lit {
    pub(super) fn rect(&self) -> Rect {
        Rect {
            min: DVec2::new(self.min.x, self.min.z),
            max: DVec2::new(self.max.x, self.max.z),
        }
    }

    /// Least and greatest depth under waves of `height_m`.
    pub(super) fn depths_m(&self, height_m: f64) -> [f64; 2] {
        [
            (-self.max.y - height_m).max(0.0),
            (-self.min.y + height_m).max(0.0),
        ]
    }
}

/// The receivers under water that the output needs light on: the floor's map and wet objects; or the box of the field from which their
/// light is looked up.
pub(super) fn receivers(facts: &SceneFacts) -> Vec<Lit> {
    if let Some(field) = &facts.field {
        return vec![field.lit()];
    }
    let mut all = Vec::new();
    if let (Some(map), Some(floor)) = (&facts.receivers.floor_map, &facts.receivers.floor) {
        all.push(Lit {
            min: DVec3::new(map.rect.min.x, floor.y_m, map.rect.min.y),
            max: DVec3::new(map.rect.max.x, floor.y_m, map.rect.max.y),
        });
    }
    let receives = |index: usize| match facts.output.receiver {
        None => true,
        Some(crate::scene::Receiver::Object(wanted)) => wanted as usize == index,
        Some(crate::scene::Receiver::Floor(_)) => false,
    };
    for index in facts.wet_objects().filter(|&index| receives(index)) {
        let object = &facts.receivers.objects[index];
        all.push(Lit {
            min: object.min,
            max: object.max,
        });
    }
    all
}

/// A part of the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// None of it.
    Nothing,
    /// At most this.
    Rect(Rect),
}

/// Range of the sideways drift of rays under water per metre of depth, over all slopes of the surface.
struct Drift {
    low: DVec2,
    high: DVec2,
}

fn drift(facts: &SceneFacts, direction: DVec3) -> Option<Drift> {
    let mut bounds: Option<(DVec2, DVec2)> = None;
    let rim = facts.water.surface.rim_slopes(RIM_DIRECTIONS);
    let tilts = std::iter::once(DVec2::ZERO).chain(
        rim.iter()
            .flat_map(|&s| [0.25, 0.5, 0.75, 1.0].map(|share| s * share)),
    );
    for slope in tilts {
        let normal = refraction::normal_from_slope(slope.x, slope.y);
        if direction.dot(normal) >= 0.0 {
            continue; // faces away from the light: nothing enters
        }
        let Some(ray) = refraction::refract_direction(direction, normal, facts.water.ior) else {
            continue;
        };
        if ray.y >= -1e-3 {
            continue; // (nearly) upwards: reaches no receiver
        }
        let d = DVec2::new(ray.x, ray.z) / -ray.y;
        bounds = Some(bounds.map_or((d, d), |(low, high)| (low.min(d), high.max(d))));
    }
    bounds.map(|(low, high)| {
        let widen = (high - low) * MARGIN;
        Drift {
            low: low - widen,
            high: high + widen,
        }
    })
}

/// Where light must enter to reach `rect` at depths `shallow` … `deep` (m).
fn entry(rect: Rect, drift: &Drift, shallow: f64, deep: f64) -> Rect {
    let shallow = shallow.max(0.0);
    Rect {
        min: rect.min - (drift.high * shallow).max(drift.high * deep),
        max: rect.max - (drift.low * shallow).min(drift.low * deep),
    }
}

/// Where light must enter to reach an object.
fn object_entry(facts: &SceneFacts, index: usize, drift: &Drift) -> Rect {
    let height = facts.water.surface.max_height_m();
    let object = &facts.receivers.objects[index];
    let lit = Lit {
        min: object.min,
        max: object.max,
    };
    entry(lit.rect(), drift, -lit.max.y - height, -lit.min.y + height)
}

/// The rectangle of water that contains all light that can reach an object, whether the object is the requested receiver or only blocks
/// light; `None` where no object is under water. It is tight only for suns; for point lights it is all of the water.
pub(super) fn objects_window(facts: &SceneFacts, source: &Source) -> Option<Rect> {
    let Source::Sun { to_light } = *source else {
        facts.wet_objects().next()?;
        return Some(Rect {
            min: DVec2::splat(-EVERYWHERE_M),
            max: DVec2::splat(EVERYWHERE_M),
        });
    };
    let drift = drift(facts, -to_light)?;
    let all = facts
        .wet_objects()
        .map(|index| object_entry(facts, index, &drift))
        .reduce(Rect::including)?;
    // The margin is far larger than f32 rounding.
    Some(all.grown(1e-3 * all.size().max_element()))
}

/// The rectangle of water whose light from a sun can reach the receivers; `None` if no light gets through.
pub fn light_window(facts: &SceneFacts, to_light: DVec3) -> Option<Rect> {
    let drift = drift(facts, -to_light)?;
    let height = facts.water.surface.max_height_m();
    let mut window: Option<Rect> = None;
    for lit in receivers(facts) {
        let rect = entry(lit.rect(), &drift, -lit.max.y - height, -lit.min.y + height);
        window = Some(window.map_or(rect, |w| w.including(rect)));
    }
    // A margin for rounding at the rim, so that no texel at the edge loses light: a share of the window's size, or of the distance from
    // the origin and below the water at which rays end in f32.
    let deepest_m = facts
        .receivers
        .floor
        .as_ref()
        .map_or(0.0, |floor| -floor.y_m);
    window.map(|w| {
        let reach_m = w.min.abs().max(w.max.abs()).max_element() + deepest_m;
        w.grown((1e-5 * w.size().max_element().max(1e-6)).max(F32_ROUNDINGS * reach_m))
    })
}

/// The part of the floor that a camera can see through any waves.
pub fn visible_floor(facts: &SceneFacts, camera: &CameraFacts) -> Region {
    let Some(floor) = &facts.receivers.floor else {
        return Region::Nothing;
    };
    let height = facts.water.surface.max_height_m();
    let whole = Region::Rect(floor.rect);
    if camera.eye.y <= height {
        // Under water (or in the waves) total reflection shows the floor in the surface: anything may be seen.
        return whole;
    }
    let tilts: Vec<DVec2> = std::iter::once(DVec2::ZERO)
        .chain(facts.water.surface.rim_slopes(16))
        .collect();
    let mut seen: Option<Rect> = None;
    for j in 0..VIEW_SAMPLES {
        for i in 0..VIEW_SAMPLES {
            let at = |k: u32| 2.0 * f64::from(k) / f64::from(VIEW_SAMPLES - 1) - 1.0;
            let offset = camera.right * at(i) + camera.up * at(j);
            let (eye, direction) = if camera.orthographic {
                (camera.eye + offset, camera.forward)
            } else {
                (camera.eye, (camera.middle + offset).normalize())
            };
            if direction.y >= -1e-3 {
                if direction.y < 0.05 {
                    return whole; // near the horizon waves turn rays down anywhere
                }
                continue;
            }
            for level in [height, -height] {
                let water = eye + direction * ((eye.y - level) / -direction.y);
                for slope in &tilts {
                    let normal = refraction::normal_from_slope(slope.x, slope.y);
                    let Some(ray) =
                        refraction::refract_direction(direction, normal, facts.water.ior)
                    else {
                        continue;
                    };
                    if ray.y >= -1e-3 {
                        return whole;
                    }
                    let hit = water + ray * ((water.y - floor.y_m) / -ray.y);
                    let p = DVec2::new(hit.x, hit.z);
                    let dot = Rect { min: p, max: p };
                    seen = Some(seen.map_or(dot, |s| s.including(dot)));
                }
            }
        }
    }
    let Some(seen) = seen else {
        return Region::Nothing;
    };
    let grow = seen.size() * 0.03;
    let min = (seen.min - grow).max(floor.rect.min);
    let max = (seen.max + grow).min(floor.rect.max);
    if min.x < max.x && min.y < max.y {
        Region::Rect(Rect { min, max })
    } else {
        Region::Nothing
    }
}
