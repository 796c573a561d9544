//! Prepared scenes: facts and warnings, and which of them are reused for another time.

use caustica::config::Limits;
use caustica::facts::SceneFacts;
use caustica::facts::source::Source;
use caustica::kept::Kept;
use caustica::methods;
use caustica::render::Prepared;
use caustica::scene::{ResolvedScene, Scene, SceneError, resolve};
use serde_json::{Value, json};

use super::{lamps, scene_files};

/// Which facts of two scenes are not the same to the bit.
fn differing(a: &SceneFacts, b: &SceneFacts) -> Vec<&'static str> {
    // Without `..`, so that a new field has to be compared too.
    let texts = |facts: &SceneFacts| {
        let SceneFacts {
            origin_m,
            water,
            lights,
            receivers,
            output,
            field,
            method,
            quality,
            blends_float32,
            warnings,
        } = facts;
        [
            ("origin_m", format!("{origin_m:?}")),
            ("water", format!("{water:?}")),
            ("lights", format!("{lights:?}")),
            ("receivers", format!("{receivers:?}")),
            ("output", format!("{output:?}")),
            ("field", format!("{field:?}")),
            ("method", format!("{method:?}")),
            ("quality", format!("{quality:?}")),
            ("blends_float32", format!("{blends_float32:?}")),
            ("warnings", format!("{warnings:?}")),
        ]
    };
    let pairs = texts(a).into_iter().zip(texts(b));
    let differing = pairs.filter(|(a, b)| a.1 != b.1);
    differing.map(|(a, _)| a.0).collect()
}

fn moved(resolved: &ResolvedScene, time_s: f64) -> ResolvedScene {
    let mut moved = resolved.clone();
    moved.scene.time_s = time_s;
    // Nothing is taken from what was computed before.
    moved.kept = Kept::default();
    moved
}

/// Goes from one time to the next, and compares each with the same prepared anew; returns all facts.
fn goes_through(name: &str, resolved: &ResolvedScene, times_s: &[f64]) -> Vec<SceneFacts> {
    let mut last = Prepared::new(resolved.clone()).unwrap();
    let mut all = vec![last.facts().clone()];
    for &time_s in times_s {
        let next = last.at(time_s).unwrap();
        let anew = Prepared::new(moved(resolved, time_s)).unwrap();
        let found = differing(next.facts(), anew.facts());
        assert!(found.is_empty(), "{name} at {time_s} s: {found:?}");
        assert_eq!(next.scene_hash(), anew.scene_hash());
        assert_eq!(
            next.resolved().scene,
            anew.resolved().scene,
            "{name} at {time_s} s"
        );
        all.push(next.facts().clone());
        last = next;
    }
    all
}

#[test]
fn the_next_moment_is_the_same_as_prepared_anew() {
    for name in scene_files::names() {
        let resolved = scene_files::load(&name, &[]);
        // Basins with obstacles take steps of time; a scene says how late a moment it accepts.
        let accepts = |time_s: f64| {
            let moved = moved(&resolved, time_s);
            methods::validate(&moved.scene, &Limits::default()).is_ok()
        };
        let late_s = if accepts(1e6) { 1e6 } else { 3.0 };
        let facts = goes_through(&name, &resolved, &[0.04, late_s, -3.7]);
        // The comparison sees what changes.
        let surface = &facts[0].water.surface;
        let is_flat = surface.max_height_m() == 0.0;
        let expected = if is_flat { vec![] } else { vec!["water"] };
        let mut found = differing(&facts[0], &facts[1]);
        if surface.bounds_change_with_time() {
            // Windows follow the bounds.
            found.truncate(1);
        }
        assert_eq!(found, expected, "{name}");
    }
}

/// A mark in the facts of one moment is there in the next one's if they were reused, and is gone if they were found anew.
#[test]
fn facts_that_time_does_not_change_are_reused() {
    for name in scene_files::names() {
        let prepared = Prepared::new(scene_files::load(&name, &[])).unwrap();
        let marked = prepared.with_facts(|facts| facts.lights.white_radiance += 1.0);
        let mark = marked.facts().lights.white_radiance;
        let next = marked.at(0.04).unwrap();
        let is_reused = next.facts().lights.white_radiance == mark;
        let is_reusable = !next.facts().water.surface.bounds_change_with_time();
        assert_eq!(is_reused, is_reusable, "{name}");
    }
}

#[test]
fn a_lamp_that_waves_rise_over_is_found_anew() {
    // A crest of 3 cm stands over the light at 2 cm; half a period later there is a trough.
    let water = json!({ "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1,
                                    "phase_deg": 90, "period_s": 2 }] });
    let mut scene = lamps::pool([0.0, 0.02, 0.0], water, 8);
    scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0.5, -1, 0], "scale": 0.3 }]);
    scene["lights"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }));
    let facts = goes_through(
        "lamp",
        &scene_files::scene(scene),
        &[0.1, 1.0, 1.1, 2.0, 3.0],
    );
    let is_under = |facts: &SceneFacts| {
        let source = facts.lights.beam_sets[0].source;
        matches!(source, Source::Submerged { .. })
    };
    let under: Vec<bool> = facts.iter().map(is_under).collect();
    assert_eq!(under, [true, true, false, false, true, false]);
    let above = ["water", "lights", "warnings"];
    assert_eq!(differing(&facts[1], &facts[2]), above);
}

#[test]
fn warnings_are_those_of_the_dials_that_are_rendered() {
    let with = |quality: Value| {
        let scene = scene_files::scene(json!({
            "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.8 }] },
            "floor": { "depth_m": 2, "size_m": [8, 8] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "quality": quality,
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 64, "height": 64 }
        }));
        let prepared = Prepared::new(scene.clone()).unwrap();
        let expected = if prepared.asks_for_dials() {
            methods::facts(&scene)
        } else {
            methods::facts_with_warnings(&scene)
        };
        assert!(differing(prepared.facts(), &expected.unwrap()).is_empty());
        let later = prepared.at(1.5).unwrap();
        assert_eq!(later.facts().warnings, prepared.facts().warnings);
        prepared.facts().warnings.len()
    };
    assert_eq!(with(json!({ "water_cells": 32 })), 1);
    assert_eq!(
        with(json!({ "water_cells": 32, "time_budget_ms": 100.0 })),
        0
    );
    assert_eq!(with(json!({ "water_cells": 32, "target_error": 0.01 })), 0);
}

#[test]
fn scenes_that_cannot_be_rendered_cannot_be_prepared() {
    // One more light in the air than the camera has room for; half a period earlier the waves are over it.
    let lamp = |x_m: f64, y_m: f64| json!({ "kind": "point", "position_m": [x_m, y_m, 0], "intensity_w_sr": [1, 1, 1] });
    let mut lights = vec![lamp(0.0, 1.0); 64];
    lights.push(lamp(0.0, 0.02));
    let scene = Scene::from_value(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1,
                               "phase_deg": 90, "period_s": 2 }] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": lights,
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 8, "height": 8 }
    }));
    let limits = Limits {
        max_lights: 65,
        ..Limits::default()
    };
    let resolved = resolve(scene.unwrap(), &limits, |_: &str| None).unwrap();
    let refused = |result: Result<Prepared, SceneError>| result.unwrap_err().issues;
    let anew = refused(Prepared::new(moved(&resolved, 1.0)));
    assert_eq!(anew[0].pointer, "/lights");
    let later = Prepared::new(resolved).unwrap().at(1.0);
    assert_eq!(refused(later), anew);
}
