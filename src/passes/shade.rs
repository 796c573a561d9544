//! Shade — radiance at the camera.

use super::camera_hits::{pixel_step, wanted_for_camera};
use super::desc::{PassDesc, Repeat};
use super::slot::Slot;
use crate::scene::LayerName;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "shade",
    repeat: Repeat::Band,
    reads: &[
        Slot::VisibleAlbedo,
        Slot::VisibleTransport,
        Slot::VisibleIrradiance,
    ],
    reads_if_present: &[],
    writes: &[Slot::Radiance],
    wanted: |facts| {
        wanted_for_camera(facts)?;
        if facts.output.wants(LayerName::Radiance) {
            Ok("the radiance layer is asked for".to_owned())
        } else {
            Err("radiance is not among the layers".to_owned())
        }
    },
    steps: |facts, run| pixel_step("shade_main", facts, run),
};
