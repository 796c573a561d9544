//! Checks that the requested output can be made from the rest of the scene.

use super::findings::Findings;
use super::ranges;
use super::strict::quoted;
use super::types::{
    Floor, ImageFormat, IrradianceMapOutput, LayerName, Light, Output, Receiver, Scene, ViewOutput,
};
use super::water_map::WaterMapOutput;
use crate::config::Limits;

pub(super) fn output(findings: &mut Findings, scene: &Scene, limits: &Limits) {
    match &scene.output {
        Output::View(output) => view(findings, scene, output, limits),
        Output::IrradianceMap(output) => {
            findings.integer::<ranges::PngBits>("/output/png_bits", output.png_bits);
            findings.number("/output/exposure_ev", output.exposure_ev, &ranges::EXPOSURE);
            light(findings, scene, output);
            layer(findings, scene, output);
            match output.receiver {
                Receiver::Floor(_) => floor_map(findings, scene, output, limits),
                Receiver::Object(index) => mesh_map(findings, scene, output, index, limits),
            }
        }
        Output::WaterMap(output) => water_map(findings, scene, output, limits),
    }
}

fn water_map(findings: &mut Findings, scene: &Scene, output: &WaterMapOutput, limits: &Limits) {
    findings.integer::<ranges::PngBits>("/output/png_bits", output.png_bits);
    map_size(findings, [output.width, output.height], limits);
    let missing = [("min_m", output.min_m), ("max_m", output.max_m)];
    let missing = missing.iter().filter(|(_, corner)| corner.is_none());
    if scene.floor.is_none() {
        for (field, _) in missing {
            findings.invalid(
                format!("/output/{field}"),
                format!("missing field `{field}`: the scene has no floor whose corner it could be"),
                "both corners of the map, `min_m` and `max_m`, (x, z) in m; or a scene with a `floor`",
            );
        }
    }
    let given = [output.min_m, output.max_m];
    corners(findings, given, output.corners_m(scene.floor.as_ref()));
}

fn view(findings: &mut Findings, scene: &Scene, output: &ViewOutput, limits: &Limits) {
    if scene.camera.is_none() {
        findings.invalid(
            "/camera",
            "missing field `camera`: a view needs one",
            "a camera with `position_m` and `target_m`, or another `output.kind`",
        );
    }
    let mut is_sized = findings.integer::<ranges::ViewSide>("/output/width", output.width);
    is_sized &= findings.integer::<ranges::ViewSide>("/output/height", output.height);
    if is_sized {
        let size = [output.width, output.height];
        pixels(findings, "/output", size, limits);
    }
    findings.integer::<ranges::PngBits>("/output/png_bits", output.png_bits);
    findings.number("/output/exposure_ev", output.exposure_ev, &ranges::EXPOSURE);
    layers(findings, output);
}

fn layers(findings: &mut Findings, output: &ViewOutput) {
    if output.layers.is_empty() {
        let detail = "no layer is requested";
        findings.invalid("/output/layers", detail, "at least one layer");
    }
    for (index, layer) in output.layers.iter().enumerate() {
        let pointer = format!("/output/layers/{index}");
        if output.layers[..index].contains(layer) {
            findings.invalid(pointer, "the layer is named twice", "each layer once");
        } else if output.format == ImageFormat::Png && *layer != LayerName::Radiance {
            findings.invalid(
                pointer,
                "PNG has no room for this layer",
                "`radiance` alone, or `output.format` = `exr`",
            );
        }
        // A longer list only repeats layers.
        if index > 2 * LAYER_COUNT {
            break;
        }
    }
}

/// The number of layers that exist.
const LAYER_COUNT: usize = 7;

fn pixels(findings: &mut Findings, pointer: &str, [width, height]: [u32; 2], limits: &Limits) {
    let count = u64::from(width) * u64::from(height);
    if count > limits.max_pixels {
        findings.over_limit(
            pointer,
            format!("{width} × {height} are {count} pixels"),
            format!("width × height of at most {}", limits.max_pixels),
        );
    }
}

/// The number of lights that have maps (suns and point lights), and their indices for messages.
fn mapped_lights(scene: &Scene) -> (usize, String) {
    let mapped: Vec<String> = scene
        .lights
        .iter()
        .enumerate()
        .filter(|(_, light)| matches!(light, Light::Sun(_) | Light::Point(_)))
        .map(|(index, _)| index.to_string())
        .collect();
    let accepted = match mapped.len() {
        0 => "no `light` field: the scene has no sun and no point light".to_owned(),
        _ => format!(
            "the index of a sun or point light: {}",
            quoted(&mapped.join(", "))
        ),
    };
    (mapped.len(), accepted)
}

fn light(findings: &mut Findings, scene: &Scene, output: &IrradianceMapOutput) {
    let (light_count, accepted) = mapped_lights(scene);
    match (output.light, output.receiver) {
        (Some(index), _) => match scene.lights.get(index as usize) {
            Some(Light::Sun(_) | Light::Point(_)) => {}
            Some(Light::Sky(_)) => {
                let detail = format!("light {index} is a sky");
                findings.invalid("/output/light", detail, accepted);
            }
            None => {
                let detail = format!("there is no light {index}");
                findings.invalid("/output/light", detail, accepted);
            }
        },
        (None, Receiver::Object(_)) if light_count > 1 => findings.invalid(
            "/output/light",
            format!(
                "missing field `light`: each of the {light_count} suns and point lights has its own map on a mesh"
            ),
            accepted,
        ),
        (None, _) => {}
    }
}

