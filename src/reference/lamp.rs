//! Traces all rays of one point light and one lattice. Each ray has its own direction and weight.
//!
//! For a light above the water the lattice lies on the water, and a ray represents I cos θ dA / r² of the light. For a light under water the
//! lattice lies on the floor's plane, so that every ray goes to the map and only meshes can block it. In both cases the lattice is in rings
//! around the foot of the light, where it is brightest: an even lattice would miss all the light of a lamp that almost touches the plane.

use glam::{DVec2, DVec3};

use super::lattice::{Lattice, Row};
use super::rings::Rings;
use super::tally::Tally;
use super::trace::Ground;
use super::window::{LampDrift, LightWindow, Target};
use crate::physics::fresnel::{fresnel_reflectance, fresnel_transmittance};
use crate::physics::refraction::refract_direction;
use crate::waves::{Surface, normal};

/// A point light in local coordinates.
pub(super) struct Lamp<'a> {
    surface: &'a Surface,
    position_m: DVec3,
    ior: f64,
    submerged: bool,
}

impl<'a> Lamp<'a> {
    pub(super) fn new(surface: &'a Surface, position_m: DVec3, submerged: bool, ior: f64) -> Self {
        Self {
            surface,
            position_m,
            ior,
            submerged,
        }
    }

    /// What the lattice covers: the water from which light can reach `targets`, the first of which is the map; for a light under water
    /// the map itself.
    pub(super) fn window(&self, targets: &[Target]) -> LightWindow {
        if self.submerged {
            let map = targets.first();
            return LightWindow {
                min_m: map.map_or(DVec2::ZERO, |m| DVec2::new(m.min_m.x, m.min_m.z)),
                max_m: map.map_or(DVec2::ZERO, |m| DVec2::new(m.max_m.x, m.max_m.z)),
            };
        }
        let crest_m = self.surface.max_height_m();
        LampDrift::of(self.surface, self.ior).window(crest_m, self.position_m, targets)
    }

    /// Counts every ray of `lattice` in `window`, per W/sr of the light; the lattice's cell is a unit of [`Self::rings`].
    pub(super) fn trace<const K: usize>(
        &self,
        ground: &Ground<'_, K>,
        window: &LightWindow,
        lattice: &Lattice,
        counted: &(dyn Fn(u64) + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Tally<K> {
        let Some((rings, part)) = self.rings(ground.map.depth_m, window) else {
            return Tally::new(ground.map, ground.occluders.bounds.len());
        };
        let count_row = |row: Row, tally: &mut Tally<K>| {
            let mut stack = Vec::new();
            for i in 0..row.count {
                let (place_m, m2) = rings.place(row.start_m + lattice.step_m() * i as f64);
                // The rings extend beyond the corners of the window.
                if !window.contains(place_m) {
                    continue;
                }
                if self.submerged {
                    self.shine(ground, (place_m, m2), &mut stack, tally);
                } else {
                    self.refract(ground, (place_m, m2), &mut stack, tally);
                }
            }
        };
        ground.count_rows(lattice, &part, counted, cancelled, &count_row)
    }

    /// Rings that cover `window` of the water, or of the floor at `depth_m`, with one unit of (s, t), and where that is; `None` where
    /// there is nothing to cover.
    fn rings(&self, depth_m: f64, window: &LightWindow) -> Option<(Rings, LightWindow)> {
        let foot_m = DVec2::new(self.position_m.x, self.position_m.z);
        let plane_m = if self.submerged {
            -depth_m
        } else {
            self.surface.at(foot_m.x, foot_m.y).height_m
        };
        let height_m = self.position_m.y - plane_m;
        let rings = Rings::around(foot_m, height_m);
        let part = rings.around_window(window);
        let size = part.max_m - part.min_m;
        if height_m <= 0.0 || !size.is_finite() || size.min_element() <= 0.0 {
            return None;
        }
        let rings = rings.in_units_of(size);
        Some((rings, rings.around_window(window)))
    }

    /// A straight ray to a place on the floor that represents `m2` of it.
    fn shine<const K: usize>(
        &self,
        ground: &Ground<'_, K>,
        (place_m, m2): (DVec2, f64),
        stack: &mut Vec<usize>,
        tally: &mut Tally<K>,
    ) {
        let to_m = DVec3::new(place_m.x, -ground.map.depth_m, place_m.y);
        let path_m = (to_m - self.position_m).length();
        let down_m = self.position_m.y - to_m.y;
        if down_m <= 0.0 || path_m == 0.0 {
            return; // the floor does not face it
        }
        let flux = m2 * down_m / path_m.powi(3);
        tally.emitted += flux;
        ground.land(flux, self.position_m, to_m, path_m, stack, tally);
    }

    /// A ray through a place on the water that represents `m2` of it.
    fn refract<const K: usize>(
        &self,
        ground: &Ground<'_, K>,
        (place_m, m2): (DVec2, f64),
        stack: &mut Vec<usize>,
        tally: &mut Tally<K>,
    ) {
        let water = self.surface.at(place_m.x, place_m.y);
        let n = normal(water);
        let from_m = DVec3::new(place_m.x, water.height_m, place_m.y);
        let way_m = self.position_m - from_m;
        let distance2 = way_m.length_squared();
        let to_light = way_m / distance2.sqrt();
        let cos_i = n.dot(to_light);
        // Not above 0 either where the light is on the water itself.
        if cos_i.is_nan() || cos_i <= 0.0 {
            return;
        }
        let flux = m2 * cos_i / (n.y * distance2);
        tally.emitted += flux;
        tally.reflected += flux * fresnel_reflectance(cos_i, self.ior);
        let entered = flux * fresnel_transmittance(cos_i, self.ior);
        let above_floor_m = from_m.y + ground.map.depth_m;
        match refract_direction(-to_light, n, self.ior) {
            Some(ray) if ray.y < -1e-9 && above_floor_m >= 0.0 => {
                let path_m = above_floor_m / -ray.y;
                let to_m = from_m + ray * path_m;
                let to_m = to_m.with_y(-ground.map.depth_m);
                ground.land(entered, from_m, to_m, path_m, stack, tally);
            }
            _ => tally.missed += entered,
        }
    }
}
