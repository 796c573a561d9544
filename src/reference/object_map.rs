//! The light on an object, in the texels of its map.
//!
//! Plain rays enter everywhere through the water that can light the object, or go straight from a point light under water. Rays that
//! hit the requested surface, the first along the map's axis or one behind it, are counted in the texel that they hit. The cells
//! of the lattice are the texels' shadows on the water, so flat water gives every texel of the first surface the same count.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::lattice::Row;
use super::light::PlacedLight;
use super::map::{MOST_GROWTH, ORDER, half_difference, mean, share};
use super::object_rays::{ObjectRays, Ray, Volley};
use super::place::Place;
use super::slanted::{halves, rows};
use super::tally::add_to;
use super::texels::TexelGrid;
use super::{ReferenceError, Truth, TruthKind, TruthSettings};
use crate::physics::attenuation::transmission;
use crate::scene::ResolvedScene;

/// Rays per texel of evenly lit water in the first round, each half.
const FIRST_POINTS: f64 = 8.0;
/// The number of bands of rows. Each has its own map, and the maps are summed in order.
const BANDS: usize = 8;
/// Surfaces closer together along the axis than this share of the object's size do not hide each other: they differ by rounding only.
const SAME_SURFACE: f64 = 1e-7;

/// Landed and blocked light per texel, W: (r, g, b) of each.
type Texels = Vec<[f64; 6]>;

/// The truth for the map on object `index`, of the surface that lies behind `layer` others along the map's axis.
pub(super) fn object_map(
    resolved: &ResolvedScene,
    (index, layer): (u32, u32),
    settings: &TruthSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Truth, ReferenceError> {
    let (object, objects) = (index as usize, &resolved.scene.objects);
    let [x_m, _, z_m] = objects
        .get(object)
        .map(|object| object.translation_m)
        .ok_or(ReferenceError::NoObject {
            index,
            objects: objects.len(),
        })?;
    let place = Place::of(resolved, DVec2::new(x_m, z_m))?;
    let side = resolved.scene.quality.level_map_texels;
    // The first light defines the map's axis.
    let light = place.lights.first();
    let grid = light.and_then(|l| TexelGrid::of(resolved, object, &place, &l.source));
    let (Some(light), Some(grid)) = (light, grid) else {
        progress(1.0);
        return Ok(dark(side));
    };
    let counter = Counter::new(&place, light, &grid, (object, layer));
    let cosines = counter.cosines(side);
    let (halves, rays) = counter.rounds(&cosines, settings, progress, cancelled)?;
    let [a, b] = &halves;
    let irradiance = [a, b].map(|half| counter.irradiance(half, &cosines));
    Ok(Truth {
        relative_error: half_difference(&irradiance[0], &irradiance[1]),
        irradiance: mean(&irradiance[0], &irradiance[1]),
        compared: cosines.iter().map(Option::is_some).collect(),
        rays,
        shadow: Some(shadow(a, b, &cosines)),
        ..dark(side)
    })
}

/// A map that no light reaches: without a light the map has no axis, and there is nothing to compare.
fn dark(side: u32) -> Truth {
    let texels = side as usize * side as usize;
    Truth {
        kind: TruthKind::ObjectMap,
        width: side,
        height: side,
        first_pixel: [0, 0],
        pixel_step: 1,
        irradiance: vec![[0.0; 3]; texels],
        compared: vec![false; texels],
        relative_error: 0.0,
        rays: 0,
        shadow: None,
        seconds: 0.0,
        from_disk: false,
    }
}

fn shadow(a: &Texels, b: &Texels, cosines: &[Option<f64>]) -> Vec<f64> {
    a.iter()
        .zip(b)
        .zip(cosines)
        .map(|((a, b), cosine)| {
            let sum = |of: std::ops::Range<usize>| of.map(|i| a[i] + b[i]).sum();
            cosine.map_or(0.0, |_| share(sum(3..6), sum(0..3)))
        })
        .collect()
}

struct Counter<'a> {
    place: &'a Place,
    light: &'a PlacedLight,
    grid: &'a TexelGrid,
    object: usize,
    /// The number of the object's surfaces in front of the requested one along the axis.
    layer: u32,
    /// The rays that may hit it; `None` if there are none.
    rays: Option<ObjectRays<'a>>,
    same_surface_m: f64,
}

