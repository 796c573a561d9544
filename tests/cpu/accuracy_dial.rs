//! Dials of a sweep: which are accepted, and their syntax.

use caustica::config::Limits;
use caustica::lab::study::comparison;
use caustica::lab::study::dial::{Dial, DialError, Setting, dials, with_dials};
use caustica::methods;
use caustica::scene::{MethodChoice, ResolvedScene};

use caustica::lab::study::sweep::{self, SweepSettings};
use serde_json::json;

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
fn unknown_dials_are_refused_with_the_accepted_ones() {
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
fn every_field_of_quality_but_the_switch_of_the_estimate_is_a_dial_and_those_of_methods_are() {
    let json = serde_json::to_value(caustica::scene::Quality {
        method: MethodChoice::named("any"),
        target_error: Some(0.1),
        time_budget_ms: Some(1.0),
        ..Default::default()
    })
    .unwrap();
    let mut expected: Vec<&str> = json.as_object().unwrap().keys().map(|k| &**k).collect();
    expected.retain(|field| *field != "estimate_error");
    for method in methods::ALL {
        expected.extend(method.dials.iter().map(|dial| dial.name));
    }
    expected.sort();
    expected.dedup();
    let known = dials();
    let mut names: Vec<&str> = known.iter().map(|dial| &*dial.name).collect();
    names.sort();
    assert_eq!(names, expected);
}

fn set(base: &ResolvedScene, dials: &[(&str, &str)]) -> Result<ResolvedScene, String> {
    let dials: Vec<(String, String)> = dials
        .iter()
        .map(|(name, value)| ((*name).to_owned(), (*value).to_owned()))
        .collect();
    match with_dials(base, &dials, &Limits::default()) {
        Ok(Setting::Scene(scene)) => Ok(*scene),
        Ok(Setting::LeftOut(reason)) => Err(format!("left out: {reason}")),
        Err(error) => Err(error.issues[0].pointer.clone()),
    }
}

#[test]
fn values_are_checked_as_the_scene_would() {
    let scene = scene_files::load("sine_pool", &[]);
    let changed = set(&scene, &[("water_cells", "77")]).unwrap();
    assert_eq!(changed.scene.quality.water_cells, 77);
    for (name, value) in [
        ("water_cells", "1"),
        ("water_cells", "few"),
        ("method", "magic"),
        ("level_map_texels", "100"),
    ] {
        let refused = set(&scene, &[(name, value)]).unwrap_err();
        assert_eq!(refused, format!("/quality/{name}"), "{value}");
    }
}

#[test]
fn dials_of_methods_are_swept_where_the_method_has_them() {
    let scene = scene_files::load("sine_pool", &[]);
    let planes = |of: &ResolvedScene| serde_json::to_value(&of.scene.quality.method).unwrap();
    let found = set(&scene, &[("planes", "21"), ("method", "planes")]).unwrap();
    assert_eq!(planes(&found), json!({ "kind": "planes", "planes": 21 }));
    // The same setting written otherwise is the same scene.
    let other = set(&found, &[("method", "level_map")]).unwrap();
    assert_eq!(other.hash(), scene.hash());
    let refused = set(&found, &[("planes", "1")]).unwrap_err();
    assert_eq!(refused, "/quality/method/planes");
    // What another method could do is left out, and is no error of the study.
    for dials in [
        &[("planes", "21")][..],
        &[("planes", "21"), ("method", "level_map")],
    ] {
        let reason = set(&scene, dials).unwrap_err();
        assert!(
            reason.starts_with("left out: method level_map has no dial `planes`"),
            "{reason}"
        );
    }
    let reason = set(&scene, &[("method", "planes"), ("target_error", "0.1")]).unwrap_err();
    assert!(reason.starts_with("left out: target_error"), "{reason}");
}

#[test]
fn a_study_that_no_method_can_do_says_why_before_it_starts() {
    let scene = scene_files::load("sine_pool", &[]);
    let check = |texts: &[&str]| {
        let settings = SweepSettings {
            dials: texts.iter().map(|t| Dial::parse(t).unwrap()).collect(),
            grid: true,
            rungs: comparison::DEFAULT_RUNGS,
            runs: 1,
        };
        sweep::check::<std::convert::Infallible>(&scene, &settings, &Limits::default())
    };
    check(&["method=level_map,planes", "planes=21..101"]).unwrap();
    let error = check(&["planes=21..101"]).unwrap_err().to_string();
    assert!(error.contains("method level_map has no dial"), "{error}");
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
