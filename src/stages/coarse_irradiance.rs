//! Coarse irradiance — irradiance from coarse beam sets (light traced again with at most two fifths of the water cells) at the places that
//! the estimate compares. Coarse maps are never resolved as a whole.

use super::estimate::{self, COMPARISONS, Compared, places_of_groups};
use super::gpu_values::vec4;
use super::light::{Light, light_uniform};
use super::maps::MapLayout;
use super::queues::in_columns;
use super::receivers::RECEIVERS;
use super::sums::{FLUX, cost_of_channels};
use super::{Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::gpu_struct;

gpu_struct! {
    /// The uniform of `shaders/stages/coarse_irradiance.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub CoarseLight = "CoarseLight" {
        power: [f32; 4],
        first_group: u32,
        group_count: u32,
        comparison_count: u32,
        adds: u32,
    }
}

/// Irradiance of the coarse beam sets.
pub static COARSE_IRRADIANCE: Slot = Slot::buffer(
    "coarse_irradiance",
    "linear RGB of the coarse beam sets per compared place, W/m²",
    |facts| 12 * places_of_groups(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "coarse_irradiance",
    shader: "stages/coarse_irradiance.wgsl",
    reads: &[&COMPARISONS, &FLUX, &RECEIVERS],
    reads_if_present: &[],
    writes: &[&COARSE_IRRADIANCE],
    uniforms: &[
        ("light", Light::LAYOUT),
        ("coarse_light", CoarseLight::LAYOUT),
    ],
    views: &[],
    wanted: |facts| {
        estimate::wanted(facts)?;
        Ok(format!(
            "light is traced again with {} water cells",
            estimate::coarse_cells(facts)
        ))
    },
    steps: Steps::CoarseBeamSet(|facts, set, fine| {
        let index = set.index;
        let compared = estimate::compared(fine);
        let floors: Vec<Compared> = (compared.iter().copied())
            .filter(|c| c.light.is_none())
            .collect();
        let own: Vec<Compared> = (compared.iter().copied())
            .filter(|c| c.light == Some(facts.lights.beam_sets[index].light))
            .collect();
        let light = light_uniform(facts, set);
        let pieces = [
            (floors, index > 0),
            (own, !facts.lights.is_first_of_light(index)),
        ];
        let wanted = pieces.iter().filter(|(piece, _)| !piece.is_empty());
        wanted
            .map(|(piece, adds)| {
                let first_group = piece[0].comparison.first_group;
                let group_count = estimate::groups_of(piece) - first_group;
                let coarse_light = CoarseLight {
                    power: vec4(facts.lights.beam_sets[index].power, 0.0),
                    first_group,
                    group_count,
                    comparison_count: compared.len() as u32,
                    adds: u32::from(*adds),
                };
                Step::compute(
                    "coarse_irradiance_main",
                    in_columns(group_count),
                    vec![
                        ("light", light.clone()),
                        ("coarse_light", bytemuck::bytes_of(&coarse_light).to_vec()),
                    ],
                )
            })
            .collect()
    }),
    work,
};

/// Work of all passes of one coarse beam set on the coarse maps, and its part of the compared places.
fn work(facts: &SceneFacts) -> f64 {
    let maps = MapLayout::with_floor(facts, estimate::coarse_floor_map(facts));
    let sums = cost_of_channels(facts);
    let waves = facts.water.surface.gpu_work_per_point();
    let wet = facts.wet_objects().count() as f64;
    f64::from(estimate::coarse_cells(facts)).powi(2) * (5.0 * sums + 2.0 + waves + wet.sqrt())
        + maps.flux_texels() as f64 * sums
        + estimate::places_of_a_light(facts)
}
