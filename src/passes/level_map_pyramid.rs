//! Level map pyramid — stores a drawn level map in the arena and halves it down to one texel, keeping least front and largest
//! back, so that rays pass empty space in large steps; further layers are stored as they are.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::level_map::{view_of, wanted_for_objects};
use super::slot::Slot;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "level_map_pyramid",
    repeat: Repeat::LevelMap,
    reads: &[],
    reads_if_present: &[],
    writes: &[Slot::LevelMaps],
    wanted: wanted_for_objects,
    steps: |_, run| {
        let Run::LevelMap {
            level_box,
            arena_offset,
            first_triangle,
            ..
        } = run
        else {
            return Vec::new();
        };
        let texels = level_box.key.texels;
        let mut view = view_of(level_box, arena_offset, first_triangle);
        let mut offset = arena_offset;
        let offsets: Vec<u32> = (0..level_box.key.levels())
            .map(|level| {
                let here = offset;
                offset += 2 * (texels >> level) * (texels >> level);
                here
            })
            .collect();
        let step = |entry, side: u32, view: &_| Step {
            entry,
            work: Work::Compute(Groups::Direct([side.div_ceil(8), side.div_ceil(8), 1])),
            uniforms: vec![("level_map_view", bytemuck::bytes_of(view).to_vec())],
        };
        // The normals lie behind the last level.
        view.target_offset = arena_offset;
        view.source_offset = offset;
        let mut steps = vec![step("pyramid_store", texels, &view)];
        for layer in 1..level_box.key.layers {
            view.source_offset = offset + level_box.key.normals_after(layer);
            view.target_offset = view.source_offset - texels * texels;
            let groups = [texels.div_ceil(8), texels.div_ceil(8), 1];
            steps.push(Step {
                work: Work::StoreLayer { layer, groups },
                ..step("pyramid_layer", texels, &view)
            });
        }
        for level in 1..level_box.key.levels() {
            view.level = level;
            view.source_offset = offsets[level as usize - 1];
            view.target_offset = offsets[level as usize];
            steps.push(step("pyramid_halve", texels >> level, &view));
        }
        steps
    },
};
