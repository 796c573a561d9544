//! How much light objects stop in truth that they are not simulated to stop: rays through the meshes' hierarchies from a grid of
//! places on the water at rest. A sample of a thousand places or so, for warnings; no picture depends on it.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::facts::{LightFacts, SceneFacts};
use super::placement::ObjectFacts;
use super::source::Source;
use super::window::Rect;
use crate::mesh::{Mesh, hierarchy};
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::refraction::refract_direction;
use crate::physics::solid_angle::solid_angle;

/// Places along each side of what is looked at, at most.
const MOST_SIDE: u32 = 32;
/// Fewest of them, where many objects share the rays.
const LEAST_SIDE: u32 = 4;
/// Rays of a scene, as long as there are enough places for each object and light.
const RAYS: f64 = 32_768.0;
/// Directions around a light within an object.
const DIRECTIONS: u32 = 1024;
/// Farther than anything in a scene, m.
const EVERYWHERE_M: f64 = 1e9;

/// Light that objects stop, of the lights of a scene whose windows are known.
pub(super) struct Stopped<'a> {
    facts: &'a SceneFacts,
    meshes: &'a [Arc<Mesh>],
    side: u32,
}

impl<'a> Stopped<'a> {
    /// `meshes` are those of the scene's objects, one each.
    pub(super) fn new(facts: &'a SceneFacts, meshes: &'a [Arc<Mesh>]) -> Self {
        let shared_by = (facts.objects.len() * facts.lights.len()).max(1) as f64;
        let side = (RAYS / shared_by).sqrt() as u32;
        Self {
            facts,
            meshes,
            side: side.clamp(LEAST_SIDE, MOST_SIDE),
        }
    }

    /// Flux into the water that the part of an object above the water at rest stops, all lights together, W; each object for itself,
    /// as if the others were not there.
    pub(super) fn above_water_w(&self, object: usize) -> [f64; 3] {
        self.of_all_lights(|light| self.unit_flux_above(object, light))
    }

    /// Flux that one object after another stops although an object before it has stopped it already, all lights together, W; as it
    /// goes under the water at rest, without what is absorbed.
    pub(super) fn stopped_again_w(&self) -> [f64; 3] {
        self.of_all_lights(|light| self.unit_flux_again(light))
    }

    /// Flux that a light within the bounds of an object sends onto it, W.
    pub(super) fn onto_w(&self, object: usize, position_m: DVec3, power: [f64; 3]) -> [f64; 3] {
        let onto = sphere(DIRECTIONS)
            .filter(|&direction| self.meets(object, position_m, direction, EVERYWHERE_M))
            .count();
        let share = onto as f64 / f64::from(DIRECTIONS);
        power.map(|i| 2.0 * TAU * i * share)
    }

    fn of_all_lights(&self, unit_flux: impl Fn(&LightFacts) -> f64) -> [f64; 3] {
        let mut sum_w = [0.0; 3];
        for light in &self.facts.lights {
            let unit = unit_flux(light);
            for (sum, power) in sum_w.iter_mut().zip(light.power) {
                *sum += power * unit;
            }
        }
        sum_w
    }

    /// Flux of a light of unit power that the dry part of an object keeps from the water, m² or sr.
    fn unit_flux_above(&self, object: usize, light: &LightFacts) -> f64 {
        let bounds = &self.facts.objects[object];
        let Some(rect) = shadow_on_water(bounds, light) else {
            return 0.0;
        };
        let falls = |place: Place| {
            let (to_light, reach_m) = place.to(&light.source)?;
            self.meets(object, place.at_m, to_light, reach_m)
                .then(|| place.unit_flux(&light.source))
        };
        places(rect, self.side).filter_map(falls).sum()
    }

    /// Flux of a light of unit power that is stopped a second and further times, m² or sr.
    fn unit_flux_again(&self, light: &LightFacts) -> f64 {
        let again = |from_m: DVec3, direction: DVec3| {
            let met = self
                .facts
                .wet_objects()
                .filter(|&object| self.meets(object, from_m, direction, EVERYWHERE_M));
            met.count().saturating_sub(1) as f64
        };
        let wet = self.facts.wet_objects().count().max(1) as f64;
        let rays = (RAYS / (wet * self.facts.lights.len() as f64)).max(64.0);
        let window = match (light.source, light.objects_window) {
            (Source::Submerged { position_m }, _) => {
                let directions = (rays as u32).min(4 * DIRECTIONS);
                let sum: f64 = sphere(directions)
                    .map(|direction| again(position_m, direction))
                    .sum();
                return sum * 2.0 * TAU / f64::from(directions);
            }
            (_, Some(objects)) => objects.within(light.window),
            (_, None) => None,
        };
        let Some(window) = window else { return 0.0 };
        let side = (rays.sqrt() as u32).clamp(8, 2 * MOST_SIDE);
        let falls = |place: Place| {
            let (to_light, _) = place.to(&light.source)?;
            let direction = refract_direction(-to_light, DVec3::Y, self.facts.ior)?;
            let enters = fresnel_transmittance(to_light.y, self.facts.ior);
            Some(again(place.at_m, direction) * enters * place.unit_flux(&light.source))
        };
        places(window, side).filter_map(falls).sum()
    }

