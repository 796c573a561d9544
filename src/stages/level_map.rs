//! Level map — draws the mesh's surface visible from a light through flat water (Tipprasert 2006, §4.2): front depth, back depth, normals;
//! then the layers behind it, one by one (depth peeling: Everitt, Interactive Order-Independent Transparency, 2001).

use wgpu::{
    CompareFunction, PrimitiveTopology, TextureFormat, TextureUsages, TextureViewDimension,
};

use super::gpu_values::vec4;
use super::objects::GEOMETRY;
use super::surface::wanted_for_light;
use super::{Pass, Slot, Step, Steps, Work};
use crate::facts::SceneFacts;
use crate::facts::placement::LevelBox;
use crate::gpu_struct;
use crate::graph::{Color, Depth, Draw, Origin, Texture, View};

/// Depth of an empty texel of a level map, as in the shaders.
pub const EMPTY_DEPTH: f64 = 1e30;

gpu_struct! {
    /// The uniform of `shaders/shared/level_map_view.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub LevelMapView = "LevelMapView" {
        u_row: [f32; 4],
        v_row: [f32; 4],
        s_row: [f32; 4],
        s_min: f32,
        s_max: f32,
        texels: u32,
        first_triangle: u32,
        arena_offset: u32,
        level: u32,
        source_offset: u32,
        target_offset: u32,
    }
}

/// Parameters of a run that builds a level map.
#[derive(Clone, Debug)]
pub struct LevelMapRun {
    /// The map's box.
    pub level_box: LevelBox,
    /// Word offset in the arena.
    pub arena_offset: u32,
    /// Where the mesh's triangles begin, in 16-byte units of the geometry.
    pub first_triangle: u32,
    /// Number of triangles.
    pub triangles: u32,
}

/// Level maps.
pub static LEVEL_MAPS: Slot = Slot {
    origin: Origin::Cached,
    ..Slot::buffer(
        "level_maps",
        "front and back depth pyramids, packed normals, further layers",
        |_| 0,
    )
};

/// A render target of the extent that `extent` gives for a scene.
const fn target(
    format: TextureFormat,
    extent: fn(&SceneFacts) -> [u32; 3],
) -> Texture<super::Caustica> {
    Texture {
        format,
        dimension: TextureViewDimension::D2,
        extent,
        usage: TextureUsages::RENDER_ATTACHMENT,
    }
}

/// Texels along a side of the largest level map of the scene.
fn largest(facts: &SceneFacts) -> u32 {
    let boxes = facts.lights.lit.iter().flat_map(|light| light.boxes.iter());
    let texels = boxes.flatten().map(|level_box| level_box.key.texels);
    texels.max().unwrap_or(0)
}

fn one_layer(facts: &SceneFacts) -> [u32; 3] {
    [largest(facts), largest(facts), 1]
}

fn further_layers(facts: &SceneFacts) -> [u32; 3] {
    [largest(facts), largest(facts), facts.quality.layers - 1]
}

