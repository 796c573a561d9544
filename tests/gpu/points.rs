//! Points: the points seen by pixels and the positions of texels, for methods that compute the light at points.

use caustica::scene::LayerName;
use caustica::stages::points::Point;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::harness;
use super::scene_files;

fn points(resolved: &caustica::scene::ResolvedScene) -> Vec<Point> {
    let mut renderer = harness::renderer();
    let points = renderer.points(resolved, &CancellationToken::new());
    points.unwrap_or_else(|error| panic!("{error}"))
}

fn pool(output: Value) -> Value {
    json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9 }] },
        "floor": { "depth_m": 2, "size_m": [6, 5], "center_m": [10, -20] },
        "lights": [{ "kind": "sun", "elevation_deg": 55, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [10, -1.2, -20], "scale": [0.5, 0.4, 0.3],
                      "rotation": [0.0, 0.3826834323650898, 0.0, 0.9238795325112867] }],
        "camera": { "position_m": [10, 2.5, -16], "target_m": [10, -1.2, -20] },
        "quality": { "level_map_texels": 64 },
        "output": output
    })
}

#[test]
fn texels_of_the_floor_lie_where_the_map_says() {
    let output = json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [9, -21], "max_m": [11.5, -19],
                         "width": 50, "height": 16 });
    let resolved = scene_files::scene(pool(output));
    let points = points(&resolved);
    assert_eq!(points.len(), 50 * 16);
    for (index, point) in points.iter().enumerate() {
        // Relative to the middle of the map, on the water at rest.
        let x = -1.25 + (f64::from((index % 50) as u32) + 0.5) * 0.05;
        let z = -1.0 + (f64::from((index / 50) as u32) + 0.5) * 0.125;
        let off = [x, -2.0, z].map(|c| c as f32);
        for (found, due) in point.position_m.iter().zip(off) {
            assert!((found - due).abs() < 1e-5, "{index}: {point:?}");
        }
        assert_eq!(point.receiver, 0.0);
        assert_eq!(point.normal, [0.0, 1.0, 0.0]);
        let side_m = (0.05_f32 * 0.125).sqrt();
        assert!((point.footprint_m - side_m).abs() < 1e-6, "{point:?}");
    }
}

/// A level map that is kept needs no geometry, but how the object is placed still has to be known.
#[test]
fn texels_of_an_object_lie_there_too_after_a_frame_with_other_objects() {
    let resolved = scene_files::scene(pool(json!({ "kind": "irradiance_map", "receiver": 0 })));
    let mut other = pool(json!({ "kind": "view", "width": 16, "height": 16 }));
    other["objects"][0]["rotation"] = json!([0, 0, 0, 1]);
    let other = scene_files::scene(other);
    let mut renderer = harness::renderer();
    let never = CancellationToken::new();
    let before = renderer.points(&resolved, &never).unwrap();
    renderer.render(&other, &never).unwrap();
    assert_eq!(renderer.points(&resolved, &never).unwrap(), before);
}

/// Texels of a box lie on its faces, with the faces' normals, turned with the object.
#[test]
fn texels_of_an_object_lie_on_its_surface() {
    let resolved = scene_files::scene(pool(json!({ "kind": "irradiance_map", "receiver": 0 })));
    let points = points(&resolved);
    assert_eq!(points.len(), 64 * 64);
    let half = [0.5_f64, 0.4, 0.3];
    let turn = std::f64::consts::FRAC_PI_4;
    let mesh = resolved.meshes[0].as_ref();
    let size = (mesh.max_m - mesh.min_m).as_dvec3() * 0.5;
    let (mut seen, mut tops) = (0, 0);
    for point in points.iter().filter(|point| point.receiver != -1.0) {
        assert_eq!(point.receiver, 1.0);
        let back = |v: [f32; 3]| {
            let [x, y, z] = v.map(f64::from);
            // Turned back by 45° about y.
            [
                x * turn.cos() - z * turn.sin(),
                y,
                x * turn.sin() + z * turn.cos(),
            ]
        };
        let [x, y, z] = back(point.position_m);
        let places = [
            x / (half[0] * size.x),
            (y + 1.2) / (half[1] * size.y),
            z / (half[2] * size.z),
        ];
        // On the surface of the unit cube: one coordinate is ±1, none is beyond. The texel's depth is that of its middle.
        let farthest = places.iter().map(|p| p.abs()).fold(0.0, f64::max);
        assert!((farthest - 1.0).abs() < 2e-3, "{places:?}");
        let normal = back(point.normal);
        let along = (0..3)
            .max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))
            .unwrap();
        assert!(normal[along].abs() > 0.999, "{normal:?}");
        let outward = places[along] * normal[along].signum();
        assert!((outward - 1.0).abs() < 2e-3, "{places:?} {normal:?}");
        seen += 1;
        tops += u32::from(along == 1);
    }
    println!("{seen} texels show the box, {tops} its top");
    assert!(seen > 1500 && tops > 500 && tops < seen);
}

/// Points of a view are its layers; the footprint of a pixel is what it shows across its ray.
#[test]
fn points_of_pixels_are_what_the_layers_show() {
    let layers = json!(["position", "normal"]);
    let resolved = scene_files::scene(pool(
        json!({ "kind": "view", "width": 64, "height": 48, "layers": layers, "format": "exr" }),
    ));
    let points = points(&resolved);
    let frame = harness::render(&resolved);
    let positions = harness::layer(&frame, LayerName::Position);
    let normals = harness::layer(&frame, LayerName::Normal);
    let origin = [10.0, 0.0, -20.0];
    for ((point, position), normal) in points.iter().zip(&positions).zip(&normals) {
        assert_eq!(point.normal.map(f64::from), *normal);
        if point.receiver == -1.0 {
            continue;
        }
        for c in 0..3 {
            let world = f64::from(point.position_m[c]) + origin[c];
            assert!((world - position[c]).abs() < 1e-5, "{point:?}");
        }
        // 45° over 48 pixels, at the distance at which the water shows it.
        let away = (point.position_m[2] - 4.0).hypot(point.position_m[1] - 2.5);
        let per_m = 2.0 * (22.5_f32.to_radians()).tan() / 48.0;
        let ratio = point.footprint_m / (per_m * away);
        assert!((0.7..1.3).contains(&ratio), "{ratio}: {point:?}");
    }
}