impl<'a> Counter<'a> {
    fn new(
        place: &'a Place,
        light: &'a PlacedLight,
        grid: &'a TexelGrid,
        (object, layer): (usize, u32),
    ) -> Self {
        let bounds = place.occluders.bounds[object];
        let size_m = (bounds.max_m - bounds.min_m).length();
        Self {
            place,
            light,
            grid,
            object,
            layer,
            rays: ObjectRays::new(place, light, bounds, (grid.corner_m, grid.edges_m)),
            same_surface_m: SAME_SURFACE * size_m,
        }
    }

    /// |n·axis| of the requested surface at each texel's centre.
    fn cosines(&self, side: u32) -> Vec<Option<f64>> {
        let axis = self.grid.axis;
        let bounds = self.place.occluders.bounds[self.object];
        let size_m = (bounds.max_m - bounds.min_m).length();
        let middle_m = (bounds.min_m + bounds.max_m) * 0.5;
        (0..side * side)
            .into_par_iter()
            .map(|texel| {
                let st = DVec2::new(f64::from(texel % side), f64::from(texel / side)) + 0.5;
                let texel_m = self.grid.place_m(st);
                let before_m = (middle_m - texel_m).dot(axis) - size_m;
                let mut stack = Vec::new();
                let mut from_m = texel_m + axis * before_m;
                let occluders = &self.place.occluders;
                for _ in 0..self.layer {
                    let before = occluders.first_seen_of(self.object, from_m, axis, &mut stack)?;
                    from_m += axis * (before.distance_m + self.same_surface_m);
                }
                occluders
                    .first_seen_of(self.object, from_m, axis, &mut stack)
                    .map(|seen| seen.normal.dot(axis).abs())
            })
            .collect()
    }

