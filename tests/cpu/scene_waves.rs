//! What is accepted of each kind of waves.

use caustica::scene::{IssueKind, Scene};
use serde_json::{Value, json};

use super::scene_parse::refusal;
use super::scene_validate::{findings, full, only, with};

fn scene(waves: Value) -> Value {
    let mut scene = full();
    scene["water"]["waves"] = json!([waves]);
    scene
}

fn gerstner() -> Value {
    json!({ "kind": "gerstner", "amplitude_m": 0.1, "wavelength_m": 2, "direction_deg": 0, "phase_deg": 0, "period_s": 1, "steepness": 0.5 })
}

fn spectrum() -> Value {
    json!({
        "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 5, "wind_direction_deg": 0, "fetch_m": 1000, "gamma": 3.3,
        "spreading": "hasselmann", "swell": 0.1, "choppiness": 0.2, "min_wavelength_m": 0.5, "max_wavelength_m": 10, "significant_height_m": 0.2,
        "tile_m": 20, "samples": 256, "seed": 1, "loop_s": 10
    })
}

fn ripples() -> Value {
    json!({
        "kind": "ripples", "min_m": [-1, -1], "max_m": [1, 2], "samples": 64, "walls": "periodic", "damping_per_s": 0.1,
        "dispersion": "shallow", "drops": [{ "position_m": [0, 0], "radius_m": 0.1, "height_m": 0.02, "at_s": 0 }]
    })
}

#[test]
fn every_range_holds_its_ends_and_nothing_beyond() {
    let at = |field: &str| format!("/water/waves/0/{field}");
    for (waves, field, [low, high], beyond) in [
        (gerstner(), "amplitude_m", [0.0, 100.0], [-0.1, 100.1]),
        (gerstner(), "wavelength_m", [1e-3, 1e5], [0.9e-3, 1.1e5]),
        (gerstner(), "steepness", [0.0, 0.95], [-0.01, 0.96]),
        (gerstner(), "period_s", [1e-6, 1e12], [0.0, 1.1e12]),
        (spectrum(), "wind_speed_m_s", [0.0, 60.0], [-1.0, 60.1]),
        (spectrum(), "fetch_m", [1.0, 1e7], [0.9, 1.1e7]),
        (spectrum(), "gamma", [1.0, 10.0], [0.9, 10.1]),
        (spectrum(), "swell", [0.0, 1.0], [-0.1, 1.1]),
        (spectrum(), "choppiness", [0.0, 2.0], [-0.1, 2.1]),
        (
            spectrum(),
            "significant_height_m",
            [0.0, 100.0],
            [-0.1, 100.1],
        ),
        (spectrum(), "loop_s", [1e-3, 1e6], [0.9e-3, 1.1e6]),
        (
            spectrum(),
            "seed",
            [0.0, 4_294_967_295.0],
            [-1.0, 4_294_967_296.0],
        ),
        (spectrum(), "samples", [256.0, 2048.0], [32.0, 4096.0]),
        (ripples(), "samples", [16.0, 1024.0], [15.0, 1025.0]),
        (ripples(), "damping_per_s", [0.0, 1e3], [-0.1, 1.1e3]),
        (ripples(), "drops/0/radius_m", [1e-4, 2.0], [0.0, 2.1]),
        (
            ripples(),
            "drops/0/height_m",
            [-100.0, 100.0],
            [-100.1, 100.1],
        ),
        (ripples(), "drops/0/at_s", [-1e12, 1e12], [-1.1e12, 1.1e12]),
    ] {
        assert_eq!(findings(&scene(waves.clone())), []);
        for value in [low, high] {
            assert_eq!(
                findings(&with(scene(waves.clone()), &at(field), json!(value))),
                [],
                "{field} = {value}"
            );
        }
        for value in beyond {
            let changed = with(scene(waves.clone()), &at(field), json!(value));
            // Integers beyond their type are refused while reading.
            let Ok(_) = Scene::from_value(changed.clone()) else {
                continue;
            };
            only(&changed, &at(field));
        }
    }
    let uneven = with(scene(spectrum()), &at("samples"), json!(300));
    assert!(
        only(&uneven, &at("samples"))
            .accepted
            .contains("power of two")
    );
}

#[test]
fn crests_that_fold_name_their_limit() {
    let mut waves = gerstner();
    waves.as_object_mut().unwrap().remove("steepness");
    assert_eq!(findings(&scene(waves.clone())), []);
    waves["amplitude_m"] = json!(0.4);
    let issue = only(&scene(waves), "/water/waves/0/amplitude_m");
    assert!(issue.detail.contains("fold over themselves"), "{issue}");
    // 0.95 λ/2π.
    assert!(issue.accepted.contains("0.302"), "{issue}");
}

#[test]
fn bands_fit_their_samples() {
    let mut waves = spectrum();
    waves["min_wavelength_m"] = json!(0.3);
    let issue = only(&scene(waves.clone()), "/water/waves/0/min_wavelength_m");
    assert!(issue.accepted.contains("at least 0.3125 m"), "{issue}");
    waves["min_wavelength_m"] = json!(11);
    let issue = only(&scene(waves), "/water/waves/0/min_wavelength_m");
    assert!(issue.detail.contains("longer than the longest"), "{issue}");
}

