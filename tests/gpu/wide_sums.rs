//! A focus so strong that narrow flux sums overflow: the light is computed again with wide sums, and nothing is lost.

use caustica::accuracy::metrics::relative_l1;
use serde_json::{Value, json};

use super::harness::{Map, render_with, renderer};
use super::scene_files;
use super::symmetry::pooled;

/// Two crossed sines with the same focal depth under a vertical sun, on a map of ±5 cm around the focus.
///
/// A crest of height A and wave number k focuses where 1 = depth · A k² (1 − 1/n): thin-lens refraction.
fn focus(side: u32, cells: u32) -> Value {
    let k = std::f64::consts::TAU / 1.0;
    let depth = 2.0;
    let amplitude = 1.0 / (depth * k * k * (1.0 - 1.0 / 1.333));
    json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": amplitude, "wavelength_m": 1.0, "direction_deg": 0, "phase_deg": 90 },
            { "kind": "sine", "amplitude_m": amplitude, "wavelength_m": 1.0, "direction_deg": 90, "phase_deg": 90 }
        ] },
        "floor": { "depth_m": depth, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": cells },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-0.05, -0.05], "max_m": [0.05, 0.05], "width": side, "height": side }
    })
}

/// The map, and how often a sun had to be followed again for it. The renderer is held meanwhile: others may rerun too.
fn map_and_reruns(scene: Value) -> (Map, u64) {
    let resolved = scene_files::scene(scene);
    let mut renderer = renderer();
    let before = renderer.wide_sum_reruns();
    let map = Map::with(&mut renderer, &resolved);
    let reruns = renderer.wide_sum_reruns() - before;
    (map, reruns)
}

#[test]
fn a_focus_that_overflows_narrow_sums_loses_nothing() {
    let (fine, reruns) = map_and_reruns(focus(512, 512));
    let brightest = fine.values().iter().copied().fold(0.0, f64::max);
    println!(
        "brightest texel {brightest:.0} times the sun, closure {:.1e}, {reruns} reruns",
        fine.closure()
    );
    assert!(brightest > 1024.0, "{brightest} is no focus");
    assert_eq!(reruns, 1, "narrow sums took it");
    assert!(fine.closure() <= 1e-5, "{:?}", fine.stats.energy);
    let on_map = fine.mean(0) * 0.01;
    let landed = fine.stats.energy[0].landed_w[0];
    assert!((on_map / landed - 1.0).abs() <= 1e-5, "{on_map} {landed}");

    // Texels 64 times as wide hold the same light, and need no rerun.
    let (coarse, reruns) = map_and_reruns(focus(8, 512));
    assert_eq!(reruns, 0);
    let blocks = pooled(&fine.texels, 512, 64);
    let mean = coarse.mean(0);
    for (block, texel) in blocks.iter().zip(&coarse.texels) {
        let error = (block[0] - texel[0]).abs() / mean;
        assert!(error <= 1e-3, "{block:?} and {texel:?}, mean {mean}");
    }
}

#[test]
fn an_even_floor_needs_no_wide_sums() {
    let mut scene = focus(64, 64);
    scene["water"] = json!({});
    let (map, reruns) = map_and_reruns(scene);
    assert!(map.closure() <= 1e-5);
    assert_eq!(reruns, 0);
}

#[test]
fn a_coarse_light_that_overflows_narrow_sums_is_done_again() {
    // Texels so small that two fifths of the cells on half the texels wrap too.
    let estimating = |side: u32, cells: u32| {
        let mut scene = focus(side, cells);
        scene["quality"]["estimate_error"] = json!(true);
        map_and_reruns(scene)
    };
    let (map, reruns) = estimating(1024, 512);
    let (_, fine_reruns) = map_and_reruns(focus(1024, 512));
    let estimated = map
        .stats
        .accuracy
        .as_ref()
        .unwrap()
        .estimated_error
        .unwrap();
    assert_eq!(fine_reruns, 1);
    assert_eq!(reruns, 2, "the light and its coarse one, each once");
    // Twice the cells are four times as near to the truth, so three quarters of the error lie between.
    let (finer, _) = map_and_reruns(focus(1024, 1024));
    let between = relative_l1(map.values(), finer.values()).unwrap();
    println!(
        "estimated {estimated:.2e}, {:.2e} by twice the cells",
        between / 0.75
    );
    let ratio = estimated / (between / 0.75);
    assert!((0.4..=2.5).contains(&ratio), "{ratio}");
}

#[test]
fn commands_recorded_before_the_sums_are_read_give_the_same() {
    let estimating = |mut scene: Value| {
        scene["quality"]["estimate_error"] = json!(true);
        scene
    };
    let sun = |azimuth: f64| json!({ "kind": "sun", "elevation_deg": 60, "azimuth_deg": azimuth, "irradiance_w_m2": [1, 2, 3] });
    let mut two_suns = focus(64, 64);
    two_suns["lights"] = json!([sun(0.0), sun(70.0)]);
    let mut view = focus(64, 96);
    view["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }]);
    view["camera"] = json!({ "position_m": [0, 2, 2], "target_m": [0, -1.5, 0] });
    view["output"] = json!({ "kind": "view", "width": 64, "height": 36, "format": "exr", "layers": ["irradiance", "radiance"] });
    let mut planes = view.clone();
    planes["quality"]["method"] = json!("planes");
    // Fine sums wrap in the first two, coarse ones too in the second; the third is cut into pieces.
    let scenes = [
        focus(512, 512),
        estimating(focus(512, 512)),
        estimating(focus(64, 1024)),
        estimating(focus(64, 64)),
        estimating(two_suns),
        view.clone(),
        estimating(view),
        planes.clone(),
        estimating(planes),
    ];
    let mut all_reruns = Vec::new();
    for (nth, scene) in scenes.into_iter().enumerate() {
        let resolved = scene_files::scene(scene);
        let mut renderer = renderer();
        let before = renderer.wide_sum_reruns();
        let timed = render_with(&mut renderer, &resolved);
        let reruns = renderer.wide_sum_reruns() - before;
        all_reruns.push(reruns);
        let before = renderer.wide_sum_reruns();
        renderer.time_by_host(false);
        let ahead = renderer.recorded_ahead();
        let untimed = render_with(&mut renderer, &resolved);
        assert!(renderer.recorded_ahead() > ahead, "{nth}");
        let again = render_with(&mut renderer, &resolved);
        renderer.time_by_host(true);
        assert_eq!(renderer.wide_sum_reruns() - before, 2 * reruns, "{nth}");
        for frame in [&untimed, &again] {
            assert!(timed.layers == frame.layers, "{nth}");
            assert_eq!(timed.stats.energy, frame.stats.energy, "{nth}");
            assert_eq!(timed.stats.accuracy, frame.stats.accuracy, "{nth}");
            assert_eq!(timed.stats.warnings, frame.stats.warnings, "{nth}");
            assert_eq!(timed.stats.planes, frame.stats.planes, "{nth}");
        }
        let mut passes = timed.stats.passes.iter();
        assert!(!timed.stats.adapter.software || passes.all(|pass| pass.gpu_ms.is_some()));
    }
    assert_eq!(all_reruns[..2], [1, 2]);
}
