//! The light at the points that a camera sees.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::camera::{Picture, ViewPoint, Viewer};
use super::light::Source;
use super::map::{MOST_GROWTH, ORDER, half_difference, mean, share};
use super::patch::{Landed, Patch, Search};
use super::place::Place;
use super::shine::shine;
use super::tally::add_to;
use super::{ReferenceError, Truth, TruthKind, TruthSettings};
use crate::physics::attenuation::transmission;
use crate::scene::{Output, ResolvedScene};

/// Rays per footprint of evenly lit water in the first round, each half.
const FIRST_POINTS: f64 = 64.0;
/// Like the above, where only the share of shadow is requested: in full light and in full shadow one ray is as good as many.
const SHADOW_POINTS: f64 = 16.0;
/// Distance within which a surface in the air does not shade itself, m.
const OWN_M: f64 = 1e-7;

/// Which pixels are sampled: every `step`th from `first` on, `size` of them along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PixelGrid {
    first: [u32; 2],
    step: u32,
    size: [u32; 2],
}

impl PixelGrid {
    /// The finest of at most `most` pixels.
    fn of(width: u32, height: u32, most: u32) -> Self {
        let mut step = 1;
        loop {
            let first = [width, height].map(|n| (step - 1).min(n - 1) / 2);
            let size = [
                (width - first[0]).div_ceil(step),
                (height - first[1]).div_ceil(step),
            ];
            if u64::from(size[0]) * u64::from(size[1]) <= u64::from(most) {
                return Self { first, step, size };
            }
            step += 1;
        }
    }

    fn pixels(self) -> impl Iterator<Item = [u32; 2]> {
        let Self { first, step, size } = self;
        (0..size[1]).flat_map(move |j| {
            (0..size[0]).map(move |i| [first[0] + i * step, first[1] + j * step])
        })
    }
}

/// A point and the light on it that is known without tracing rays.
struct Lit {
    point: ViewPoint,
    patch: Patch,
    /// From skies and, in the air, from all lights, W/m².
    known: [f64; 3],
    /// At a dry point: light that meshes block.
    blocked: [f64; 3],
}

/// One round: two halves per point, and the number of rays.
type Counted = ([Landed; 2], u64);

/// The truth at the points that the camera of `resolved` sees.
pub(super) fn view(
    resolved: &ResolvedScene,
    settings: &TruthSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Truth, ReferenceError> {
    let Output::View(output) = &resolved.scene.output else {
        return Err(ReferenceError::NoCamera);
    };
    let picture = Picture::of(resolved)?;
    let place = Place::of(resolved, picture.middle_m())?;
    let grid = PixelGrid::of(
        output.width.max(1),
        output.height.max(1),
        settings.most_points,
    );
    let mut viewer = Viewer::of(&place, &picture);
    let mut points = Vec::new();
    for pixel in grid.pixels() {
        points.push(viewer.point(pixel).map(|point| lit(&place, point)));
        if cancelled() {
            return Err(ReferenceError::Cancelled);
        }
    }
    let counted = rounds(&place, &points, settings, progress, cancelled)?;
    let [a, b] = irradiance_halves(&points, &counted);
    Ok(Truth {
        kind: TruthKind::View,
        width: grid.size[0],
        height: grid.size[1],
        first_pixel: grid.first,
        pixel_step: grid.step,
        irradiance: mean(&a, &b),
        compared: points.iter().map(Option::is_some).collect(),
        relative_error: half_difference(&a, &b),
        rays: counted.iter().map(|(_, rays)| rays).sum(),
        shadow: (!place.occluders.is_empty()).then(|| {
            points
                .iter()
                .zip(&counted)
                .map(|(p, c)| p.as_ref().map_or(0.0, |lit| shadow(&place, lit, c)))
                .collect()
        }),
        seconds: 0.0,
        from_disk: false,
    })
}

/// The radiance at the pixels of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct RadianceTruth {
    /// Pixels along x.
    pub width: u32,
    /// Pixels along y.
    pub height: u32,
    /// The pixel of the first value.
    pub first_pixel: [u32; 2],
    /// Pixels from one value to the next along both axes.
    pub pixel_step: u32,
    /// W/(m² sr), row by row.
    pub radiance: Vec<[f64; 3]>,
    /// Estimated relative L1 error of `radiance`, from two independent halves.
    pub relative_error: f64,
    /// Rays of light counted.
    pub rays: u64,
}

