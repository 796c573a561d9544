//! Point in sub-volume — light at the points of a band, from the sub-volumes of a beam set that each point lies in.

use glam::DVec3;

use super::flat_water_shadows::FLAT_SHADOWS;
use super::{FACE, FLUX_RATIO, INTENSITY, OFF, SAMPLE_PLANES, SHADE, SHADOWS, has_flat_shadows};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::stages::gpu_values::vec4;
use crate::stages::light::{Light, light_uniform};
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::points::{POINT_IRRADIANCE, POINTS};
use crate::stages::surface::{SURFACE, wanted_for_light};
use crate::stages::volume_bounds::{
    VOLUME_BOUNDS, VOLUME_FLUX, VOLUME_RAYS, Volumes, search_work, volumes_of_band,
};
use crate::stages::{Groups, Pass, Step, Steps};

gpu_struct! {
    /// How volumes are cut and shaded; fields are documented in the shader.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub SubVolumes = "SubVolumes" {
        eye: [f32; 4],
        count: u32,
        is_parallel: u32,
        shades_faces: u32,
        is_scaled: u32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "point_in_sub_volume",
    shader: "methods/sub_volume/point_in_sub_volume.wgsl",
    reads: &[
        &POINTS,
        &SURFACE,
        &VOLUME_RAYS,
        &VOLUME_FLUX,
        &VOLUME_BOUNDS,
        &GEOMETRY,
        &INSTANCES,
    ],
    reads_if_present: &[&FLAT_SHADOWS],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[
        ("light", Light::LAYOUT),
        ("volumes", Volumes::LAYOUT),
        ("sub_volumes", SubVolumes::LAYOUT),
    ],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let planes = SAMPLE_PLANES.integer(&facts.quality);
        let place = match SHADE.word(&facts.quality) {
            FACE => "on the face before it",
            _ => "at the point",
        };
        let intensity = match INTENSITY.word(&facts.quality) {
            FLUX_RATIO => "the flux ratio",
            _ => "scaled to the flux",
        };
        let shadows = match SHADOWS.word(&facts.quality) {
            OFF => "without shadows",
            _ if has_flat_shadows(facts) => "with the shadows of flat water",
            _ => "with shadows",
        };
        Ok(format!(
            "the sub-volumes around each point, between {planes} planes and the water, intensity {place}, {intensity}, {shadows}"
        ))
    },
    steps: Steps::BandBeamSet(|facts, band, set| {
        let has_shadows = SHADOWS.word(&facts.quality) != OFF;
        let Some(volumes) = volumes_of_band(facts, band, set, has_shadows) else {
            return Vec::new();
        };
        let uniforms = vec![
            ("light", light_uniform(facts, set)),
            ("volumes", bytemuck::bytes_of(&volumes).to_vec()),
            (
                "sub_volumes",
                bytemuck::bytes_of(&sub_volumes(facts)).to_vec(),
            ),
        ];
        // Without an object under water there is no shadow map, and no shadow.
        let entry = if has_flat_shadows(facts) && facts.wet_objects().next().is_some() {
            "point_with_flat_shadows_main"
        } else {
            "point_in_sub_volume_main"
        };
        let groups = Groups::Direct([volumes.width.div_ceil(8), band.rows.div_ceil(8), 1]);
        vec![Step::compute(entry, groups, uniforms)]
    }),
    work: search_work,
};

fn sub_volumes(facts: &SceneFacts) -> SubVolumes {
    // A map is seen from straight above.
    let (eye, is_parallel) = match &facts.output.camera {
        None => (DVec3::Y, true),
        Some(camera) if camera.orthographic => (-camera.forward, true),
        Some(camera) => (camera.eye, false),
    };
    SubVolumes {
        eye: vec4(eye, 0.0),
        count: SAMPLE_PLANES.integer(&facts.quality),
        is_parallel: u32::from(is_parallel),
        shades_faces: u32::from(SHADE.word(&facts.quality) == FACE),
        is_scaled: u32::from(INTENSITY.word(&facts.quality) != FLUX_RATIO),
    }
}
