//! Further layers: surfaces of an object behind its first, which only tilted rays reach.

use caustica::accuracy::metrics::relative_l1;
use caustica::frame::Frame;
use caustica::reference::{Truth, TruthSettings, truth};
use caustica::scene::{LayerName, ResolvedScene};
use serde_json::{Value, json};

use super::harness::{self, Map};
use super::scene_files;

fn truth_of(scene: &ResolvedScene, error: f64) -> Truth {
    let settings = TruthSettings {
        target_error: Some(error),
        most_points: 20_000,
        ..TruthSettings::default()
    };
    truth(scene, &settings, &|_| {}, &|| false).unwrap()
}

/// Pixels of the truth along x and y.
const SIZE: [usize; 2] = [64, 48];
/// Pixels of the renderer for each of those along both: the truth is the mean over a pixel, a picture is what its middle shows.
const FINER: usize = 4;

/// The sides of the box in `scenes/box_sides.json` with the given number of layers, in a picture `finer` times as large as that
/// of the reference.
fn box_sides(layers: &str, finer: usize) -> ResolvedScene {
    let [width, height] = SIZE.map(|n| (n * finer).to_string());
    scene_files::load(
        "box_sides",
        &[
            ("/output/width", &width),
            ("/output/height", &height),
            ("/output/format", "exr"),
            ("/output/layers", "irradiance,normal,albedo"),
            ("/quality/layers", layers),
        ],
    )
}

/// A pixel of the truth: mean irradiance there, and the normal if all of it lies on the box.
fn coarse(frame: &Frame) -> Vec<([f64; 3], Option<[f64; 3]>)> {
    let [irradiance, normals, albedos] =
        [LayerName::Irradiance, LayerName::Normal, LayerName::Albedo]
            .map(|name| harness::layer(frame, name));
    let width = SIZE[0] * FINER;
    (0..SIZE[0] * SIZE[1])
        .map(|at| {
            let first = (at / SIZE[0]) * FINER * width + (at % SIZE[0]) * FINER;
            let all: Vec<usize> = (0..FINER * FINER)
                .map(|i| first + i / FINER * width + i % FINER)
                .collect();
            let mean = std::array::from_fn(|c| {
                all.iter().map(|&i| irradiance[i][c]).sum::<f64>() / all.len() as f64
            });
            let normal = normals[first];
            let is_one = all
                .iter()
                .all(|&i| normals[i] == normal && albedos[i][0] > 0.7);
            (mean, is_one.then_some(normal))
        })
        .collect()
}

// Bounds are about one and a half times what was measured.
#[test]
fn sides_away_from_the_light_are_lit_by_a_second_layer() {
    let truth = truth_of(&box_sides("1", 1), 2e-2);
    let (mut side_errors, mut away_errors) = (Vec::new(), Vec::new());
    for layers in ["1", "2", "3"] {
        let scene = box_sides(layers, FINER);
        let mut renderer = harness::renderer();
        harness::render_with(&mut renderer, &scene);
        let frame = harness::render_with(&mut renderer, &scene);
        drop(renderer);
        let pixels = coarse(&frame);
        let error_where = |wanted: &dyn Fn([f64; 3]) -> bool| {
            let of: Vec<usize> = (0..pixels.len())
                .filter(|&at| pixels[at].1.is_some_and(wanted))
                .collect();
            let pick = |value: &dyn Fn(usize) -> [f64; 3]| -> Vec<f64> {
                of.iter().flat_map(|&at| value(at)).collect()
            };
            let (seen, true_one) = (pick(&|at| pixels[at].0), pick(&|at| truth.irradiance[at]));
            let flux = seen.iter().sum::<f64>() / true_one.iter().sum::<f64>();
            (relative_l1(&seen, &true_one).unwrap(), flux, of.len())
        };
        let sides = error_where(&|n| n[1].abs() < 0.5);
        let away = error_where(&|n| n[2] > 0.5);
        let stats = &frame.stats;
        println!(
            "{layers} layers: error, flux, pixels {sides:.3?} on the sides, {away:.3?} on the one away from the sun; {:.0} ms, {} bytes; truth {:.1e}",
            stats.time_ms.total, stats.memory.peak_bytes, truth.relative_error
        );
        assert!(away.2 > 100 && sides.2 > away.2 + 50);
        assert_eq!(stats.memory.peak_bytes, stats.memory.planned_peak_bytes);
        assert!(stats.energy[0].closure <= 1e-5, "{:?}", stats.energy);
        side_errors.push(sides.0);
        away_errors.push(away.0);
    }
    // One layer leaves it black.
    assert!((away_errors[0] - 1.0).abs() <= 1e-9, "{away_errors:?}");
    assert!(away_errors[1] <= 0.5, "{away_errors:?}");
    assert!(side_errors[1] <= 0.85 * side_errors[0], "{side_errors:?}");
    // A box has two surfaces.
    assert_eq!(away_errors[2], away_errors[1]);
}

