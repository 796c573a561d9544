//! Plane deposit — light on meshes by reference planes (Tipprasert 2006, ch. 4). Each beam's triangle on each plane lights the texels
//! whose depth is within half a plane distance. Only beams that may reach the object are processed.

use crate::stages::beams::BEAMS;
use crate::stages::level_map::LEVEL_MAPS;
use crate::stages::light::Light;
use crate::stages::receivers::RECEIVERS;
use crate::stages::reference_planes::{
    BEAM_QUEUE, PLANE_COUNTS, PLANE_LISTS, Planes, beams_at_planes, cull_steps, objects_of,
    over_queue, wanted_for_planes,
};
use crate::stages::sums::{ENERGY, FLUX};
use crate::stages::surface::SURFACE;
use crate::stages::{Pass, Steps};

/// See the module.
pub static PASS: Pass = Pass {
    name: "plane_deposit",
    shader: "methods/planes/plane_deposit.wgsl",
    reads: &[&SURFACE, &BEAMS, &RECEIVERS, &LEVEL_MAPS, &PLANE_LISTS],
    reads_if_present: &[],
    writes: &[&FLUX, &ENERGY, &BEAM_QUEUE, &PLANE_COUNTS],
    uniforms: &[("light", Light::LAYOUT), ("planes", Planes::LAYOUT)],
    views: &[],
    wanted: |facts| {
        let objects = wanted_for_planes(facts)?;
        Ok(format!(
            "{objects}, cut by {} planes",
            facts.method.reference_planes
        ))
    },
    steps: Steps::BeamSet(|facts, set| {
        objects_of(facts, set.index)
            .into_iter()
            .flat_map(|(object, _)| {
                let cull = cull_steps(facts, set, object, "planes_share_out");
                let deposit = over_queue(facts, set, (object, 0), ["planes_main", "planes_wide"]);
                cull.into_iter().chain(deposit)
            })
            .collect()
    }),
    work: beams_at_planes,
};