fn layer(findings: &mut Findings, scene: &Scene, output: &IrradianceMapOutput) {
    let layers = scene.quality.layers;
    let accepted = match output.receiver {
        Receiver::Floor(_) if output.layer > 0 => {
            "0 or no `layer` field: the floor has one surface".to_owned()
        }
        Receiver::Object(_) if output.layer >= layers => format!(
            "below `quality.layers`, which is {layers}: 0 … {}",
            layers.saturating_sub(1)
        ),
        _ => return,
    };
    let detail = format!("there is no layer {}", output.layer);
    findings.invalid("/output/layer", detail, accepted);
}

fn mesh_map(
    findings: &mut Findings,
    scene: &Scene,
    output: &IrradianceMapOutput,
    index: u32,
    limits: &Limits,
) {
    let count = scene.objects.len();
    if index as usize >= count {
        let accepted = match count {
            0 => "\"floor\": the scene has no objects".to_owned(),
            _ => format!("\"floor\" or an index into `objects`, 0 … {}", count - 1),
        };
        findings.invalid(
            "/output/receiver",
            format!("there is no object {index}"),
            accepted,
        );
    }
    let floor_only = [
        ("min_m", output.min_m.is_some()),
        ("max_m", output.max_m.is_some()),
        ("width", output.width.is_some()),
        ("height", output.height.is_some()),
    ];
    for (field, _) in floor_only.iter().filter(|(_, is_there)| *is_there) {
        findings.invalid(
            format!("/output/{field}"),
            format!("`{field}` is for the floor only"),
            "no such field: the map of a mesh has the texels of its level map, `quality.level_map_texels` along each side",
        );
    }
    let side = scene.quality.level_map_texels;
    pixels(findings, "/quality/level_map_texels", [side, side], limits);
}

fn floor_map(
    findings: &mut Findings,
    scene: &Scene,
    output: &IrradianceMapOutput,
    limits: &Limits,
) {
    map_size(findings, [output.width, output.height], limits);
    match &scene.floor {
        Some(floor) => window(findings, floor, output),
        None => findings.invalid(
            "/output/receiver",
            "the scene has no floor",
            "an index into `objects`, or a scene with a `floor`",
        ),
    }
}

/// Checks the numbers of texels along x and z.
fn map_size(findings: &mut Findings, sides: [Option<u32>; 2], limits: &Limits) {
    let mut is_sized = true;
    for (pointer, side) in [("/output/width", sides[0]), ("/output/height", sides[1])] {
        is_sized &= side.is_none_or(|side| findings.integer::<ranges::MapSide>(pointer, side));
    }
    if is_sized {
        let size = sides.map(|side| side.unwrap_or(ranges::DEFAULT_MAP_SIDE));
        pixels(findings, "/output", size, limits);
    }
}

fn window(findings: &mut Findings, floor: &Floor, output: &IrradianceMapOutput) {
    let [floor_min, floor_max] = floor.corners_m();
    let min = output.min_m.unwrap_or(floor_min);
    let max = output.max_m.unwrap_or(floor_max);
    let given = [output.min_m, output.max_m];
    let Some(named) = corners(findings, given, Some([min, max])) else {
        return;
    };
    // Rounding errors are tolerated. A texel beside the floor would show light where there is no surface.
    let hair = |axis: usize| 1e-9 * (floor_max[axis] - floor_min[axis]);
    let leaves = |axis: usize| {
        min[axis] < floor_min[axis] - hair(axis) || max[axis] > floor_max[axis] + hair(axis)
    };
    if leaves(0) || leaves(1) {
        findings.invalid(
            format!("/output/{named}"),
            format!("the map from {min:?} to {max:?} m extends beyond the floor"),
            format!("a map within the floor, which reaches from {floor_min:?} to {floor_max:?} m"),
        );
    }
}

/// Checks the corners that the scene gives, and the rectangle between the corners that then apply. Returns the field of a corner that
/// the scene gives, if it gives one and all is well.
fn corners(
    findings: &mut Findings,
    [given_min, given_max]: [Option<[f64; 2]>; 2],
    applied: Option<[[f64; 2]; 2]>,
) -> Option<&'static str> {
    let mut is_sound = true;
    for (pointer, corner) in [("/output/min_m", given_min), ("/output/max_m", given_max)] {
        if let Some(corner) = corner {
            is_sound &= findings.numbers(pointer, &corner, &ranges::COORDINATE);
        }
    }
    // Report the corner that the scene gives.
    let given = match (given_min, given_max) {
        (_, Some(_)) => "max_m",
        (Some(_), None) => "min_m",
        (None, None) => return None,
    };
    let [min, max] = applied.filter(|_| is_sound)?;
    for axis in [0, 1] {
        let name = ["x", "z"][axis];
        // The largest floor, too, has a map; rounding errors are tolerated.
        let extents = ranges::EXTENT.min..=ranges::EXTENT.max * (1.0 + 1e-9);
        if !extents.contains(&(max[axis] - min[axis])) {
            findings.invalid(
                format!("/output/{given}/{axis}"),
                format!(
                    "along {name} the map reaches from {} to {} m",
                    min[axis], max[axis]
                ),
                format!(
                    "`min_m` below `max_m`, by {} … {} m",
                    ranges::number(ranges::EXTENT.min),
                    ranges::number(ranges::EXTENT.max)
                ),
            );
            is_sound = false;
        }
    }
    is_sound.then_some(given)
}
