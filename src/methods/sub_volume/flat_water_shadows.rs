//! Flat-water shadows — the points of a band that an object would hide from the sun if the water were flat.

use glam::DVec3;

use super::has_flat_shadows;
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::stages::gpu_values::vec4;
use crate::stages::level_map::{LEVEL_MAPS, wanted_for_objects};
use crate::stages::objects::INSTANCES;
use crate::stages::points::{POINTS, band_rows, size};
use crate::stages::receivers::RECEIVERS;
use crate::stages::{Groups, Pass, Slot, Step, Steps};

gpu_struct! {
    /// The uniform; fields are documented in the shader.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub FlatWater = "FlatWater" {
        to_light: [f32; 4],
        width: u32,
        row_count: u32,
        instance_count: u32,
        layers: u32,
    }
}

/// Which points are hidden.
pub static FLAT_SHADOWS: Slot = Slot::buffer(
    "flat_shadows",
    "1 per point that an object hides from the sun under flat water, else 0",
    |facts| 4 * points_of_a_band(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "flat_water_shadows",
    shader: "methods/sub_volume/flat_water_shadows.wgsl",
    reads: &[&POINTS, &RECEIVERS, &LEVEL_MAPS, &INSTANCES],
    reads_if_present: &[],
    writes: &[&FLAT_SHADOWS],
    uniforms: &[("flat_water", FlatWater::LAYOUT)],
    views: &[],
    wanted: |facts| {
        if !has_flat_shadows(facts) {
            return Err(format!(
                "method {} takes no shadows from flat water here (its dial `shadows`)",
                facts.method.name
            ));
        }
        wanted_for_objects(facts)
    },
    steps: Steps::BandBeamSet(|facts, band, set| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let light = &facts.lights.beam_sets[set.index];
        // The direction of a sun does not depend on where it shines.
        let direction = light.source.direction_at(DVec3::ZERO, light.band.ior);
        let flat_water = FlatWater {
            to_light: vec4(-direction.unwrap_or(-DVec3::Y), 0.0),
            width,
            row_count: band.rows,
            instance_count: facts.receivers.objects.len() as u32,
            layers: facts.quality.layers,
        };
        let uniforms = vec![("flat_water", bytemuck::bytes_of(&flat_water).to_vec())];
        let groups = Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]);
        vec![Step::compute("flat_water_shadows_main", groups, uniforms)]
    }),
    // A point tests the objects that the hierarchy finds along its way: about the square root of their number.
    work: |facts| {
        let points = size(facts).map_or(0.0, |[w, h]| f64::from(w) * f64::from(h));
        points * (1.0 + (facts.wet_objects().count() as f64).sqrt())
    },
};

fn points_of_a_band(facts: &SceneFacts) -> u64 {
    size(facts).map_or(0, |[width, height]| {
        u64::from(width) * u64::from(band_rows(width, height))
    })
}
