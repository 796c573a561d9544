//! Planes — light on meshes by reference planes (Tipprasert 2006, ch. 4): each beam's triangle on each plane lights the texels
//! whose depth is within half a distance of the plane. Only beams that may reach the object are tried.

use super::desc::{PassDesc, Repeat, Run};
use super::plane_steps::{cull_steps, objects_of, over_queue, wanted_for_planes};
use super::slot::Slot;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "planes",
    repeat: Repeat::Light,
    reads: &[
        Slot::Surface,
        Slot::Beams,
        Slot::Receivers,
        Slot::LevelMaps,
        Slot::PlaneLists,
    ],
    reads_if_present: &[],
    writes: &[Slot::Flux, Slot::Energy, Slot::BeamQueue, Slot::PlaneCounts],
    wanted: |facts| {
        let objects = wanted_for_planes(facts)?;
        if facts.quality.is_volumetric() {
            return Err("quality.method is volumetric".to_owned());
        }
        Ok(format!("{objects}, cut by {} planes", facts.quality.planes))
    },
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let light = (index, wide_sums);
        objects_of(facts, index)
            .into_iter()
            .flat_map(|(object, _)| {
                let cull = cull_steps(facts, light, object, "planes_share_out");
                let deposit = over_queue(facts, light, (object, 0), ["planes_main", "planes_wide"]);
                cull.into_iter().chain(deposit)
            })
            .collect()
    },
};
