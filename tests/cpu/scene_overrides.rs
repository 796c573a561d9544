//! Fields replaced from outside: the list of fields, and how their text becomes JSON.

use caustica::scene::overrides::{Field, apply, fields};
use caustica::scene::{Output, Scene};
use serde_json::{Value, json};

fn overridden(mut value: Value, overrides: &[(&str, &str)]) -> Value {
    let overrides: Vec<(String, String)> = overrides
        .iter()
        .map(|(pointer, text)| ((*pointer).to_owned(), (*text).to_owned()))
        .collect();
    apply(&mut value, &overrides);
    value
}

fn field(name: &str) -> Field {
    let found = fields().into_iter().find(|field| field.name == name);
    found.unwrap_or_else(|| panic!("no field {name}"))
}

#[test]
fn every_serialised_field_of_quality_and_output_is_there_once() {
    let map = json!({ "output": {
        "kind": "irradiance_map", "receiver": "floor", "min_m": [0, 0], "max_m": [1, 1], "width": 1, "height": 1, "light": 0, "embed_scene": false
    } });
    let wishes =
        json!({ "quality": { "method": "any", "target_error": 0.1, "time_budget_ms": 10 } });
    let water = json!({ "output": {
        "kind": "water_map", "min_m": [0, 0], "max_m": [1, 1], "width": 1, "height": 1, "embed_scene": false
    } });
    let mut pointers = Vec::new();
    for scene in [wishes, map, water] {
        let scene = Scene::from_value(scene).unwrap();
        let value = serde_json::to_value(&scene).unwrap();
        for section in ["quality", "output"] {
            for name in value[section].as_object().unwrap().keys() {
                pointers.push(format!("/{section}/{name}"));
            }
        }
    }
    pointers.sort();
    pointers.dedup();
    let mut known: Vec<String> = fields().into_iter().map(|field| field.pointer).collect();
    known.sort();
    assert_eq!(known, pointers);
    assert!(known.len() >= 20, "{known:?}");
}

#[test]
fn fields_carry_their_documentation() {
    for field in fields() {
        assert!(field.help.len() > 10, "{field:?}");
    }
    let cells = field("water_cells");
    assert_eq!(cells.flag, "water-cells");
    assert!(cells.help.contains("2 … 2048"), "{}", cells.help);
    assert_eq!(field("format").words, ["png", "exr"]);
    assert_eq!(field("tone_curve").words, ["clip", "pbr_neutral"]);
    let layers: Vec<_> = fields()
        .into_iter()
        .filter(|f| f.name == "layers")
        .collect();
    assert_eq!(layers[0].pointer, "/quality/layers");
    assert_eq!(layers[0].flag, "quality-layers");
    assert_eq!(layers[1].flag, "layers");
    assert!(layers[1].words.contains(&"depth".to_owned()));
    assert_eq!(field("kind").words, ["view", "irradiance_map", "water_map"]);
    let width = field("width").help;
    assert!(width.starts_with("View: Picture width"), "{width}");
    assert!(
        width.contains("Irradiance map: Texels along x") && width.contains("Water map: Texels"),
        "{width}"
    );
    assert_eq!(width.matches("View:").count(), 1, "{width}");
    let scene = field("embed_scene").help;
    assert!(!scene.contains("map:"), "the same for all kinds: {scene}");
    let lists: Vec<String> = fields()
        .into_iter()
        .filter(|f| f.is_list)
        .map(|f| f.name)
        .collect();
    assert_eq!(lists, ["layers", "max_m", "min_m"]);
}

#[test]
fn texts_become_json_of_the_right_type() {
    let out = overridden(
        json!({ "output": { "kind": "view", "width": 3 }, "quality": {} }),
        &[
            ("/output/width", "1920"),
            ("/output/format", "exr"),
            ("/output/layers", "radiance, depth"),
            ("/output/exposure_ev", "-.5"),
            ("/output/include_sky", "true"),
            ("/output/min_m", "-1,2e0"),
            ("/output/receiver", "floor"),
            ("/quality/water_cells", "64"),
        ],
    );
    assert_eq!(
        out,
        json!({
            "output": {
                "kind": "view", "width": 1920, "format": "exr", "layers": ["radiance", "depth"], "exposure_ev": -0.5,
                "include_sky": true, "min_m": [-1, 2.0], "receiver": "floor"
            },
            "quality": { "water_cells": 64 }
        })
    );
}

#[test]
fn a_single_layer_is_still_a_list() {
    let out = overridden(json!({}), &[("/output/layers", "depth")]);
    assert_eq!(out["output"]["layers"], json!(["depth"]));
}

