//! Field irradiance — light at the points of a band, looked up in the kept field of each beam set. Objects cast shadows along the mean
//! direction of the light.

use super::light_field::{LIGHT_FIELD, LIGHT_FIELDS, in_words};
use super::objects::{GEOMETRY, INSTANCES};
use super::points::{POINT_IRRADIANCE, POINTS, points_of_a_band, size};
use super::surface::wanted_for_light;
use super::{Groups, Pass, Step, Steps};
use crate::facts::Product;
use crate::gpu_struct;

gpu_struct! {
    /// The uniform of `shaders/stages/field_irradiance.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub FieldLookup = "FieldLookup" {
        width: u32,
        row_count: u32,
        field: u32,
        instance_count: u32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "field_irradiance",
    shader: "stages/field_irradiance.wgsl",
    reads: &[&POINTS, &LIGHT_FIELD, &LIGHT_FIELDS, &GEOMETRY, &INSTANCES],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[("field_lookup", FieldLookup::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        match (facts.method.product, &facts.field) {
            (Product::Field, Some(field)) => Ok(format!(
                "each point looks its light up in {}, along its mean direction",
                in_words(field)
            )),
            _ => Err(format!("method {} makes no field", facts.method.name)),
        }
    },
    steps: Steps::Band(|facts, band| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let step = |field| {
            let uniform = FieldLookup {
                width,
                row_count: band.rows,
                field,
                instance_count: facts.receivers.objects.len() as u32,
            };
            let groups = Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]);
            let uniforms = vec![("field_lookup", bytemuck::bytes_of(&uniform).to_vec())];
            Step::compute("field_irradiance_main", groups, uniforms)
        };
        (0..facts.lights.beam_sets.len() as u32).map(step).collect()
    }),
    // Three slices, four texels of each.
    work: |facts| 12.0 * points_of_a_band(facts) as f64 * facts.lights.beam_sets.len() as f64,
};
