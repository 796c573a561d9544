//! Shade — radiance at the camera.

use super::camera_hits::{
    VISIBLE_ALBEDO, VISIBLE_TRANSPORT, View, pixel_step, pixels, wanted_for_camera,
};
use super::points::POINT_IRRADIANCE;
use super::{Pass, Slot, Steps};
use crate::scene::LayerName;

/// The picture.
pub static RADIANCE: Slot = Slot::buffer(
    "radiance",
    "linear RGB per pixel, W/(m² sr), and notes",
    |facts| 16 * pixels(facts),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "shade",
    shader: "stages/shade.wgsl",
    reads: &[&VISIBLE_ALBEDO, &VISIBLE_TRANSPORT, &POINT_IRRADIANCE],
    reads_if_present: &[],
    writes: &[&RADIANCE],
    uniforms: &[("view", View::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_camera(facts)?;
        if facts.output.wants(LayerName::Radiance) {
            Ok("the radiance layer is requested".to_owned())
        } else {
            Err("radiance is not among the layers".to_owned())
        }
    },
    steps: Steps::Band(|facts, band| pixel_step("shade_main", facts, band)),
    work: |facts| pixels(facts) as f64,
};
