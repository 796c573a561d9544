//! Camera irradiance — irradiance of the surface that each pixel sees: under water from the receivers' maps, above it from the lights.

use super::camera_hits::{View, pixel_step, pixels, wanted_for_camera};
use super::gpu_values::vec4;
use super::irradiance::IRRADIANCE;
use super::level_map::LEVEL_MAPS;
use super::objects::{GEOMETRY, INSTANCES};
use super::points::{POINT_IRRADIANCE, POINTS};
use super::receivers::ALL_RECEIVERS;
use super::{Pass, Steps};
use crate::facts::source::Source;
use crate::facts::{MOST_LIGHTS, Product, SceneFacts};
use crate::gpu_struct;

gpu_struct! {
    /// A light in the air of `shaders/shared/air_lights.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub AirLight = "AirLight" {
        source: [f32; 4],
        power: [f32; 4],
    }
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "camera_irradiance",
    shader: "stages/camera_irradiance.wgsl",
    reads: &[&POINTS, &GEOMETRY, &INSTANCES, &ALL_RECEIVERS],
    reads_if_present: &[&IRRADIANCE, &LEVEL_MAPS],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[("view", View::LAYOUT), ("air_lights", AirLight::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_camera(facts)?;
        if facts.method.product != Product::ReceiverMaps {
            return Err(format!(
                "method {} computes the irradiance at the points itself",
                facts.method.name
            ));
        }
        if facts.output.wants_irradiance() {
            Ok("the picture needs the irradiance of the surfaces it shows".to_owned())
        } else {
            Err("neither radiance nor irradiance is among the layers".to_owned())
        }
    },
    steps: Steps::Band(|facts, band| {
        let mut steps = pixel_step("camera_irradiance_main", facts, band);
        for step in &mut steps {
            step.uniforms.push(("air_lights", air_lights(facts)));
        }
        steps
    }),
    work: |facts| pixels(facts) as f64,
};

/// The uniform of `shaders/shared/air_lights.wgsl`.
pub(super) fn air_lights(facts: &SceneFacts) -> Vec<u8> {
    // The facts refuse scenes with more lights.
    let mut all = [AirLight::default(); MOST_LIGHTS];
    for (slot, light) in all.iter_mut().zip(&facts.lights.in_air) {
        *slot = AirLight {
            source: match light.source {
                Source::Sun { to_light } => vec4(to_light, 0.0),
                Source::Point { position_m } | Source::Submerged { position_m } => {
                    vec4(position_m, 1.0)
                }
            },
            power: vec4(light.power, 0.0),
        };
    }
    bytemuck::bytes_of(&all).to_vec()
}
