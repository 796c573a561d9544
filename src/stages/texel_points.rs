//! Texel points — where the texels of an irradiance map lie, for methods that compute irradiance at points.

use super::level_map::LEVEL_MAPS;
use super::objects::INSTANCES;
use super::points::{POINTS, points_of_a_band, size};
use super::receivers::ALL_RECEIVERS;
use super::{Groups, Pass, Step, Steps};
use crate::gpu_struct;
use crate::scene::Receiver;

gpu_struct! {
    /// The uniform of `shaders/stages/texel_points.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub TexelPoints = "TexelPoints" {
        receiver: u32,
        object: u32,
        is_object: u32,
        layer: u32,
        width: u32,
        first_row: u32,
        row_count: u32,
        pad: u32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "texel_points",
    shader: "stages/texel_points.wgsl",
    reads: &[&ALL_RECEIVERS],
    reads_if_present: &[&LEVEL_MAPS, &INSTANCES],
    writes: &[&POINTS],
    uniforms: &[("texel_points", TexelPoints::LAYOUT)],
    views: &[],
    wanted: |facts| match (&facts.output.camera, size(facts)) {
        _ if facts.output.is_water_map() => {
            Err("the output is a map of the water, not of a receiver".to_owned())
        }
        (None, Some([width, height])) => Ok(format!("a map of {width} × {height} texels")),
        (None, None) => Err("the requested map has no texels".to_owned()),
        (Some(_), _) => Err("the output is a view: its points come from the pixels".to_owned()),
    },
    steps: Steps::Band(|facts, band| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let object = match facts.output.receiver {
            Some(Receiver::Object(index)) => Some(index),
            _ => None,
        };
        let layer = facts.output.receiver_layer;
        let uniform = TexelPoints {
            receiver: object.map_or(0, |index| 1 + index * facts.quality.layers + layer),
            object: object.unwrap_or(0),
            is_object: u32::from(object.is_some()),
            layer,
            width,
            first_row: band.first_row,
            row_count: band.rows,
            pad: 0,
        };
        vec![Step::compute(
            "texel_points_main",
            Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]),
            vec![("texel_points", bytemuck::bytes_of(&uniform).to_vec())],
        )]
    }),
    work: |facts| points_of_a_band(facts) as f64,
};
