//! Point in volume — light at the points of a band, from the caustic volumes of a beam set that each point lies in.

use super::volume_bounds::{VOLUME_BOUNDS, VOLUME_FLUX, VOLUME_RAYS, Volumes, volumes};
use super::{DENSITY, LINEAR, OFF, SHADOWS};
use crate::stages::light::{Light, light_uniform};
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::points::{POINT_IRRADIANCE, POINTS, size};
use crate::stages::surface::{SURFACE, wanted_for_light};
use crate::stages::{Groups, Pass, Step, Steps};

/// See the module.
pub static PASS: Pass = Pass {
    name: "point_in_volume",
    shader: "methods/caustic_volume/point_in_volume.wgsl",
    reads: &[
        &POINTS,
        &SURFACE,
        &VOLUME_RAYS,
        &VOLUME_FLUX,
        &VOLUME_BOUNDS,
        &GEOMETRY,
        &INSTANCES,
    ],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[("light", Light::LAYOUT), ("volumes", Volumes::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let density = DENSITY.word(&facts.quality);
        let shadows = match SHADOWS.word(&facts.quality) {
            OFF => "without shadows",
            _ => "with shadows",
        };
        Ok(format!(
            "the volumes around each point, of {density} density, {shadows}"
        ))
    },
    steps: Steps::BandBeamSet(|facts, band, set| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let volumes = Volumes {
            width,
            row_count: band.rows,
            instance_count: facts.receivers.objects.len() as u32,
            is_linear: u32::from(DENSITY.word(&facts.quality) == LINEAR),
            has_shadows: u32::from(SHADOWS.word(&facts.quality) != OFF),
            ..volumes(facts, set)
        };
        let uniforms = vec![
            ("light", light_uniform(facts, set)),
            ("volumes", bytemuck::bytes_of(&volumes).to_vec()),
        ];
        let groups = Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]);
        vec![Step::compute("point_in_volume_main", groups, uniforms)]
    }),
    // Each point descends through the levels of the blocks.
    work: |facts| {
        let points =
            size(facts).map_or(0.0, |[width, height]| f64::from(width) * f64::from(height));
        points * f64::from(facts.quality.water_cells).log2().max(1.0)
    },
};