/// The box on whose sides tilted rays fall, as a map of one of its layers.
fn layer_map(layers: u32, layer: u32) -> Value {
    json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": 0.045, "wavelength_m": 0.9, "direction_deg": 70, "phase_deg": 90 },
            { "kind": "sine", "amplitude_m": 0.035, "wavelength_m": 0.7, "direction_deg": 110, "phase_deg": 225 }
        ], "absorption_per_m": [0.2, 0.2, 0.2] },
        "floor": { "depth_m": 1.6, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": 35, "azimuth_deg": 190, "irradiance_w_m2": [1000, 1000, 1000] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.6 }],
        "quality": { "water_cells": 768, "level_map_texels": 128, "split_levels": 3, "layers": layers },
        "output": { "kind": "irradiance_map", "receiver": 0, "layer": layer }
    })
}

#[test]
fn maps_of_layers_are_those_of_the_reference() {
    for (layer, bound) in [(0, 0.06), (1, 0.35)] {
        let scene = scene_files::scene(layer_map(3, layer));
        let truth = truth_of(&scene, 2e-2);
        let map = Map::from(&scene);
        let error = relative_l1(map.values(), truth.irradiance.as_flattened()).unwrap();
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let flux = sum(map.values()) / sum(truth.irradiance.as_flattened());
        println!(
            "layer {layer}: {error:.3}, flux {flux:.3}; truth {:.1e}",
            truth.relative_error
        );
        assert!(error <= bound, "{error}");
        assert!((flux - 1.0).abs() <= bound, "{flux}");
    }
}

#[test]
fn flat_water_lights_the_first_layer_alone() {
    let mut scene = layer_map(2, 0);
    scene["water"] = json!({});
    let first = Map::of(scene.clone()).mean(0);
    scene["output"]["layer"] = json!(1);
    let behind = Map::of(scene.clone()).mean(0);
    println!("{behind} W/m² behind, {first} in front");
    // What strikes the very rim may be taken for what lies behind it.
    assert!(first > 1.0 && behind <= 2e-3 * first, "{behind} {first}");
}

#[test]
fn a_map_of_the_floor_needs_no_layers() {
    let map = |layers: u32| {
        let mut scene = layer_map(layers, 0);
        scene["quality"]["water_cells"] = json!(128);
        scene["output"] =
            json!({ "kind": "irradiance_map", "receiver": "floor", "width": 64, "height": 64 });
        Map::of(scene)
    };
    // The first frame of the mesh builds its level map.
    map(1);
    let (one, three) = (map(1), map(3));
    assert_eq!(one.texels, three.texels);
    let planned = |map: &Map| map.stats.memory.planned_peak_bytes;
    assert_eq!(planned(&one), planned(&three));
    assert!(three.stats.absent.iter().any(|pass| pass.name == "layers"));
}

#[test]
fn layers_are_planned_for_to_the_byte() {
    for layers in [1, 2, 4] {
        let mut renderer = harness::new_renderer(&caustica::config::RenderConfig::default());
        let frame = harness::render_with(
            &mut renderer,
            &scene_files::scene(layer_map(layers, layers - 1)),
        );
        let memory = &frame.stats.memory;
        println!("{layers} layers: {} bytes", memory.peak_bytes);
        assert_eq!(memory.planned_peak_bytes, memory.peak_bytes, "{layers}");
        let closure = frame.stats.energy[0].closure;
        assert!(closure <= 1e-5, "{closure:e}");
    }
}
