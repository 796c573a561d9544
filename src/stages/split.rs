//! Split — halves the sides of beams whose corners end on different receivers, and traces the new corners. One dispatch per halving
//! level; parts that still straddle receivers are queued for the next level.

use super::level_map::LEVEL_MAPS;
use super::light::{Light, light_uniform};
use super::objects::{GEOMETRY, INSTANCES};
use super::receivers::RECEIVERS;
use super::sums::{ENERGY, FLUX};
use super::surface::{WAVES, wanted_for_light};
use super::{Groups, Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::Clear;

/// Words at the head of the split queue, which has a count per level.
pub const SPLIT_HEAD_WORDS: u64 = 16;
/// Word of that head where the dispatch over wide footprints begins; the word before it is their count.
pub const SPLIT_WIDE_WORD: u32 = 13;
/// Capacity of a level of the split queue in parts, per cell along the window's side and times 2^`split_levels`. Enough for shadow edges
/// whose total length is thirty times the window's side.
const PARTS_PER_CELL: u64 = 64;
/// Largest capacity of a level of the split queue, in parts: 32 MiB.
const MOST_PARTS: u64 = 1 << 22;

gpu_struct! {
    /// The uniform of `shaders/stages/split.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Split = "Split" {
        level: u32,
        source: u32,
        destination: u32,
        capacity: u32,
        wide: u32,
        wide_capacity: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

/// Beams to be halved.
pub static SPLIT_QUEUE: Slot = Slot {
    clear: Clear::Head(&[0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
    ..Slot::buffer(
        "split_queue",
        "beams that straddle receivers, and two levels of their parts",
        |facts| {
            let cells = u64::from(facts.quality.water_cells);
            4 * (SPLIT_HEAD_WORDS
                + 2 * cells * cells
                + 4 * u64::from(split_parts(facts))
                + 2 * u64::from(split_wides(facts)))
        },
    )
};

/// See the module.
pub static PASS: Pass = Pass {
    name: "split",
    shader: "stages/split.wgsl",
    reads: &[
        &SPLIT_QUEUE,
        &WAVES,
        &RECEIVERS,
        &LEVEL_MAPS,
        &GEOMETRY,
        &INSTANCES,
    ],
    reads_if_present: &[],
    writes: &[&FLUX, &ENERGY, &SPLIT_QUEUE],
    uniforms: &[("light", Light::LAYOUT), ("split", Split::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let wet = facts.wet_objects().count();
        if wet == 0 {
            return Err("no object is under water: every beam ends on the floor".to_owned());
        }
        Ok(format!(
            "{wet} object{} may split beams",
            if wet == 1 { "" } else { "s" }
        ))
    },
    steps: Steps::BeamSet(|facts, set| {
        let light = light_uniform(facts, set);
        let levels = facts.quality.split_levels;
        let step = |entry, word, level| {
            let split = bytemuck::bytes_of(&level_of(facts, level)).to_vec();
            Step::compute(
                entry,
                Groups::Queue(&SPLIT_QUEUE, word),
                vec![("light", light.clone()), ("split", split)],
            )
        };
        (levels.min(1)..=levels)
            .map(|level| step("split_main", 0, level))
            .chain([step("split_wide", SPLIT_WIDE_WORD, 0)])
            .collect()
    }),
    // Parts along the shadows' edges; each part evaluates the waves and traverses the meshes' hierarchies.
    work: |facts| {
        f64::from(facts.quality.water_cells)
            * f64::from(1_u32 << facts.quality.split_levels)
            * edges(facts)
            * (1.0
                + facts.water.surface.gpu_work_per_point()
                + (facts.receivers.geometry_bytes as f64 / 64.0)
                    .max(1.0)
                    .log2())
    },
};

/// Where halving number `level` reads its beams or parts, and where it writes the parts that still straddle.
fn level_of(facts: &SceneFacts, level: u32) -> Split {
    let capacity = split_parts(facts);
    let beams = SPLIT_HEAD_WORDS as u32;
    let parts = beams + 2 * facts.quality.water_cells * facts.quality.water_cells;
    // Odd levels leave their parts in the first list, even ones in the second.
    let list = |level: u32| parts + 2 * capacity * ((level + 1) % 2);
    Split {
        level,
        source: if level <= 1 { beams } else { list(level - 1) },
        destination: list(level),
        capacity,
        wide: parts + 4 * capacity,
        wide_capacity: split_wides(facts),
        ..Split::default()
    }
}

/// Capacity of a level of the split queue, in parts. Parts that were halved fewer than `split_levels` times are queued, and about twice
/// as many parts straddle after each halving.
pub fn split_parts(facts: &SceneFacts) -> u32 {
    let levels = facts.quality.split_levels;
    if levels < 2 || facts.wet_objects().next().is_none() {
        return 0;
    }
    let cells = u64::from(facts.quality.water_cells);
    // A level runs only if its queue could hold all four parts of every item.
    let all = (2 * cells * cells) << (2 * (levels - 1));
    let parts = ((PARTS_PER_CELL * cells) << levels)
        .min(all)
        .min(MOST_PARTS);
    u32::try_from(parts).unwrap_or(u32::MAX)
}

/// Capacity of the queue of wide footprints of straddling beams: the number of beams and parts.
pub fn split_wides(facts: &SceneFacts) -> u32 {
    if facts.wet_objects().next().is_none() {
        return 0;
    }
    let cells = facts.quality.water_cells;
    (2 * cells * cells).saturating_add(split_parts(facts))
}

/// Length of the shadows' edges, in units of the side of the widest window.
fn edges(facts: &SceneFacts) -> f64 {
    let around_m: f64 = facts
        .wet_objects()
        .map(|index| {
            let object = &facts.receivers.objects[index];
            let size = object.max - object.min;
            2.0 * (size.x + size.z)
        })
        .sum();
    let side_m = facts
        .lights
        .beam_sets
        .iter()
        .map(|set| set.span_m(facts.quality.water_cells))
        .fold(0.0, f64::max);
    if side_m > 0.0 { around_m / side_m } else { 0.0 }
}
