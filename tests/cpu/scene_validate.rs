//! Ranges and limits of a scene: every rule is broken once, and met exactly at its limit.

use caustica::config::Limits;
use caustica::methods;
use caustica::scene::{Camera, Issue, IssueKind, Scene};
use serde_json::{Value, json};

/// A valid scene that has everything.
pub(crate) fn full() -> Value {
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "period_s": 1.0 }],
            "level_m": 0.0, "ior": 1.333, "absorption_per_m": [0.35, 0.07, 0.03], "scattering_per_m": [0, 0, 0]
        },
        "floor": { "depth_m": 2.0, "size_m": [4, 4], "center_m": [1, 0], "albedo": [0.7, 0.65, 0.5] },
        "lights": [
            { "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "sky", "radiance_w_m2_sr": [20, 30, 45] }
        ],
        "objects": [{
            "mesh": "blake3:00", "translation_m": [0, -1, 0], "rotation": [0, 0, 0, 1], "scale": 0.5, "albedo": [1, 0, 0.5]
        }],
        "camera": { "position_m": [0, 2.5, 4], "target_m": [0, -1.5, 0], "up": [0, 1, 0], "vertical_fov_deg": 45 },
        "quality": { "water_cells": 256, "map_texels": 512, "level_map_texels": 256, "split_levels": 2, "pixel_samples": 1 },
        "output": {
            "kind": "view", "width": 960, "height": 540, "png_bits": 8, "exposure_ev": 0.0, "layers": ["radiance"]
        },
        "time_s": 0.0
    })
}

/// A valid scene whose output is a map, with these fields.
pub(crate) fn map_scene(fields: Value) -> Value {
    let mut scene = full();
    scene["output"] = json!({ "kind": "irradiance_map" });
    let output = scene["output"].as_object_mut().unwrap();
    output.extend(fields.as_object().unwrap().clone());
    scene
}

fn findings_in(value: &Value, limits: &Limits) -> Vec<Issue> {
    let scene = Scene::from_value(value.clone()).unwrap_or_else(|error| panic!("{value}: {error}"));
    methods::validate(&scene, limits)
        .err()
        .map_or_else(Vec::new, |error| error.issues)
}

pub(crate) fn findings(value: &Value) -> Vec<Issue> {
    findings_in(value, &Limits::default())
}

pub(crate) fn with(mut value: Value, pointer: &str, replacement: Value) -> Value {
    *value
        .pointer_mut(pointer)
        .unwrap_or_else(|| panic!("no {pointer}")) = replacement;
    value
}

/// Asserts one finding at `pointer` and returns it.
pub(crate) fn only(value: &Value, pointer: &str) -> Issue {
    let found = findings(value);
    assert_eq!(found.len(), 1, "{pointer}: {found:#?}");
    assert_eq!(found[0].pointer, pointer);
    assert!(!found[0].accepted.is_empty());
    found[0].clone()
}

#[test]
fn the_full_scene_is_valid() {
    assert_eq!(findings(&full()), []);
    assert_eq!(findings(&map_scene(json!({ "receiver": "floor" }))), []);
    assert_eq!(findings(&map_scene(json!({ "receiver": 0 }))), []);
}

