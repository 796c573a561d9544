//! Volumetric — light on meshes by an image of every slice (Tipprasert 2006, §5.2.1), what level maps are measured against. All of
//! it is done anew for every frame, slices too.

use super::desc::{PassDesc, Repeat, Run, Step, Work};
use super::level_map::view_of;
use super::plane_steps::{cull_steps, objects_of, over_queue, plane_step, wanted_for_planes};
use super::slot::Slot;
use crate::facts::SceneFacts;
use crate::facts::placement::LevelBox;
use crate::physics::slicing::plane_depth;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "volumetric",
    repeat: Repeat::Light,
    reads: &[
        Slot::Surface,
        Slot::Beams,
        Slot::Receivers,
        Slot::Geometry,
        Slot::Instances,
    ],
    reads_if_present: &[],
    writes: &[
        Slot::Flux,
        Slot::BeamQueue,
        Slot::PlaneCounts,
        Slot::Slices,
        Slot::Combined,
    ],
    wanted: |facts| {
        let objects = wanted_for_planes(facts)?;
        if !facts.quality.is_volumetric() {
            return Err("quality.method is level_map".to_owned());
        }
        Ok(format!(
            "{objects}, an image for each of {} planes",
            facts.quality.planes
        ))
    },
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let light = (index, wide_sums);
        let mut steps = Vec::new();
        for (object, texels) in objects_of(facts, index) {
            let set = &facts.lights.beam_sets[index];
            let Some(level_box) = &facts.lights.boxes_of(set)[object] else {
                continue;
            };
            let planes = 0..facts.planes_of(object);
            steps.extend(
                planes
                    .clone()
                    .map(|plane| slice_step(facts, light, level_box, object, plane)),
            );
            steps.extend(cull_steps(facts, light, object, "volumetric_share_out"));
            let tiles = texels.div_ceil(8);
            for plane in planes {
                let place = (object, plane);
                let entries = ["volumetric_deposit", "volumetric_wide"];
                steps.extend(over_queue(facts, light, place, entries));
                let work = Work::OverSlice {
                    groups: [tiles, tiles, 1],
                    plane,
                };
                steps.push(plane_step(facts, light, place, "volumetric_combine", work));
            }
        }
        steps
    },
};

/// Draws what lies between the middles of a plane and its neighbours.
fn slice_step(
    facts: &SceneFacts,
    light: (usize, bool),
    level_box: &LevelBox,
    object: usize,
    plane: u32,
) -> Step {
    let [s_min, s_max] = level_box.s_range;
    let planes = f64::from(facts.planes_of(object));
    let border = |index: f64| plane_depth(s_min, s_max, planes, index) as f32;
    let mut view = view_of(level_box, 0, 0);
    view.s_min = border(f64::from(plane) - 0.5);
    view.s_max = border(f64::from(plane) + 0.5);
    let work = Work::DrawSlice {
        plane,
        texels: level_box.key.texels,
        vertices: 3 * facts.receivers.objects[object].triangles,
    };
    let mut step = plane_step(facts, light, (object, plane), "slice_vertex", work);
    let view = bytemuck::bytes_of(&view).to_vec();
    step.uniforms.push(("level_map_view", view));
    step
}
