//! Camera irradiance — the light on what each pixel sees: from the receivers' maps under water, from the lights above it.

use super::camera_hits::{pixel_step, wanted_for_camera};
use super::desc::{PassDesc, Repeat};
use super::gpu_data::{AirLight, vec4};
use super::slot::Slot;
use crate::facts::source::Source;
use crate::facts::{MOST_LIGHTS, SceneFacts};

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "camera_irradiance",
    repeat: Repeat::Band,
    reads: &[
        Slot::VisiblePosition,
        Slot::VisibleNormal,
        Slot::Geometry,
        Slot::Instances,
        Slot::AllReceivers,
    ],
    reads_if_present: &[Slot::Irradiance, Slot::LevelMaps],
    writes: &[Slot::VisibleIrradiance],
    wanted: |facts| {
        wanted_for_camera(facts)?;
        if facts.output.wants_irradiance() {
            Ok("the picture needs the light on what it shows".to_owned())
        } else {
            Err("neither radiance nor irradiance is among the layers".to_owned())
        }
    },
    steps: |facts, run| {
        let mut steps = pixel_step("camera_irradiance_main", facts, run);
        for step in &mut steps {
            step.uniforms.push(("air_lights", air_lights(facts)));
        }
        steps
    },
};

fn air_lights(facts: &SceneFacts) -> Vec<u8> {
    // No more than that pass the facts.
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
