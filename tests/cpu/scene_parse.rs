//! JSON to scene: what is accepted, and the pointers and texts of refusals.

use caustica::scene::{
    Camera, FloorWord, Issue, IssueKind, Light, Output, Receiver, Scale, Scene, SceneError, Wave,
};
use serde_json::{Value, json};

/// The only finding of a text that must be refused.
pub(crate) fn refusal(text: &str) -> Issue {
    let SceneError { issues } =
        Scene::from_json(text.as_bytes()).expect_err(&format!("should be refused: {text}"));
    assert_eq!(issues.len(), 1, "{text}: {issues:?}");
    issues[0].clone()
}

fn accepted(value: Value) -> Scene {
    Scene::from_value(value.clone()).unwrap_or_else(|error| panic!("{value}: {error}"))
}

#[test]
fn the_example_of_the_documentation_is_read() {
    let scene = accepted(json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20, "phase_deg": 0 }],
            "ior": 1.333, "absorption_per_m": [0.35, 0.07, 0.03], "scattering_per_m": [0, 0, 0]
        },
        "floor": { "depth_m": 2.0, "size_m": [4, 4], "albedo": [0.7, 0.65, 0.5] },
        "lights": [
            { "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [1000, 1000, 1000] },
            { "kind": "sky", "radiance_w_m2_sr": [20, 30, 45] }
        ],
        "objects": [{ "mesh": "blake3:00", "translation_m": [0, -1.2, 0], "rotation": [0, 0, 0, 1], "scale": 0.5 }],
        "camera": { "position_m": [0, 2.5, 4], "target_m": [0, -1.5, 0], "vertical_fov_deg": 45 },
        "quality": { "method": "level_map", "water_cells": 256, "map_texels": 512 },
        "output": { "kind": "view", "width": 960, "height": 540, "format": "png" },
        "time_s": 0.0
    }));
    let Wave::Sine(wave) = &scene.water.waves[0] else {
        panic!("a sine");
    };
    assert_eq!(wave.wavelength_m, 0.9);
    assert!(matches!(scene.lights[1], Light::Sky(_)));
    assert!(matches!(scene.camera, Some(Camera::Perspective(_))));
    assert_eq!(scene.objects[0].scale, Scale::Uniform(0.5));
}

#[test]
fn an_empty_object_is_the_default_scene_and_survives_a_round_trip() {
    let scene = accepted(json!({}));
    assert_eq!(scene.water.ior, 1.333);
    let Output::View(view) = &scene.output else {
        panic!("the default output is a view");
    };
    assert_eq!((view.width, view.height), (960, 540));
    let text = serde_json::to_vec(&scene).unwrap();
    assert_eq!(Scene::from_json(&text).unwrap(), scene);
}

#[test]
fn null_stands_for_an_absent_optional_field() {
    let scene = accepted(json!({ "floor": null, "camera": null }));
    assert_eq!((scene.floor, scene.camera), (None, None));
}

#[test]
fn texts_that_are_not_json_are_refused_with_line_and_column() {
    // (text, what the detail must contain)
    let table = [
        ("", "empty"),
        (" \n\t ", "empty"),
        ("{", "line 1, column 1"),
        ("{\n  \"time_s\": }", "line 2, column 13"),
        (
            "{} {}",
            "there is text after the JSON document (line 1, column 4)",
        ),
        ("{\"time_s\": NaN}", "line 1, column 12"),
        ("{\"time_s\": 01}", "line 1"),
        ("{'time_s': 1}", "key must be a string"),
        ("{\"time_s\": 1,}", "trailing comma"),
        ("// scene\n{}", "line 1"),
        ("{}\u{feff}", "line 1"),
        ("{\"a\": \"\\ud800\"}", "line 1"),
    ];
    for (text, detail) in table {
        let issue = refusal(text);
        assert_eq!(issue.pointer, "", "{text}");
        assert_eq!(issue.kind, IssueKind::Syntax, "{text}");
        assert!(issue.detail.contains(detail), "{text}: {}", issue.detail);
        assert!(!issue.accepted.is_empty(), "{text}");
    }
}

#[test]
fn a_byte_order_mark_is_ignored_and_other_encodings_are_named() {
    let text = r#"{ "time_s": 2 }"#;
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    assert_eq!(Scene::from_json(&marked).unwrap().time_s, 2.0);
    let utf_16 = |unit: fn(u16) -> [u8; 2], mark: &str| -> Vec<u8> {
        format!("{mark}{text}")
            .encode_utf16()
            .flat_map(unit)
            .collect()
    };
    for bytes in [
        utf_16(u16::to_le_bytes, "\u{feff}"),
        utf_16(u16::to_be_bytes, "\u{feff}"),
        utf_16(u16::to_le_bytes, ""),
        utf_16(u16::to_be_bytes, ""),
        text.bytes().flat_map(|byte| [byte, 0, 0, 0]).collect(),
    ] {
        let error = Scene::from_json(&bytes).unwrap_err();
        let issue = &error.issues[0];
        assert_eq!(issue.kind, IssueKind::Syntax);
        assert!(issue.detail.contains("UTF-16"), "{issue}");
        assert!(issue.accepted.contains("UTF-8"), "{issue}");
    }
    for blank in [&b"\xef\xbb\xbf"[..], b"\xef\xbb\xbf \n"] {
        assert!(
            Scene::from_json(blank).unwrap_err().issues[0]
                .detail
                .contains("empty")
        );
    }
}