/// Pointer; smallest and largest accepted; a bit below and a bit above, `None` where the type ends there.
type RangeRow = (&'static str, [f64; 2], [Option<f64>; 2]);

fn ranges() -> Vec<RangeRow> {
    let both = |a: f64, b: f64| [Some(a), Some(b)];
    vec![
        ("/time_s", [-1e12, 1e12], both(-1.001e12, 1.001e12)),
        ("/water/level_m", [-1e8, 1e8], both(-1.1e8, 1.1e8)),
        ("/water/ior", [1.0, 4.0], both(0.999, 4.001)),
        (
            "/water/absorption_per_m/0",
            [0.0, 1e4],
            both(-1e-9, 10_001.0),
        ),
        (
            "/water/scattering_per_m/2",
            [0.0, 1e4],
            both(-1e-9, 10_001.0),
        ),
        (
            "/water/waves/0/amplitude_m",
            [0.0, 100.0],
            both(-1e-9, 100.1),
        ),
        (
            "/water/waves/0/wavelength_m",
            [1e-3, 1e5],
            both(0.9e-3, 1.1e5),
        ),
        ("/water/waves/0/period_s", [1e-6, 1e12], both(0.0, 1.1e12)),
        ("/floor/depth_m", [0.0, 11_000.0], both(-0.1, 11_000.1)),
        ("/floor/size_m/1", [1e-6, 1e6], both(0.0, 1.1e6)),
        ("/floor/center_m/0", [-1e8, 1e8], both(-1.1e8, 1.1e8)),
        ("/floor/albedo/0", [0.0, 1.0], both(-0.001, 1.001)),
        ("/lights/0/elevation_deg", [-90.0, 90.0], both(-90.1, 90.1)),
        ("/lights/0/azimuth_deg", [-1e6, 1e6], both(-1.1e6, 1.1e6)),
        ("/lights/0/irradiance_w_m2/1", [0.0, 1e9], both(-1.0, 1.1e9)),
        (
            "/lights/1/radiance_w_m2_sr/1",
            [0.0, 1e9],
            both(-1.0, 1.1e9),
        ),
        (
            "/objects/0/translation_m/1",
            [-1e8, 1e8],
            both(-1.1e8, 1.1e8),
        ),
        ("/objects/0/scale", [1e-6, 1e6], both(0.0, 1.1e6)),
        ("/objects/0/albedo/2", [0.0, 1.0], both(-0.001, 1.001)),
        ("/camera/position_m/0", [-1e8, 1e8], both(-1.1e8, 1.1e8)),
        ("/camera/target_m/0", [-1e8, 1e8], both(-1.1e8, 1.1e8)),
        ("/camera/vertical_fov_deg", [0.1, 179.0], both(0.09, 179.1)),
        ("/quality/water_cells", [2.0, 2048.0], both(1.0, 2049.0)),
        ("/quality/map_texels", [16.0, 4096.0], both(15.0, 4097.0)),
        (
            "/quality/level_map_texels",
            [16.0, 2048.0],
            both(15.0, 2049.0),
        ),
        ("/quality/split_levels", [0.0, 8.0], [None, Some(9.0)]),
        ("/quality/pixel_samples", [1.0, 8.0], both(0.0, 9.0)),
        ("/output/width", [1.0, 16_384.0], both(0.0, 16_385.0)),
        ("/output/height", [1.0, 16_384.0], both(0.0, 16_385.0)),
        ("/output/png_bits", [8.0, 16.0], both(7.0, 17.0)),
        ("/output/exposure_ev", [-40.0, 40.0], both(-40.1, 40.1)),
    ]
}

#[test]
fn every_range_holds_its_ends_and_nothing_beyond() {
    for (pointer, ends, beyond) in ranges() {
        for value in ends {
            assert_eq!(
                findings(&with(full(), pointer, json!(value))),
                [],
                "{pointer} = {value}"
            );
        }
        for value in beyond.into_iter().flatten() {
            let issue = only(&with(full(), pointer, json!(value)), pointer);
            assert_eq!(issue.kind, IssueKind::Invalid);
            assert!(issue.detail.contains("out of range"), "{issue}");
        }
    }
}

#[test]
fn every_number_of_the_scene_has_a_range() {
    fn numbers(value: &Value, pointer: &str, found: &mut Vec<String>) {
        match value {
            Value::Number(_) => found.push(pointer.to_owned()),
            Value::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    numbers(item, &format!("{pointer}/{index}"), found);
                }
            }
            Value::Object(members) => {
                for (key, member) in members {
                    numbers(member, &format!("{pointer}/{key}"), found);
                }
            }
            _ => {}
        }
    }
    let orthographic = json!({ "kind": "orthographic", "position_m": [0, 1, 0], "target_m": [0, 0, 0], "up": [0, 0, 1], "height_m": 1 });
    let window = json!({ "receiver": "floor", "min_m": [0, 0], "max_m": [1, 1] });
    let scenes = [
        full(),
        with(full(), "/objects/0/scale", json!([1, 1, 1])),
        with(full(), "/camera", orthographic),
        map_scene(window),
    ];
    for scene in scenes {
        // With all defaults written out.
        let scene = serde_json::to_value(Scene::from_value(scene).unwrap()).unwrap();
        let mut pointers = Vec::new();
        numbers(&scene, "", &mut pointers);
        assert!(pointers.len() > 40);
        for pointer in pointers {
            let is_integer = scene.pointer(&pointer).unwrap().is_u64();
            let huge = if is_integer {
                json!(4_000_000_000_u32)
            } else {
                json!(1e300)
            };
            let found = findings(&with(scene.clone(), &pointer, huge));
            let is_found = found
                .iter()
                .any(|issue| pointer.starts_with(&issue.pointer));
            assert!(is_found, "{pointer}: {found:?}");
        }
    }
}

