//! The view from a sun: what it covers, and the uniform of all passes of the method.

use glam::{DVec2, DVec3};

use super::{INTERPOLATED, ITERATIONS, LOOKUP, MAP_TEXELS, PHOTONS_PER_SIDE};
use crate::facts::source::Source;
use crate::facts::window::Rect;
use crate::facts::{BeamSet, SceneFacts};
use crate::gpu_struct;
use crate::scene::Receiver;
use crate::stages::gpu_values::{vec2, vec4};
use crate::stages::light::energy_scale;

gpu_struct! {
    /// The uniform of `shaders/shared/light_view.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub LightView = "LightView" {
        to_light: [f32; 4],
        extinction_per_m: [f32; 4],
        power: [f32; 4],
        lean: [f32; 2],
        view_min_m: [f32; 2],
        view_texel_m: [f32; 2],
        map_min_m: [f32; 2],
        map_texel_m: [f32; 2],
        water_min_m: [f32; 2],
        water_cell_m: [f32; 2],
        cells: u32,
        texels: u32,
        iterations: u32,
        has_floor: u32,
        object_count: u32,
        channels: u32,
        bottom_y_m: f32,
        ior: f32,
        sum_scale: f32,
        term_scale: f32,
        energy_scale: f32,
        first_texel: u32,
        first_object: u32,
        width: u32,
        row_count: u32,
        are_texels: u32,
        interpolates: u32,
        pad: u32,
    }
}

/// Name of the uniform's variable.
pub const LIGHT_VIEW: &str = "light_view";

/// Largest number of counts of a photon in the sums of a texel: with 2²⁴ photons, 63 bits hold all of them.
const PHOTON_COUNTS: f64 = 1_073_741_824.0;
/// The same in the account of a workgroup of 64.
const TERM_COUNTS: f64 = 33_554_432.0;
/// Least side of a view, as a share of its other side, and in m: a wall seen edge-on has no width.
const LEAST_SIDE: f64 = 1e-6;
const LEAST_SIDE_M: f64 = 1e-9;
/// Least depth of the bottom where there is no floor, m; and how far it lies below the lowest object, as a share of that one's depth.
const LEAST_DEPTH_M: f64 = 1e-3;
const BELOW_OBJECTS: f64 = 1.001;

/// Photons along each side of the water.
pub fn photons_per_side(facts: &SceneFacts) -> u32 {
    PHOTONS_PER_SIDE.integer(&facts.quality)
}

/// All photons of a beam set.
pub fn photon_count(facts: &SceneFacts) -> u32 {
    photons_per_side(facts).pow(2)
}

/// Texels along each side of view and map.
pub fn texels(facts: &SceneFacts) -> u32 {
    MAP_TEXELS.integer(&facts.quality)
}

/// Direction to the sun of a beam set. `supports` refuses all other lights.
fn to_light(set: &BeamSet) -> DVec3 {
    match set.source {
        Source::Sun { to_light } => to_light,
        Source::Point { .. } | Source::Submerged { .. } => DVec3::Y,
    }
}

/// Height of the floor; without one just below all objects.
pub fn bottom_y_m(facts: &SceneFacts) -> f64 {
    if let Some(floor) = &facts.receivers.floor {
        return floor.y_m;
    }
    let objects = facts.wet_objects();
    let lowest = objects.map(|index| facts.receivers.objects[index].min.y);
    (lowest.fold(0.0, f64::min) * BELOW_OBJECTS).min(-LEAST_DEPTH_M)
}

/// The places of a box on the water at rest, along the sun's rays.
fn places(lean: DVec2, min: DVec3, max: DVec3) -> Rect {
    let at = |p: DVec3| DVec2::new(p.x, p.z) - lean * p.y;
    let ends = [min.y, max.y].map(|y| [at(min.with_y(y)), at(max.with_y(y))]);
    Rect {
        min: ends[0][0].min(ends[1][0]),
        max: ends[0][1].max(ends[1][1]),
    }
}

