//! Split — halves beams whose corners end on different receivers, with rays of their own: a dispatch per halving, which queues the
//! parts that still straddle for the next one.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::Split;
use super::light::light_uniform;
use super::slot::{self, Slot};
use super::surface::wanted_for_light;
use crate::facts::SceneFacts;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "split",
    repeat: Repeat::Light,
    reads: &[
        Slot::SplitQueue,
        Slot::Waves,
        Slot::Receivers,
        Slot::LevelMaps,
        Slot::Geometry,
        Slot::Instances,
    ],
    reads_if_present: &[],
    writes: &[Slot::Flux, Slot::Energy, Slot::SplitQueue],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let wet = facts.wet_objects().count();
        if wet == 0 {
            return Err("no object is under water: every beam ends on the floor".to_owned());
        }
        Ok(format!(
            "{wet} object{} may tear beams",
            if wet == 1 { "" } else { "s" }
        ))
    },
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let light = light_uniform(facts, index, wide_sums);
        let levels = facts.quality.split_levels;
        (levels.min(1)..=levels)
            .map(|level| Step {
                entry: "split_main",
                work: Work::Compute(Groups::Queue(Slot::SplitQueue)),
                uniforms: vec![
                    ("light", light.clone()),
                    (
                        "split",
                        bytemuck::bytes_of(&level_of(facts, level)).to_vec(),
                    ),
                ],
            })
            .chain([Step {
                entry: "split_wide",
                work: Work::Compute(Groups::QueueAt(Slot::SplitQueue, slot::SPLIT_WIDE_WORD)),
                uniforms: vec![
                    ("light", light.clone()),
                    ("split", bytemuck::bytes_of(&level_of(facts, 0)).to_vec()),
                ],
            }])
            .collect()
    },
};

/// Where halving number `level` finds its beams or parts, and where it leaves what straddles on.
fn level_of(facts: &SceneFacts, level: u32) -> Split {
    let capacity = slot::split_parts(facts);
    let beams = slot::SPLIT_HEAD_WORDS as u32;
    let parts = beams + 2 * facts.quality.water_cells * facts.quality.water_cells;
    // Odd levels leave their parts in the first list, even ones in the second.
    let list = |level: u32| parts + 2 * capacity * ((level + 1) % 2);
    Split {
        level,
        source: if level <= 1 { beams } else { list(level - 1) },
        destination: list(level),
        capacity,
        wide: parts + 4 * capacity,
        wide_capacity: slot::split_wides(facts),
        ..Split::default()
    }
}