#[test]
fn numbers_that_json_cannot_hold_are_refused_too() {
    let mut scene = Scene::from_value(full()).unwrap();
    scene.time_s = f64::NAN;
    scene.water.ior = f64::INFINITY;
    scene.objects[0].rotation = [f64::NAN; 4];
    let Some(Camera::Perspective(camera)) = &mut scene.camera else {
        panic!("the camera is perspective");
    };
    camera.up = [f64::NEG_INFINITY, 0.0, 0.0];
    let issues = scene.validate(&Limits::default()).unwrap_err().issues;
    let pointers: Vec<&str> = issues.iter().map(|issue| issue.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/time_s",
            "/water/ior",
            "/objects/0/rotation",
            "/camera/up/0"
        ]
    );
}

#[test]
fn schema_ranges_are_the_ones_that_are_enforced() {
    use caustica::scene::{IrradianceMapOutput, Quality, ViewOutput};
    use utoipa::PartialSchema;
    let map = map_scene(json!({ "receiver": "floor", "width": 1, "height": 1, "png_bits": 8 }));
    let sections = [
        (Quality::schema(), "/quality", full()),
        (ViewOutput::schema(), "/output", full()),
        (IrradianceMapOutput::schema(), "/output", map),
    ];
    let mut count = 0;
    for (schema, section, base) in sections {
        let schema = serde_json::to_value(schema).unwrap();
        for (name, property) in schema["properties"].as_object().unwrap() {
            let (Some(min), Some(max)) =
                (property["minimum"].as_f64(), property["maximum"].as_f64())
            else {
                continue;
            };
            count += 1;
            let pointer = format!("{section}/{name}");
            let mut base = base.clone();
            // Absent unless asked for.
            base[section.trim_start_matches('/')][name.as_str()] = json!(min);
            for value in [min, max] {
                assert_eq!(
                    findings(&with(base.clone(), &pointer, json!(value))),
                    [],
                    "{pointer} = {value}"
                );
            }
            only(&with(base.clone(), &pointer, json!(max + 1.0)), &pointer);
            if min > 0.0 {
                only(&with(base.clone(), &pointer, json!(min - 1.0)), &pointer);
            }
        }
    }
    assert_eq!(count, 16, "all such fields say their range in the schema");
}

#[test]
fn a_layer_is_one_that_the_mesh_has() {
    let mut scene = map_scene(json!({ "receiver": 0, "layer": 1 }));
    let issue = only(&scene, "/output/layer");
    assert!(
        issue.accepted.contains("below `quality.layers`"),
        "{issue:?}"
    );
    scene["quality"]["layers"] = json!(2);
    assert_eq!(findings(&scene), []);
    scene["output"]["layer"] = json!(2);
    let issue = only(&scene, "/output/layer");
    assert!(issue.accepted.ends_with("0 … 1"), "{issue:?}");
    scene["output"]["receiver"] = json!("floor");
    let issue = only(&scene, "/output/layer");
    assert!(
        issue.accepted.contains("the floor has one surface"),
        "{issue:?}"
    );
}

