//! Converts results read from the GPU to layers, energy accounts and warnings.

use std::collections::BTreeMap;

use glam::DVec3;

use super::RenderError;
use crate::accuracy::estimate::{Compared, FrameComparison, estimate_error};
use crate::facts::placement::LevelMapKey;
use crate::facts::unfollowed;
use crate::facts::warnings::{SCATTERING_NOT_FOLLOWED, WAVES_UNDERSAMPLED};
use crate::facts::{FieldKey, SceneFacts};
use crate::frame::{FAR_DEPTH_M, Layer};
use crate::plan;
use crate::scene::{LayerName, Receiver};
use crate::stages::camera_hits::{
    CUT_OFF, MARCH_UNFINISHED, OUTSIDE_MAP, VISIBLE_ALBEDO, VISIBLE_DEPTH,
};
use crate::stages::maps::MapLayout;
use crate::stages::points::{POINT_IRRADIANCE, POINTS};
use crate::stages::shade::RADIANCE;
use crate::stages::sums::ENERGY_TERMS;
use crate::stages::water_map::WATER_MAP;
use crate::stages::{Slot, estimate, light, term};
use crate::stats::{EnergyAccount, FieldStats, PlaneStats, Warning};

/// Bytes of one light's energy account.
pub(super) const ACCOUNT_BYTES: u64 = 8 * ENERGY_TERMS;

/// Widest step of single precision that world positions may have without a warning, m.
const COARSE_STEP_M: f32 = 1e-3;

/// Largest closure at which a method counts as conserving energy.
const CLOSED: f64 = 1e-5;

/// The accounts of all lights, from the raw sums of their beam sets, and the warnings that follow from them.
pub(super) fn energy(facts: &SceneFacts, raw: &[u64]) -> (Vec<EnergyAccount>, Vec<Warning>) {
    let mut of_lights: Vec<Option<LightSums>> = vec![None; facts.lights.lit.len()];
    let of_sets = raw.chunks_exact(ENERGY_TERMS as usize);
    for (index, (set, terms)) in facts.lights.beam_sets.iter().zip(of_sets).enumerate() {
        let sums = of_lights[set.light].get_or_insert_with(|| LightSums::new(set.light_index));
        sums.add(facts, index, terms);
    }
    let mut accounts = Vec::new();
    let mut warnings = Vec::new();
    for mut sums in of_lights.into_iter().flatten() {
        sums.account.closure = closure(&sums.account);
        warnings.extend(not_conserved(facts, &sums.account));
        warnings.extend(unresolved(facts, &sums));
        warnings.extend(not_followed(&sums));
        accounts.push(sums.account);
    }
    (accounts, warnings)
}

/// Sums over the beam sets of a light.
#[derive(Clone)]
struct LightSums {
    account: EnergyAccount,
    /// Each term for a light of unit power.
    unit: [f64; ENERGY_TERMS as usize],
    /// Each term that is the same in all channels, W.
    grey_w: [[f64; 3]; ENERGY_TERMS as usize],
    /// Number of unresolved pieces: parts of beams that straddle receivers after the last halving.
    unresolved: u64,
}

impl LightSums {
    fn new(light: u32) -> Self {
        Self {
            account: EnergyAccount {
                light,
                ..EnergyAccount::default()
            },
            unit: [0.0; ENERGY_TERMS as usize],
            grey_w: [[0.0; 3]; ENERGY_TERMS as usize],
            unresolved: 0,
        }
    }

