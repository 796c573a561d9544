//! Shared by the passes that trace a beam set: its uniform, and the fixed-point scales of its sums.
//!
//! Flux is counted per unit power: a sun's in m² under 1 W/m², a point light's in sr at 1 W/sr.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::gpu_values::{vec2, vec4};
use super::maps::MapLayout;
use crate::facts::source::Source;
use crate::facts::window::Rect;
use crate::facts::{BeamSet, SceneFacts};
use crate::gpu_struct;
use crate::graph::BeamSetRun;
use crate::physics::fresnel::fresnel_transmittance;
use crate::physics::solid_angle::solid_angle;

gpu_struct! {
    /// The light of `shaders/shared/light.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Light = "Light" {
        source: [f32; 4],
        extinction_per_m: [f32; 4],
        window_min: [f32; 2],
        cell: [f32; 2],
        cells: u32,
        object_count: u32,
        has_floor: u32,
        ior: f32,
        flux_scale: f32,
        energy_scale: f32,
        channels: u32,
        split_levels: u32,
        layers: u32,
        wide_texels: u32,
        triangle_scale: f32,
        pad: u32,
        foot_m: [f32; 2],
        bend_per_m2: f32,
        kind: u32,
        objects_min_m: [f32; 2],
        objects_max_m: [f32; 2],
    }
}

/// Footprints of more texels than this are shared by several workgroups.
const WIDE_TEXELS: u32 = 1024;
/// Largest number of counts of one beam in narrow sums: 2³⁰, so that a deposit fits u32 with room for rounding.
const BEAM_COUNTS: f64 = 1_073_741_824.0;
/// The same in wide sums: 2⁴⁰, so that all beams of the finest grid (2 · 2048²) fit 63 bits together.
const WIDE_BEAM_COUNTS: f64 = 1_099_511_627_776.0;
/// Largest number of counts of one beam in sums whose addends fit u32: 2³¹.
const ADDEND_COUNTS: f64 = 2_147_483_648.0;
/// Fewest counts in narrow sums of the largest beam, and of an evenly lit texel of the coarsest map. Equal deposits round the same way,
/// by up to half a count, so their rounding errors add up.
const FINE_COUNTS: f64 = 65_536.0;
/// Fewest counts of an evenly lit texel of the finest map. Fewer than above, because a small object in a wide pool is common and must
/// not force the more expensive wide sums.
const FINEST_MAP_COUNTS: f64 = 4096.0;
/// Fewest counts of the mean beam of a point light in narrow sums.
const MEAN_BEAM_COUNTS: f64 = 16_384.0;
/// Fewest counts of the smallest part of the largest beam that straddles receivers: with fewer it would be lost to rounding.
const PART_COUNTS: f64 = 64.0;
/// Counts at which a narrow sum wraps: 2³².
const WRAP_COUNTS: f64 = 4_294_967_296.0;
/// Capacity of a narrow sum, as a multiple of an evenly lit texel's flux.
const NARROW_HEADROOM: f64 = 1024.0;
/// Largest number of counts of one beam in the account of a workgroup, whose 128 beams must fit u32 together.
const BEAM_ACCOUNT_COUNTS: f64 = 8_388_608.0;

/// Intervals along each axis of the grid in which the largest beam is searched.
const PIECES: u32 = 24;
/// Upper bound of the sum of all beams of a point light, sr: all directions, 1024 times over, since a ray may cross several waves.
const MOST_LAMP_SR: f64 = 1024.0 * 2.0 * TAU;
/// Least beam that is used for scales, sr: smaller ones would leave the range of f32, and their light is invisible.
const LEAST_BEAM_SR: f64 = 1e-20;
/// Largest solid angle per area of the octahedral square, sr, times 1.5 for triangles bent over its edges.
const OCTAHEDRAL_SR: f64 = 1.5 * 5.196_152_422_706_632;

/// Largest flux that one beam can carry from a light of unit power.
fn largest_beam(facts: &SceneFacts, light: &BeamSet) -> f64 {
    let cell = light.grid.places.size() / f64::from(facts.quality.water_cells);
    match light.source {
        Source::Sun { to_light } => {
            let sideways = DVec2::new(to_light.x, to_light.z).length();
            0.5 * cell.x * cell.y * (to_light.y + facts.water.surface.max_slope() * sideways)
        }
        Source::Submerged { .. } => (0.5 * cell.x * cell.y * OCTAHEDRAL_SR).min(TAU),
        Source::Point { position_m } => lamp_beam(facts, light, position_m, cell),
    }
}