#[test]
fn all_findings_are_collected_in_the_order_of_the_scene() {
    let mut scene = full();
    for (pointer, value) in [
        ("/time_s", json!(1e13)),
        ("/water/ior", json!(0.5)),
        ("/lights/0/elevation_deg", json!(91)),
        ("/quality/split_levels", json!(9)),
        ("/output/layers", json!([])),
    ] {
        scene = with(scene, pointer, value);
    }
    let found: Vec<String> = findings(&scene)
        .into_iter()
        .map(|issue| issue.pointer)
        .collect();
    let expected = [
        "/time_s",
        "/water/ior",
        "/lights/0/elevation_deg",
        "/quality/split_levels",
        "/output/layers",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_flood_of_findings_is_cut() {
    let wave = json!({ "kind": "sine", "amplitude_m": -1, "wavelength_m": 0 });
    let scene = with(full(), "/water/waves", json!(vec![wave; 256]));
    let found = findings(&scene);
    assert_eq!(found.len(), 101);
    assert_eq!(found[100].detail, "412 more findings are not listed");
}

#[test]
fn a_camera_has_a_direction_and_an_up_across_it() {
    let at_target = with(full(), "/camera/target_m", json!([0, 2.5, 4]));
    only(&at_target, "/camera/target_m");
    let down = with(full(), "/camera/target_m", json!([0, -1, 4]));
    let issue = only(&down, "/camera/up");
    assert!(issue.accepted.contains("[0, 0, -1]"), "{issue}");
    assert_eq!(findings(&with(down, "/camera/up", json!([0, 0, -1]))), []);
    only(&with(full(), "/camera/up", json!([0, 0, 0])), "/camera/up");
    // Any length will do.
    assert_eq!(
        findings(&with(full(), "/camera/up", json!([0, 1e-300, 0]))),
        []
    );
    assert_eq!(
        findings(&with(full(), "/camera/up", json!([0, 1e6, 0]))),
        []
    );
    let orthographic = json!({ "kind": "orthographic", "position_m": [0, 1, 0], "target_m": [0, 0, 0], "height_m": 0 });
    let found = findings(&with(full(), "/camera", orthographic));
    let pointers: Vec<&str> = found.iter().map(|issue| issue.pointer.as_str()).collect();
    assert_eq!(pointers, ["/camera/height_m", "/camera/up"]);
}

#[test]
fn rotations_are_quaternions_of_length_one() {
    for rotation in [
        json!([0, 0, 0, 0]),
        json!([0, 0, 0, 1.0011]),
        json!([0, 0, 0, 0.9989]),
        json!([1, 1, 1, 1]),
    ] {
        only(
            &with(full(), "/objects/0/rotation", rotation),
            "/objects/0/rotation",
        );
    }
    for rotation in [json!([0, 0, 0, 1.0009]), json!([0, 0, 0, -0.9991])] {
        assert_eq!(findings(&with(full(), "/objects/0/rotation", rotation)), []);
    }
}

#[test]
fn scales_per_axis_are_checked_one_by_one() {
    let scene = with(full(), "/objects/0/scale", json!([1, -1, 1]));
    only(&scene, "/objects/0/scale/1");
}

#[test]
fn limits_are_reported_with_numbers() {
    let limits = Limits {
        max_pixels: 100,
        max_objects: 1,
        max_lights: 2,
        max_waves: 1,
        ..Limits::default()
    };
    let over = |value: &Value, pointer: &str, detail: &str, accepted: &str| {
        let found = findings_in(value, &limits);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].pointer, pointer);
        assert_eq!(found[0].kind, IssueKind::LimitExceeded);
        assert!(found[0].detail.contains(detail), "{}", found[0]);
        assert!(found[0].accepted.contains(accepted), "{}", found[0]);
    };
    let mut small = with(full(), "/output/width", json!(10));
    small["output"]["height"] = json!(10);
    assert_eq!(findings_in(&small, &limits), []);
    over(
        &with(small.clone(), "/output/width", json!(11)),
        "/output",
        "11 × 10 are 110 pixels",
        "100",
    );
    let doubled = |section: &str| {
        let mut scene = small.clone();
        let list = scene.pointer_mut(section).unwrap().as_array_mut().unwrap();
        list.push(list[0].clone());
        scene
    };
    over(&doubled("/objects"), "/objects", "2 objects", "at most 1");
    over(&doubled("/lights"), "/lights", "3 lights", "at most 2");
    over(
        &doubled("/water/waves"),
        "/water/waves",
        "2 waves",
        "at most 1",
    );
    let map = map_scene(json!({ "receiver": "floor" }));
    over(&map, "/output", "512 × 512 are 262144 pixels", "100");
    let mesh_map = map_scene(json!({ "receiver": 0 }));
    over(&mesh_map, "/quality/level_map_texels", "256 × 256", "100");
}

#[test]
fn dials_are_not_chosen_for_methods_that_were_not_measured() {
    let unmeasured = methods::ALL.into_iter().filter(|m| !m.dials_can_be_chosen);
    let unmeasured: Vec<&str> = unmeasured.map(|method| method.name).collect();
    assert!(!unmeasured.is_empty());
    for (wish, value) in [("target_error", json!(0.01)), ("time_budget_ms", json!(50))] {
        for method in &unmeasured {
            let mut scene = map_scene(json!({ "receiver": 0 }));
            scene["quality"] = json!({ "method": method });
            assert_eq!(findings(&scene), []);
            scene["quality"][wish] = value.clone();
            let found = findings(&scene);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].pointer, "/quality/method");
        }
    }
}
