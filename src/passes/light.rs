//! What the passes that follow a sun share: its uniform, and the receivers' maps.

use super::gpu_data::{Light, Receiver, vec2, vec4};
use super::maps::MapLayout;
use crate::scene::facts::{SceneFacts, SunFacts};

/// Footprints of more texels than this get workgroups of their own.
const WIDE_TEXELS: u32 = 1024;
/// Counts that the largest possible beam makes in narrow sums: 2³⁰, so that a deposit fits u32 with room for rounding.
const BEAM_COUNTS: f64 = 1_073_741_824.0;
/// The same in wide sums: 2⁴⁰, so that all beams of the finest grid (2 · 2048²) fit 63 bits together.
const WIDE_BEAM_COUNTS: f64 = 1_099_511_627_776.0;
/// Fewest counts in narrow sums of the largest beam, and of an evenly lit texel of the coarsest map: what is all alike all
/// rounds the same way, by up to half a count.
const FINE_COUNTS: f64 = 65_536.0;
/// Fewest counts of an evenly lit texel of the finest map; less, because a small object in a wide pool is common and must not
/// make everything dear.
const FINEST_MAP_COUNTS: f64 = 4096.0;
/// Fewest counts of the smallest part of the largest beam that straddles receivers: less would be lost to rounding.
const PART_COUNTS: f64 = 64.0;
/// Where a narrow sum wraps.
const WRAP_COUNTS: f64 = 4_294_967_296.0;
/// Times an evenly lit texel's flux that a narrow sum holds.
const NARROW_HEADROOM: f64 = 1024.0;
/// The same in the account of a workgroup, whose 128 beams must fit u32 together.
const BEAM_ACCOUNT_COUNTS: f64 = 8_388_608.0;

/// Flux that one beam can carry at most under unit irradiance, m².
fn largest_beam_m2(facts: &SceneFacts, sun: &SunFacts) -> f64 {
    let cells = f64::from(facts.quality.water_cells);
    let cell = sun.window.size() / cells;
    let sideways = glam::DVec2::new(sun.to_light.x, sun.to_light.z).length();
    0.5 * cell.x * cell.y * (sun.to_light.y + facts.surface.max_slope() * sideways)
}

/// The uniform of one sun.
pub fn light_uniform(facts: &SceneFacts, index: usize, wide_sums: bool) -> Vec<u8> {
    let sun = &facts.suns[index];
    let cells = facts.quality.water_cells;
    let beam_m2 = largest_beam_m2(facts, sun);
    let light = Light {
        to_light: vec4(sun.to_light, 0.0),
        extinction_per_m: vec4(facts.extinction_per_m, 0.0),
        window_min_m: vec2(sun.window.min),
        cell_m: vec2(sun.window.size() / f64::from(cells)),
        cells,
        wave_count: facts.surface.components.len() as u32,
        object_count: facts.objects.len() as u32,
        has_floor: u32::from(facts.floor.is_some()),
        ior: facts.ior as f32,
        flux_scale: flux_scale(facts, index, wide_sums) as f32,
        energy_scale: energy_scale(facts, index) as f32,
        channels: facts.channels(),
        split_levels: facts.quality.split_levels,
        layers: facts.quality.layers,
        wide_texels: WIDE_TEXELS,
        triangle_scale: (BEAM_ACCOUNT_COUNTS / beam_m2).log2().floor().exp2() as f32,
    };
    bytemuck::bytes_of(&light).to_vec()
}

/// Counts per m² in the energy account of a sun; a power of two, so that scaling is exact.
pub fn energy_scale(facts: &SceneFacts, index: usize) -> f64 {
    // A beam may light texels of each plane.
    let times = if places_by_planes(facts) {
        f64::from(facts.quality.planes)
    } else {
        1.0
    };
    let all_m2 = largest_beam_m2(facts, &facts.suns[index])
        * 2.0
        * f64::from(facts.quality.water_cells).powi(2)
        * times;
    (2.0_f64.powi(60) / all_m2).log2().floor().exp2()
}

/// Counts per m² in the flux sums; a power of two.
///
/// Wide sums take the largest beam at 2⁴⁰. Narrow ones take it at 2³⁰ at most and leave room for [`NARROW_HEADROOM`] times the
/// flux of an evenly lit texel.
pub fn flux_scale(facts: &SceneFacts, index: usize, wide_sums: bool) -> f64 {
    let beam_m2 = largest_beam_m2(facts, &facts.suns[index]);
    if wide_sums {
        return (WIDE_BEAM_COUNTS / beam_m2).log2().floor().exp2();
    }
    let texel_m2 = texel_fluxes_m2(facts, index).fold(0.0, f64::max);
    let narrow = WRAP_COUNTS / (NARROW_HEADROOM * texel_m2);
    narrow.min(BEAM_COUNTS / beam_m2).log2().floor().exp2()
}

