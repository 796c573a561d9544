//! Light that objects would block in reality, although the simulation does not block it. Estimated with rays through the meshes'
//! hierarchies from a grid of about a thousand places on the water at rest. Only warnings use it; no picture depends on it.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};

use super::placement::{ObjectFacts, corners};
use super::source::Source;
use super::window::{EVERYWHERE_M, Rect};
use super::{BeamSet, SceneFacts};
use crate::mesh::{Mesh, hierarchy};
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::octahedral::octahedral_place;
use crate::physics::refraction::refract_direction;
use crate::physics::solid_angle::solid_angle;

/// Most places along each side of a sampled rectangle.
const MOST_SIDE: u32 = 32;
/// Fewest places along each side, where many objects share the rays.
const LEAST_SIDE: u32 = 4;
/// Number of rays per scene for each quantity, shared by its objects and lights; each pair gets a few in any case.
const RAYS: f64 = 32_768.0;
/// Fewest and most directions around a light within an object.
const DIRECTIONS: [f64; 2] = [64.0, 1024.0];
/// Distance behind a ray's origin at which a hit still counts, as a share of the object's size, so that surfaces in the plane where rays
/// start are hit.
const BEHIND: f64 = 1e-6;

/// Light of a scene that its objects block.
pub(super) struct Blocked<'a> {
    facts: &'a SceneFacts,
    meshes: &'a [Arc<Mesh>],
    mesh_from_local: Vec<DAffine3>,
    side: u32,
    directions: u32,
}

impl<'a> Blocked<'a> {
    /// `meshes` are those of the scene's objects, one each.
    pub(super) fn new(facts: &'a SceneFacts, meshes: &'a [Arc<Mesh>]) -> Self {
        let pairs = facts.receivers.objects.len() * facts.lights.beam_sets.len();
        let side = (RAYS / pairs.max(1) as f64).sqrt() as u32;
        let positions = facts
            .lights
            .beam_sets
            .iter()
            .filter_map(|l| l.source.position_m());
        let within: usize = positions
            .map(|position_m| {
                let around = facts
                    .receivers
                    .objects
                    .iter()
                    .filter(|o| is_around(o, position_m));
                around.count()
            })
            .sum();
        let [fewest, most] = DIRECTIONS;
        Self {
            facts,
            meshes,
            mesh_from_local: facts
                .receivers
                .objects
                .iter()
                .map(|object| object.local_from_mesh.inverse())
                .collect(),
            side: side.clamp(LEAST_SIDE, MOST_SIDE),
            directions: (RAYS / within.max(1) as f64).clamp(fewest, most) as u32,
        }
    }

    /// Flux towards the water, before its reflection, that the part of an object above the water at rest blocks, W; sum over all lights.
    /// Each object is counted as if it were alone.
    pub(super) fn above_water_w(&self, object: usize) -> [f64; 3] {
        self.of_all_lights(|light| self.unit_flux_above(object, light))
    }

    /// Flux that arrives at further objects although an object nearer to the light has blocked it already, W; sum over all lights and over
    /// the further objects. Taken just under the water at rest, without absorption.
    pub(super) fn blocked_again_w(&self) -> [f64; 3] {
        self.of_all_lights(|light| self.unit_flux_met(light, |met| met.saturating_sub(1)))
    }

    /// Flux that hits an object at all, W; sum over all lights, taken in the same way.
    pub(super) fn blocked_w(&self) -> [f64; 3] {
        self.of_all_lights(|light| self.unit_flux_met(light, |met| met.min(1)))
    }

    /// Flux that a light within the bounds of an object sends onto it, W.
    pub(super) fn onto_w(&self, object: usize, position_m: DVec3, power: [f64; 3]) -> [f64; 3] {
        let onto = sphere(self.directions)
            .filter(|&direction| self.meets(object, position_m, direction, EVERYWHERE_M))
            .count();
        let share = onto as f64 / f64::from(self.directions);
        power.map(|i| 2.0 * TAU * i * share)
    }

    fn of_all_lights(&self, unit_flux: impl Fn(&BeamSet) -> f64) -> [f64; 3] {
        let mut sum_w = [0.0; 3];
        for light in &self.facts.lights.beam_sets {
            let unit = unit_flux(light);
            for (sum, power) in sum_w.iter_mut().zip(light.power) {
                *sum += power * unit;
            }
        }
        sum_w
    }

    /// Flux of a light of unit power that the dry part of an object blocks, m² or sr.
    fn unit_flux_above(&self, object: usize, light: &BeamSet) -> f64 {
        let bounds = &self.facts.receivers.objects[object];
        if let Source::Sun { to_light } = light.source {
            return self.silhouette_m2(object, to_light, light.window);
        }
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

    /// Area of the silhouette of an object's dry part seen from a sun, as far as its shadow falls into `window`, m².
    fn silhouette_m2(&self, object: usize, to_light: DVec3, window: Rect) -> f64 {
        let bounds = &self.facts.receivers.objects[object];
        if bounds.max.y < 0.0 {
            return 0.0;
        }
        let low = bounds.min.with_y(bounds.min.y.max(0.0));
        let (u, v) = to_light.any_orthonormal_pair();
        let seen =
            corners(low, bounds.max).map(|p| DVec3::new(p.dot(u), p.dot(v), p.dot(to_light)));
        let [min, max] = [
            seen.into_iter().fold(DVec3::INFINITY, DVec3::min),
            seen.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max),
        ];
        let before_m = min.z - BEHIND * (max - min).length();
        let step_m = (max - min).truncate() / f64::from(self.side);
        let shadowed = (0..self.side * self.side).filter(|k| {
            let nth = DVec2::new(f64::from(k % self.side), f64::from(k / self.side)) + 0.5;
            let at = min.truncate() + step_m * nth;
            let mut from_m = u * at.x + v * at.y + to_light * before_m;
            let foot_m = from_m - to_light * (from_m.y / to_light.y);
            if from_m.y < 0.0 {
                from_m = foot_m;
            }
            window.holds(DVec2::new(foot_m.x, foot_m.z))
                && self.meets(object, from_m, to_light, EVERYWHERE_M)
        });
        shadowed.count() as f64 * step_m.element_product()
    }

