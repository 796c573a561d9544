//! Deposit — adds the flux of a beam set's beams to the receivers' maps by exact texel coverage.

use super::beams::BEAMS;
use super::hits::HITS;
use super::light::{Light, light_uniform};
use super::queues::{QUEUE_HEAD_WORDS, WIDE_GROUPS};
use super::receivers::RECEIVERS;
use super::split::SPLIT_QUEUE;
use super::sums::{ENERGY, FLUX, cost_of_channels, texels};
use super::surface::{SURFACE, cells, wanted_for_light};
use super::{Groups, Pass, Slot, Step, Steps};
use crate::graph::Clear;

/// Water cells along a side of a workgroup's square, as in the shader.
pub(crate) const CELLS_ALONG_GROUP: u32 = 8;

/// Wide footprints, each shared by several workgroups.
pub static WIDE_QUEUE: Slot = Slot {
    clear: Clear::Head(&[0, WIDE_GROUPS, 1, 0]),
    ..Slot::buffer(
        "wide_queue",
        "slices of footprints of many texels",
        |facts| 4 * (QUEUE_HEAD_WORDS + 2 * u64::from(facts.quality.water_cells).pow(2)),
    )
};

/// See the module.
pub static PASS: Pass = Pass {
    name: "deposit",
    shader: "stages/deposit.wgsl",
    reads: &[&SURFACE, &BEAMS, &HITS, &RECEIVERS],
    reads_if_present: &[],
    writes: &[&FLUX, &ENERGY, &SPLIT_QUEUE, &WIDE_QUEUE],
    uniforms: &[("light", Light::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| {
        let groups = facts.quality.water_cells.div_ceil(CELLS_ALONG_GROUP);
        let uniforms = vec![("light", light_uniform(facts, set))];
        vec![
            Step::compute(
                "deposit_main",
                Groups::Direct([groups, groups, 1]),
                uniforms.clone(),
            ),
            Step::compute("deposit_wide", Groups::Queue(&WIDE_QUEUE, 0), uniforms),
        ]
    }),
    // The beams cover the maps about twice, whatever their number.
    work: |facts| (5.0 * cells(facts) + texels(facts)) * cost_of_channels(facts),
};