    /// Adds the raw sums of beam set number `index`.
    fn add(&mut self, facts: &SceneFacts, index: usize, terms: &[u64]) {
        let set = &facts.lights.beam_sets[index];
        let per_count = 1.0 / light::energy_scale(facts, index);
        let grey = |t: usize| set.power.map(|p| terms[t] as f64 * per_count * p);
        let spectral = |t: usize| -> [f64; 3] {
            std::array::from_fn(|c| {
                let channel = if facts.channels() == 1 { 0 } else { c };
                terms[t + channel] as f64 * per_count * set.power[c]
            })
        };
        let lost = spectral(term::EXTINGUISHED);
        let absorbed_share: [f64; 3] = std::array::from_fn(|c| {
            let extinction = set.band.extinction_per_m[c];
            if extinction > 0.0 {
                set.band.absorption_per_m[c] / extinction
            } else {
                1.0
            }
        });
        let account = &mut self.account;
        for c in 0..3 {
            account.emitted_w[c] += grey(term::EMITTED)[c];
            account.landed_w[c] += spectral(term::LANDED)[c];
            account.absorbed_w[c] += lost[c] * absorbed_share[c];
            account.scattered_w[c] += lost[c] * (1.0 - absorbed_share[c]);
            account.reflected_w[c] += grey(term::REFLECTED)[c];
            account.left_region_w[c] += spectral(term::LEFT)[c];
            account.missed_w[c] += grey(term::MISSED)[c];
        }
        for (t, count) in terms.iter().enumerate() {
            self.unit[t] += *count as f64 * per_count;
            for (sum, w) in self.grey_w[t].iter_mut().zip(grey(t)) {
                *sum += w;
            }
        }
        self.unresolved += terms[term::UNRESOLVED_COUNT];
    }

    /// A term as a share of the emitted flux, percent.
    fn percent(&self, term: usize) -> f64 {
        if self.unit[term::EMITTED] > 0.0 {
            100.0 * self.unit[term] / self.unit[term::EMITTED]
        } else {
            0.0
        }
    }
}

/// Warnings about light on paths that are not simulated.
fn not_followed(sums: &LightSums) -> Vec<Warning> {
    let light = sums.account.light;
    let measured = |term: usize, warning: Warning| {
        (sums.unit[term] > 0.0).then(|| Warning {
            flux_w: Some(sums.grey_w[term]),
            pointer: Some(format!("/lights/{light}")),
            ..warning
        })
    };
    let facing_away = measured(term::FACING_AWAY, unfollowed::waves_shade_waves(light));
    let leaving_again = measured(
        term::LEAVING_AGAIN,
        Warning::new(
            "light_leaves_water_again",
            format!(
                "{:.3} % of the flux of light {light} meets steep waves a second time; it is traced as if it stayed under water",
                sums.percent(term::LEAVING_AGAIN)
            ),
        ),
    );
    let bared_floor = measured(
        term::BARED_FLOOR,
        Warning::new(
            "waves_bare_floor",
            format!(
                "{:.3} % of the flux of light {light} enters where troughs lie below the floor; it lands on the floor refracted, with a path length of 0 under water",
                sums.percent(term::BARED_FLOOR)
            ),
        ),
    );
    [facing_away, leaving_again, bared_floor]
        .into_iter()
        .flatten()
        .collect()
}

/// The warning about a light whose flux was summed again.
pub(super) fn widened(light: u32) -> Warning {
    Warning {
        pointer: Some(format!("/lights/{light}")),
        ..Warning::new(
            "sums_done_again",
            format!(
                "light {light} is so concentrated that 32-bit sums of its flux overflowed; it was traced again with 64-bit sums, which takes longer and loses nothing"
            ),
        )
    }
}

/// Adds the warnings that a frame measured to those known before it. If the frame measured the light, the prediction that waves shade
/// waves is dropped, because the measured warning replaces it or shows that there was none.
pub(super) fn join_warnings(known: &mut Vec<Warning>, measured: Vec<Warning>, was_measured: bool) {
    if was_measured {
        known.retain(|warning| warning.code != unfollowed::WAVES_SHADE_WAVES);
    }
    known.extend(measured);
}

/// Adds the measured flux to warnings that were found before rendering.
pub(super) fn add_flux_to_warnings(
    warnings: &mut [Warning],
    facts: &SceneFacts,
    energy: &[EnergyAccount],
) {
    let sum_w = |of: &dyn Fn(&EnergyAccount) -> Option<[f64; 3]>| {
        let each = energy.iter().filter_map(of);
        each.fold([0.0; 3], |sum, flux_w| {
            std::array::from_fn(|c| sum[c] + flux_w[c])
        })
    };
    let undersampled = |account: &EnergyAccount| {
        let mut lights = facts.lights.beam_sets.iter();
        let light = lights.find(|set| set.light_index == account.light)?;
        facts.is_undersampled(light).then_some(account.emitted_w)
    };
    for warning in warnings {
        warning.flux_w = match warning.code.as_str() {
            SCATTERING_NOT_FOLLOWED => Some(sum_w(&|account| Some(account.scattered_w))),
            WAVES_UNDERSAMPLED => Some(sum_w(&undersampled)),
            _ => continue,
        };
    }
}

