//! Layers as a dataset script uses them: depths, positions and the camera's matrices fit each other; pixels that see nothing have one
//! value; calibrated cameras; scenes in map coordinates.

use caustica::frame::{FAR_DEPTH_M, Frame};
use caustica::scene::LayerName;
use glam::{DMat4, DVec3, DVec4};
use serde_json::{Value, json};

use super::harness;
use super::scene_files;

const LAYERS: [&str; 7] = [
    "radiance",
    "depth",
    "seen_depth",
    "normal",
    "position",
    "albedo",
    "irradiance",
];

/// A pool with a box that stands out of the water and one under it, and sky in the upper third of the picture.
fn pool(lens: Value, [width, height]: [u32; 2]) -> Value {
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.7, "direction_deg": 30 }],
            "absorption_per_m": [0.3, 0.06, 0.02]
        },
        "floor": { "depth_m": 1.2, "size_m": [6, 6] },
        "lights": [
            { "kind": "sun", "elevation_deg": 55, "azimuth_deg": 120, "irradiance_w_m2": [900, 900, 900] },
            { "kind": "sky", "radiance_w_m2_sr": [20, 30, 45] }
        ],
        "objects": [
            { "mesh": "box.obj", "translation_m": [0.6, -0.2, -0.4], "scale": 0.9 },
            { "mesh": "box.obj", "translation_m": [-0.7, -0.9, 0.3], "scale": 0.4 }
        ],
        "camera": with(json!({ "position_m": [0.4, 1.6, 3.2], "target_m": [0, -0.2, -0.6] }), lens),
        "quality": { "water_cells": 96, "map_texels": 128, "level_map_texels": 64 },
        "output": { "kind": "view", "width": width, "height": height, "format": "exr", "layers": LAYERS }
    })
}

fn with(mut object: Value, fields: Value) -> Value {
    object
        .as_object_mut()
        .unwrap()
        .extend(fields.as_object().unwrap().clone());
    object
}

fn render(scene: Value) -> Frame {
    harness::render(&scene_files::scene(scene))
}

fn values(frame: &Frame, name: LayerName) -> Vec<f64> {
    frame.layers[&name]
        .data
        .iter()
        .map(|v| f64::from(*v))
        .collect()
}

fn points(frame: &Frame, name: LayerName) -> Vec<DVec3> {
    harness::layer(frame, name)
        .into_iter()
        .map(DVec3::from)
        .collect()
}

