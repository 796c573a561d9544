//! Photon map — irradiance of a plane facing the sun, from the flux summed per texel.

use super::draws;
use super::photon_draw::PHOTON_DOTS;
use super::photon_sums::PHOTON_SUMS;
use super::view::{LIGHT_VIEW, LightView, light_view, texels, uniforms};
use crate::stages::surface::wanted_for_light;
use crate::stages::{Groups, Pass, Slot, Step, Steps};

/// The maps of all beam sets: what works at points later needs them together.
pub static PHOTON_MAP: Slot = Slot::buffer(
    "photon_map",
    "irradiance of a plane facing the sun W/m² per texel, for each beam set",
    |facts| 16 * u64::from(texels(facts)).pow(2) * facts.lights.beam_sets.len() as u64,
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "photon_map",
    shader: "methods/photon/photon_map.wgsl",
    reads: &[],
    reads_if_present: &[&PHOTON_SUMS, &PHOTON_DOTS],
    writes: &[&PHOTON_MAP],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::FineBeamSet(|facts, set| {
        let entry = if draws(facts) {
            "photon_map_of_dots"
        } else {
            "photon_map_of_sums"
        };
        let groups = texels(facts).div_ceil(8);
        let uniforms = uniforms(&light_view(facts, set.index));
        vec![Step::compute(
            entry,
            Groups::Direct([groups, groups, 1]),
            uniforms,
        )]
    }),
    work: |facts| f64::from(texels(facts)).powi(2),
};