/// Flux of an evenly lit texel of each receiver's map under unit irradiance, m².
fn texel_fluxes_m2(facts: &SceneFacts, index: usize) -> impl Iterator<Item = f64> {
    let sun = &facts.suns[index];
    let floor = facts.floor_map.map(|map| {
        sun.to_light.y * map.rect.size().x * map.rect.size().y / f64::from(map.width * map.height)
    });
    let objects = sun.boxes.iter().flatten();
    floor
        .into_iter()
        .chain(objects.map(|b| 1.0 / b.density_per_flux))
}

/// Whether meshes get their light by planes.
pub fn places_by_planes(facts: &SceneFacts) -> bool {
    facts.quality.has_planes() && facts.wet_objects().next().is_some()
}

/// Whether narrow sums would be too coarse for a sun from the start: very many beams on a texel, texels under a beam, or beams
/// in very small parts.
pub fn needs_wide_sums(facts: &SceneFacts, index: usize) -> bool {
    // What planes land is not what rays take away: a sum that has wrapped would not be told from that.
    if places_by_planes(facts) {
        return true;
    }
    let scale = flux_scale(facts, index, false);
    let coarsest_m2 = texel_fluxes_m2(facts, index).fold(0.0, f64::max);
    let finest_m2 = texel_fluxes_m2(facts, index).fold(f64::INFINITY, f64::min);
    let parts = if facts.wet_objects().next().is_some() {
        4.0_f64.powi(facts.quality.split_levels as i32)
    } else {
        1.0
    };
    scale * largest_beam_m2(facts, &facts.suns[index]) < FINE_COUNTS.max(PART_COUNTS * parts)
        || scale * coarsest_m2 < FINE_COUNTS
        || scale * finest_m2 < FINEST_MAP_COUNTS
}

/// Whether narrow sums of a sun have wrapped: what landed is then short by at least one whole 2³² counts.
pub fn has_wrapped(facts: &SceneFacts, index: usize, missing_m2: f64) -> bool {
    missing_m2 > 0.5 * WRAP_COUNTS / flux_scale(facts, index, false)
}

/// The receivers of one sun: the floor, then those of the objects, one per layer; `level_map_offset` tells where in the arena an
/// object's map lies.
pub fn receivers(
    facts: &SceneFacts,
    index: usize,
    level_map_offset: impl Fn(usize) -> u32,
) -> Vec<Receiver> {
    let mut all = vec![floor_receiver(facts)];
    let maps = MapLayout::of(facts);
    let layers = facts.quality.layers;
    for (object, level_box) in facts.suns[index].boxes.iter().enumerate() {
        let Some(level_box) = level_box else {
            all.extend((0..layers).map(|_| Receiver::default()));
            continue;
        };
        let row = |r: glam::DVec4| [r.x as f32, r.y as f32, r.z as f32, r.w as f32];
        let receiver = Receiver {
            u_row: row(level_box.map_from_local[0]),
            v_row: row(level_box.map_from_local[1]),
            s_row: row(level_box.map_from_local[2]),
            map_width: level_box.key.texels,
            map_height: level_box.key.texels,
            level_map_offset: level_map_offset(object),
            s_min: level_box.s_range[0] as f32,
            s_max: level_box.s_range[1] as f32,
            level_count: level_box.key.levels(),
            density_per_flux: level_box.density_per_flux as f32,
            axis: vec4(level_box.axis, 0.0),
            s_per_m: level_box.s_per_m as f32,
            planes: if facts.quality.has_planes() {
                facts.quality.planes
            } else {
                0
            },
            ..Receiver::default()
        };
        all.extend((0..layers).map(|layer| Receiver {
            map_offset: maps.flux_of(object, layer),
            irradiance_offset: maps.irradiance_of(index, object, layer),
            layer,
            ..receiver
        }));
    }
    all
}

fn floor_receiver(facts: &SceneFacts) -> Receiver {
    let Some(floor) = &facts.floor else {
        return Receiver::default();
    };
    let mut receiver = Receiver {
        s_row: [0.0, -1.0, 0.0, floor.y_m as f32],
        s_per_m: 1.0,
        axis: [0.0, -1.0, 0.0, 0.0],
        floor_min_m: vec2(floor.rect.min),
        floor_max_m: vec2(floor.rect.max),
        density_per_flux: 1.0,
        ..Receiver::default()
    };
    if let Some(map) = facts.floor_map {
        let per_m = glam::DVec2::new(f64::from(map.width), f64::from(map.height)) / map.rect.size();
        receiver.u_row = [per_m.x as f32, 0.0, 0.0, (-map.rect.min.x * per_m.x) as f32];
        receiver.v_row = [0.0, 0.0, per_m.y as f32, (-map.rect.min.y * per_m.y) as f32];
        receiver.map_width = map.width;
        receiver.map_height = map.height;
        receiver.density_per_flux = (per_m.x * per_m.y) as f32;
    }
    receiver
}