/// Statistics of reference planes, from the counts of each light and object.
pub(super) fn planes(facts: &SceneFacts, counts: &[Vec<[u32; 4]>]) -> Vec<PlaneStats> {
    let cells = facts.quality.water_cells;
    let mut all = Vec::new();
    for (light, counts) in facts.lights.beam_sets.iter().zip(counts) {
        for (object, (level_box, &[kept, used, sub_boxes, _])) in
            facts.lights.boxes_of(light).iter().zip(counts).enumerate()
        {
            if level_box.is_some() {
                all.push(PlaneStats {
                    light: light.light_index,
                    object: object as u32,
                    specified: facts.planes_of(object),
                    used,
                    sub_boxes,
                    beams: 2 * cells * cells,
                    beams_kept: kept,
                });
            }
        }
    }
    all
}

/// Statistics of the kept fields, from the raw accounts of the slices of each beam set.
pub(super) fn fields(
    facts: &SceneFacts,
    accounts: &[Vec<u64>],
    built: &[FieldKey],
) -> Vec<FieldStats> {
    let Some(field) = &facts.field else {
        return Vec::new();
    };
    let world = |at: DVec3| (at + facts.origin_m).to_array();
    let sets = facts.lights.beam_sets.iter().zip(accounts).enumerate();
    sets.map(|(index, (set, accounts))| {
        let mut closure_of_all = 0.0_f64;
        let mut through_w = Vec::new();
        for terms in accounts.chunks_exact(ENERGY_TERMS as usize) {
            let mut sums = LightSums::new(set.light_index);
            sums.add(facts, index, terms);
            closure_of_all = closure_of_all.max(closure(&sums.account));
            through_w.push(sums.account.landed_w);
        }
        let [low, high] = [field.rect.min, field.rect.max];
        FieldStats {
            light: set.light_index,
            slices: field.slices,
            width: field.width,
            height: field.height,
            min_m: world(DVec3::new(low.x, field.bottom_m, low.y)),
            max_m: world(DVec3::new(high.x, field.top_m, high.y)),
            bytes: set.field.as_ref().map_or(0, |key| key.bytes),
            was_kept: set.field.as_ref().is_some_and(|key| !built.contains(key)),
            closure: closure_of_all,
            through_w,
        }
    })
    .collect()
}

/// The warning that a method does not conserve energy: the difference between the landed flux and the flux that the rays carry.
fn not_conserved(facts: &SceneFacts, account: &EnergyAccount) -> Option<Warning> {
    let lands_as_taken = facts.method.conserves_energy || facts.wet_objects().next().is_none();
    if lands_as_taken || account.closure <= CLOSED {
        return None;
    }
    let surplus_w: [f64; 3] =
        std::array::from_fn(|c| accounted_w(account, c) - account.emitted_w[c]);
    let mut message = format!(
        "method {} does not conserve energy: the flux on the objects differs from the flux of their rays by {:.3} % of the flux of light {}",
        facts.method.name,
        100.0 * account.closure,
        account.light
    );
    if facts.method.has_scratch_map && facts.attenuates() {
        message.push_str("; light absorbed along the path to them is part of that");
    }
    Some(Warning {
        flux_w: Some(surplus_w),
        ..Warning::new("method_does_not_conserve", message)
    })
}

/// The warning about unresolved pieces, or about photons that end out of the light's view.
fn unresolved(facts: &SceneFacts, sums: &LightSums) -> Option<Warning> {
    if sums.unresolved == 0 {
        return None;
    }
    let light = sums.account.light;
    if facts.method.lands_in_view {
        let message = format!(
            "{} rays of light {light} with {:.3} % of its flux end where the view from the light shows no surface: they are hidden from it, or the search did not find their end; their light falls on the surface shown there",
            sums.unresolved,
            sums.percent(term::UNRESOLVED),
        );
        return Some(Warning {
            flux_w: Some(sums.grey_w[term::UNRESOLVED]),
            ..Warning::new("rays_end_out_of_view", message)
        });
    }
    let mut message = format!(
        "{} pieces of beams of light {light} with {:.3} % of its flux still straddle receivers after quality.split_levels halvings; the receiver at each corner gets a third of the piece",
        sums.unresolved,
        sums.percent(term::UNRESOLVED),
    );
    if sums.unit[term::CUT] > 0.0 {
        let cut = format!(
            "; {:.3} % of the flux was halved fewer times, because the queue was full: fewer quality.split_levels with more quality.water_cells have the same effect",
            sums.percent(term::CUT)
        );
        message.push_str(&cut);
    }
    Some(Warning {
        flux_w: Some(sums.grey_w[term::UNRESOLVED]),
        ..Warning::new("beams_unresolved", message)
    })
}