#[test]
fn drops_are_in_their_basin() {
    let pointer = "/water/waves/0/drops/0/position_m";
    let issue = only(&with(scene(ripples()), pointer, json!([0, 2.1])), pointer);
    assert!(issue.detail.contains("outside"), "{issue}");
    assert_eq!(
        findings(&with(scene(ripples()), pointer, json!([1, 2]))),
        []
    );
    let pointer = "/water/waves/0/max_m/1";
    only(&with(scene(ripples()), pointer, json!(-1)), pointer);
    let text = r#"{"water": {"waves": [{"kind": "ripples", "min_m": [0, 0], "max_m": [1, 1], "walls": "soft", "drops": []}]}}"#;
    assert_eq!(refusal(text).pointer, "/water/waves/0/walls");
}

#[test]
fn grids_are_bounded_together() {
    let mut large = spectrum();
    large["samples"] = json!(2048);
    let mut scene = full();
    scene["water"]["waves"] = json!(vec![large.clone(); 4]);
    assert_eq!(findings(&scene), []);
    scene["water"]["waves"] = json!(vec![large; 5]);
    let issue = only(&scene, "/water/waves");
    assert_eq!(issue.kind, IssueKind::LimitExceeded);
    assert!(issue.accepted.contains("16777216"), "{issue}");
    // So is the work of all drops.
    let mut busy = ripples();
    busy["samples"] = json!(1024);
    busy["drops"] = json!(vec![busy["drops"][0].clone(); 256]);
    scene["water"]["waves"] = json!([busy]);
    assert_eq!(findings(&scene), []);
    scene["water"]["waves"] = json!([busy, busy]);
    let issue = only(&scene, "/water/waves");
    assert_eq!(issue.kind, IssueKind::LimitExceeded);
}

#[test]
fn obstacles_name_objects_in_shallow_water() {
    let with_obstacles = |obstacles: Value| {
        let mut scene = scene(ripples());
        scene["water"]["waves"][0]["obstacles"] = obstacles;
        scene
    };
    let good = with_obstacles(json!([0]));
    assert_eq!(findings(&good), []);
    assert_eq!(findings(&with_obstacles(json!([]))), []);
    let pointer = "/water/waves/0/obstacles/1";
    let issue = only(&with_obstacles(json!([0, 1])), pointer);
    assert!(issue.detail.contains("there is no object 1") && issue.accepted == "0");
    let issue = only(&with_obstacles(json!([0, 0])), pointer);
    assert!(issue.detail.contains("twice"), "{issue}");
    let mut bare = good.clone();
    bare["objects"] = json!([]);
    let issue = only(&bare, "/water/waves/0/obstacles/0");
    assert!(issue.accepted.contains("has no objects"), "{issue}");
    let pointer = "/water/waves/0/dispersion";
    let issue = only(&with(good.clone(), pointer, json!("finite_depth")), pointer);
    assert!(issue.accepted.contains("`shallow`"), "{issue}");
    let mut bottomless = good.clone();
    bottomless.as_object_mut().unwrap().remove("floor");
    let found = findings(&bottomless);
    let issue = found
        .iter()
        .find(|issue| issue.pointer == "/water/waves/0/obstacles")
        .unwrap();
    assert!(issue.accepted.contains("floor"), "{issue}");
    for wrong in [json!([-1]), json!(["post"]), json!(true), json!([0.5])] {
        let text = with_obstacles(wrong).to_string();
        assert!(
            refusal(&text)
                .pointer
                .starts_with("/water/waves/0/obstacles")
        );
    }
}

/// Steps × samples are bounded: 42 × 64 samples in 2 m of water take some 150 steps a second.
#[test]
fn times_that_need_too_many_steps_are_refused() {
    let mut scene = scene(ripples());
    scene["water"]["waves"][0]["obstacles"] = json!([0]);
    for time_s in [-1e12, 0.0, 1e3] {
        assert_eq!(findings(&with(scene.clone(), "/time_s", json!(time_s))), []);
    }
    let issue = only(&with(scene.clone(), "/time_s", json!(1e9)), "/time_s");
    assert_eq!(issue.kind, IssueKind::LimitExceeded);
    assert!(issue.accepted.contains("4e9 samples × steps"), "{issue}");
    // The time that is named is accepted, and twice as much is not.
    let most_s: f64 = issue
        .accepted
        .split("a time of at most ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap();
    assert_eq!(findings(&with(scene.clone(), "/time_s", json!(most_s))), []);
    only(
        &with(scene.clone(), "/time_s", json!(2.0 * most_s)),
        "/time_s",
    );
    // Without obstacles any time does.
    scene["water"]["waves"][0]["obstacles"] = json!([]);
    assert_eq!(findings(&with(scene, "/time_s", json!(1e12))), []);
}