fn matrix(rows: [[f64; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&rows).transpose()
}

#[test]
fn depths_positions_and_matrices_fit_each_other() {
    let size = [96, 72];
    let lens = json!({ "intrinsics": { "fx": 80, "fy": 95, "cx": 30.25, "cy": 41 } });
    let frame = render(pool(lens, size));
    let camera = frame.stats.camera.clone().expect("a view has a camera");
    let (cv, gl) = (
        matrix(camera.world_to_camera_opencv),
        matrix(camera.world_to_camera_opengl),
    );
    let k = camera.k_px.expect("a pinhole").map(DVec3::from);
    let (depth, seen) = (
        values(&frame, LayerName::Depth),
        values(&frame, LayerName::SeenDepth),
    );
    let position = points(&frame, LayerName::Position);
    let (mut dry, mut wet, mut nothing) = (0, 0, 0);
    for (at, p) in position.iter().enumerate() {
        if seen[at] == f64::from(FAR_DEPTH_M) {
            nothing += 1;
            continue;
        }
        let p_cv = (cv * p.extend(1.0)).truncate();
        assert!(
            (p_cv.z - seen[at]).abs() < 1e-5,
            "pixel {at}: {p_cv} {}",
            seen[at]
        );
        let p_gl = gl * p.extend(1.0);
        assert_eq!(p_gl, DVec4::new(p_cv.x, -p_cv.y, -p_cv.z, 1.0));
        let middle = [at as u32 % size[0], at as u32 / size[0]].map(|i| f64::from(i) + 0.5);
        if p.y > 0.021 {
            // In the air: X = (u − cx) Z / fx.
            let projected = [0, 1].map(|i| k[i].dot(p_cv) / p_cv.z);
            for axis in 0..2 {
                assert!(
                    (projected[axis] - middle[axis]).abs() < 0.01,
                    "pixel {at}: {projected:?} {middle:?}"
                );
            }
            assert!((depth[at] - seen[at]).abs() < 1e-5, "pixel {at}");
            dry += 1;
        } else {
            // The water's surface is nearer than what is seen through it, and on the pixel's ray.
            let ray = DVec3::new(
                (middle[0] - k[0].z) / k[0].x,
                (middle[1] - k[1].z) / k[1].y,
                1.0,
            );
            let on_water = cv.inverse().transform_point3(ray * depth[at]);
            assert!(on_water.y.abs() < 0.021, "pixel {at}: {on_water}");
            assert!(depth[at] < seen[at] + 1e-4, "pixel {at}");
            wet += 1;
        }
    }
    assert!(
        dry > 200 && wet > 2000 && nothing > 500,
        "{dry} {wet} {nothing}"
    );
}

#[test]
fn pixels_that_see_nothing_have_one_value_in_every_layer() {
    // Sky, and water without a floor under it.
    let mut scene = pool(json!({ "vertical_fov_deg": 60 }), [64, 64]);
    let with_floor = render(scene.clone());
    scene.as_object_mut().unwrap().remove("floor");
    let without = render(scene);
    for frame in [&with_floor, &without] {
        let albedo = points(frame, LayerName::Albedo);
        let blind: Vec<usize> = (0..albedo.len())
            .filter(|at| albedo[*at] == DVec3::ZERO)
            .collect();
        assert!(blind.len() > 100, "{}", blind.len());
        let (depth, seen) = (
            values(frame, LayerName::Depth),
            values(frame, LayerName::SeenDepth),
        );
        for name in [
            LayerName::Normal,
            LayerName::Position,
            LayerName::Irradiance,
        ] {
            let layer = points(frame, name);
            assert!(blind.iter().all(|at| layer[*at] == DVec3::ZERO), "{name:?}");
        }
        assert!(blind.iter().all(|at| seen[*at] == f64::from(FAR_DEPTH_M)));
        let far = depth.iter().filter(|d| **d > 1e4).count();
        assert!(
            depth
                .iter()
                .all(|d| *d < 1e4 || *d == f64::from(FAR_DEPTH_M))
        );
        assert!(far > 50, "{far}");
    }
    // Without a floor the water still has a depth.
    let over_water = values(&without, LayerName::Depth)
        .iter()
        .zip(values(&without, LayerName::SeenDepth))
        .filter(|(depth, seen)| **depth < 1e4 && *seen > 1e4)
        .count();
    assert!(over_water > 500, "{over_water}");
}

/// The same pixels, whether they are a part of a picture or a picture of their own whose principal point is outside.
#[test]
fn a_part_of_a_picture_is_that_of_a_camera_off_its_axis() {
    let (size, part, corner) = ([96_u32, 72_u32], [40_u32, 30_u32], [50_u32, 35_u32]);
    let focal = 36.0 / 25_f64.to_radians().tan();
    let mut scenes = [
        pool(json!({ "vertical_fov_deg": 50 }), size),
        pool(
            json!({ "intrinsics": {
                "fx": focal, "fy": focal, "cx": 48.0 - f64::from(corner[0]), "cy": 36.0 - f64::from(corner[1])
            } }),
            part,
        ),
    ];
    for scene in &mut scenes {
        // The map of the floor covers what is seen of it: many texels, so that the two maps differ little.
        scene["quality"] =
            json!({ "water_cells": 256, "map_texels": 1024, "level_map_texels": 256 });
    }
    let [whole, part_of_it] = scenes.map(render);
    for (name, tolerance) in [
        (LayerName::Depth, 1e-5),
        (LayerName::SeenDepth, 1e-5),
        (LayerName::Position, 2e-5),
        (LayerName::Normal, 1e-5),
        (LayerName::Albedo, 1e-6),
    ] {
        let (a, b) = (&whole.layers[&name], &part_of_it.layers[&name]);
        let n = a.channels;
        let mut wrong = 0;
        for y in 0..part[1] {
            for x in 0..part[0] {
                let of = |x: u32, y: u32, width: u32| (y * width + x) as usize * n;
                let (i, j) = (of(x + corner[0], y + corner[1], size[0]), of(x, y, part[0]));
                let differs = |c: usize| (a.data[i + c] - b.data[j + c]).abs() > tolerance;
                wrong += u32::from((0..n).any(differs));
            }
        }
        // Single pixels on an edge may fall on the other side.
        assert!(wrong <= 3, "{name:?}: {wrong}");
    }
    let mean = |frame: &Frame, x_0: u32, y_0: u32| {
        let layer = harness::layer(frame, LayerName::Irradiance);
        let mut sum = 0.0;
        for y in 0..part[1] {
            for x in 0..part[0] {
                sum += layer[((y + y_0) * frame.width + x + x_0) as usize][1];
            }
        }
        sum
    };
    let (a, b) = (mean(&whole, corner[0], corner[1]), mean(&part_of_it, 0, 0));
    assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
}

/// A pool in UTM coordinates is rendered as it is at the origin.
#[test]
fn a_scene_in_map_coordinates_is_exact() {
    let near = pool(json!({ "vertical_fov_deg": 50 }), [64, 48]);
    let offset = [454_322.25, 0.0, 5_567_891.5];
    let mut far = near.clone();
    let add = |value: &mut Value| {
        for (axis, part) in offset.iter().enumerate() {
            value[axis] = json!(value[axis].as_f64().unwrap() + part);
        }
    };
    add(&mut far["camera"]["position_m"]);
    add(&mut far["camera"]["target_m"]);
    for object in far["objects"].as_array_mut().unwrap() {
        add(&mut object["translation_m"]);
    }
    far["floor"]["center_m"] = json!([offset[0], offset[2]]);
    // The phase of the wave at the new place.
    let (wavelength_m, degrees) = (0.7, 30_f64);
    let along_m = offset[0] * degrees.to_radians().cos() + offset[2] * degrees.to_radians().sin();
    let phase_deg = -360.0 * (along_m / wavelength_m).fract();
    far["water"]["waves"][0]["phase_deg"] = json!(phase_deg);
    let (near, far) = (render(near), render(far));
    for (name, tolerance) in [
        (LayerName::Radiance, 2e-2),
        (LayerName::Depth, 1e-4),
        (LayerName::SeenDepth, 1e-4),
        (LayerName::Albedo, 1e-4),
    ] {
        let (a, b) = (values(&near, name), values(&far, name));
        let difference: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs().min(1.0)).sum();
        let mean = difference / a.len() as f64;
        assert!(mean < tolerance, "{name:?}: {mean}");
    }
    let codes = |frame: &Frame| -> Vec<String> {
        frame
            .stats
            .warnings
            .iter()
            .map(|w| w.code.clone())
            .collect()
    };
    assert!(!codes(&near).contains(&"positions_coarse".to_owned()));
    assert!(
        codes(&far).contains(&"positions_coarse".to_owned()),
        "{:?}",
        codes(&far)
    );
    let told = far
        .stats
        .warnings
        .iter()
        .find(|w| w.code == "positions_coarse")
        .unwrap();
    assert!(told.message.contains("steps of 0.5 m"), "{}", told.message);
}

#[test]
fn a_frame_contains_its_scene_unless_told_not_to() {
    let mut scene = pool(json!({ "vertical_fov_deg": 50 }), [8, 8]);
    let frame = render(scene.clone());
    let text = frame.scene.expect("by default");
    let hash = format!("blake3:{}", blake3::hash(text.as_bytes()).to_hex());
    assert_eq!(hash, frame.stats.scene_hash);
    assert!(
        text.contains("\"vertical_fov_deg\":50.0") && text.contains("\"mesh\":\"blake3:"),
        "{text}"
    );
    scene["output"]["embed_scene"] = json!(false);
    assert_eq!(render(scene).scene, None);
}