/// Flux of a light of unit power that is missing in its raw account; the largest of the channels.
pub(super) fn missing_flux(facts: &SceneFacts, index: usize, terms: &[u64]) -> f64 {
    let grey =
        terms[term::EMITTED] as f64 - terms[term::REFLECTED] as f64 - terms[term::MISSED] as f64;
    let missing = (0..facts.channels() as usize)
        .map(|c| {
            grey - [term::EXTINGUISHED, term::LEFT, term::LANDED]
                .map(|t| terms[t + c] as f64)
                .iter()
                .sum::<f64>()
        })
        .fold(f64::MIN, f64::max);
    missing / light::energy_scale(facts, index)
}

/// Whether the account of a light shows that its narrow sums wrapped.
pub(super) fn has_wrapped(facts: &SceneFacts, index: usize, account: &[u64]) -> bool {
    light::has_wrapped(facts, index, missing_flux(facts, index, account))
}

/// Sum of all terms of a channel except the emitted flux, W.
fn accounted_w(account: &EnergyAccount, c: usize) -> f64 {
    account.landed_w[c]
        + account.absorbed_w[c]
        + account.scattered_w[c]
        + account.reflected_w[c]
        + account.left_region_w[c]
        + account.missed_w[c]
}

fn closure(account: &EnergyAccount) -> f64 {
    (0..3)
        .filter(|&c| account.emitted_w[c] > 0.0)
        .map(|c| ((account.emitted_w[c] - accounted_w(account, c)) / account.emitted_w[c]).abs())
        .fold(0.0, f64::max)
}

/// The layers of a view (or of a map that is made in bands), filled band by band.
pub(super) struct PointLayers<'a> {
    facts: &'a SceneFacts,
    width: u32,
    height: u32,
    layers: BTreeMap<LayerName, Layer>,
    outside_map: u64,
    unfinished: u64,
    cut_off: u64,
}

impl<'a> PointLayers<'a> {
    pub(super) fn new(facts: &'a SceneFacts, width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        let layers = facts
            .output
            .layers
            .iter()
            .map(|&name| {
                let channels = match name {
                    LayerName::Radiance => 4,
                    LayerName::Depth | LayerName::SeenDepth => 1,
                    _ => 3,
                };
                (
                    name,
                    Layer {
                        channels,
                        data: vec![0.0; pixels * channels],
                    },
                )
            })
            .collect();
        Self {
            facts,
            width,
            height,
            layers,
            outside_map: 0,
            unfinished: 0,
            cut_off: 0,
        }
    }

