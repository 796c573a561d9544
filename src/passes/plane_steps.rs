//! What the passes that place light by planes share: their uniform, and the steps that find the beams that may reach an object.

use super::desc::{Groups, Step, Work};
use super::gpu_data::Planes;
use super::light::light_uniform;
use super::maps::MapLayout;
use super::slot::{self, Slot};
use crate::facts::SceneFacts;
use crate::scene::Slicing;

/// Word of the beam queue where the dispatch over beams with wide footprints lies.
pub(super) const WIDE_DISPATCH: u32 = 4;

/// The wet objects of a light, with the texels along a side of their maps.
pub(super) fn objects_of(facts: &SceneFacts, light: usize) -> Vec<(usize, u32)> {
    let set = &facts.lights.beam_sets[light];
    let boxes = facts.lights.boxes_of(set).iter().enumerate();
    boxes
        .filter_map(|(object, level_box)| Some((object, level_box.as_ref()?.key.texels)))
        .collect()
}

/// The uniform for an object and, where each plane has its own dispatch, a plane.
pub(super) fn planes_uniform(facts: &SceneFacts, object: usize, plane: u32) -> Vec<u8> {
    let narrow = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
    let cells = u64::from(facts.quality.water_cells);
    let uniform = Planes {
        receiver: narrow(1 + object as u64 * u64::from(facts.quality.layers)),
        object: narrow(object as u64),
        planes: facts.planes_of(object),
        list: narrow(object as u64 * slot::plane_list_words(facts)),
        plane,
        scratch: MapLayout::of(facts).scratch(),
        capacity: narrow(2 * cells * cells),
        smart: u32::from(facts.quality.slicing == Slicing::Smart),
    };
    bytemuck::bytes_of(&uniform).to_vec()
}

/// One dispatch for an object under a light.
pub(super) fn plane_step(
    facts: &SceneFacts,
    (light, wide_sums): (usize, bool),
    (object, plane): (usize, u32),
    entry: &'static str,
    work: Work,
) -> Step {
    Step {
        entry,
        work,
        uniforms: vec![
            ("light", light_uniform(facts, light, wide_sums)),
            ("planes", planes_uniform(facts, object, plane)),
        ],
    }
}

/// Queues the beams that may reach an object, and shares the dispatches out over them (`share_out` is the pass's own entry point).
pub(super) fn cull_steps(
    facts: &SceneFacts,
    light: (usize, bool),
    object: usize,
    share_out: &'static str,
) -> [Step; 3] {
    let tiles = facts.quality.water_cells.div_ceil(8);
    let step = |entry, groups| {
        let work = Work::Compute(Groups::Direct(groups));
        plane_step(facts, light, (object, 0), entry, work)
    };
    [
        step("cull_reset", [1, 1, 1]),
        step("cull_main", [tiles, tiles, 1]),
        step(share_out, [1, 1, 1]),
    ]
}

/// The dispatch over the queue's beams with narrow footprints, and the one over those with wide ones.
pub(super) fn over_queue(
    facts: &SceneFacts,
    light: (usize, bool),
    place: (usize, u32),
    [narrow, wide]: [&'static str; 2],
) -> [Step; 2] {
    let step = |entry, groups| plane_step(facts, light, place, entry, Work::Compute(groups));
    [
        step(narrow, Groups::Queue(Slot::BeamQueue)),
        step(wide, Groups::QueueAt(Slot::BeamQueue, WIDE_DISPATCH)),
    ]
}

/// Why planes are in or out, up to which of the two ways they go.
pub(super) fn wanted_for_planes(facts: &SceneFacts) -> Result<String, String> {
    if !facts.quality.has_planes() {
        return Err("quality.placement is hit".to_owned());
    }
    super::level_map::wanted_for_objects(facts)
}
