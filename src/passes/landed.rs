//! Landed — sums what lies on a light's maps, for the energy account; narrow sums that have wrapped show here.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::Span;
use super::light::light_uniform;
use super::maps::MapLayout;
use super::slot::Slot;
use super::surface::wanted_for_light;

/// Texels of a workgroup, as in the shader.
pub const TEXELS_PER_GROUP: u32 = 64 * 64;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "landed",
    repeat: Repeat::Light,
    reads: &[Slot::Flux],
    reads_if_present: &[],
    writes: &[Slot::Energy],
    wanted: wanted_for_light,
    steps: |facts, run| {
        let Run::Light { index, wide_sums } = run else {
            return Vec::new();
        };
        let span = Span {
            texel_count: u32::try_from(MapLayout::of(facts).flux_texels()).unwrap_or(u32::MAX),
            ..Span::default()
        };
        let groups = span.texel_count.div_ceil(TEXELS_PER_GROUP);
        vec![Step {
            entry: "landed_main",
            work: Work::Compute(Groups::Direct([groups, 1, 1])),
            uniforms: vec![
                ("light", light_uniform(facts, index, wide_sums)),
                ("span", bytemuck::bytes_of(&span).to_vec()),
            ],
        }]
    },
};
