//! Deposit — lays the beams of a light on the receivers' maps by exact texel coverage.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::light::light_uniform;
use super::slot::Slot;
use super::surface::wanted_for_light;

/// Water cells along a side of a workgroup's square, as in the shader.
pub(super) const CELLS_ALONG_GROUP: u32 = 8;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "deposit",
    repeat: Repeat::Light,
    reads: &[Slot::Surface, Slot::Beams, Slot::Hits, Slot::Receivers],
    reads_if_present: &[],
    writes: &[Slot::Flux, Slot::Energy, Slot::SplitQueue, Slot::WideQueue],
    wanted: wanted_for_light,
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let groups = facts.quality.water_cells.div_ceil(CELLS_ALONG_GROUP);
        let uniforms = vec![("light", light_uniform(facts, index, wide_sums))];
        vec![
            Step {
                entry: "deposit_main",
                work: Work::Compute(Groups::Direct([groups, groups, 1])),
                uniforms: uniforms.clone(),
            },
            Step {
                entry: "deposit_wide",
                work: Work::Compute(Groups::Queue(Slot::WideQueue)),
                uniforms,
            },
        ]
    },
};
