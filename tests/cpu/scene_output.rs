//! Outputs of a scene: views with their layers, maps of floor and meshes.

use serde_json::{Value, json};

use super::scene_validate::{findings, full, map_scene, only, with};

#[test]
fn a_view_needs_a_camera_and_a_map_does_not() {
    let mut scene = full();
    scene.as_object_mut().unwrap().remove("camera");
    only(&scene, "/camera");
    let mut scene = map_scene(json!({ "receiver": "floor" }));
    scene.as_object_mut().unwrap().remove("camera");
    assert_eq!(findings(&scene), []);
}

#[test]
fn layers_fit_the_format() {
    let layers = |format: &str, layers: Value| {
        let mut scene = with(full(), "/output/layers", layers);
        scene["output"]["format"] = json!(format);
        scene
    };
    assert_eq!(findings(&layers("exr", json!(["depth", "normal"]))), []);
    only(&layers("exr", json!([])), "/output/layers");
    only(
        &layers("exr", json!(["depth", "normal", "depth"])),
        "/output/layers/2",
    );
    let issue = only(
        &layers("png", json!(["radiance", "depth"])),
        "/output/layers/1",
    );
    assert!(issue.accepted.contains("exr"), "{issue}");
    let flood = findings(&layers("exr", json!(vec!["depth"; 10_000])));
    assert!((10..100).contains(&flood.len()), "{}", flood.len());
}

#[test]
fn png_bits_are_8_or_16() {
    assert_eq!(findings(&with(full(), "/output/png_bits", json!(16))), []);
    let issue = only(
        &with(full(), "/output/png_bits", json!(12)),
        "/output/png_bits",
    );
    assert_eq!(issue.accepted, "8 or 16");
}

#[test]
fn maps_of_a_mesh_name_an_object_and_nothing_of_the_floor() {
    let issue = only(&map_scene(json!({ "receiver": 1 })), "/output/receiver");
    assert!(issue.accepted.contains("0 … 0"), "{issue}");
    let all = json!({ "receiver": 0, "min_m": [0, 0], "max_m": [1, 1], "width": 3, "height": 3 });
    let found = findings(&map_scene(all));
    let pointers: Vec<&str> = found.iter().map(|issue| issue.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/output/min_m",
            "/output/max_m",
            "/output/width",
            "/output/height"
        ]
    );
}

#[test]
fn the_light_of_a_map_is_a_sun_or_a_point_light() {
    assert_eq!(
        findings(&map_scene(json!({ "receiver": "floor", "light": 0 }))),
        []
    );
    let issue = only(
        &map_scene(json!({ "receiver": "floor", "light": 1 })),
        "/output/light",
    );
    assert_eq!(issue.detail, "light 1 is a sky");
    let issue = only(
        &map_scene(json!({ "receiver": "floor", "light": 2 })),
        "/output/light",
    );
    assert_eq!(issue.accepted, "the index of a sun or point light: 0");
    let mut scene = map_scene(json!({ "receiver": "floor", "light": 2 }));
    let lamp = json!({ "kind": "point", "position_m": [0, 1, 0], "intensity_w_sr": [1, 1, 1] });
    scene["lights"].as_array_mut().unwrap().push(lamp);
    assert_eq!(findings(&scene), []);
}

#[test]
fn a_map_of_a_mesh_under_several_suns_needs_a_light() {
    let mut scene = map_scene(json!({ "receiver": 0 }));
    let sun = scene["lights"][0].clone();
    scene["lights"].as_array_mut().unwrap().push(sun);
    let issue = only(&scene, "/output/light");
    assert_eq!(issue.accepted, "the index of a sun or point light: 0, 2");
    scene["output"]["light"] = json!(2);
    assert_eq!(findings(&scene), []);
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": "floor" });
    assert_eq!(findings(&scene), []);
}

#[test]
fn a_map_of_the_floor_needs_a_floor_and_a_window_on_it() {
    let mut scene = map_scene(json!({ "receiver": "floor" }));
    scene.as_object_mut().unwrap().remove("floor");
    only(&scene, "/output/receiver");
    // The floor reaches from (-1, -2) to (3, 2).
    let window = |min: Value, max: Value| {
        findings(&map_scene(
            json!({ "receiver": "floor", "min_m": min, "max_m": max }),
        ))
        .into_iter()
        .map(|issue| issue.pointer)
        .collect::<Vec<_>>()
    };
    assert!(window(json!([-1, -2]), json!([3, 2])).is_empty());
    assert_eq!(window(json!([-9, -9]), json!([9, 9])), ["/output/max_m"]);
    assert_eq!(window(json!([2.9, 1.9]), json!([9, 9])), ["/output/max_m"]);
    assert!(window(json!([2.9, 1.9]), json!([3, 2])).is_empty());
    assert_eq!(window(json!([0, 0]), json!([0, 1])), ["/output/max_m/0"]);
    assert_eq!(window(json!([0, 2]), json!([1, 1])), ["/output/max_m/1"]);
    assert_eq!(window(json!([3, 0]), json!([9, 9])), ["/output/max_m"]);
    assert_eq!(window(json!([0, -9]), json!([1, -2])), ["/output/max_m"]);
    // A corner that is not given is the floor's.
    assert_eq!(window(json!([3.5, 0]), Value::Null), ["/output/min_m/0"]);
    assert_eq!(window(Value::Null, json!([0, -2])), ["/output/max_m/1"]);
    assert!(window(Value::Null, json!([0, 0])).is_empty());
}
