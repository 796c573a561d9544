//! Sky and air lights — irradiance at points that does not depend on the method: the sky's, and that of lights in the air on dry surfaces.
//! It runs for methods that compute irradiance at points; their own passes add to it.

use super::camera_irradiance::{AirLight, air_lights};
use super::gpu_values::vec4;
use super::objects::{GEOMETRY, INSTANCES};
use super::points::{POINT_IRRADIANCE, POINTS, points_of_a_band, size};
use super::{Groups, Pass, Step, Steps};
use crate::facts::Product;
use crate::gpu_struct;

gpu_struct! {
    /// The uniform of `shaders/stages/sky_and_air_lights.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Surroundings = "Surroundings" {
        sky_radiance: [f32; 4],
        extinction_per_m: [f32; 4],
        map_sky: [f32; 4],
        width: u32,
        row_count: u32,
        are_texels: u32,
        instance_count: u32,
        air_light_count: u32,
        ior: f32,
        sky_transmittance: f32,
        sky_path_factor: f32,
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "sky_and_air_lights",
    shader: "stages/sky_and_air_lights.wgsl",
    reads: &[&POINTS, &GEOMETRY, &INSTANCES],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[
        ("surroundings", Surroundings::LAYOUT),
        ("air_lights", AirLight::LAYOUT),
    ],
    views: &[],
    wanted: |facts| match facts.method.product {
        Product::PointIrradiance | Product::Field => Ok(format!(
            "method {} adds its light to that of the surroundings",
            facts.method.name
        )),
        Product::ReceiverMaps => Err(format!(
            "method {} does not compute irradiance at points",
            facts.method.name
        )),
    },
    steps: Steps::Band(|facts, band| {
        let Some([width, _]) = size(facts) else {
            return Vec::new();
        };
        let sky = &facts.lights.sky;
        let uniform = Surroundings {
            sky_radiance: vec4(sky.radiance, 0.0),
            extinction_per_m: vec4(facts.water.extinction_per_m, 0.0),
            map_sky: vec4(facts.output.sky_w_m2, 0.0),
            width,
            row_count: band.rows,
            are_texels: u32::from(facts.output.camera.is_none()),
            instance_count: facts.receivers.objects.len() as u32,
            air_light_count: facts.lights.in_air.len() as u32,
            ior: facts.water.ior as f32,
            sky_transmittance: sky.transmittance as f32,
            sky_path_factor: sky.path_factor as f32,
        };
        let uniforms = vec![
            ("surroundings", bytemuck::bytes_of(&uniform).to_vec()),
            ("air_lights", air_lights(facts)),
        ];
        let groups = Groups::Direct([width.div_ceil(8), band.rows.div_ceil(8), 1]);
        vec![Step::compute("sky_and_air_lights_main", groups, uniforms)]
    }),
    work: |facts| points_of_a_band(facts) as f64,
};