    /// Flux of a light of unit power, m² or sr, that counts as often as `counts` says of the number of objects that it meets.
    fn unit_flux_met(&self, light: &BeamSet, counts: fn(usize) -> usize) -> f64 {
        let met = |from_m: DVec3, direction: DVec3| {
            // Rays that go up end at the water.
            let reach_m = if direction.y > 0.0 {
                -from_m.y.min(0.0) / direction.y
            } else {
                EVERYWHERE_M
            };
            let hit = self
                .facts
                .wet_objects()
                .filter(|&object| self.meets(object, from_m, direction, reach_m));
            counts(hit.count()) as f64
        };
        let wet = self.facts.wet_objects().count().max(1) as f64;
        let rays = (RAYS / (wet * self.facts.lights.beam_sets.len() as f64)).clamp(64.0, 4096.0);
        let window = match (light.source, light.objects_window) {
            (Source::Submerged { position_m }, _) => {
                let directions = rays as u32;
                let is_all = light.window.holds(DVec2::NEG_ONE) && light.window.holds(DVec2::ONE);
                let followed = sphere(directions).filter(|&direction| {
                    is_all || direction.y < 0.0 && light.window.holds(octahedral_place(direction))
                });
                let sum: f64 = followed.map(|direction| met(position_m, direction)).sum();
                return sum * 2.0 * TAU / f64::from(directions);
            }
            (_, Some(objects)) => objects.within(light.window),
            (_, None) => None,
        };
        let Some(window) = window else { return 0.0 };
        let side = (rays.sqrt() as u32).clamp(8, 2 * MOST_SIDE);
        let falls = |place: Place| {
            let (to_light, _) = place.to(&light.source)?;
            let direction = refract_direction(-to_light, DVec3::Y, self.facts.water.ior)?;
            let enters = fresnel_transmittance(to_light.y, self.facts.water.ior);
            Some(met(place.at_m, direction) * enters * place.unit_flux(&light.source))
        };
        places(window, side).filter_map(falls).sum()
    }

    /// Whether a ray hits an object before `reach_m`; `direction` has unit length.
    fn meets(&self, object: usize, from_m: DVec3, direction: DVec3, reach_m: f64) -> bool {
        let mesh = &self.meshes[object];
        let mesh_from_local = &self.mesh_from_local[object];
        let along = mesh_from_local.transform_vector3(direction);
        let per_m = along.length();
        let behind = BEHIND * f64::from((mesh.max_m - mesh.min_m).length());
        let hit = hierarchy::first_hit(
            &mesh.hierarchy,
            &mesh.triangles,
            mesh_from_local.transform_point3(from_m).as_vec3(),
            (along / per_m).as_vec3(),
            -behind as f32,
            (reach_m * per_m).min(f64::from(f32::MAX)) as f32,
        );
        hit.is_some()
    }
}

/// Whether a place is within the bounds of an object.
pub(super) fn is_around(object: &ObjectFacts, position_m: DVec3) -> bool {
    position_m.cmpge(object.min).all() && position_m.cmple(object.max).all()
}

/// A small rectangle of the water at rest.
#[derive(Clone, Copy)]
pub(super) struct Place {
    at_m: DVec3,
    rect: Rect,
}

impl Place {
    /// Unit direction to a light above the water, and its distance, m.
    pub(super) fn to(&self, source: &Source) -> Option<(DVec3, f64)> {
        match *source {
            Source::Sun { to_light } => Some((to_light, EVERYWHERE_M)),
            Source::Point { position_m } => {
                let to_light = position_m - self.at_m;
                (to_light.y > 0.0).then(|| (to_light.normalize(), to_light.length()))
            }
            Source::Submerged { .. } => None,
        }
    }

    /// Flux of a light of unit power onto it: m² for a sun, sr for a point light.
    pub(super) fn unit_flux(&self, source: &Source) -> f64 {
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

/// A rectangle of the water at rest, divided evenly into `side` × `side` places.
pub(super) fn places(rect: Rect, side: u32) -> impl Iterator<Item = Place> {
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

/// The part of a point light's window that the shadow of an object's dry part falls on; `None` where there is none.
fn shadow_on_water(object: &ObjectFacts, light: &BeamSet) -> Option<Rect> {
    let Source::Point { position_m } = light.source else {
        return None;
    };
    let low_m = object.min.y.max(0.0);
    if object.max.y < 0.0 || low_m >= position_m.y {
        return None;
    }
    if object.max.y >= position_m.y {
        // An object that reaches above the light may shadow any part of the window.
        return Some(light.window);
    }
    let shadow = corners(object.min.with_y(low_m), object.max)
        .into_iter()
        .map(|p| {
            let from = DVec2::new(position_m.x, position_m.z);
            let longer = position_m.y / (position_m.y - p.y);
            let foot = from + (DVec2::new(p.x, p.z) - from) * longer;
            Rect {
                min: foot,
                max: foot,
            }
        })
        .reduce(Rect::including)?;
    shadow.within(light.window)
}
