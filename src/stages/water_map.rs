//! Water map — height and slope of the water at the texels of a rectangle. An output of its own: no light, floor or object takes part.

use super::gpu_values::vec2;
use super::points::{points_of_a_band, size};
use super::surface::WAVES;
use super::{Groups, Pass, Slot, Step, Steps};
use crate::gpu_struct;

gpu_struct! {
    /// The uniform of `shaders/stages/water_map.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub WaterGrid = "WaterGrid" {
        min_m: [f32; 2],
        texel_m: [f32; 2],
        width: u32,
        first_row: u32,
        row_count: u32,
        pad: u32,
    }
}

/// The rows of a band.
pub static WATER_MAP: Slot = Slot::buffer("water_map", "height m and slope per texel", |facts| {
    16 * points_of_a_band(facts)
});

/// See the module.
pub static PASS: Pass = Pass {
    name: "water_map",
    shader: "stages/water_map.wgsl",
    reads: &[&WAVES],
    reads_if_present: &[],
    writes: &[&WATER_MAP],
    uniforms: &[("water_grid", WaterGrid::LAYOUT)],
    views: &[],
    wanted: |facts| match &facts.output.water_map {
        Some(map) => Ok(format!(
            "a map of {} × {} texels of {}",
            map.width,
            map.height,
            facts.water.surface.description()
        )),
        None => Err("output.kind is not water_map".to_owned()),
    },
    steps: Steps::Band(|facts, band| {
        let (Some(map), Some([width, _])) = (&facts.output.water_map, size(facts)) else {
            return Vec::new();
        };
        let uniform = WaterGrid {
            min_m: vec2(map.rect.min),
            texel_m: vec2(map.texel_m()),
            width,
            first_row: band.first_row,
            row_count: band.rows,
            pad: 0,
        };
        vec![Step::compute(
            "water_map_main",
            Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]),
            vec![("water_grid", bytemuck::bytes_of(&uniform).to_vec())],
        )]
    }),
    work: |facts| points_of_a_band(facts) as f64 * (1.0 + facts.water.surface.gpu_work_per_point()),
};
