//! Slice deposit — light on meshes by an image of every slice (Tipprasert 2006, §5.2.1), the baseline for level maps. Everything,
//! including the slices, is computed again for every frame.

use wgpu::{
    CompareFunction, PrimitiveTopology, TextureFormat, TextureUsages, TextureViewDimension,
};

use crate::facts::SceneFacts;
use crate::facts::placement::LevelBox;
use crate::graph::{BeamSetRun, Color, Depth, Draw, Texture, View};
use crate::physics::slicing::plane_depth;
use crate::stages::beams::BEAMS;
use crate::stages::level_map::{LevelMapView, view_of};
use crate::stages::light::Light;
use crate::stages::maps::MapLayout;
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::receivers::RECEIVERS;
use crate::stages::reference_planes::{
    BEAM_QUEUE, PLANE_COUNTS, Planes, beams_at_planes, cull_steps, objects_of, over_queue,
    plane_uniforms, wanted_for_planes,
};
use crate::stages::sums::FLUX;
use crate::stages::surface::SURFACE;
use crate::stages::{Groups, Pass, Slot, Step, Steps, Work};

/// An image of each slice of the current object.
pub static SLICES: Slot = Slot::texture(
    "slices",
    "a colour image per plane of the current object",
    Texture {
        format: TextureFormat::Rgba8Unorm,
        dimension: TextureViewDimension::D2,
        extent: |facts| {
            let [side, _, _] = one_image(facts);
            [side, side, facts.method.reference_planes]
        },
        usage: TextureUsages::RENDER_ATTACHMENT,
    },
);

/// The depth that slices are drawn with.
pub static SLICE_DEPTH: Slot = Slot::texture(
    "slice_depth",
    "depth that draws of slices are tested against",
    Texture {
        format: TextureFormat::Depth32Float,
        dimension: TextureViewDimension::D2,
        extent: one_image,
        usage: TextureUsages::RENDER_ATTACHMENT,
    },
);

/// The slices processed so far, front to back.
pub static COMBINED: Slot = Slot::buffer(
    "combined",
    "colour of the first slice per texel of the current object",
    |facts| 4 * MapLayout::of(facts).scratch_texels(),
);

/// An image as large as the map of the largest object.
fn one_image(facts: &SceneFacts) -> [u32; 3] {
    let wet = facts.wet_objects();
    let texels = wet.map(|o| facts.receivers.objects[o].map_texels);
    let side = texels.max().unwrap_or(0);
    [side, side, 1]
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "slice_deposit",
    shader: "methods/volumetric/slice_deposit.wgsl",
    reads: &[&SURFACE, &BEAMS, &RECEIVERS, &GEOMETRY, &INSTANCES],
    reads_if_present: &[],
    writes: &[
        &FLUX,
        &BEAM_QUEUE,
        &PLANE_COUNTS,
        &SLICES,
        &SLICE_DEPTH,
        &COMBINED,
    ],
    uniforms: &[
        ("light", Light::LAYOUT),
        ("planes", Planes::LAYOUT),
        ("level_map_view", LevelMapView::LAYOUT),
    ],
    views: &["slice"],
    wanted: |facts| {
        let objects = wanted_for_planes(facts)?;
        Ok(format!(
            "{objects}, an image for each of {} planes",
            facts.method.reference_planes
        ))
    },
    steps: Steps::BeamSet(|facts, set| {
        let boxes = facts.lights.boxes_of(&facts.lights.beam_sets[set.index]);
        let mut steps = Vec::new();
        for (object, texels) in objects_of(facts, set.index) {
            let Some(level_box) = &boxes[object] else {
                continue;
            };
            let planes = 0..facts.planes_of(object);
            steps.extend(
                planes
                    .clone()
                    .map(|plane| slice_step(facts, set, level_box, (object, plane))),
            );
            steps.extend(cull_steps(facts, set, object, "volumetric_share_out"));
            let tiles = texels.div_ceil(8);
            for plane in planes {
                let place = (object, plane);
                let entries = ["volumetric_deposit", "volumetric_wide"];
                steps.extend(over_queue(facts, set, place, entries));
                let groups = Groups::Direct([tiles, tiles, 1]);
                let uniforms = plane_uniforms(facts, set, place);
                steps.push(Step {
                    views: vec![View {
                        variable: "slice",
                        slot: &SLICES,
                        layer: plane,
                    }],
                    ..Step::compute("volumetric_combine", groups, uniforms)
                });
            }
        }
        steps
    }),
    work: beams_at_planes,
};

/// Draws the part of the mesh between the midpoints from a plane to its neighbours.
fn slice_step(
    facts: &SceneFacts,
    set: BeamSetRun,
    level_box: &LevelBox,
    (object, plane): (usize, u32),
) -> Step {
    let [s_min, s_max] = level_box.s_range;
    let planes = f64::from(facts.planes_of(object));
    let border = |index: f64| plane_depth(s_min, s_max, planes, index) as f32;
    let mut view = view_of(level_box, 0, 0);
    view.s_min = border(f64::from(plane) - 0.5);
    view.s_max = border(f64::from(plane) + 0.5);
    let mut uniforms = plane_uniforms(facts, set, (object, plane));
    uniforms.push(("level_map_view", bytemuck::bytes_of(&view).to_vec()));
    Step {
        entry: "slice_vertex",
        work: Work::Draw(Draw {
            fragment: "slice_fragment",
            vertices: 3 * facts.receivers.objects[object].triangles,
            instances: 1,
            topology: PrimitiveTopology::TriangleList,
            cull: None,
            colors: vec![Color {
                slot: &SLICES,
                layer: plane,
                clear: Some([0.0; 4]),
                blend: None,
            }],
            depth: Some(Depth {
                slot: &SLICE_DEPTH,
                clear: Some(1.0),
                compare: CompareFunction::Less,
                writes: true,
                stencil: wgpu::StencilState::default(),
                stencil_clear: None,
            }),
            // The images are sized for the largest object.
            viewport: Some([level_box.key.texels; 2]),
        }),
        uniforms,
        views: Vec::new(),
    }
}
