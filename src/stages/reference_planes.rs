//! Shared by the passes that place light by reference planes: their uniform, and the steps that find the beams that may reach an
//! object.

use super::level_map::wanted_for_objects;
use super::light::light_uniform;
use super::maps::MapLayout;
use super::queues::QUEUE_HEAD_WORDS;
use super::surface::cells;
use super::{Groups, Slot, Step};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::{BeamSetRun, Clear};

/// Words at the head of the queue of beams that may reach an object's planes: two dispatches with their counts.
pub const CULL_HEAD_WORDS: u64 = 2 * QUEUE_HEAD_WORDS;
/// Words at the head of an object's list of planes.
pub const PLANE_LIST_HEAD_WORDS: u64 = 4;
/// Texels along a side of a tile; the list of planes holds, for each tile, the planes near its surface.
pub const PLANE_TILE_TEXELS: u32 = 4;
/// Word of the beam queue where the dispatch over beams with wide footprints lies.
pub const WIDE_DISPATCH: u32 = 4;

gpu_struct! {
    /// The uniform of `shaders/shared/cull.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Planes = "Planes" {
        receiver: u32,
        object: u32,
        planes: u32,
        list: u32,
        plane: u32,
        scratch: u32,
        capacity: u32,
        smart: u32,
    }
}

/// Beams that may reach an object's planes.
pub static BEAM_QUEUE: Slot = Slot {
    clear: Clear::Head(&super::queues::EMPTY_QUEUE),
    ..Slot::buffer(
        "beam_queue",
        "beams that may reach the current object",
        |facts| 4 * (CULL_HEAD_WORDS + 2 * u64::from(facts.quality.water_cells).pow(2)),
    )
};

/// Which planes of each object are used.
pub static PLANE_LISTS: Slot = Slot {
    clear: Clear::Zero(|facts, _| list_bytes(facts)),
    ..Slot::buffer(
        "plane_lists",
        "planes in use, texels near each plane and planes near each tile, per object",
        list_bytes,
    )
};

/// Number of beams and planes that were used.
pub static PLANE_COUNTS: Slot = Slot::buffer(
    "plane_counts",
    "beams kept, planes used and pieces of the box per object",
    |facts| 16 * facts.receivers.objects.len() as u64,
);

fn list_bytes(facts: &SceneFacts) -> u64 {
    4 * plane_list_words(facts) * facts.receivers.objects.len() as u64
}

/// Words of an object's list of planes: its head, the planes, the texels near each, and the planes near each tile of its map.
pub fn plane_list_words(facts: &SceneFacts) -> u64 {
    let tiles = u64::from(facts.quality.level_map_texels / PLANE_TILE_TEXELS);
    PLANE_LIST_HEAD_WORDS + 2 * u64::from(facts.method.reference_planes) + tiles * tiles
}

/// The wet objects of a light, with the texels along a side of their maps.
pub fn objects_of(facts: &SceneFacts, light: usize) -> Vec<(usize, u32)> {
    let set = &facts.lights.beam_sets[light];
    let boxes = facts.lights.boxes_of(set).iter().enumerate();
    boxes
        .filter_map(|(object, level_box)| Some((object, level_box.as_ref()?.key.texels)))
        .collect()
}

/// The uniform for an object and, where each plane has its own dispatch, a plane.
pub fn planes_uniform(facts: &SceneFacts, object: usize, plane: u32) -> Vec<u8> {
    let narrow = |value: u64| u32::try_from(value).unwrap_or(u32::MAX);
    let cells = u64::from(facts.quality.water_cells);
    let uniform = Planes {
        receiver: narrow(1 + object as u64 * u64::from(facts.quality.layers)),
        object: narrow(object as u64),
        planes: facts.planes_of(object),
        list: narrow(object as u64 * plane_list_words(facts)),
        plane,
        scratch: MapLayout::of(facts).scratch(),
        capacity: narrow(2 * cells * cells),
        smart: u32::from(facts.method.skips_empty_planes),
    };
    bytemuck::bytes_of(&uniform).to_vec()
}

/// Units of work of placing light by planes: each beam at each plane of each object.
pub fn beams_at_planes(facts: &SceneFacts) -> f64 {
    let objects = facts.wet_objects().count() as f64;
    cells(facts) * f64::from(facts.method.reference_planes) * objects
}

/// The uniforms of a dispatch for an object under a beam set.
pub fn plane_uniforms(
    facts: &SceneFacts,
    set: BeamSetRun,
    (object, plane): (usize, u32),
) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("light", light_uniform(facts, set)),
        ("planes", planes_uniform(facts, object, plane)),
    ]
}

/// Queues the beams that may reach an object and sizes the dispatches over them (`share_out` is the pass's own entry point).
pub fn cull_steps(
    facts: &SceneFacts,
    set: BeamSetRun,
    object: usize,
    share_out: &'static str,
) -> [Step; 3] {
    let tiles = facts.quality.water_cells.div_ceil(8);
    let step = |entry, groups| {
        let uniforms = plane_uniforms(facts, set, (object, 0));
        Step::compute(entry, Groups::Direct(groups), uniforms)
    };
    [
        step("cull_reset", [1, 1, 1]),
        step("cull_main", [tiles, tiles, 1]),
        step(share_out, [1, 1, 1]),
    ]
}

/// The dispatch over the queue's beams with narrow footprints, and the one over those with wide ones.
pub fn over_queue(
    facts: &SceneFacts,
    set: BeamSetRun,
    place: (usize, u32),
    [narrow, wide]: [&'static str; 2],
) -> [Step; 2] {
    let step = |entry, word| {
        let uniforms = plane_uniforms(facts, set, place);
        Step::compute(entry, Groups::Queue(&BEAM_QUEUE, word), uniforms)
    };
    [step(narrow, 0), step(wide, WIDE_DISPATCH)]
}

/// The reason why passes that place light by planes run: light falls on objects under water.
pub fn wanted_for_planes(facts: &SceneFacts) -> Result<String, String> {
    wanted_for_objects(facts)
}
