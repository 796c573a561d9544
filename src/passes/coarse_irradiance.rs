//! Coarse irradiance — what the light that is done again with two fifths of the water cells or fewer leaves at the places where the estimate
//! looks: coarse maps are never made whole.

use super::desc::{PassDesc, Repeat, Run, Step, Work};
use super::estimate::{self, Compared};
use super::gpu_data::{CoarseLight, vec4};
use super::light::light_uniform;
use super::slot::{self, Slot};

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "coarse_irradiance",
    repeat: Repeat::CoarseLight,
    reads: &[Slot::Comparisons, Slot::Flux, Slot::Energy, Slot::Receivers],
    reads_if_present: &[],
    writes: &[Slot::CoarseIrradiance],
    wanted: |facts| {
        estimate::wanted(facts)?;
        Ok(format!(
            "the light is done again with {} water cells",
            estimate::coarse_cells(facts)
        ))
    },
    steps: |facts, run| {
        let Run::CoarseLight {
            index,
            wide_sums,
            fine,
        } = run
        else {
            return Vec::new();
        };
        let compared = estimate::compared(fine);
        let floors: Vec<Compared> = (compared.iter().copied())
            .filter(|c| c.light.is_none())
            .collect();
        let own: Vec<Compared> = (compared.iter().copied())
            .filter(|c| c.light == Some(facts.lights.beam_sets[index].light))
            .collect();
        let light = light_uniform(facts, index, wide_sums);
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
                Step {
                    entry: "coarse_irradiance_main",
                    work: Work::Compute(slot::in_columns(group_count)),
                    uniforms: vec![
                        ("light", light.clone()),
                        ("coarse_light", bytemuck::bytes_of(&coarse_light).to_vec()),
                    ],
                }
            })
            .collect()
    },
};
