//! Point in volume — light at the points of a band, from the caustic volumes of a beam set that each point lies in.

use super::{DENSITY, LINEAR, OFF, SHADOWS};
use crate::gpu_struct;
use crate::stages::light::{Light, light_uniform};
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::points::{POINT_IRRADIANCE, POINTS};
use crate::stages::surface::{SURFACE, wanted_for_light};
use crate::stages::volume_bounds::{
    VOLUME_BOUNDS, VOLUME_FLUX, VOLUME_RAYS, Volumes, search_work, volumes_of_band,
};
use crate::stages::{Groups, Pass, Step, Steps};

gpu_struct! {
    /// How the light of a volume varies; fields are documented in the shader.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub VolumeDensity = "VolumeDensity" {
        is_linear: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

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
    uniforms: &[
        ("light", Light::LAYOUT),
        ("volumes", Volumes::LAYOUT),
        ("volume_density", VolumeDensity::LAYOUT),
    ],
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
        let has_shadows = SHADOWS.word(&facts.quality) != OFF;
        let Some(volumes) = volumes_of_band(facts, band, set, has_shadows) else {
            return Vec::new();
        };
        let density = VolumeDensity {
            is_linear: u32::from(DENSITY.word(&facts.quality) == LINEAR),
            ..VolumeDensity::default()
        };
        let uniforms = vec![
            ("light", light_uniform(facts, set)),
            ("volumes", bytemuck::bytes_of(&volumes).to_vec()),
            ("volume_density", bytemuck::bytes_of(&density).to_vec()),
        ];
        let groups = Groups::Direct([volumes.width.div_ceil(8), band.rows.div_ceil(8), 1]);
        vec![Step::compute("point_in_volume_main", groups, uniforms)]
    }),
    work: search_work,
};