    /// Copies a band of a slot into the layers that come from it.
    pub(super) fn add_band(&mut self, source: &Slot, first_row: u32, band: &[f32]) {
        let first = first_row as usize * self.width as usize;
        let origin = self.facts.origin_m;
        let words = (plan::bytes_per_point(source) / 4) as usize;
        let fill = |layer: Option<&mut Layer>, values: &dyn Fn(&[f32]) -> [f32; 4]| {
            let Some(layer) = layer else { return };
            let n = layer.channels;
            let target = &mut layer.data[first * n..][..band.len() / words * n];
            for (pixel, value) in target.chunks_exact_mut(n).zip(band.chunks_exact(words)) {
                pixel.copy_from_slice(&values(value)[..n]);
            }
        };
        let layers = &mut self.layers;
        let three = |v: &[f32]| [v[0], v[1], v[2], 0.0];
        if *source == RADIANCE {
            for notes in band.chunks_exact(words).map(|v| v[3]) {
                let has = |note: u32| u64::from(notes as u32 & note != 0);
                self.outside_map += has(OUTSIDE_MAP);
                self.unfinished += has(MARCH_UNFINISHED);
                self.cut_off += has(CUT_OFF);
            }
            let per_sample = 1.0 / (self.facts.quality.pixel_samples as f32).powi(2);
            fill(layers.get_mut(&LayerName::Radiance), &|v| {
                [v[0] * per_sample, v[1] * per_sample, v[2] * per_sample, 1.0]
            });
        } else if *source == VISIBLE_DEPTH {
            fill(layers.get_mut(&LayerName::Depth), &|v| {
                [v[0], 0.0, 0.0, 0.0]
            });
        } else if *source == POINTS {
            // Position, receiver, normal, footprint. Without a receiver, no surface is seen.
            if let Some(camera) = &self.facts.output.camera {
                fill(layers.get_mut(&LayerName::SeenDepth), &|v| {
                    let local = DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
                    let depth_m = (local - camera.eye).dot(camera.forward) as f32;
                    [
                        if v[3] == -1.0 { FAR_DEPTH_M } else { depth_m },
                        0.0,
                        0.0,
                        0.0,
                    ]
                });
            }
            fill(layers.get_mut(&LayerName::Normal), &|v| three(&v[4..]));
            fill(layers.get_mut(&LayerName::Position), &|v| {
                if v[3] == -1.0 {
                    return [0.0; 4];
                }
                let local = DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
                let world = local + origin;
                [world.x as f32, world.y as f32, world.z as f32, 0.0]
            });
        } else if *source == VISIBLE_ALBEDO {
            fill(layers.get_mut(&LayerName::Albedo), &three);
        } else if *source == POINT_IRRADIANCE {
            fill(layers.get_mut(&LayerName::Irradiance), &three);
        } else if *source == WATER_MAP {
            fill(layers.get_mut(&LayerName::Water), &three);
        }
    }

    /// All layers, checked to be finite.
    pub(super) fn finish(self) -> Result<(BTreeMap<LayerName, Layer>, Vec<Warning>), RenderError> {
        for (name, layer) in &self.layers {
            check_finite(*name, layer, self.width)?;
        }
        let pixels = f64::from(self.width) * f64::from(self.height);
        let of_pixels = |count: u64, code: &str, what: &str| {
            (count > 0).then(|| {
                let share = 100.0 * count as f64 / pixels;
                Warning::new(code, format!("{count} pixels ({share:.3} %) {what}"))
            })
        };
        let outside = of_pixels(
            self.outside_map,
            "pixels_outside_map",
            "see the floor outside its irradiance map; they repeat the map's edge",
        );
        let unfinished = of_pixels(
            self.unfinished,
            "pixels_along_water",
            "have camera rays at such a grazing angle to the waves that the search for their hit on the water ran out of steps; they may show a wrong point of the water",
        );
        let bounces = self.facts.legs().bounces;
        let cut_off = of_pixels(
            self.cut_off,
            "rays_cut_off",
            &format!(
                "have camera rays that meet the water more than {bounces} times (`quality.bounces`); over the water they end there and show the sky, in it they go straight on"
            ),
        );
        let coarse = self
            .layers
            .get(&LayerName::Position)
            .and_then(coarse_positions);
        let warnings = outside
            .into_iter()
            .chain(unfinished)
            .chain(cut_off)
            .chain(coarse)
            .collect();
        Ok((self.layers, warnings))
    }
}

/// The warning that world positions are too far from the world's origin for single precision.
fn coarse_positions(positions: &Layer) -> Option<Warning> {
    let farthest_m = positions.data.iter().fold(0.0, |a: f32, b| a.max(b.abs()));
    let step_m = farthest_m.next_up() - farthest_m;
    (step_m > COARSE_STEP_M).then(|| {
        Warning::new(
            "positions_coarse",
            format!(
                "layer position has steps of {step_m} m, because it is single precision and reaches {farthest_m:.0} m from the world's origin; the picture itself is exact there; for surfaces that are not seen through water, so is seen_depth, which with the camera in stats gives the position"
            ),
        )
    })
}

fn check_finite(name: LayerName, layer: &Layer, width: u32) -> Result<(), RenderError> {
    match layer.data.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(index) => {
            let pixel = (index / layer.channels) as u32;
            Err(RenderError::NotFinite {
                layer: format!("{name:?}").to_lowercase(),
                x: pixel % width,
                y: pixel / width,
            })
        }
    }
}