/// Depth of the nearest surface.
pub static FRONT_DEPTH: Slot = Slot::texture(
    "front_depth",
    "depth of a level map's nearest surface, units of its box",
    target(TextureFormat::R32Float, one_layer),
);
/// Normal of the nearest surface.
pub static FRONT_NORMAL: Slot = Slot::texture(
    "front_normal",
    "packed normal of a level map's nearest surface",
    target(TextureFormat::R32Uint, one_layer),
);
/// Depth of the farthest surface.
pub static BACK_DEPTH: Slot = Slot::texture(
    "back_depth",
    "depth of a level map's farthest surface, units of its box",
    target(TextureFormat::R32Float, one_layer),
);
/// Normal of the farthest surface; unused.
pub static BACK_NORMAL: Slot = Slot::texture(
    "back_normal",
    "packed normal of a level map's farthest surface",
    target(TextureFormat::R32Uint, one_layer),
);
/// Depth of each further layer.
pub static LAYER_DEPTH: Slot = Slot::texture(
    "layer_depth",
    "depth of each further layer of a level map, units of its box",
    target(TextureFormat::R32Float, further_layers),
);
/// Normal of each further layer.
pub static LAYER_NORMAL: Slot = Slot::texture(
    "layer_normal",
    "packed normal of each further layer of a level map",
    target(TextureFormat::R32Uint, further_layers),
);
/// The depth that draws of level maps are tested against.
pub static MAP_DEPTH: Slot = Slot::texture(
    "map_depth",
    "depth that draws of level maps are tested against",
    target(TextureFormat::Depth32Float, one_layer),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "level_map",
    shader: "stages/level_map.wgsl",
    reads: &[&GEOMETRY],
    reads_if_present: &[],
    writes: &[
        &LEVEL_MAPS,
        &FRONT_DEPTH,
        &FRONT_NORMAL,
        &BACK_DEPTH,
        &BACK_NORMAL,
        &LAYER_DEPTH,
        &LAYER_NORMAL,
        &MAP_DEPTH,
    ],
    uniforms: &[("level_map_view", LevelMapView::LAYOUT)],
    views: &["previous_depth"],
    wanted: wanted_for_objects,
    steps: Steps::LevelMap(|_, run| {
        let front = draw(
            run,
            "level_map_fragment",
            [(&FRONT_DEPTH, 0), (&FRONT_NORMAL, 0)],
            true,
        );
        let back = draw(
            run,
            "level_map_fragment",
            [(&BACK_DEPTH, 0), (&BACK_NORMAL, 0)],
            false,
        );
        let further = (1..run.level_box.key.layers).map(|layer| {
            let targets = [(&LAYER_DEPTH, layer - 1), (&LAYER_NORMAL, layer - 1)];
            let (slot, layer) = match layer {
                1 => (&FRONT_DEPTH, 0),
                _ => (&LAYER_DEPTH, layer - 2),
            };
            Step {
                views: vec![View {
                    variable: "previous_depth",
                    slot,
                    layer,
                }],
                ..draw(run, "level_map_behind", targets, true)
            }
        });
        [front, back].into_iter().chain(further).collect()
    }),
    work,
};

/// Work for front and back of the largest map, and for each further layer.
pub(super) fn work(facts: &SceneFacts) -> f64 {
    let objects = facts.receivers.objects.iter();
    let texels = objects.map(|o| f64::from(o.map_texels).powi(2));
    texels.fold(0.0, f64::max) * 0.5 * f64::from(1 + facts.quality.layers)
}

/// Draws the mesh's nearest or farthest fragments into a depth and a normal.
fn draw(
    run: &LevelMapRun,
    fragment: &'static str,
    [depth, normal]: [(&'static Slot, u32); 2],
    nearest: bool,
) -> Step {
    let view = view_of(&run.level_box, run.arena_offset, run.first_triangle);
    let sign = if nearest { 1.0 } else { -1.0 };
    let color = |(slot, layer), value| Color {
        slot,
        layer,
        clear: Some([value, 0.0, 0.0, 1.0]),
        blend: None,
    };
    Step {
        entry: "level_map_vertex",
        work: Work::Draw(Draw {
            fragment,
            vertices: 3 * run.triangles,
            instances: 1,
            topology: PrimitiveTopology::TriangleList,
            cull: None,
            colors: vec![color(depth, sign * EMPTY_DEPTH), color(normal, 0.0)],
            depth: Some(Depth {
                slot: &MAP_DEPTH,
                clear: Some(if nearest { 1.0 } else { 0.0 }),
                compare: if nearest {
                    CompareFunction::Less
                } else {
                    CompareFunction::Greater
                },
                writes: true,
                stencil: wgpu::StencilState::default(),
                stencil_clear: None,
            }),
            viewport: Some([run.level_box.key.texels; 2]),
        }),
        uniforms: vec![("level_map_view", bytemuck::bytes_of(&view).to_vec())],
        views: Vec::new(),
    }
}

/// The reason why level maps are needed: light falls on objects under water.
pub fn wanted_for_objects(facts: &SceneFacts) -> Result<String, String> {
    let wet = facts.wet_objects().count();
    if wet == 0 {
        return Err("no object is under water".to_owned());
    }
    wanted_for_light(facts)?;
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
pub fn view_of(level_box: &LevelBox, arena_offset: u32, first_triangle: u32) -> LevelMapView {
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