    /// Whether a ray meets an object before `reach_m`; `direction` has unit length.
    fn meets(&self, object: usize, from_m: DVec3, direction: DVec3, reach_m: f64) -> bool {
        let mesh = &self.meshes[object];
        let mesh_from_local = self.facts.objects[object].local_from_mesh.inverse();
        let along = mesh_from_local.transform_vector3(direction);
        let per_m = along.length();
        let hit = hierarchy::first_hit(
            &mesh.hierarchy,
            &mesh.triangles,
            mesh_from_local.transform_point3(from_m).as_vec3(),
            (along / per_m).as_vec3(),
            0.0,
            (reach_m * per_m).min(f64::from(f32::MAX)) as f32,
        );
        hit.is_some()
    }
}

/// A small rectangle of the water at rest.
#[derive(Clone, Copy)]
struct Place {
    at_m: DVec3,
    rect: Rect,
}

impl Place {
    /// Unit direction to a light above the water, and how far it is, m.
    fn to(&self, source: &Source) -> Option<(DVec3, f64)> {
        match *source {
            Source::Sun { to_light } => Some((to_light, EVERYWHERE_M)),
            Source::Point { position_m } => {
                let way = position_m - self.at_m;
                (way.y > 0.0).then(|| (way.normalize(), way.length()))
            }
            Source::Submerged { .. } => None,
        }
    }

    /// Flux of a light of unit power onto it, m² of a sun, sr of a point light.
    fn unit_flux(&self, source: &Source) -> f64 {
        match *source {
            Source::Sun { to_light } => self.rect.size().element_product() * to_light.y,
            Source::Point { position_m } => rect_sr(self.rect, position_m),
            Source::Submerged { .. } => 0.0,
        }
    }
}

/// Solid angle of a rectangle of the water at rest, seen from `position_m`, sr.
pub(super) fn rect_sr(rect: Rect, position_m: DVec3) -> f64 {
    let corner = |p: DVec2| DVec3::new(p.x, 0.0, p.y) - position_m;
    let (low, high) = (corner(rect.min), corner(rect.max));
    let size = rect.size();
    let (x, z) = (DVec3::X * size.x, DVec3::Z * size.y);
    solid_angle(low, z, x).abs() + solid_angle(high, -z, -x).abs()
}

/// The even grid of places that make up a rectangle of the water at rest.
fn places(rect: Rect, side: u32) -> impl Iterator<Item = Place> {
    let step_m = rect.size() / f64::from(side);
    (0..side * side).map(move |k| {
        let at = DVec2::new(f64::from(k % side), f64::from(k / side));
        let min = rect.min + step_m * at;
        let middle = min + 0.5 * step_m;
        Place {
            at_m: DVec3::new(middle.x, 0.0, middle.y),
            rect: Rect {
                min,
                max: min + step_m,
            },
        }
    })
}

/// Directions evenly all around (Fibonacci lattice).
fn sphere(count: u32) -> impl Iterator<Item = DVec3> {
    let golden_turn = TAU * (1.0 - 1.0 / 1.618_033_988_749_895);
    (0..count).map(move |i| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let across = (1.0 - y * y).sqrt();
        let (sin, cos) = (golden_turn * f64::from(i)).sin_cos();
        DVec3::new(across * cos, y, across * sin)
    })
}

/// The piece of a light's window in which the shadow of an object's dry part lies; `None` where there is none.
fn shadow_on_water(object: &ObjectFacts, light: &LightFacts) -> Option<Rect> {
    let (low_m, high_m) = (object.min.y.max(0.0), object.max.y);
    let under_light = light
        .source
        .position_m()
        .is_none_or(|position_m| low_m < position_m.y);
    if high_m <= 0.0 || !under_light {
        return None;
    }
    let mut shadow: Option<Rect> = None;
    for y in [low_m, high_m] {
        for x in [object.min.x, object.max.x] {
            for z in [object.min.z, object.max.z] {
                let foot = match light.source {
                    Source::Sun { to_light } => {
                        let drift = DVec2::new(to_light.x, to_light.z) / to_light.y;
                        DVec2::new(x, z) - drift * y
                    }
                    Source::Point { position_m } if y < position_m.y => {
                        let from = DVec2::new(position_m.x, position_m.z);
                        from + (DVec2::new(x, z) - from) * (position_m.y / (position_m.y - y))
                    }
                    // What reaches up beside the light may hide it from anywhere.
                    Source::Point { .. } => return Some(light.window),
                    Source::Submerged { .. } => return None,
                };
                let dot = Rect {
                    min: foot,
                    max: foot,
                };
                shadow = Some(shadow.map_or(dot, |s| s.including(dot)));
            }
        }
    }
    shadow?.within(light.window)
}