/// Largest Fresnel transmittance over all slopes of the water. It is small for a sun near the horizon, and the sums must then count
/// finely enough for that. 1 for a point light, and where no light enters at all.
fn brightest_transmittance(facts: &SceneFacts, light: &BeamSet) -> f64 {
    let Source::Sun { to_light } = light.source else {
        return 1.0;
    };
    let tilt = facts.water.surface.max_slope().atan();
    let to_normal = (to_light.y.clamp(0.0, 1.0).acos() - tilt).max(0.0);
    let most = fresnel_transmittance(to_normal.cos(), light.band.ior);
    if most > 0.0 { most } else { 1.0 }
}

/// Upper bound of the solid angle of half a cell, sr: its projected area for the light's height and the steepest slope, over the square
/// of its least distance; at most half of all directions.
fn lamp_beam(facts: &SceneFacts, light: &BeamSet, position_m: DVec3, cell: DVec2) -> f64 {
    let grid = &light.grid;
    // Per interval of an axis: the largest cell side in it, and its least distance from the light's foot.
    let pieces = |axis: usize| -> Vec<(f64, f64)> {
        let (low, high) = (grid.places.min[axis], grid.places.max[axis]);
        let foot_m = [position_m.x, position_m.z][axis];
        let aside_m = |s: f64| grid.foot_m[axis] + s * (1.0 + grid.bend_per_m2 * s * s) - foot_m;
        let at = |k: u32| low + (high - low) * f64::from(k) / f64::from(PIECES);
        (0..PIECES)
            .map(|k| {
                let (from, to) = (at(k) - cell[axis], at(k + 1) + cell[axis]);
                let (from_m, to_m) = (aside_m(from), aside_m(to));
                let near_m = if from_m < 0.0 && to_m > 0.0 {
                    0.0
                } else {
                    from_m.abs().min(to_m.abs())
                };
                (cell[axis] * grid.stretch(from.abs().max(to.abs())), near_m)
            })
            .collect()
    };
    let (along_x, along_z) = (pieces(0), pieces(1));
    let crest_m = facts.water.surface.max_height_m();
    let rise_m = (position_m.y - crest_m).max(0.0);
    let steepest = facts.water.surface.max_slope();
    let mut largest = LEAST_BEAM_SR;
    for &(side_x, near_x) in &along_x {
        for &(side_z, near_z) in &along_z {
            let distance_m = rise_m.hypot(near_x.hypot(near_z));
            // Written so that a distance of 0 counts as half of all directions.
            let facing =
                ((position_m.y + crest_m) / distance_m + steepest).min(steepest.hypot(1.0));
            let area = 0.5 * side_x * side_z * facing;
            largest = largest.max(if area < TAU * distance_m * distance_m {
                area / (distance_m * distance_m)
            } else {
                TAU
            });
        }
    }
    largest
}

/// The uniform of one beam set.
pub fn light_uniform(facts: &SceneFacts, set: BeamSetRun) -> Vec<u8> {
    let BeamSetRun { index, wide_sums } = set;
    let light = &facts.lights.beam_sets[index];
    let cells = facts.quality.water_cells;
    let beam = largest_beam(facts, light);
    let (source, kind) = match light.source {
        Source::Sun { to_light } => (to_light, 0),
        Source::Point { position_m } => (position_m, 1),
        Source::Submerged { position_m } => (position_m, 2),
    };
    let (objects_min_m, objects_max_m) =
        light.objects_window.map_or(([1.0; 2], [-1.0; 2]), |rect| {
            (vec2(rect.min), vec2(rect.max))
        });
    let uniform = Light {
        source: vec4(source, 0.0),
        extinction_per_m: vec4(light.band.extinction_per_m, 0.0),
        window_min: vec2(light.grid.places.min),
        cell: vec2(light.grid.places.size() / f64::from(cells)),
        cells,
        object_count: facts.receivers.objects.len() as u32,
        has_floor: u32::from(facts.receivers.floor.is_some()),
        ior: light.band.ior as f32,
        flux_scale: flux_scale(facts, index, wide_sums) as f32,
        energy_scale: energy_scale(facts, index) as f32,
        channels: facts.channels(),
        split_levels: facts.quality.split_levels,
        layers: facts.quality.layers,
        wide_texels: WIDE_TEXELS,
        triangle_scale: (BEAM_ACCOUNT_COUNTS / beam).log2().floor().exp2() as f32,
        pad: 0,
        foot_m: vec2(light.grid.foot_m),
        bend_per_m2: light.grid.bend_per_m2 as f32,
        kind,
        objects_min_m,
        objects_max_m,
    };
    bytemuck::bytes_of(&uniform).to_vec()
}

