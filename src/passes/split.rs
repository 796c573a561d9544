//! Split — halves beams whose corners end on different receivers, with rays of their own.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::light::light_uniform;
use super::slot::Slot;
use super::surface::wanted_for_sun;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "split",
    repeat: Repeat::Sun,
    reads: &[
        Slot::SplitQueue,
        Slot::Waves,
        Slot::Receivers,
        Slot::LevelMaps,
    ],
    reads_if_present: &[],
    writes: &[Slot::Flux, Slot::Energy],
    wanted: |facts| {
        wanted_for_sun(facts)?;
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
        let Run::Sun { index, wide_sums } = run else {
            return Vec::new();
        };
        vec![Step {
            entry: "split_main",
            work: Work::Compute(Groups::Queue(Slot::SplitQueue)),
            uniforms: vec![("light", light_uniform(facts, index, wide_sums))],
        }]
    },
};
