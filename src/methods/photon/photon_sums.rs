//! Photon sums — adds each photon's flux to its texel of the light's map, as integers, whose sum does not depend on their order.

use super::photons::PHOTONS;
use super::view::{LIGHT_VIEW, LightView, light_view, photon_count, texels, uniforms};
use super::{DEPOSIT, DRAWN, draws};
use crate::facts::SceneFacts;
use crate::graph::Clear;
use crate::stages::queues::in_columns;
use crate::stages::surface::wanted_for_light;
use crate::stages::{Pass, Slot, Step, Steps};

/// Sums of a beam set.
pub static PHOTON_SUMS: Slot = Slot {
    clear: Clear::Zero(|facts, _| bytes(facts)),
    ..Slot::buffer(
        "photon_sums",
        "64-bit fixed-point flux of the photons per texel and channel",
        bytes,
    )
};

fn bytes(facts: &SceneFacts) -> u64 {
    if draws(facts) {
        return 0;
    }
    8 * u64::from(facts.channels()) * u64::from(texels(facts)).pow(2)
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "photon_sums",
    shader: "methods/photon/photon_sums.wgsl",
    reads: &[&PHOTONS],
    reads_if_present: &[],
    writes: &[&PHOTON_SUMS],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        if draws(facts) {
            return Err("photons are drawn as points".to_owned());
        }
        let texels = texels(facts);
        let sums = format!("sums of {texels} × {texels} texels");
        Ok(if DEPOSIT.word(&facts.quality) == DRAWN {
            format!("{sums}; the adapter cannot blend 32-bit floats, so integers are added instead")
        } else {
            sums
        })
    },
    steps: Steps::FineBeamSet(|facts, set| {
        let groups = in_columns(photon_count(facts).div_ceil(64));
        let uniforms = uniforms(&light_view(facts, set.index));
        vec![Step::compute("photon_sums_main", groups, uniforms)]
    }),
    work: |facts| f64::from(photon_count(facts)),
};
