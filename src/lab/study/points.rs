//! Points at which methods are compared: texels of a map of the floor, or what the pixels of a camera show.

use serde_json::json;

use crate::config::Limits;
use crate::methods;
use crate::scene::{
    ImageFormat, Issue, LayerName, Output, Receiver, ResolvedScene, Scene, SceneError, ViewOutput,
};

/// Texels along each side of a map that the scene does not ask for itself.
const MAP_SIDE: u32 = 256;
/// Size of a view that the scene does not ask for itself, pixels.
const VIEW_SIZE: [u32; 2] = [192, 128];
/// Half the side of such a map, in depths of the floor.
const HALF_SIDE: f64 = 0.625;

/// Where light is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Points {
    /// Texels of an irradiance map of the floor.
    Map,
    /// What the pixels of the scene's camera show.
    View,
}

/// The scene with an output that has the irradiance at these points, and nothing else.
///
/// A scene with such an output keeps its size. Any other gets a map of 256 × 256 texels of a square of the floor, 1.25 depths
/// along each side, around where the camera looks (without a camera, in the middle of the floor); or a view of 192 × 128 pixels.
///
/// # Errors
/// A view without a camera, a map without a floor.
pub fn with_points(
    resolved: &ResolvedScene,
    points: Points,
    limits: &Limits,
) -> Result<ResolvedScene, SceneError> {
    let mut scene = resolved.scene.clone();
    scene.output = match (points, scene.output) {
        (Points::Map, Output::IrradianceMap(map)) if matches!(map.receiver, Receiver::Floor(_)) => {
            Output::IrradianceMap(map)
        }
        (Points::Map, _) => map_of(&resolved.scene)?,
        (Points::View, Output::View(view)) => irradiance(view),
        (Points::View, _) => irradiance(ViewOutput {
            width: VIEW_SIZE[0],
            height: VIEW_SIZE[1],
            ..ViewOutput::default()
        }),
    };
    // More camera rays do not change the irradiance.
    scene.quality.pixel_samples = 1;
    methods::validate(&scene, limits)?;
    Ok(ResolvedScene {
        scene,
        ..resolved.clone()
    })
}

/// A view of the irradiance alone.
fn irradiance(mut view: ViewOutput) -> Output {
    view.layers = vec![LayerName::Irradiance];
    view.format = ImageFormat::Exr;
    Output::View(view)
}

fn map_of(scene: &Scene) -> Result<Output, SceneError> {
    let Some(floor) = &scene.floor else {
        let detail = "the scene has no floor of which a map could be made";
        return Err(Issue::invalid("/floor", detail, "a floor, or points of a view").into());
    };
    let middle_m = match &scene.camera {
        Some(camera) => {
            let (_, target_m, _) = camera.pose();
            [target_m[0], target_m[2]]
        }
        None => floor.center_m,
    };
    let [lower, upper] = floor.corners_m();
    let half_m = HALF_SIDE * floor.depth_m;
    // Moved, and if need be cut, to lie on the floor.
    let side = |axis: usize| {
        let half_m = half_m.min(0.5 * (upper[axis] - lower[axis]));
        let middle_m = middle_m[axis]
            .min(upper[axis] - half_m)
            .max(lower[axis] + half_m);
        (middle_m - half_m, middle_m + half_m)
    };
    let (x, z) = (side(0), side(1));
    serde_json::from_value(json!({
        "kind": "irradiance_map", "receiver": "floor", "min_m": [x.0, z.0], "max_m": [x.1, z.1],
        "width": MAP_SIDE, "height": MAP_SIDE
    }))
    .map_err(|error| Issue::invalid("/output", error.to_string(), "a map of the floor").into())
}