/// Counts per unit flux in the energy account of a light; a power of two, so that scaling is exact.
pub fn energy_scale(facts: &SceneFacts, index: usize) -> f64 {
    let times = if facts.wet_objects().next().is_some() {
        f64::from(facts.method.deposits_per_beam)
    } else {
        1.0
    };
    let light = &facts.lights.beam_sets[index];
    let beams = 2.0 * f64::from(facts.quality.water_cells).powi(2);
    let mut all = largest_beam(facts, light) * beams;
    if light.source.position_m().is_some() {
        all = all.min(MOST_LAMP_SR);
    }
    let all = all * times;
    (2.0_f64.powi(60) / all).log2().floor().exp2()
}

/// Counts per unit flux in the flux sums; a power of two.
///
/// In wide sums the largest beam makes 2⁴⁰ counts. In narrow ones it makes 2³⁰ at most, and there is room for [`NARROW_HEADROOM`] times
/// the flux of an evenly lit texel.
pub fn flux_scale(facts: &SceneFacts, index: usize, wide_sums: bool) -> f64 {
    let light = &facts.lights.beam_sets[index];
    let beam = largest_beam(facts, light) * brightest_transmittance(facts, light);
    if wide_sums {
        return (WIDE_BEAM_COUNTS / beam).log2().floor().exp2();
    }
    let texel = texel_fluxes(facts, index)
        .map(|t| t.brightest)
        .fold(0.0, f64::max);
    let narrow = WRAP_COUNTS / (NARROW_HEADROOM * texel);
    narrow.min(BEAM_COUNTS / beam).log2().floor().exp2()
}

/// Counts per unit flux in 64-bit sums whose addends fit 32 bits, so that most need one addition: the largest beam makes 2³¹ counts. A power of
/// two. All beams of the finest grid fit 63 bits together, so such sums cannot overflow.
pub fn addend_scale(facts: &SceneFacts, index: usize) -> f64 {
    flux_scale(facts, index, true) / (WIDE_BEAM_COUNTS / ADDEND_COUNTS)
}

/// Flux of a map's texel from a light of unit power, under flat water with the transmittance of the most transparent slope.
struct TexelFlux {
    /// Where the light is nearest.
    brightest: f64,
    /// Mean over the map.
    mean: f64,
}

/// The texel flux of each requested map.
fn texel_fluxes(facts: &SceneFacts, index: usize) -> impl Iterator<Item = TexelFlux> {
    let light = &facts.lights.beam_sets[index];
    let transmittance = brightest_transmittance(facts, light);
    let even = |flux: f64| TexelFlux {
        brightest: flux,
        mean: flux,
    };
    let floor = facts.receivers.floor_map.map(move |map| {
        let texels = f64::from(map.width) * f64::from(map.height);
        let area_m2 = map.rect.size().x * map.rect.size().y / texels;
        match (light.source, &facts.receivers.floor) {
            (Source::Sun { to_light }, _) => even(transmittance * to_light.y * area_m2),
            (_, Some(floor)) => lamp_on_floor(light, &map.rect, floor.y_m, light.band.ior, texels),
            (_, None) => even(area_m2),
        }
    });
    let maps = MapLayout::of(facts);
    let is_requested = move |object: usize| {
        let layers = facts.quality.layers;
        (0..layers).any(|layer| maps.holds(object, layer))
    };
    let objects = facts
        .lights
        .boxes_of(light)
        .iter()
        .zip(&facts.receivers.objects)
        .enumerate();
    let objects = objects.filter(move |(number, _)| is_requested(*number));
    let objects = objects.filter_map(move |(_, (level_box, object))| {
        let area_m2 = 1.0 / level_box.as_ref()?.density_per_flux;
        let Some(position_m) = light.source.position_m() else {
            return Some(even(transmittance * area_m2));
        };
        let middle_m = object.wet_middle();
        let rise_m = light.source.apparent_height_m(middle_m.y, light.band.ior);
        let distance_m = (middle_m - position_m).with_y(rise_m).length();
        let radius_m = 0.5 * (object.max - object.min).length();
        let near_m = (distance_m - radius_m).max(0.1 * radius_m).max(1e-6);
        let share = |distance_m: f64| (area_m2 / (distance_m * distance_m)).min(TAU);
        Some(TexelFlux {
            brightest: share(near_m),
            mean: share(distance_m.max(near_m)),
        })
    });
    floor.into_iter().chain(objects)
}

