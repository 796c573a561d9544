//! Level map — draws what a light sees of a mesh through flat water (Tipprasert 2006, §4.2): front, back, normals; then layer by layer
//! what lies behind (depth peeling: Everitt, Interactive Order-Independent Transparency, 2001).

use super::desc::{PassDesc, Repeat, Run, Step, Surface, Work};
use super::gpu_data::{LevelMapView, vec4};
use super::slot::Slot;
use crate::facts::SceneFacts;
use crate::facts::placement::LevelBox;

/// Depth a level map is cleared to where there is nothing, as in the shaders.
pub const EMPTY_DEPTH: f64 = 1e30;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "level_map",
    repeat: Repeat::LevelMap,
    reads: &[Slot::Geometry],
    reads_if_present: &[],
    writes: &[Slot::LevelMaps],
    wanted: wanted_for_objects,
    steps: |_, run| {
        let Run::LevelMap {
            level_box,
            arena_offset,
            first_triangle,
            triangles,
        } = run
        else {
            return Vec::new();
        };
        let view = view_of(level_box, arena_offset, first_triangle);
        [Surface::Front, Surface::Back]
            .into_iter()
            .chain((1..level_box.key.layers).map(Surface::Layer))
            .map(|surface| Step {
                entry: "level_map_vertex",
                work: Work::DrawLevelMap {
                    surface,
                    vertices: 3 * triangles,
                },
                uniforms: vec![("level_map_view", bytemuck::bytes_of(&view).to_vec())],
            })
            .collect()
    },
};

/// Level maps are in when light meets objects under water.
pub(super) fn wanted_for_objects(facts: &SceneFacts) -> Result<String, String> {
    let wet = facts.wet_objects().count();
    if wet == 0 {
        return Err("no object is under water".to_owned());
    }
    super::surface::wanted_for_light(facts)?;
    let layers = match facts.quality.layers {
        1 => String::new(),
        layers => format!(" in {layers} layers"),
    };
    Ok(format!(
        "{wet} object{} under water{layers}{}",
        if wet == 1 { "" } else { "s" },
        facts.reduced_maps()
    ))
}

/// The uniform of a level map.
pub(super) fn view_of(
    level_box: &LevelBox,
    arena_offset: u32,
    first_triangle: u32,
) -> LevelMapView {
    let row = |r: glam::DVec4| vec4([r.x, r.y, r.z], r.w);
    LevelMapView {
        u_row: row(level_box.map_from_mesh[0]),
        v_row: row(level_box.map_from_mesh[1]),
        s_row: row(level_box.map_from_mesh[2]),
        s_min: level_box.s_range[0] as f32,
        s_max: level_box.s_range[1] as f32,
        texels: level_box.key.texels,
        first_triangle,
        arena_offset,
        ..LevelMapView::default()
    }
}
