//! Computes a map in rounds of finer and finer lattices until its error is small enough.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3};

use super::checks::{check_surface, check_water, point_lights, suns};
use super::floor::FloorMap;
use super::lamp::Lamp;
use super::lattice::{Lattice, SECOND_HALF, uniform};
use super::light::Source;
use super::occluders::Occluders;
use super::tally::Tally;
use super::trace::{Beam, Ground};
use super::window::{LightWindow, Target, window_of};
use super::{REFINEMENT, ReferenceError, ReferenceSettings};
use crate::scene::{ResolvedScene, Scene};
use crate::waves::Surface;

/// The error falls with the number of rays N as N to minus this power; measured 0.72 … 0.75 where light folds.
pub(super) const ORDER: f64 = 0.73;
/// Largest ratio of the rays of a round to those of the round before.
pub(super) const MOST_GROWTH: f64 = 16.0;

/// Share of the rays in the first half.
const FIRST_HALF: f64 = 0.515;
/// Where the light went, W per channel, all suns together. Each term is summed where it happens, none by subtraction.
///
/// emitted = reflected + absorbed + scattered + landed (floor and objects) + left_region + missed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnergyTerms {
    /// Arrives at the window of water.
    pub emitted_w: [f64; 3],
    /// Reflected at the surface.
    pub reflected_w: [f64; 3],
    /// Absorbed on the path to a receiver or to the floor's plane.
    pub absorbed_w: [f64; 3],
    /// Scattered on that path.
    pub scattered_w: [f64; 3],
    /// Arrives in the floor's plane outside the map or the floor.
    pub left_region_w: [f64; 3],
    /// Refracted upwards, or starts under the floor.
    pub missed_w: [f64; 3],
}

/// The truth for a map.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceMap {
    /// Texels along x.
    pub width: u32,
    /// Texels along z.
    pub height: u32,
    /// Irradiance per texel, W/m², row 0 at min z.
    pub irradiance: Vec<[f64; 3]>,
    /// Estimated relative L1 error of `irradiance`: ‖A − B‖₁ / ‖A + B‖₁ of two independent halves. Of seas and basins comes the error of
    /// their grids, which both halves share: where it was measured 1.5·10⁻⁴ with up to 1024 samples, 1.4·10⁻³ with 2048, if the
    /// shortest waves have four samples; 5·10⁻⁵ and 3·10⁻⁴ if they have 6.4.
    pub relative_error: f64,
    /// Rays in the map (both halves, all suns; those of earlier rounds not counted).
    pub rays: u64,
    /// Arrived on each receiver, W: the map on the floor first, then the objects in order. Of the light through the windows
    /// below, which hold all that can reach the map or an object.
    pub landed_w: Vec<[f64; 3]>,
    /// Where the rest of the light went.
    pub energy: EnergyTerms,
    /// The window of each light, first the suns, then the point lights, in world coordinates (for a point light under water, the
    /// rectangle of floor).
    pub windows: Vec<LightWindow>,
}

