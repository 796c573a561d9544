//! Unfollowed — sums the light that takes ways which are not followed: slopes that look away from it, rays that come out of the water
//! again, troughs below the floor. Only where the waves are steep or deep enough for that.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::Unfollowed;
use super::light::light_uniform;
use super::slot::Slot;
use super::surface::wanted_for_light;
use crate::facts::source::Source;

/// Steps along the shortest wave, at least.
const STEPS_PER_WAVE: f64 = 64.0;
/// What is still a step on water without waves, m.
const LONGEST_STEP_M: f64 = 1e6;
/// Where the floor is if there is none, m.
const NO_FLOOR_M: f64 = -1e30;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "unfollowed",
    repeat: Repeat::FineLight,
    reads: &[Slot::Waves, Slot::Surface, Slot::Beams, Slot::Hits],
    reads_if_present: &[],
    writes: &[Slot::Energy],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let ways = facts.unfollowed_ways().words();
        if ways.is_empty() {
            return Err(
                "no wave is so steep that light comes out of the water again or slopes look away from it, nor so high that it bares the floor"
                    .to_owned(),
            );
        }
        Ok(format!(
            "counts light that is not followed: {}",
            ways.join(", ")
        ))
    },
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        if matches!(
            facts.lights.beam_sets[index].source,
            Source::Submerged { .. }
        ) {
            return Vec::new();
        }
        let ways = facts.unfollowed_ways();
        let least_step_m = if ways.again || ways.bared {
            (facts.water.surface.shortest_wave_m() / STEPS_PER_WAVE).min(LONGEST_STEP_M)
        } else {
            0.0
        };
        let uniform = Unfollowed {
            max_height_m: facts.water.surface.max_height_m() as f32,
            max_slope: facts.water.surface.max_slope() as f32,
            least_step_m: least_step_m as f32,
            floor_y_m: facts
                .receivers
                .floor
                .as_ref()
                .map_or(NO_FLOOR_M, |floor| floor.y_m) as f32,
        };
        let groups = facts.quality.water_cells.div_ceil(8);
        vec![Step {
            entry: "unfollowed_main",
            work: Work::Compute(Groups::Direct([groups, groups, 1])),
            uniforms: vec![
                ("light", light_uniform(facts, index, wide_sums)),
                ("unfollowed", bytemuck::bytes_of(&uniform).to_vec()),
            ],
        }]
    },
};