/// The radiance that the camera of `resolved` sees through the middle of each pixel: every way of its ray that meets the water at most
/// `quality.bounces` times (at least once) is followed to its end.
///
/// # Errors
/// As [`truth`](super::truth).
pub fn radiance(
    resolved: &ResolvedScene,
    settings: &TruthSettings,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<RadianceTruth, ReferenceError> {
    settings.check()?;
    let Output::View(output) = &resolved.scene.output else {
        return Err(ReferenceError::NoCamera);
    };
    let picture = Picture::of(resolved)?;
    let place = Place::of(resolved, picture.middle_m())?;
    let grid = PixelGrid::of(
        output.width.max(1),
        output.height.max(1),
        settings.most_points,
    );
    let bounces = resolved.scene.quality.bounces.max(1);
    let mut viewer = Viewer::of(&place, &picture);
    let mut legs = Vec::new();
    for (index, pixel) in grid.pixels().enumerate() {
        let of_pixel = viewer.legs(pixel, bounces).into_iter();
        legs.extend(of_pixel.map(|leg| (index, leg)));
        if cancelled() {
            return Err(ReferenceError::Cancelled);
        }
    }
    let points: Vec<Option<Lit>> = legs
        .iter()
        .map(|(_, leg)| leg.end.map(|point| lit(&place, point)))
        .collect();
    let counted = rounds(&place, &points, settings, &|_| {}, cancelled)?;
    let halves = irradiance_halves(&points, &counted).map(|irradiance| {
        let mut pixels = vec![[0.0; 3]; grid.size[0] as usize * grid.size[1] as usize];
        for ((pixel, leg), irradiance) in legs.iter().zip(&irradiance) {
            for c in 0..3 {
                let radiance = match &leg.end {
                    Some(point) => point.albedo[c] * irradiance[c] / PI,
                    None => place.sky.radiance[c],
                };
                let left = transmission(place.extinction_per_m[c], leg.wet_m);
                pixels[*pixel][c] += leg.weight * left * radiance;
            }
        }
        pixels
    });
    Ok(RadianceTruth {
        width: grid.size[0],
        height: grid.size[1],
        first_pixel: grid.first,
        pixel_step: grid.step,
        radiance: mean(&halves[0], &halves[1]),
        relative_error: half_difference(&halves[0], &halves[1]),
        rays: counted.iter().map(|(_, rays)| rays).sum(),
    })
}

/// Share of shadow, 0 … 1, at some pixels; `None` where a pixel shows nothing.
pub(super) fn shadows(
    resolved: &ResolvedScene,
    pixels: &[[u32; 2]],
) -> Result<Vec<Option<f64>>, ReferenceError> {
    let picture = Picture::of(resolved)?;
    let place = Place::of(resolved, picture.middle_m())?;
    let viewer = Viewer::of(&place, &picture);
    let points: Vec<Option<Lit>> = pixels
        .par_iter()
        .map_init(
            || viewer.clone(),
            |viewer, &pixel| viewer.point(pixel).map(|point| lit(&place, point)),
        )
        .collect();
    let counted = round(&place, &points, SHADOW_POINTS, &|| false, &|_| {});
    Ok(points
        .iter()
        .zip(&counted)
        .map(|(lit, counted)| lit.as_ref().map(|lit| shadow(&place, lit, counted)))
        .collect())
}

/// Share of the light of suns and point lights on a point that meshes block.
fn shadow(place: &Place, lit: &Lit, (halves, _): &Counted) -> f64 {
    if lit.point.dry {
        // The known light of a dry point includes skies, so the light of the other lights alone is computed again.
        let open = lights_in_air(place, &lit.point).lit;
        return share(lit.blocked.iter().sum(), open.iter().sum());
    }
    let mut both = halves[0];
    both.add(&halves[1]);
    share(both.blocked.iter().sum(), both.lit.iter().sum())
}

fn lit(place: &Place, point: ViewPoint) -> Lit {
    let mut known = place.sky_w_m2(point.position_m, point.normal, point.dry);
    let mut blocked = [0.0; 3];
    if point.dry {
        let lights = lights_in_air(place, &point);
        blocked = lights.blocked;
        add_to(&mut known, &lights.lit);
    }
    Lit {
        point,
        patch: Patch::new(point.position_m, point.normal, point.side_m, point.object),
        known,
        blocked,
    }
}

/// Suns and point lights above the water on a point above it, with exact shadows.
fn lights_in_air(place: &Place, point: &ViewPoint) -> Landed {
    let mut sum = Landed::default();
    let mut stack = Vec::new();
    for light in &place.lights {
        if matches!(
            light.source,
            Source::Lamp {
                submerged: true,
                ..
            }
        ) {
            continue;
        }
        let (to_light, distance_m) = light.toward(point.position_m);
        let cosine = point.normal.dot(to_light);
        if cosine.is_nan() || cosine <= 0.0 {
            continue;
        }
        let from_m: DVec3 = point.position_m + to_light * OWN_M;
        let until_m = distance_m.min(f64::MAX);
        let blocker = place
            .occluders
            .first_seen(from_m, to_light, until_m, &mut stack);
        let target = if blocker.is_some() {
            &mut sum.blocked
        } else {
            &mut sum.lit
        };
        let facing = cosine * light.facing_w_m2(distance_m);
        add_to(target, &light.power.map(|e| e * facing));
    }
    sum
}

/// Traces all points with an increasing number of rays until the error is small enough.
fn rounds(
    place: &Place,
    points: &[Option<Lit>],
    settings: &TruthSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Counted>, ReferenceError> {
    let most = settings.max_rays as f64;
    let target = settings.target_error.unwrap_or(0.0);
    let mut per_patch = FIRST_POINTS;
    let mut last = false;
    // In points times rays per footprint, before and after the coming round.
    let mut work = 0.0;
    loop {
        let planned = work + per_patch;
        let counted = round(place, points, per_patch, cancelled, &|part| {
            if last {
                progress(((work + part * per_patch) / planned).min(1.0));
            }
        });
        if cancelled() {
            return Err(ReferenceError::Cancelled);
        }
        let [a, b] = irradiance_halves(points, &counted);
        let error = half_difference(&a, &b);
        let rays: u64 = counted.iter().map(|(_, rays)| rays).sum();
        if error <= target || last || rays == 0 {
            progress(1.0);
            return Ok(counted);
        }
        work += per_patch;
        let room = most / rays as f64;
        let wanted = 1.1 * (error / target).powf(1.0 / ORDER);
        let growth = if target > 0.0 {
            wanted.clamp(2.0, MOST_GROWTH)
        } else {
            room
        };
        if room <= 1.5 {
            progress(1.0);
            return Ok(counted);
        }
        last = growth >= room;
        per_patch *= growth.min(room);
    }
}

/// Counts every point once, about `per_patch` rays per evenly lit footprint and half.
fn round(
    place: &Place,
    points: &[Option<Lit>],
    per_patch: f64,
    cancelled: &(dyn Fn() -> bool + Sync),
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Counted> {
    let done = AtomicU64::new(0);
    let indexed = points.par_iter().enumerate();
    indexed
        .map(|(index, lit)| {
            let result = match lit {
                Some(lit) if !lit.point.dry && !cancelled() => {
                    count_point(place, &lit.patch, per_patch, index)
                }
                _ => Counted::default(),
            };
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(done as f64 / points.len() as f64);
            result
        })
        .collect()
}

/// All lights through the water and under it on one square.
fn count_point(place: &Place, patch: &Patch, per_patch: f64, index: usize) -> Counted {
    let mut sum = Counted::default();
    let mut stack = Vec::new();
    for (nth, light) in place.lights.iter().enumerate() {
        let key = (index * place.lights.len() + nth) as u64;
        let (halves, rays) = if let Source::Lamp {
            position_m,
            submerged: true,
        } = light.source
        {
            shine(
                place,
                light,
                position_m,
                patch,
                (per_patch, key),
                &mut stack,
            )
        } else if let Some(search) = Search::new(place, light, patch) {
            search.light(per_patch, key, &mut stack)
        } else {
            continue;
        };
        for (sum, half) in sum.0.iter_mut().zip(&halves) {
            sum.add(half);
        }
        sum.1 += rays;
    }
    sum
}

/// Irradiance per point of each half; 0 where the pixel shows nothing.
fn irradiance_halves(points: &[Option<Lit>], counted: &[Counted]) -> [Vec<[f64; 3]>; 2] {
    [0, 1].map(|half: usize| {
        points
            .iter()
            .zip(counted)
            .map(|(lit, (halves, _))| match lit {
                Some(lit) => std::array::from_fn(|c| lit.known[c] + halves[half].lit[c]),
                None => [0.0; 3],
            })
            .collect()
    })
}