#[test]
fn missing_sections_are_made() {
    for start in [json!({}), json!({ "output": null, "quality": null })] {
        let out = overridden(
            start,
            &[("/output/width", "7"), ("/quality/split_levels", "0")],
        );
        let Output::View(view) = Scene::from_value(out).unwrap().output else {
            panic!("a missing output is a view");
        };
        assert_eq!(view.width, 7);
    }
}

#[test]
fn the_kind_is_put_in_first() {
    let out = overridden(
        json!({}),
        &[
            ("/output/receiver", "floor"),
            ("/output/kind", "irradiance_map"),
        ],
    );
    assert!(matches!(
        Scene::from_value(out).unwrap().output,
        Output::IrradianceMap(_)
    ));
}

#[test]
fn another_kind_of_output_drops_what_it_does_not_have() {
    let view = json!({ "output": {
        "kind": "view", "width": 7, "exposure_ev": 1.0, "layers": ["radiance"], "embed_scene": false, "typo": 1
    } });
    let to = |kind: &str| overridden(view.clone(), &[("/output/kind", kind)])["output"].clone();
    assert_eq!(
        to("water_map"),
        json!({ "kind": "water_map", "width": 7, "embed_scene": false })
    );
    assert_eq!(
        to("irradiance_map"),
        json!({ "kind": "irradiance_map", "width": 7, "exposure_ev": 1.0, "embed_scene": false })
    );
    // The same kind keeps what is wrong in it, and so does one that there is not: reading the scene says what it is.
    assert_eq!(to("view"), view["output"]);
    assert_eq!(to("video")["typo"], 1);
    let given = overridden(
        view,
        &[("/output/kind", "water_map"), ("/output/exposure_ev", "2")],
    );
    assert_eq!(given["output"]["exposure_ev"], 2);
}

#[test]
fn a_dial_joins_the_method_that_stands_there() {
    let cases = [
        (json!({}), vec![("n", "3")], json!({ "n": 3 })),
        (json!("a"), vec![("n", "3")], json!({ "kind": "a", "n": 3 })),
        (
            json!({ "kind": "a", "m": 1 }),
            vec![("n", "x")],
            json!({ "kind": "a", "m": 1, "n": "x" }),
        ),
        // The method first, whatever the order; it keeps no dials of another one, and all of its own.
        (
            json!({ "kind": "a", "m": 1 }),
            vec![("n", "2"), ("", "b")],
            json!({ "kind": "b", "n": 2 }),
        ),
        (json!({ "kind": "a", "m": 1 }), vec![("", "b")], json!("b")),
        (
            json!({ "kind": "a", "m": 1 }),
            vec![("", "a")],
            json!({ "kind": "a", "m": 1 }),
        ),
        (json!(null), vec![("n", "3")], json!({ "n": 3 })),
        // For the reading to refuse.
        (json!(7), vec![("n", "3")], json!(7)),
    ];
    for (start, changes, expected) in cases {
        let mut scene = json!({ "quality": { "method": start.clone() } });
        let changes: Vec<(String, String)> = changes
            .into_iter()
            .map(|(name, text)| match name {
                "" => ("/quality/method".to_owned(), text.to_owned()),
                name => (format!("/quality/method/{name}"), text.to_owned()),
            })
            .collect();
        apply(&mut scene, &changes);
        assert_eq!(
            scene["quality"]["method"], expected,
            "{start} with {changes:?}"
        );
    }
    let nothing = overridden(json!({}), &[("/quality/method/n", "3")]);
    assert_eq!(nothing["quality"]["method"], json!({ "n": 3 }));
}

#[test]
fn bad_values_are_refused_on_reading() {
    for (pointer, text) in [
        ("/output/width", "wide"),
        ("/output/width", "-1"),
        ("/output/width", "1e10"),
        ("/output/width", ""),
        ("/output/width", "nan"),
        ("/output/width", "inf"),
        ("/output/format", "jpg"),
        ("/quality/method", "3"),
        ("/output/receiver", "floor"),
    ] {
        let out = overridden(json!({}), &[(pointer, text)]);
        let error = Scene::from_value(out).expect_err(text);
        assert_eq!(error.issues[0].pointer, pointer, "{text}: {error}");
    }
}

#[test]
fn values_that_are_not_objects_are_left_for_reading_to_refuse() {
    for start in [json!([]), json!(null), json!(3), json!({ "output": 3 })] {
        assert_eq!(overridden(start.clone(), &[("/output/width", "7")]), start);
    }
}
