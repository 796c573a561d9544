//! Photon view — the depth of what lies under water, drawn from the sun (Mihálik 2008, ch. 8). The floor is the view's background.

use wgpu::{
    CompareFunction, PrimitiveTopology, TextureFormat, TextureUsages, TextureViewDimension,
};

use super::view::{LIGHT_VIEW, LightView, bottom_y_m, light_view, texels, uniforms};
use crate::facts::SceneFacts;
use crate::graph::{Color, Depth, Draw, Texture};
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::surface::wanted_for_light;
use crate::stages::{Pass, Slot, Step, Steps, Work};

/// What each beam set's view shows.
pub static LIGHT_DEPTH: Slot = Slot::texture(
    "light_depth",
    "height of the surface that a view from the sun shows, m; a layer per beam set",
    Texture {
        format: TextureFormat::R32Float,
        dimension: TextureViewDimension::D2,
        extent: |facts| {
            [
                texels(facts),
                texels(facts),
                facts.lights.beam_sets.len() as u32,
            ]
        },
        usage: TextureUsages::RENDER_ATTACHMENT,
    },
);

/// The depth that draws of views are tested against.
pub static LIGHT_DEPTH_TEST: Slot = Slot::texture(
    "light_depth_test",
    "depth that draws of a view from the sun are tested against",
    Texture {
        format: TextureFormat::Depth32Float,
        dimension: TextureViewDimension::D2,
        extent: |facts| [texels(facts), texels(facts), 1],
        usage: TextureUsages::RENDER_ATTACHMENT,
    },
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "photon_view",
    shader: "methods/photon/photon_view.wgsl",
    reads: &[&GEOMETRY, &INSTANCES],
    reads_if_present: &[],
    writes: &[&LIGHT_DEPTH, &LIGHT_DEPTH_TEST],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        Ok(match facts.wet_objects().count() {
            0 => "the floor, as the sun sees it".to_owned(),
            1 => "1 object under water, as the sun sees it".to_owned(),
            objects => format!("{objects} objects under water, as the sun sees them"),
        })
    },
    steps: Steps::FineBeamSet(|facts, set| {
        let runs = alike(facts);
        let mut steps: Vec<Step> = Vec::with_capacity(runs.len());
        for run in &runs {
            steps.push(draw(facts, set.index, *run, steps.is_empty()));
        }
        if steps.is_empty() {
            // Only clears.
            steps.push(draw(facts, set.index, Run::default(), true));
        }
        steps
    }),
    work: |facts| {
        let objects = facts.wet_objects();
        let triangles = objects.map(|index| f64::from(facts.receivers.objects[index].triangles));
        f64::from(texels(facts)).powi(2) + triangles.sum::<f64>()
    },
};

/// Objects that are drawn together: neighbours in the list with equal numbers of triangles.
#[derive(Clone, Copy, Default)]
struct Run {
    first: u32,
    objects: u32,
    triangles: u32,
}

fn alike(facts: &SceneFacts) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for index in facts.wet_objects() {
        let triangles = facts.receivers.objects[index].triangles;
        let index = index as u32;
        match runs.last_mut() {
            Some(run) if run.triangles == triangles && run.first + run.objects == index => {
                run.objects += 1;
            }
            _ => runs.push(Run {
                first: index,
                objects: 1,
                triangles,
            }),
        }
    }
    runs
}

fn draw(facts: &SceneFacts, index: usize, run: Run, clears: bool) -> Step {
    let view = LightView {
        first_object: run.first,
        ..light_view(facts, index)
    };
    let bottom = f64::from(bottom_y_m(facts) as f32);
    Step {
        entry: "photon_view_vertex",
        work: Work::Draw(Draw {
            fragment: "photon_view_fragment",
            vertices: 3 * run.triangles,
            instances: run.objects,
            topology: PrimitiveTopology::TriangleList,
            cull: None,
            colors: vec![Color {
                slot: &LIGHT_DEPTH,
                layer: index as u32,
                clear: clears.then_some([bottom, 0.0, 0.0, 1.0]),
                blend: None,
            }],
            depth: Some(Depth {
                slot: &LIGHT_DEPTH_TEST,
                clear: clears.then_some(1.0),
                compare: CompareFunction::Less,
                writes: true,
                stencil: wgpu::StencilState::default(),
                stencil_clear: None,
            }),
            viewport: None,
        }),
        uniforms: uniforms(&view),
        views: Vec::new(),
    }
}
