//! Level map pyramid — stores a drawn level map in the arena and halves it down to one texel, keeping the least front and the largest
//! back depth, so that rays cross empty space in large steps. Further layers are stored at full resolution only.

use super::level_map::{
    BACK_DEPTH, FRONT_DEPTH, FRONT_NORMAL, LAYER_DEPTH, LAYER_NORMAL, LEVEL_MAPS, LevelMapView,
    view_of, wanted_for_objects, work,
};
use super::{Groups, Pass, Step, Steps};
use crate::graph::View;

/// See the module.
pub static PASS: Pass = Pass {
    name: "level_map_pyramid",
    shader: "stages/level_map_pyramid.wgsl",
    reads: &[&FRONT_DEPTH, &FRONT_NORMAL, &BACK_DEPTH],
    reads_if_present: &[&LAYER_DEPTH, &LAYER_NORMAL],
    writes: &[&LEVEL_MAPS],
    uniforms: &[("level_map_view", LevelMapView::LAYOUT)],
    views: &[],
    wanted: wanted_for_objects,
    steps: Steps::LevelMap(|_, run| {
        let key = &run.level_box.key;
        let texels = key.texels;
        let mut view = view_of(&run.level_box, run.arena_offset, run.first_triangle);
        let mut offset = run.arena_offset;
        let offsets: Vec<u32> = (0..key.levels())
            .map(|level| {
                let here = offset;
                offset += 2 * (texels >> level) * (texels >> level);
                here
            })
            .collect();
        let step = |entry, side: u32, view: &LevelMapView| {
            let groups = Groups::Direct([side.div_ceil(8), side.div_ceil(8), 1]);
            let view = bytemuck::bytes_of(view).to_vec();
            Step::compute(entry, groups, vec![("level_map_view", view)])
        };
        // The normals lie behind the last level.
        view.target_offset = run.arena_offset;
        view.source_offset = offset;
        let mut steps = vec![step("pyramid_store", texels, &view)];
        for layer in 1..key.layers {
            view.source_offset = offset + key.normals_after(layer);
            view.target_offset = view.source_offset - texels * texels;
            let layer = layer - 1;
            let of_layer = |variable, slot| View {
                variable,
                slot,
                layer,
            };
            steps.push(Step {
                views: vec![
                    of_layer("layer_depth", &LAYER_DEPTH),
                    of_layer("layer_normal", &LAYER_NORMAL),
                ],
                ..step("pyramid_layer", texels, &view)
            });
        }
        for level in 1..key.levels() {
            view.level = level;
            view.source_offset = offsets[level as usize - 1];
            view.target_offset = offsets[level as usize];
            steps.push(step("pyramid_halve", texels >> level, &view));
        }
        steps
    }),
    work,
};
