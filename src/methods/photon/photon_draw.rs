//! Photon draw — adds each photon's flux to its texel of the light's map by drawing it as a point with additive blending (Mihálik 2008,
//! ch. 8). Vulkan blends the points of a draw in their order, so the sums are the same in every frame.

use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, PrimitiveTopology, TextureFormat,
    TextureUsages, TextureViewDimension,
};

use super::draws;
use super::photons::PHOTONS;
use super::view::{LIGHT_VIEW, LightView, light_view, photon_count, texels, uniforms};
use crate::graph::{Color, Draw, Texture};
use crate::stages::surface::wanted_for_light;
use crate::stages::{Pass, Slot, Step, Steps, Work};

/// Sums of a beam set.
pub static PHOTON_DOTS: Slot = Slot::texture(
    "photon_dots",
    "flux of the photons per texel, m² under 1 W/m²",
    Texture {
        format: TextureFormat::Rgba32Float,
        dimension: TextureViewDimension::D2,
        extent: |facts| {
            if draws(facts) {
                [texels(facts), texels(facts), 1]
            } else {
                [0; 3]
            }
        },
        usage: TextureUsages::RENDER_ATTACHMENT,
    },
);

const SUM: BlendComponent = BlendComponent {
    src_factor: BlendFactor::One,
    dst_factor: BlendFactor::One,
    operation: BlendOperation::Add,
};

/// See the module.
pub static PASS: Pass = Pass {
    name: "photon_draw",
    shader: "methods/photon/photon_draw.wgsl",
    reads: &[&PHOTONS],
    reads_if_present: &[],
    writes: &[&PHOTON_DOTS],
    uniforms: &[(LIGHT_VIEW, LightView::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        if !draws(facts) {
            return Err("photons are added as integers".to_owned());
        }
        let texels = texels(facts);
        Ok(format!("points on {texels} × {texels} texels"))
    },
    steps: Steps::FineBeamSet(|facts, set| {
        vec![Step {
            entry: "photon_draw_vertex",
            work: Work::Draw(Draw {
                fragment: "photon_draw_fragment",
                vertices: photon_count(facts),
                instances: 1,
                topology: PrimitiveTopology::PointList,
                cull: None,
                colors: vec![Color {
                    slot: &PHOTON_DOTS,
                    layer: 0,
                    clear: Some([0.0; 4]),
                    blend: Some(BlendState {
                        color: SUM,
                        alpha: SUM,
                    }),
                }],
                depth: None,
                viewport: None,
            }),
            uniforms: uniforms(&light_view(facts, set.index)),
            views: Vec::new(),
        }]
    }),
    work: |facts| f64::from(photon_count(facts)),
};
