//! Dials: what may be swept, and how it is written.

use caustica::config::Limits;
use caustica::lab::study::dial::{Dial, DialError, dials, with_dials};
use caustica::scene::Method;

use super::scene_files;

fn values(text: &str) -> Vec<String> {
    Dial::parse(text).unwrap().values
}

#[test]
fn ranges_double_or_count() {
    assert_eq!(
        values("water_cells=64..1024"),
        ["64", "128", "256", "512", "1024"]
    );
    assert_eq!(values("water-cells = 100..500"), ["100", "200", "400"]);
    assert_eq!(values("split_levels=0..4"), ["0", "1", "2", "3", "4"]);
    assert_eq!(values("water_cells=96, 200,1000"), ["96", "200", "1000"]);
    assert_eq!(values("method=level_map"), ["level_map"]);
}

#[test]
fn what_is_no_dial_is_refused_with_what_would_be() {
    let unknown = Dial::parse("cells=1..4").unwrap_err().to_string();
    assert!(
        unknown.contains("`cells` is no dial") && unknown.contains("water_cells"),
        "{unknown}"
    );
    for text in ["water_cells", "water_cells:64"] {
        assert!(
            matches!(Dial::parse(text), Err(DialError::Form(_))),
            "{text}"
        );
    }
    for text in [
        "water_cells=0..64",
        "water_cells=64..64",
        "water_cells=9..3",
        "water_cells=a..b",
        "split_levels=-1..4",
    ] {
        assert!(
            matches!(Dial::parse(text), Err(DialError::Range(_))),
            "{text}"
        );
    }
    for text in ["water_cells=", "water_cells=,"] {
        assert!(
            matches!(Dial::parse(text), Err(DialError::Count { count: 0, .. })),
            "{text}"
        );
    }
    let many: Vec<String> = (2..40).map(|n| n.to_string()).collect();
    let text = format!("water_cells={}", many.join(","));
    assert!(matches!(
        Dial::parse(&text),
        Err(DialError::Count { count: 38, .. })
    ));
}

#[test]
fn every_field_of_quality_but_the_switch_of_the_estimate_is_a_dial() {
    let json = serde_json::to_value(caustica::scene::Quality {
        target_error: Some(0.1),
        time_budget_ms: Some(1.0),
        ..Default::default()
    })
    .unwrap();
    let mut fields: Vec<&String> = json.as_object().unwrap().keys().collect();
    fields.retain(|field| *field != "estimate_error");
    fields.sort();
    let names: Vec<String> = dials().into_iter().map(|dial| dial.name).collect();
    assert_eq!(fields, names.iter().collect::<Vec<_>>());
}

#[test]
fn values_are_checked_as_the_scene_would() {
    let scene = scene_files::load("sine_pool", &[]);
    let limits = Limits::default();
    let set = |name: &str, value: &str| {
        with_dials(&scene, &[(name.to_owned(), value.to_owned())], &limits)
    };
    let changed = set("water_cells", "77").unwrap();
    assert_eq!(changed.scene.quality.water_cells, 77);
    assert_eq!(
        set("method", "level_map").unwrap().scene.quality.method,
        Method::LevelMap
    );
    for (name, value) in [
        ("water_cells", "1"),
        ("water_cells", "few"),
        ("method", "magic"),
        ("level_map_texels", "100"),
    ] {
        let error = set(name, value).unwrap_err();
        assert_eq!(
            error.issues[0].pointer,
            format!("/quality/{name}"),
            "{error}"
        );
    }
}

#[test]
fn a_scene_without_meshes_sweeps_no_dials_of_meshes() {
    let names = |scene: &str| -> Vec<String> {
        let dials = Dial::for_scene(&scene_files::load(scene, &[]));
        dials.into_iter().map(|dial| dial.name).collect()
    };
    assert_eq!(names("sine_pool"), ["water_cells"]);
    assert_eq!(names("pool"), ["water_cells", "map_texels"]);
    assert_eq!(
        names("teapot_pool"),
        [
            "water_cells",
            "split_levels",
            "level_map_texels",
            "map_texels"
        ]
    );
    let on_a_mesh = scene_files::scene(serde_json::json!({
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }],
        "output": { "kind": "irradiance_map", "receiver": 0 }
    }));
    let dials = Dial::for_scene(&on_a_mesh);
    assert!(
        dials.iter().all(|dial| dial.name != "level_map_texels"),
        "the truth has that size"
    );
}