#[test]
fn bytes_that_are_not_utf8_are_refused() {
    let error = Scene::from_json(b"{\"a\xff\": 1}").unwrap_err();
    assert_eq!(error.kind(), IssueKind::Syntax);
}

#[test]
fn numbers_beyond_f64_are_refused_where_they_stand() {
    let issue = refusal(r#"{"water": {"waves": [], "ior": 1e400}}"#);
    assert_eq!(issue.pointer, "/water/ior");
    assert!(issue.detail.contains("64-bit"), "{}", issue.detail);
    assert_eq!(
        refusal(r#"{"lights": [{"x": [1, -1e999]}]}"#).pointer,
        "/lights/0/x/1"
    );
}

#[test]
fn deep_nesting_is_refused_and_shallow_nesting_is_not() {
    let nested = |levels: usize| format!("{}{}", "[".repeat(levels), "]".repeat(levels));
    for levels in [128, 100_000] {
        let issue = refusal(&nested(levels));
        assert!(
            issue.detail.contains("nested too deeply"),
            "{}",
            issue.detail
        );
    }
    // 100 levels are JSON, only no scene.
    assert_eq!(refusal(&nested(100)).kind, IssueKind::Invalid);
}

#[test]
fn an_oversized_text_is_refused_before_it_is_read() {
    let text = format!(
        "{{\"time_s\": 1{}}}",
        " ".repeat(caustica::scene::parse::MAX_JSON_BYTES)
    );
    let issue = refusal(&text);
    assert_eq!(issue.kind, IssueKind::LimitExceeded);
    assert!(issue.accepted.contains("4194304"), "{}", issue.accepted);
}

#[test]
fn every_key_that_stands_twice_is_named() {
    let text = r#"{"time_s": 1, "water": {"ior": 1.3, "ior": 1.4}, "lights": [{"a/b~": 1, "a/b~": 2}], "time_s": 1}"#;
    let SceneError { issues } = Scene::from_json(text.as_bytes()).unwrap_err();
    let pointers: Vec<&str> = issues.iter().map(|issue| issue.pointer.as_str()).collect();
    assert_eq!(pointers, ["/water/ior", "/lights/0/a~1b~0", "/time_s"]);
    assert!(issues.iter().all(|issue| issue.detail.contains("twice")));
}

#[test]
fn integers_may_be_written_as_floats() {
    let scene = accepted(json!({
        "quality": { "water_cells": 64.0 },
        "output": { "kind": "irradiance_map", "receiver": 0.0, "light": 1.0, "format": "png", "png_bits": 16.0 }
    }));
    assert_eq!(scene.quality.water_cells, 64);
    let Output::IrradianceMap(map) = scene.output else {
        panic!("a map was asked for");
    };
    assert_eq!(
        (map.receiver, map.light, map.png_bits),
        (Receiver::Object(0), Some(1), 16)
    );
    let map = accepted(
        json!({ "output": { "kind": "irradiance_map", "receiver": "floor", "width": null } }),
    );
    let Output::IrradianceMap(map) = map.output else {
        panic!("a map was asked for");
    };
    assert_eq!(
        (map.receiver, map.width),
        (Receiver::Floor(FloorWord::Word), None)
    );
}

#[test]
fn rotations_are_normalised_on_reading_and_only_once() {
    let read = |rotation: Value| {
        accepted(json!({ "objects": [{ "mesh": "m", "rotation": rotation }] })).objects[0].rotation
    };
    let length = |q: [f64; 4]| q.iter().map(|v| v * v).sum::<f64>().sqrt();
    let once = read(json!([0.1, 0.2, 0.3, 0.9274]));
    assert!((length(once) - 1.0).abs() < 1e-15);
    assert_eq!(read(json!(once)), once);
    // Too far off: kept as it is, for validation to refuse.
    assert_eq!(read(json!([0.0, 0.0, 0.0, 1.1])), [0.0, 0.0, 0.0, 1.1]);
}

#[test]
fn long_pieces_of_the_input_are_cut_in_messages() {
    let long = "x".repeat(10_000);
    for text in [
        format!("{{\"time_s\": \"{long}\"}}"),
        format!("{{\"lights\": [{{\"kind\": \"{long}\"}}]}}"),
        format!("{{\"{long}\": 1}}"),
    ] {
        let issue = refusal(&text);
        assert!(issue.detail.len() < 200, "{}", issue.detail.len());
    }
}

#[test]
fn an_error_reads_well_in_a_terminal() {
    let error = Scene::from_json(br#"{"floor": {"depth": 2, "size_m": [4, 4]}}"#).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the scene is not valid\n  \
         /floor/depth: unknown field `depth`; did you mean `depth_m`?\n    \
         accepted: the fields `depth_m`, `size_m`, `center_m` or `albedo`"
    );
}
