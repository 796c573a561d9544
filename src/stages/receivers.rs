//! The receivers of light, and where their maps lie: the floor, and each layer of each object.

use glam::DVec2;

use super::Slot;
use super::gpu_values::{vec2, vec4};
use super::maps::MapLayout;
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::Origin;

gpu_struct! {
    /// A receiver of `shaders/shared/receivers.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Receiver = "Receiver" {
        u_row: [f32; 4],
        v_row: [f32; 4],
        s_row: [f32; 4],
        map_width: u32,
        map_height: u32,
        map_offset: u32,
        level_map_offset: u32,
        s_min: f32,
        s_max: f32,
        level_count: u32,
        density_per_flux: f32,
        axis: [f32; 4],
        irradiance_offset: u32,
        s_per_m: f32,
        layer: u32,
        planes: u32,
        floor_min_m: [f32; 2],
        floor_max_m: [f32; 2],
    }
}

/// Receivers of the current light.
pub static RECEIVERS: Slot = Slot {
    origin: Origin::Host,
    element: Some(Receiver::LAYOUT),
    ..Slot::buffer(
        "receivers",
        "map of each receiver for the current light",
        bytes_of_a_light,
    )
};

/// Receivers of all lights.
pub static ALL_RECEIVERS: Slot = Slot {
    origin: Origin::Host,
    element: Some(Receiver::LAYOUT),
    ..Slot::buffer(
        "all_receivers",
        "map of each receiver for each light",
        |facts| bytes_of_a_light(facts) * facts.lights.lit.len().max(1) as u64,
    )
};

/// Bytes of the receivers of one light.
fn bytes_of_a_light(facts: &SceneFacts) -> u64 {
    let layers = u64::from(facts.quality.layers);
    let receivers = 1 + facts.receivers.objects.len() as u64 * layers;
    size_of::<Receiver>() as u64 * receivers
}

/// The receivers of lit light number `light`: the floor, then one per layer of each object. `level_map_offset` gives the place of an
/// object's level map in the arena.
pub fn receivers(
    facts: &SceneFacts,
    light: usize,
    level_map_offset: impl Fn(usize) -> u32,
) -> Vec<Receiver> {
    let mut all = vec![floor_receiver(facts)];
    let maps = MapLayout::of(facts);
    let layers = facts.quality.layers;
    for (object, level_box) in facts.lights.lit[light].boxes.iter().enumerate() {
        let Some(level_box) = level_box else {
            // A dry object has no texels but keeps its place: `density_at` in the shaders searches receivers by the start of their maps.
            all.extend((0..layers).map(|layer| Receiver {
                map_offset: maps.flux_of(object, layer),
                layer,
                ..Receiver::default()
            }));
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
            planes: facts.planes_of(object),
            ..Receiver::default()
        };
        all.extend((0..layers).map(|layer| Receiver {
            map_offset: maps.flux_of(object, layer),
            irradiance_offset: maps.irradiance_of(light, object, layer),
            layer,
            ..receiver
        }));
    }
    all
}

fn floor_receiver(facts: &SceneFacts) -> Receiver {
    let Some(floor) = &facts.receivers.floor else {
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
    if let Some(map) = facts.receivers.floor_map {
        let per_m = DVec2::new(f64::from(map.width), f64::from(map.height)) / map.rect.size();
        receiver.u_row = [per_m.x as f32, 0.0, 0.0, (-map.rect.min.x * per_m.x) as f32];
        receiver.v_row = [0.0, 0.0, per_m.y as f32, (-map.rect.min.y * per_m.y) as f32];
        receiver.map_width = map.width;
        receiver.map_height = map.height;
        receiver.density_per_flux = (per_m.x * per_m.y) as f32;
    }
    receiver
}
