//! Unfollowed — sums the light on paths that are not simulated: slopes that face away from the light, rays that leave the water again,
//! troughs below the floor. Runs only where the waves are steep or deep enough for that.

use super::beams::BEAMS;
use super::hits::HITS;
use super::light::{Light, light_uniform};
use super::sums::ENERGY;
use super::surface::{SURFACE, WAVES, cells, wanted_for_light};
use super::{Groups, Pass, Step, Steps};
use crate::gpu_struct;

/// Steps along the shortest wave, at least.
const STEPS_PER_WAVE: f64 = 64.0;
/// Longest step, for water without waves, m.
const LONGEST_STEP_M: f64 = 1e6;
/// Height of the floor where there is none, m: below everything.
const NO_FLOOR_M: f64 = -1e30;

gpu_struct! {
    /// The uniform of `shaders/stages/unfollowed.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Unfollowed = "Unfollowed" {
        max_height_m: f32,
        max_slope: f32,
        least_step_m: f32,
        floor_y_m: f32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "unfollowed",
    shader: "stages/unfollowed.wgsl",
    reads: &[&WAVES, &SURFACE, &BEAMS, &HITS],
    reads_if_present: &[],
    writes: &[&ENERGY],
    uniforms: &[("light", Light::LAYOUT), ("unfollowed", Unfollowed::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let paths = facts.unfollowed_paths().words();
        if paths.is_empty() {
            return Err(
                "no wave is steep enough for slopes to face away from a light or for rays to leave the water again, or high enough to bare the floor"
                    .to_owned(),
            );
        }
        Ok(format!(
            "counts light on paths that are not simulated: {}",
            paths.join(", ")
        ))
    },
    steps: Steps::FineBeamSet(|facts, set| {
        if facts.lights.beam_sets[set.index].is_submerged() {
            return Vec::new();
        }
        let paths = facts.unfollowed_paths();
        let surface = &facts.water.surface;
        let least_step_m = if paths.leaves_again || paths.bares_floor {
            (surface.shortest_wave_m() / STEPS_PER_WAVE).min(LONGEST_STEP_M)
        } else {
            0.0
        };
        let floor = facts.receivers.floor.as_ref();
        let uniform = Unfollowed {
            max_height_m: surface.max_height_m() as f32,
            max_slope: surface.max_slope() as f32,
            least_step_m: least_step_m as f32,
            floor_y_m: floor.map_or(NO_FLOOR_M, |floor| floor.y_m) as f32,
        };
        let groups = facts.quality.water_cells.div_ceil(8);
        vec![Step::compute(
            "unfollowed_main",
            Groups::Direct([groups, groups, 1]),
            vec![
                ("light", light_uniform(facts, set)),
                ("unfollowed", bytemuck::bytes_of(&uniform).to_vec()),
            ],
        )]
    }),
    // Where rays are marched on below the surface, each evaluates the waves some dozens of times.
    work: |facts| {
        let paths = facts.unfollowed_paths();
        let steps = if paths.leaves_again || paths.bares_floor {
            32.0
        } else {
            0.0
        };
        let waves = facts.water.surface.gpu_work_per_point();
        cells(facts) * (2.0 + steps * (1.0 + waves))
    },
};
