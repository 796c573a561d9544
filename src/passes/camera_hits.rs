//! Camera hits — what each pixel sees, through true refraction at the water.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::{View, vec2, vec4};
use super::slot::Slot;
use crate::facts::SceneFacts;

/// What a sample of a pixel whose march along the water ended early adds to its notes (the fourth value of its radiance); one that sees
/// the floor beside its map adds 1.
pub const MARCH_UNFINISHED: f32 = 128.0;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "camera_hits",
    repeat: Repeat::Band,
    reads: &[Slot::Waves, Slot::Geometry, Slot::Instances],
    reads_if_present: &[],
    writes: &[
        Slot::VisiblePosition,
        Slot::VisibleNormal,
        Slot::VisibleAlbedo,
        Slot::VisibleTransport,
    ],
    wanted: wanted_for_camera,
    steps: |facts, run| pixel_step("camera_hits_main", facts, run),
};

/// Passes that follow a picture are in when there is one.
pub(super) fn wanted_for_camera(facts: &SceneFacts) -> Result<String, String> {
    match &facts.camera {
        Some(camera) => Ok(format!(
            "a view of {} × {} pixels",
            camera.width, camera.height
        )),
        None => Err("the output is an irradiance map, seen by no camera".to_owned()),
    }
}

/// One invocation per pixel of a band.
pub(super) fn pixel_step(entry: &'static str, facts: &SceneFacts, run: Run<'_>) -> Vec<Step> {
    let (Run::Band { rows, .. }, Some(camera)) = (run, &facts.camera) else {
        return Vec::new();
    };
    vec![Step {
        entry,
        work: Work::Compute(Groups::Direct([
            camera.width.div_ceil(8),
            rows.div_ceil(8),
            1,
        ])),
        uniforms: vec![("view", view_uniform(facts, run))],
    }]
}

/// The uniform of a band.
fn view_uniform(facts: &SceneFacts, run: Run<'_>) -> Vec<u8> {
    let Run::Band {
        first_row,
        rows,
        offset,
        sample_index,
    } = run
    else {
        return Vec::new();
    };
    let Some(camera) = &facts.camera else {
        return Vec::new();
    };
    let floor = facts.floor.as_ref();
    let view = View {
        eye: vec4(camera.eye, 0.0),
        right: vec4(camera.right, 0.0),
        up: vec4(camera.up, 0.0),
        forward: vec4(camera.forward, 0.0),
        extinction_per_m: vec4(facts.extinction_per_m, 0.0),
        sky_radiance: vec4(facts.sky_radiance, 0.0),
        floor_albedo: floor.map_or([0.0; 4], |f| vec4(f.albedo, 0.0)),
        floor_min_m: floor.map_or([0.0; 2], |f| vec2(f.rect.min)),
        floor_max_m: floor.map_or([0.0; 2], |f| vec2(f.rect.max)),
        floor_y_m: floor.map_or(0.0, |f| f.y_m as f32),
        has_floor: u32::from(floor.is_some()),
        width: camera.width,
        height: camera.height,
        first_row,
        row_count: rows,
        orthographic: u32::from(camera.orthographic),
        wave_count: facts.surface.gpu_element_count() as u32,
        instance_count: facts.objects.len() as u32,
        light_count: facts.lights.len() as u32,
        air_light_count: facts.air_lights.len() as u32,
        max_height_m: facts.surface.max_height_m() as f32,
        max_slope: facts.surface.max_slope() as f32,
        ior: facts.ior as f32,
        sky_transmittance: facts.sky_transmittance as f32,
        sky_path_factor: facts.sky_path_factor as f32,
        layers: facts.quality.layers,
        sample_index,
        sample_offset: offset.map(|o| o as f32),
    };
    bytemuck::bytes_of(&view).to_vec()
}