/// The frame's estimate of its own relative L1 error; `None` where no light landed.
pub(super) fn estimated_error(facts: &SceneFacts, differences: &[[f32; 4]]) -> Option<f64> {
    let (mut difference_w, mut landed_w) = (0.0, 0.0);
    for map in estimate::compared(facts) {
        let first = map.comparison.first_group as usize;
        for sums in &differences[first..first + map.groups() as usize] {
            difference_w += f64::from(sums[0]) * map.texel_m2;
            landed_w += f64::from(sums[1]) * map.texel_m2;
        }
    }
    let texels = match (
        facts.output.camera,
        facts.receivers.floor_map,
        estimate::coarse_floor_map(facts),
    ) {
        (Some(_), ..) => Compared::Between,
        (None, Some(fine), Some(low)) => Compared::Blocks(fine.width / low.width),
        (None, ..) => Compared::Blocks(1),
    };
    (landed_w > 0.0).then(|| {
        estimate_error(&FrameComparison {
            difference: difference_w / landed_w,
            cells_ratio: f64::from(facts.quality.water_cells)
                / f64::from(estimate::coarse_cells(facts)),
            texels,
        })
    })
}

/// The texels of the irradiance array that make up the requested map.
pub(super) struct MapPlace {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) first_texel: u64,
    /// The level map whose normals convert flux through the map's plane to irradiance on the surface.
    pub(super) level_map: Option<LevelMapKey>,
    axis_in_mesh: DVec3,
}

/// Where the requested map lies.
pub(super) fn map_of(facts: &SceneFacts) -> MapPlace {
    if let Some(Receiver::Object(index)) = facts.output.receiver {
        let texels = facts.receivers.objects[index as usize].map_texels;
        let found = facts
            .lights
            .lit
            .first()
            .and_then(|light| light.boxes.get(index as usize))
            .and_then(Option::as_ref);
        return MapPlace {
            width: texels,
            height: texels,
            first_texel: u64::from(MapLayout::of(facts).irradiance_of(
                0,
                index as usize,
                facts.output.receiver_layer,
            )),
            level_map: found.map(|b| b.key.clone()),
            axis_in_mesh: found.map_or(DVec3::Y, |b| b.axis),
        };
    }
    let (width, height) = facts
        .receivers
        .floor_map
        .map_or((0, 0), |map| (map.width, map.height));
    MapPlace {
        width,
        height,
        first_texel: 0,
        level_map: None,
        axis_in_mesh: DVec3::Y,
    }
}

/// The finished map: on an object the values are multiplied by the cosine between surface normal and map axis; on the floor the sky is
/// added if requested.
pub(super) fn finish_map(
    facts: &SceneFacts,
    map: &MapPlace,
    mut values: Vec<f32>,
    normals: Option<&[u32]>,
) -> Result<Layer, RenderError> {
    if let (Some(normals), Some(Receiver::Object(index))) = (normals, facts.output.receiver) {
        let normal_to_local = facts.receivers.objects[index as usize]
            .local_from_mesh
            .matrix3
            .inverse()
            .transpose();
        for (texel, &packed) in values.chunks_exact_mut(3).zip(normals) {
            let n = (normal_to_local * unpack_normal(packed)).normalize();
            let cosine = n.dot(map.axis_in_mesh).abs() as f32;
            for value in texel {
                *value *= cosine;
            }
        }
    }
    for texel in values.chunks_exact_mut(3) {
        for (value, sky) in texel.iter_mut().zip(facts.output.sky_w_m2) {
            *value += sky as f32;
        }
    }
    let layer = Layer {
        channels: 3,
        data: values,
    };
    check_finite(LayerName::Irradiance, &layer, map.width)?;
    Ok(layer)
}

/// Undoes the shaders' octahedral packing.
fn unpack_normal(word: u32) -> DVec3 {
    let half = |bits: u16| f64::from(bits as i16) / 32767.0;
    let (x, y) = (half(word as u16), half((word >> 16) as u16));
    let mut n = DVec3::new(x, y, 1.0 - x.abs() - y.abs());
    let fold = (-n.z).max(0.0);
    n.x -= fold.copysign(n.x);
    n.y -= fold.copysign(n.y);
    n.normalize()
}