/// Flux of a point light on a texel of the floor's map.
fn lamp_on_floor(light: &BeamSet, rect: &Rect, y_m: f64, ior: f64, texels: f64) -> TexelFlux {
    let foot_m = light
        .source
        .position_m()
        .map_or(DVec2::ZERO, |p| DVec2::new(p.x, p.z));
    let height_m = light.source.apparent_height_m(y_m, ior).max(1e-6);
    let (low, high) = (rect.min - foot_m, rect.max - foot_m);
    let corner = DVec3::new(low.x, -height_m, low.y);
    let (along_x, along_z) = (DVec3::X * (high.x - low.x), DVec3::Z * (high.y - low.y));
    let whole = (solid_angle(corner, along_x, along_x + along_z)
        + solid_angle(corner, along_x + along_z, along_z))
    .abs()
    .min(entering_sr(light));
    let aside_m = low.max(-high).max(DVec2::ZERO).length();
    let area_m2 = (high.x - low.x) * (high.y - low.y) / texels;
    let distance_m = height_m.hypot(aside_m);
    let mean = whole / texels;
    TexelFlux {
        brightest: (area_m2 * height_m / distance_m.powi(3)).min(TAU).max(mean),
        mean,
    }
}

/// Solid angle of the window of the water at rest, seen from a point light above it; all directions for a light under water, sr.
fn entering_sr(light: &BeamSet) -> f64 {
    let Source::Point { position_m } = light.source else {
        return 2.0 * TAU;
    };
    let low = light.window.min - DVec2::new(position_m.x, position_m.z);
    let size = light.window.size();
    let corner = DVec3::new(low.x, -position_m.y.max(1e-9), low.y);
    let (along_x, along_z) = (DVec3::X * size.x, DVec3::Z * size.y);
    let near = solid_angle(corner, along_x, along_x + along_z);
    let far = solid_angle(corner, along_x + along_z, along_z);
    (near + far).abs()
}

/// Whether narrow sums are known to be too coarse for a light: very many beams per texel or texels per beam, beams split into very small
/// parts, or a low sun whose light is mostly reflected.
pub fn needs_wide_sums(facts: &SceneFacts, index: usize) -> bool {
    // If the method does not conserve energy, a wrapped sum cannot be distinguished from the method's own surplus.
    if !facts.method.conserves_energy && facts.wet_objects().next().is_some() {
        return true;
    }
    let scale = flux_scale(facts, index, false);
    let means = || texel_fluxes(facts, index).map(|t| t.mean);
    let coarsest = means().fold(0.0, f64::max);
    let finest = means().fold(f64::INFINITY, f64::min);
    let parts = if facts.wet_objects().next().is_some() {
        4.0_f64.powi(facts.quality.split_levels as i32)
    } else {
        1.0
    };
    let light = &facts.lights.beam_sets[index];
    let beams = 2.0 * f64::from(facts.quality.water_cells).powi(2);
    // For a near light most beams are far smaller than the largest one.
    if matches!(light.source, Source::Point { .. })
        && scale * entering_sr(light) / beams < MEAN_BEAM_COUNTS
    {
        return true;
    }
    let beam = largest_beam(facts, light) * brightest_transmittance(facts, light);
    scale * beam < FINE_COUNTS.max(PART_COUNTS * parts)
        || scale * coarsest < FINE_COUNTS
        || scale * finest < FINEST_MAP_COUNTS
}

/// Whether narrow sums of a light have wrapped: then the landed flux is short by at least 2³² counts.
pub fn has_wrapped(facts: &SceneFacts, index: usize, missing: f64) -> bool {
    missing > 0.5 * WRAP_COUNTS / flux_scale(facts, index, false)
}