/// Counts the light on the floor of `resolved.scene`, whose output must be an irradiance map of it.
///
/// All suns above the horizon and all point lights count, or the one in `output.light`. Each texel holds Σ E·dA·(n·l)/n_y·T·e^(−(a+b)d) of the rays
/// that land in it, over its area; n·l below 0 counts as 0. The bits do not depend on the number of threads. `progress` is called with
/// the finished part, 0 … 1, from any thread, as far as it can be predicted; it goes back when another round is needed.
pub fn irradiance_map(
    resolved: &ResolvedScene,
    settings: &ReferenceSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<ReferenceMap, ReferenceError> {
    count(resolved, settings, progress, &|| false).map(|counted| counted.map)
}

/// A map, and the share of its light that meshes block.
pub(super) struct CountedMap {
    pub(super) map: ReferenceMap,
    /// Share per texel, 0 … 1; `None` without meshes.
    pub(super) shadow: Option<Vec<f64>>,
}

/// Like [`irradiance_map`], until `cancelled` returns true.
pub(super) fn count(
    resolved: &ResolvedScene,
    settings: &ReferenceSettings,
    progress: &(dyn Fn(f64) + Sync),
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<CountedMap, ReferenceError> {
    settings.check()?;
    let extinction_per_m = check_water(&resolved.scene.water)?;
    // Channels with the same extinction are counted once.
    let mut different = extinction_per_m.to_vec();
    different.dedup();
    match different[..] {
        [a] => Counter::new(resolved, [a], [0; 3])?.run(settings, progress, cancelled),
        [a, b] if extinction_per_m[0] == extinction_per_m[1] => {
            Counter::new(resolved, [a, b], [0, 0, 1])?.run(settings, progress, cancelled)
        }
        [a, b] => Counter::new(resolved, [a, b], [0, 1, 1])?.run(settings, progress, cancelled),
        _ => {
            Counter::new(resolved, extinction_per_m, [0, 1, 2])?.run(settings, progress, cancelled)
        }
    }
}

/// One light and its window.
struct CountedLight {
    source: Source,
    /// W/m² on a plane facing the sun, or W/sr of the point light.
    power: [f64; 3],
    window: LightWindow,
}

/// One round's result.
struct Round<const K: usize> {
    /// Per sun, the two halves added.
    tallies: Vec<Tally<K>>,
    irradiance: Vec<[f64; 3]>,
    relative_error: f64,
    rays: u64,
}

/// Everything that stays the same between rounds; `K` different extinction coefficients.
struct Counter<'a, const K: usize> {
    scene: &'a Scene,
    map: FloorMap,
    occluders: Occluders,
    surface: Surface,
    suns: Vec<CountedLight>,
    extinction_per_m: [f64; K],
    /// Which coefficient each channel has.
    coefficient_of: [usize; 3],
}

impl<'a, const K: usize> Counter<'a, K> {
    fn new(
        resolved: &'a ResolvedScene,
        extinction_per_m: [f64; K],
        coefficient_of: [usize; 3],
    ) -> Result<Self, ReferenceError> {
        let scene = &resolved.scene;
        let map = FloorMap::of(scene)?;
        let occluders = Occluders::of(resolved, map.origin_m)?;
        let surface = Surface::refined(resolved, REFINEMENT)?.recentred(map.origin_m);
        check_surface(&surface)?;
        let size_m = map.size_m();
        let mut targets = vec![Target {
            min_m: DVec3::new(0.0, -map.depth_m, 0.0),
            max_m: DVec3::new(size_m.x, -map.depth_m, size_m.y),
        }];
        targets.extend(occluders.bounds.iter().copied());
        let corner_m = DVec3::new(map.origin_m.x, scene.water.level_m, map.origin_m.y);
        let suns = suns(scene)?.into_iter();
        let suns = suns.map(|sun| (Source::of_sun(sun), sun.irradiance_w_m2));
        let lamps = point_lights(scene)?.into_iter().map(|lamp| {
            let source = Source::of_lamp(lamp, corner_m, &surface);
            (source, lamp.intensity_w_sr)
        });
        let ior = scene.water.ior;
        let suns = suns
            .chain(lamps)
            .map(|(source, power)| CountedLight {
                source,
                power,
                window: match source {
                    Source::Sun { to_light } => window_of(&surface, to_light, ior, &targets),
                    Source::Lamp {
                        position_m,
                        submerged,
                    } => Lamp::new(&surface, position_m, submerged, ior).window(&targets),
                },
            })
            .collect();
        Ok(Self {
            scene,
            map,
            occluders,
            surface,
            suns,
            extinction_per_m,
            coefficient_of,
        })
    }

    /// Texels' worth of water in all windows.
    fn texels_of_water(&self) -> f64 {
        let windows = self.suns.iter().map(|sun| &sun.window);
        windows.map(|window| self.texels_in(window)).sum()
    }

    fn texels_in(&self, window: &LightWindow) -> f64 {
        let texel_m2 = self.map.texel_m.x * self.map.texel_m.y;
        (window.max_m - window.min_m).element_product() / texel_m2
    }

    fn run(
        &self,
        settings: &ReferenceSettings,
        progress: &(dyn Fn(f64) + Sync),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<CountedMap, ReferenceError> {
        let most = settings.max_rays as f64;
        let target = settings.target_error.unwrap_or(0.0);
        let mut rays = match settings.target_error {
            Some(_) => (settings.initial_rays as f64).min(most),
            None => most,
        };
        let counted = AtomicU64::new(0);
        let mut first = true;
        loop {
            let planned = counted.load(Ordering::Relaxed) as f64 + rays;
            let round = self.round(rays, cancelled, &|more| {
                let done = counted.fetch_add(more, Ordering::Relaxed) + more;
                // Until the first error is known, the amount of work cannot be predicted.
                if !first || rays >= most {
                    progress((done as f64 / planned).min(1.0));
                }
            });
            first = false;
            if cancelled() {
                return Err(ReferenceError::Cancelled);
            }
            if round.relative_error <= target || rays >= most {
                progress(1.0);
                return Ok(CountedMap {
                    shadow: self.shadow(&round),
                    map: self.finish(round),
                });
            }
            let growth = 1.1 * (round.relative_error / target).powf(1.0 / ORDER);
            rays = (rays * growth.clamp(2.0, MOST_GROWTH)).min(most);
        }
    }

    /// Two halves with different lattices and independent shifts, about `rays` rays together.
    fn round(
        &self,
        rays: f64,
        cancelled: &(dyn Fn() -> bool + Sync),
        counted: &(dyn Fn(u64) + Sync),
    ) -> Round<K> {
        let per_texel = rays / self.texels_of_water().max(f64::MIN_POSITIVE);
        let mut halves = [
            vec![[0.0; 3]; self.map.len()],
            vec![[0.0; 3]; self.map.len()],
        ];
        let mut tallies = Vec::new();
        for (index, sun) in self.suns.iter().enumerate() {
            let ground = Ground {
                map: &self.map,
                occluders: &self.occluders,
                extinction_per_m: self.extinction_per_m,
            };
            let ior = self.scene.water.ior;
            let mut both: Option<Tally<K>> = None;
            let mut points_per_texel = per_texel * FIRST_HALF;
            for (half, irradiance) in halves.iter_mut().enumerate() {
                let key = (index * 2 + half) as u64 * 2;
                let shift = DVec2::new(uniform(key), uniform(key + 1));
                // All rays of a point light lie in one cell, see `lamp`.
                let (cell_m, texels) = match sun.source {
                    Source::Sun { .. } => (self.map.texel_m, 1.0),
                    Source::Lamp { .. } => (DVec2::ONE, self.texels_in(&sun.window)),
                };
                let points = points_per_texel * texels;
                let lattice = Lattice::new(points, cell_m, shift, half == 1);
                points_per_texel = SECOND_HALF * lattice.points_per_texel(cell_m) / texels;
                let tally = match sun.source {
                    Source::Sun { to_light } => Beam {
                        ground,
                        surface: &self.surface,
                        to_light,
                        ior,
                        window: sun.window,
                    }
                    .trace(&lattice, counted, cancelled),
                    Source::Lamp {
                        position_m,
                        submerged,
                    } => Lamp::new(&self.surface, position_m, submerged, ior).trace(
                        &ground,
                        &sun.window,
                        &lattice,
                        counted,
                        cancelled,
                    ),
                };
                self.add_irradiance(&tally, sun, irradiance);
                match &mut both {
                    Some(both) => both.add(&tally),
                    None => both = Some(tally),
                }
            }
            tallies.extend(both);
        }
        let [a, b] = halves;
        Round {
            relative_error: half_difference(&a, &b),
            irradiance: mean(&a, &b),
            rays: tallies.iter().map(|t| t.rays).sum(),
            tallies,
        }
    }

    fn add_irradiance(&self, tally: &Tally<K>, sun: &CountedLight, irradiance: &mut [[f64; 3]]) {
        let per_texel = 1.0 / (self.map.texel_m.x * self.map.texel_m.y);
        for (sum, counted) in irradiance.iter_mut().zip(&tally.texels) {
            for c in 0..3 {
                sum[c] += counted[self.coefficient_of[c]] * per_texel * sun.power[c];
            }
        }
    }

    /// Share of the light that meshes block, per texel, over all suns and channels.
    fn shadow(&self, round: &Round<K>) -> Option<Vec<f64>> {
        if self.occluders.is_empty() {
            return None;
        }
        let mut blocked_landed = vec![[0.0; 2]; self.map.len()];
        for (tally, sun) in round.tallies.iter().zip(&self.suns) {
            let weighed = |values: &[f64; K]| -> f64 {
                (0..3)
                    .map(|c| values[self.coefficient_of[c]] * sun.power[c])
                    .sum()
            };
            for (sum, (blocked, landed)) in blocked_landed
                .iter_mut()
                .zip(tally.shaded.iter().zip(&tally.texels))
            {
                sum[0] += weighed(blocked);
                sum[1] += weighed(landed);
            }
        }
        Some(
            blocked_landed
                .into_iter()
                .map(|[blocked, landed]| share(blocked, landed))
                .collect(),
        )
    }

    fn finish(&self, round: Round<K>) -> ReferenceMap {
        let water = &self.scene.water;
        let mut landed_w = vec![[0.0; 3]; 1 + self.occluders.bounds.len()];
        let mut energy = EnergyTerms::default();
        for (tally, sun) in round.tallies.iter().zip(&self.suns) {
            let on_map = tally.texels.iter().fold([0.0; K], |mut sum, texel| {
                super::tally::add_to(&mut sum, texel);
                sum
            });
            for c in 0..3 {
                let k = self.coefficient_of[c];
                // Both halves hold the whole window: each counts half.
                let w = 0.5 * sun.power[c];
                let absorbed_part = if self.extinction_per_m[k] > 0.0 {
                    water.absorption_per_m[c] / self.extinction_per_m[k]
                } else {
                    0.0
                };
                landed_w[0][c] += on_map[k] * w;
                for (landed, object) in landed_w[1..].iter_mut().zip(&tally.objects) {
                    landed[c] += object[k] * w;
                }
                energy.emitted_w[c] += tally.emitted * w;
                energy.reflected_w[c] += tally.reflected * w;
                energy.absorbed_w[c] += tally.lost[k] * w * absorbed_part;
                energy.scattered_w[c] += tally.lost[k] * w * (1.0 - absorbed_part);
                energy.left_region_w[c] += tally.left[k] * w;
                energy.missed_w[c] += tally.missed * w;
            }
        }
        ReferenceMap {
            width: self.map.width as u32,
            height: self.map.height as u32,
            irradiance: round.irradiance,
            relative_error: round.relative_error,
            rays: round.rays,
            landed_w,
            energy,
            windows: self
                .suns
                .iter()
                .map(|sun| LightWindow {
                    min_m: sun.window.min_m + self.map.origin_m,
                    max_m: sun.window.max_m + self.map.origin_m,
                })
                .collect(),
        }
    }
}

/// blocked / (blocked + landed); 0 where there is no light either way.
pub(super) fn share(blocked: f64, landed: f64) -> f64 {
    if blocked > 0.0 {
        blocked / (blocked + landed)
    } else {
        0.0
    }
}

/// ‖A − B‖₁ / ‖A + B‖₁; 0 when both are black.
pub(super) fn half_difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let (mut difference, mut total) = (0.0, 0.0);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        difference += (a - b).abs();
        total += a + b;
    }
    if total > 0.0 { difference / total } else { 0.0 }
}

pub(super) fn mean(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter()
        .zip(b)
        .map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c])))
        .collect()
}