fn including(a: Rect, b: Rect) -> Rect {
    Rect {
        min: a.min.min(b.min),
        max: a.max.max(b.max),
    }
}

/// The places of all receivers whose light the output needs.
fn map_rect(facts: &SceneFacts, lean: DVec2) -> Option<Rect> {
    let floor = facts
        .receivers
        .floor_map
        .zip(facts.receivers.floor.as_ref());
    let floor = floor.map(|(map, floor)| {
        let corner = |p: DVec2| DVec3::new(p.x, floor.y_m, p.y);
        places(lean, corner(map.rect.min), corner(map.rect.max))
    });
    let is_needed = |index: usize| match facts.output.receiver {
        None => true,
        Some(Receiver::Object(wanted)) => wanted as usize == index,
        Some(Receiver::Floor(_)) => false,
    };
    let crest_m = facts.water.surface.max_height_m();
    let objects = facts.wet_objects().filter(|&index| is_needed(index));
    let objects = objects.map(|index| {
        let object = &facts.receivers.objects[index];
        places(
            lean,
            object.min,
            object.max.with_y(object.max.y.min(crest_m)),
        )
    });
    let all = floor.into_iter().chain(objects).reduce(including)?;
    let size = all.size();
    let least = (LEAST_SIDE * size.max_element()).max(LEAST_SIDE_M);
    let grow = (DVec2::splat(least) - size).max(DVec2::ZERO) * 0.5;
    Some(Rect {
        min: all.min - grow,
        max: all.max + grow,
    })
}

/// The uniform of one beam set.
pub fn light_view(facts: &SceneFacts, index: usize) -> LightView {
    let set = &facts.lights.beam_sets[index];
    let to_light = to_light(set);
    let lean = DVec2::new(to_light.x, to_light.z) / to_light.y;
    let water = set.window;
    let map = map_rect(facts, lean).unwrap_or(water);
    // A straight path between a place on the water and one on a receiver stays between these.
    let wave_m = lean.abs() * facts.water.surface.max_height_m();
    let view = including(
        map,
        Rect {
            min: water.min - wave_m,
            max: water.max + wave_m,
        },
    );
    let texels = texels(facts);
    let cells = photons_per_side(facts);
    let cell_m = water.size() / f64::from(cells);
    let sideways = DVec2::new(to_light.x, to_light.z).length();
    let largest = cell_m.x * cell_m.y * (to_light.y + facts.water.surface.max_slope() * sideways);
    let power_of_two = |counts: f64| (counts / largest).log2().floor().exp2() as f32;
    LightView {
        to_light: vec4(to_light, 0.0),
        extinction_per_m: vec4(set.band.extinction_per_m, 0.0),
        power: vec4(set.power, 0.0),
        lean: vec2(lean),
        view_min_m: vec2(view.min),
        view_texel_m: vec2(view.size() / f64::from(texels)),
        map_min_m: vec2(map.min),
        map_texel_m: vec2(map.size() / f64::from(texels)),
        water_min_m: vec2(water.min),
        water_cell_m: vec2(cell_m),
        cells,
        texels,
        iterations: ITERATIONS.integer(&facts.quality),
        has_floor: u32::from(facts.receivers.floor.is_some()),
        object_count: facts.receivers.objects.len() as u32,
        channels: facts.channels(),
        bottom_y_m: bottom_y_m(facts) as f32,
        ior: set.band.ior as f32,
        sum_scale: power_of_two(PHOTON_COUNTS),
        term_scale: power_of_two(TERM_COUNTS),
        energy_scale: energy_scale(facts, index) as f32,
        first_texel: index as u32 * texels * texels,
        interpolates: u32::from(LOOKUP.word(&facts.quality) == INTERPOLATED),
        ..LightView::default()
    }
}

/// A uniform as the bytes of a step.
pub fn uniforms(view: &LightView) -> Vec<(&'static str, Vec<u8>)> {
    vec![(LIGHT_VIEW, bytemuck::bytes_of(view).to_vec())]
}
