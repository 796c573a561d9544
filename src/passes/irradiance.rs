//! Irradiance — turns a sun's flux sums into W/m², and adds them to the floor's map.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::{Resolve, vec4};
use super::light::{light_uniform, receivers};
use super::slot::{self, Slot};
use super::surface::wanted_for_sun;
use crate::scene::Receiver;
use crate::scene::facts::SceneFacts;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "irradiance",
    repeat: Repeat::Sun,
    reads: &[Slot::Flux, Slot::Energy],
    reads_if_present: &[],
    writes: &[Slot::Irradiance],
    wanted: |facts| {
        wanted_for_sun(facts)?;
        let mut parts = Vec::new();
        if let Some(map) = facts.floor_map {
            parts.push(format!(
                "the floor's map of {} × {} texels",
                map.width, map.height
            ));
        }
        let wet = match facts.map_receiver {
            None => facts.wet_objects().count(),
            Some(Receiver::Floor(_)) => 0,
            Some(Receiver::Object(_)) => 1,
        };
        if wet > 0 {
            let most = facts
                .wet_objects()
                .map(|o| facts.objects[o].map_texels)
                .max();
            parts.push(format!(
                "{wet} object map{} of {}² texels",
                if wet == 1 { "" } else { "s" },
                most.unwrap_or(0)
            ));
        }
        Ok(parts.join(" and "))
    },
    steps: |facts, run| resolve_steps("irradiance_main", facts, run),
};

/// Whether anything reads the finished map of receiver `number` (0 the floor, then the objects' layers): a camera reads all, a map
/// is of one.
fn is_asked_for(facts: &SceneFacts, number: usize) -> bool {
    match facts.map_receiver {
        None => true,
        Some(Receiver::Floor(_)) => number == 0,
        Some(Receiver::Object(index)) => {
            number > 0 && (number - 1) / facts.quality.layers as usize == index as usize
        }
    }
}

/// One dispatch per receiver of a sun whose map is asked for: its piece of the flux sums becomes W/m².
pub(super) fn resolve_steps(entry: &'static str, facts: &SceneFacts, run: Run<'_>) -> Vec<Step> {
    let Run::Sun { index, wide_sums } = run else {
        return Vec::new();
    };
    let mut steps = Vec::new();
    for (number, receiver) in receivers(facts, index, |_| 0).iter().enumerate() {
        let texels = receiver.map_width * receiver.map_height;
        if texels == 0 || !is_asked_for(facts, number) {
            continue;
        }
        let resolve = Resolve {
            power: vec4(facts.suns[index].power, 0.0),
            first_texel: receiver.map_offset,
            texel_count: texels,
            first_output: receiver.irradiance_offset,
            adds: u32::from(number == 0 && index > 0),
            density_per_flux: receiver.density_per_flux,
            ..Resolve::default()
        };
        let groups = texels.div_ceil(64);
        let columns = groups.min(slot::MOST_GROUPS);
        steps.push(Step {
            entry,
            work: Work::Compute(Groups::Direct([columns, groups.div_ceil(columns), 1])),
            uniforms: vec![
                ("light", light_uniform(facts, index, wide_sums)),
                ("resolve", bytemuck::bytes_of(&resolve).to_vec()),
            ],
        });
    }
    steps
}
