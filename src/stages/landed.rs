//! Landed — sums the flux on a beam set's maps for the energy account. If narrow sums have wrapped, flux is missing here.

use super::light::{Light, light_uniform};
use super::maps::MapLayout;
use super::sums::{ENERGY, FLUX, texels};
use super::surface::wanted_for_light;
use super::{Groups, Pass, Step, Steps};
use crate::gpu_struct;

/// Texels of a workgroup, as in the shader.
pub const TEXELS_PER_GROUP: u32 = 64 * 64;

gpu_struct! {
    /// The uniform of `shaders/stages/landed.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Span = "Span" {
        texel_count: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "landed",
    shader: "stages/landed.wgsl",
    reads: &[&FLUX],
    reads_if_present: &[],
    writes: &[&ENERGY],
    uniforms: &[("light", Light::LAYOUT), ("span", Span::LAYOUT)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BeamSet(|facts, set| {
        let span = Span {
            texel_count: u32::try_from(MapLayout::of(facts).flux_texels()).unwrap_or(u32::MAX),
            ..Span::default()
        };
        let groups = span.texel_count.div_ceil(TEXELS_PER_GROUP);
        vec![Step::compute(
            "landed_main",
            Groups::Direct([groups, 1, 1]),
            vec![
                ("light", light_uniform(facts, set)),
                ("span", bytemuck::bytes_of(&span).to_vec()),
            ],
        )]
    }),
    work: |facts| texels(facts) * f64::from(facts.channels()),
};
