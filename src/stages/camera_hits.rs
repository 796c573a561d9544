//! Camera hits — the surface that each pixel sees, with refraction at the actual water surface.

use super::gpu_values::{vec2, vec4};
use super::objects::{GEOMETRY, INSTANCES};
use super::points::{POINTS, points_of_a_band};
use super::surface::WAVES;
use super::{Groups, Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::BandRun;

/// Note of a pixel (a bit of the fourth value of its radiance): it sees the floor outside its map.
pub const OUTSIDE_MAP: u32 = 1;
/// Note of a pixel: a march along the water ran out of steps.
pub const MARCH_UNFINISHED: u32 = 2;
/// Note of a pixel: a ray met the water too often.
pub const CUT_OFF: u32 = 4;

gpu_struct! {
    /// The uniform of `shaders/shared/view.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub View = "View" {
        eye: [f32; 4],
        right: [f32; 4],
        up: [f32; 4],
        forward: [f32; 4],
        middle: [f32; 4],
        extinction_per_m: [f32; 4],
        sky_radiance: [f32; 4],
        floor_albedo: [f32; 4],
        floor_min_m: [f32; 2],
        floor_max_m: [f32; 2],
        floor_y_m: f32,
        has_floor: u32,
        width: u32,
        height: u32,
        first_row: u32,
        row_count: u32,
        orthographic: u32,
        instance_count: u32,
        light_count: u32,
        air_light_count: u32,
        max_height_m: f32,
        max_slope: f32,
        ior: f32,
        sky_transmittance: f32,
        sky_path_factor: f32,
        layers: u32,
        sample_index: u32,
        leg: u32,
        splits: u32,
        bounces: u32,
        start_m: f32,
        pad: u32,
        sample_offset: [f32; 2],
    }
}

/// Distance of the first surface that pixels see.
pub static VISIBLE_DEPTH: Slot = Slot::buffer(
    "visible_depth",
    "distance along the viewing axis to the first surface m per pixel",
    |facts| 4 * pixels(facts),
);

/// Reflectance of the surface that pixels see, and the path length under water to it.
pub static VISIBLE_ALBEDO: Slot = Slot::buffer(
    "visible_albedo",
    "reflectance and path under water m per pixel",
    |facts| 16 * pixels(facts),
);

/// Weights of surface and sky in a pixel's radiance, and path length under water of the sky's light.
pub static VISIBLE_TRANSPORT: Slot = Slot::buffer(
    "visible_transport",
    "weights of surface and sky, path of the sky's light m, notes per pixel",
    |facts| 16 * pixels(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "camera_hits",
    shader: "stages/camera_hits.wgsl",
    reads: &[&WAVES, &GEOMETRY, &INSTANCES],
    reads_if_present: &[],
    writes: &[&POINTS, &VISIBLE_DEPTH, &VISIBLE_ALBEDO, &VISIBLE_TRANSPORT],
    uniforms: &[("view", View::LAYOUT)],
    views: &[],
    wanted: |facts| {
        let view = wanted_for_camera(facts)?;
        let legs = facts.legs();
        Ok(match legs.count() {
            1 => format!("{view}; {}", legs.reason),
            count => format!("{view}, {count} ways of each ray; {}", legs.reason),
        })
    },
    steps: Steps::Band(|facts, band| pixel_step("camera_hits_main", facts, band)),
    work: |facts| pixels(facts) as f64 * (1.0 + facts.water.surface.gpu_work_per_point()),
};

/// Pixels of the largest band of a view; 0 without a camera.
pub(super) fn pixels(facts: &SceneFacts) -> u64 {
    facts.output.camera.map_or(0, |_| points_of_a_band(facts))
}

/// The reason why passes that make a picture run: the output has a camera.
pub(super) fn wanted_for_camera(facts: &SceneFacts) -> Result<String, String> {
    match &facts.output.camera {
        Some(camera) => Ok(format!(
            "a view of {} × {} pixels",
            camera.width, camera.height
        )),
        None if facts.output.is_water_map() => {
            Err("the output is a map of the water, which has no camera".to_owned())
        }
        None => Err("the output is an irradiance map, which has no camera".to_owned()),
    }
}

/// One invocation per pixel of a band.
pub(super) fn pixel_step(entry: &'static str, facts: &SceneFacts, band: BandRun) -> Vec<Step> {
    let Some(camera) = &facts.output.camera else {
        return Vec::new();
    };
    vec![Step::compute(
        entry,
        Groups::Direct([camera.width.div_ceil(8), band.rows.div_ceil(8), 1]),
        vec![("view", view_uniform(facts, band))],
    )]
}

/// The uniform of a band.
fn view_uniform(facts: &SceneFacts, band: BandRun) -> Vec<u8> {
    let Some(camera) = &facts.output.camera else {
        return Vec::new();
    };
    let floor = facts.receivers.floor.as_ref();
    let legs = facts.legs();
    let view = View {
        eye: vec4(camera.eye, 0.0),
        right: vec4(camera.right, 0.0),
        up: vec4(camera.up, 0.0),
        forward: vec4(camera.forward, 0.0),
        middle: vec4(camera.middle, 0.0),
        extinction_per_m: vec4(facts.water.extinction_per_m, 0.0),
        sky_radiance: vec4(facts.lights.sky.radiance, 0.0),
        floor_albedo: floor.map_or([0.0; 4], |f| vec4(f.albedo, 0.0)),
        floor_min_m: floor.map_or([0.0; 2], |f| vec2(f.rect.min)),
        floor_max_m: floor.map_or([0.0; 2], |f| vec2(f.rect.max)),
        floor_y_m: floor.map_or(0.0, |f| f.y_m as f32),
        has_floor: u32::from(floor.is_some()),
        width: camera.width,
        height: camera.height,
        first_row: band.first_row,
        row_count: band.rows,
        orthographic: u32::from(camera.orthographic),
        instance_count: facts.receivers.objects.len() as u32,
        light_count: facts.lights.lit.len() as u32,
        air_light_count: facts.lights.in_air.len() as u32,
        max_height_m: facts.water.surface.max_height_m() as f32,
        max_slope: facts.water.surface.max_slope() as f32,
        ior: facts.water.ior as f32,
        sky_transmittance: facts.lights.sky.transmittance as f32,
        sky_path_factor: facts.lights.sky.path_factor as f32,
        layers: facts.quality.layers,
        sample_index: band.sample_index,
        leg: band.leg,
        splits: legs.splits,
        bounces: legs.bounces,
        start_m: camera.start_m as f32,
        pad: 0,
        sample_offset: band.offset.map(|o| o as f32),
    };
    bytemuck::bytes_of(&view).to_vec()
}