    /// Both halves of the last round, and the number of its rays.
    fn rounds(
        &self,
        cosines: &[Option<f64>],
        settings: &TruthSettings,
        progress: &(dyn Fn(f64) + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<([Texels; 2], u64), ReferenceError> {
        let Some(rays_of_light) = &self.rays else {
            return Ok(([(); 2].map(|()| vec![[0.0; 6]; cosines.len()]), 0));
        };
        let size = rays_of_light.part.max_m - rays_of_light.part.min_m;
        let most = (settings.max_rays as f64 / (2.0 * size.element_product())).max(1e-6);
        let target = settings.target_error.unwrap_or(0.0);
        let mut points = match settings.target_error {
            Some(_) => FIRST_POINTS.min(most),
            None => most,
        };
        let mut first = true;
        loop {
            let planned = 2.0 * points * size.element_product();
            let counted = AtomicU64::new(0);
            let mut rays = 0;
            let both = halves(points, self.object as u64).map(|lattice| {
                let volley = rays_of_light.volley(lattice);
                let all = rows(&lattice, &rays_of_light.part).collect::<Vec<_>>();
                let per_point = lattice.area_per_point_m2();
                let sent = (&volley, &all[..], per_point);
                let texels = self.count(sent, cosines.len(), cancelled, &|more| {
                    let done = counted.fetch_add(more, Ordering::Relaxed) + more;
                    if !first || points >= most {
                        progress((done as f64 / planned).min(1.0));
                    }
                });
                rays = counted.load(Ordering::Relaxed);
                texels
            });
            if cancelled() {
                return Err(ReferenceError::Cancelled);
            }
            first = false;
            let [a, b] = [0, 1].map(|half: usize| self.irradiance(&both[half], cosines));
            let error = half_difference(&a, &b);
            if error <= target || points >= most {
                progress(1.0);
                return Ok((both, rays));
            }
            let growth = 1.1 * (error / target).powf(1.0 / ORDER);
            points = (points * growth.clamp(2.0, MOST_GROWTH)).min(most);
        }
    }

    /// Sends the rays of all rows, each of which stands for `per_point` units of (s, t).
    fn count(
        &self,
        (volley, all, per_point): (&Volley<'_>, &[Row], f64),
        texels: usize,
        cancelled: &(dyn Fn() -> bool + Sync),
        counted: &(dyn Fn(u64) + Sync),
    ) -> Texels {
        let bands: Vec<Texels> = (0..BANDS)
            .into_par_iter()
            .map(|band| {
                let mut sum = vec![[0.0; 6]; texels];
                let mut scratch = Scratch::default();
                for row in &all[all.len() * band / BANDS..all.len() * (band + 1) / BANDS] {
                    if cancelled() {
                        break;
                    }
                    volley.send(*row, &mut |ray| {
                        self.book(ray, per_point, &mut sum, &mut scratch);
                    });
                    counted(row.count);
                }
                sum
            })
            .collect();
        let mut total = vec![[0.0; 6]; texels];
        for band in &bands {
            for (sum, value) in total.iter_mut().zip(band) {
                add_to(sum, value);
            }
        }
        total
    }

    /// Counts a ray where it crosses the requested surface.
    fn book(&self, ray: &Ray, per_point: f64, sum: &mut Texels, scratch: &mut Scratch) {
        let occluders = &self.place.occluders;
        let Ray {
            from_m,
            to_m,
            path_m: whole_m,
            flux,
        } = *ray;
        let Scratch {
            stack,
            crossings,
            before_m,
        } = scratch;
        occluders.crossings(self.object, from_m, to_m, stack, crossings);
        let axis = self.grid.axis;
        let first = crossings.iter().find(|&&fraction| {
            let p_m = from_m.lerp(to_m, fraction);
            let same_m = self.same_surface_m;
            if self.layer == 0 {
                return !occluders.meets_object(self.object, p_m, -axis, same_m, stack);
            }
            let before =
                occluders.surfaces_beyond(self.object, (p_m, -axis), same_m, stack, before_m);
            before == self.layer as usize
        });
        let Some(&fraction) = first else { return };
        let p_m = from_m.lerp(to_m, fraction);
        let Some(texel) = self.grid.texel_at(p_m) else {
            return; // rounding: the map has a rim
        };
        if self.out_of_water(from_m, p_m) {
            return;
        }
        let path_m = whole_m * fraction;
        // The ray meets the surface itself there; anything slightly before that blocks it.
        let until = fraction - self.same_surface_m / whole_m;
        let before_m = from_m.lerp(to_m, until.max(0.0));
        let blocked = until > 0.0
            && (self.behind_floor(from_m, before_m)
                || occluders.blocks(from_m, before_m, None, 1.0, stack));
        let first_channel = if blocked { 3 } else { 0 };
        for c in 0..3 {
            sum[texel][first_channel + c] += flux
                * transmission(self.place.extinction_per_m[c], path_m)
                * per_point
                * self.light.power[c];
        }
    }

    /// Whether an upward ray has left the water before it reaches `p_m`: light that goes up from a light under water ends at the surface.
    fn out_of_water(&self, from_m: DVec3, p_m: DVec3) -> bool {
        p_m.y > from_m.y && self.place.over_water_m(p_m) > 0.0
    }

    /// Whether the segment between two points crosses the floor.
    fn behind_floor(&self, from_m: DVec3, to_m: DVec3) -> bool {
        let Some(floor) = &self.place.floor else {
            return false;
        };
        let fraction = (from_m.y - floor.y_m) / (from_m.y - to_m.y);
        (0.0..=1.0).contains(&fraction) && floor.spans(from_m.lerp(to_m, fraction))
    }

    /// W/m² on the surface of each texel: its flux over its projected area across the axis, times the cosine.
    fn irradiance(&self, sums: &Texels, cosines: &[Option<f64>]) -> Vec<[f64; 3]> {
        sums.iter()
            .zip(cosines)
            .map(|(sum, cosine)| {
                let per_m2 = self.grid.per_m2 * cosine.unwrap_or(0.0);
                [sum[0] * per_m2, sum[1] * per_m2, sum[2] * per_m2]
            })
            .collect()
    }
}

/// Scratch space, reused by all rays.
#[derive(Default)]
struct Scratch {
    stack: Vec<usize>,
    crossings: Vec<f64>,
    /// Distances of the surfaces in front of a point.
    before_m: Vec<f64>,
}
