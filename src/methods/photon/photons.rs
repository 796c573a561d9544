//! Photons — light from each cell of the water to where it ends (Mihálik 2008, §8.1).

use super::photon_view::LIGHT_DEPTH;
use super::view::{LIGHT_VIEW, LightView, light_view, photon_count, photons_per_side, uniforms};
use super::{EXACT, ITERATIONS, SEARCH};
use crate::graph::View;
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::queues::in_columns;
use crate::stages::sums::ENERGY;
use crate::stages::surface::{WAVES, wanted_for_light};
use crate::stages::{Pass, Slot, Step, Steps};

/// The photons of a beam set.
pub static PHOTONS: Slot = Slot::buffer(
    "photons",
    "place on the map texels, flux that enters m² under 1 W/m², path m per photon",
    |facts| 16 * u64::from(photon_count(facts)),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "photons",
    shader: "methods/photon/photons.wgsl",
    reads: &[&WAVES, &GEOMETRY, &INSTANCES, &LIGHT_DEPTH],
    reads_if_present: &[],
    writes: &[&PHOTONS, &ENERGY],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &["light_depth"],
    wanted: |facts| {
        let lights = wanted_for_light(facts)?;
        let side = photons_per_side(facts);
        let how = match SEARCH.word(&facts.quality) {
            EXACT => "to where they meet the scene".to_owned(),
            _ => match ITERATIONS.integer(&facts.quality) {
                1 => "in 1 step of the search in image space".to_owned(),
                steps => format!("in {steps} steps of the search in image space"),
            },
        };
        Ok(format!(
            "{lights}; {side} × {side} photons are followed {how}"
        ))
    },
    steps: Steps::FineBeamSet(|facts, set| {
        let entry = match SEARCH.word(&facts.quality) {
            EXACT => "photons_exact",
            _ => "photons_in_image_space",
        };
        let groups = in_columns(photon_count(facts).div_ceil(64));
        let uniforms = uniforms(&light_view(facts, set.index));
        vec![Step {
            views: vec![View {
                variable: "light_depth",
                slot: &LIGHT_DEPTH,
                layer: set.index as u32,
            }],
            ..Step::compute(entry, groups, uniforms)
        }]
    }),
    work: |facts| {
        let waves = facts.water.surface.gpu_work_per_point();
        f64::from(photon_count(facts)) * (1.0 + waves)
    },
};
