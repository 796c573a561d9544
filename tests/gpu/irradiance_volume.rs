//! The kept field of light, made by slices: on a slice, between slices, in every slice's account, and from frame to frame.

use caustica::accuracy::{convergence_order, metrics};
use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::methods::irradiance_volume::{METHOD, SLICE_TEXELS, SLICES};
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::render::{RenderError, Renderer};
use caustica::scene::{LayerName, Light, MethodChoice, ResolvedScene};
use serde_json::{Value, json};

use super::harness::{self, Map, nan_fails};
use super::{scene_files, truths};

/// A scene with a field of this resolution.
fn with(mut scene: Value, slices: u32, texels: u32) -> ResolvedScene {
    let choice = MethodChoice::named(METHOD.name)
        .with(&SLICES, slices)
        .with(&SLICE_TEXELS, texels);
    scene["quality"]["method"] = json!(choice);
    scene_files::scene(scene)
}

fn sun(elevation_deg: f64) -> Value {
    json!({ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 180, "irradiance_w_m2": [1000, 900, 800] })
}

/// The waves of the sine pool.
fn waves() -> Value {
    json!([
        { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 22.9 },
        { "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 97.4 },
        { "kind": "sine", "amplitude_m": 0.006, "wavelength_m": 0.5, "direction_deg": -35, "phase_deg": 166.2 }
    ])
}

/// Height of the highest crest that [`waves`] may have, m.
const CREST_M: f64 = 0.051;

/// The sine pool with a map of 2 m × 2 m of the floor.
fn pool(depth_m: f64, lights: Value, absorption_per_m: Value) -> Value {
    json!({
        "water": { "waves": waves(), "absorption_per_m": absorption_per_m },
        "floor": { "depth_m": depth_m, "size_m": [8, 8] },
        "lights": lights,
        "quality": { "water_cells": 256 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": 256, "height": 256 }
    })
}

/// Under a vertical sun the window over the box is that over the floor, so beams and texels are those of the default method.
#[test]
fn a_floor_in_a_slice_has_the_map_of_the_default_method() {
    for absorption in [json!([0, 0, 0]), json!([0.35, 0.07, 0.03])] {
        let scene = pool(2.0, json!([sun(90.0)]), absorption);
        let due = Map::of(scene.clone());
        let found = Map::from(&with(scene, 8, 256));
        let error = metrics::relative_l1(found.values(), due.values()).unwrap();
        let worst = harness::largest_to_mean(found.values(), due.values());
        println!("off by {error:.1e}, at most {worst:.1e} of the mean");
        assert!(error <= 1e-5, "{error:e}");
        assert!(worst <= 1e-3, "{worst:e}");
        let landed = |map: &Map| map.stats.energy[0].landed_w[0];
        assert!((landed(&found) / landed(&due) - 1.0).abs() <= 1e-5);
    }
}

/// Light that several suns throw adds up.
#[test]
fn several_beam_sets_add_up() {
    let suns = [sun(90.0), sun(40.0)];
    let map = |lights: Value| Map::from(&with(pool(2.0, lights, json!([0.3, 0.1, 0.05])), 8, 64));
    let [one, other] = suns.clone().map(|sun| map(json!([sun])));
    let both = map(json!(suns));
    let sum: Vec<f64> = one
        .values()
        .iter()
        .zip(other.values())
        .map(|(a, b)| a + b)
        .collect();
    let worst = harness::largest_to_mean(both.values(), &sum);
    assert!(worst <= 1e-5, "{worst:e}");
    assert_eq!(both.stats.fields.len(), 2);
}

/// A square metre lies at `height_m`, seen from straight above it, over the floor of a pool as large as itself.
fn plate(waves: Value, floor_m: f64, height_m: f64, elevation_deg: f64) -> Value {
    json!({
        "water": { "waves": waves },
        "floor": { "depth_m": floor_m, "size_m": [2, 2] },
        "lights": [sun(elevation_deg)],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, height_m - 0.0005, 0], "scale": [2, 0.001, 2] }],
        "camera": { "kind": "orthographic", "position_m": [0, -0.2, 0], "target_m": [0, -1, 0], "up": [0, 0, -1], "height_m": 1.5 },
        "quality": { "water_cells": 384 },
        "output": { "kind": "view", "width": 192, "height": 192, "layers": ["irradiance"], "format": "exr" }
    })
}

fn irradiance(resolved: &ResolvedScene) -> Vec<f64> {
    harness::layer(&harness::render(resolved), LayerName::Irradiance).concat()
}

/// Gentle waves that focus far below: no light folds. The plate lies a third of the way up, so a third or two thirds between its slices.
#[test]
fn between_slices_the_error_falls_with_the_square_of_their_distance() {
    let waves = json!([
        { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.3, "direction_deg": 20 },
        { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 1.1, "direction_deg": 100 }
    ]);
    let (floor_m, crest_m) = (1.5, 0.03);
    let height_m = -floor_m + (floor_m + crest_m) / 3.0;
    let scene = plate(waves, floor_m, height_m, 70.0);
    // On a slice.
    let due = irradiance(&with(scene.clone(), 13, 256));
    let points: Vec<(f64, f64)> = [2, 3, 5]
        .iter()
        .map(|&slices| {
            let found = irradiance(&with(scene.clone(), slices, 256));
            (
                f64::from(slices - 1),
                metrics::relative_l1(&found, &due).unwrap(),
            )
        })
        .collect();
    let order = convergence_order(&points);
    println!("{points:?}, order {order:.2}");
    assert!(order >= 1.8, "{order} from {points:?}");
    let default = irradiance(&scene_files::scene(scene));
    let error = metrics::relative_l1(&due, &default).unwrap();
    println!("on a slice off the default method by {error:.1e}");
    assert!(error <= 0.01, "{error:e}");
}

/// The sine pool, folded as it is, at heights between two of 64 slices: against float64 rays.
#[test]
fn between_64_slices_the_sine_pool_is_near_the_truth() {
    for depth_m in [0.6, 1.0, 1.6] {
        let spacing_m = (2.0 + CREST_M) / 63.0;
        // Halfway between two slices.
        let level = ((2.0 - depth_m) / spacing_m).floor() + 0.5;
        let height_m = -2.0 + level * spacing_m;
        let mut scene = plate(waves(), 2.0, height_m, 60.0);
        scene["quality"]["water_cells"] = json!(384);
        let found = irradiance(&with(scene, 64, 256));
        let mut map = pool(-height_m, json!([sun(60.0)]), json!([0, 0, 0]));
        map["output"] = json!({ "kind": "irradiance_map", "receiver": "floor",
            "min_m": [-0.75, -0.75], "max_m": [0.75, 0.75], "width": 192, "height": 192 });
        let due = truths::floor_map(&scene_files::scene(map), &harness::truth_settings(3e-3));
        let error = metrics::relative_l1(&found, due.irradiance.as_flattened()).unwrap();
        println!(
            "{height_m:.3} m: off by {:.2} %, the truth by {:.2} %",
            100.0 * error,
            100.0 * due.relative_error
        );
        assert!(error <= 0.03, "{error}");
    }
}

/// Through + lost above + beside = entered, for every slice; and flat water has the closed form in each of them.
#[test]
fn every_slice_has_an_account_that_closes() {
    let lamp =
        json!({ "kind": "point", "position_m": [0.4, 1.1, -0.3], "intensity_w_sr": [100, 90, 80] });
    for lights in [json!([sun(60.0)]), json!([sun(10.0)]), json!([lamp])] {
        for cells in [7, 256] {
            let mut scene = pool(2.0, lights.clone(), json!([0.35, 0.07, 0.03]));
            scene["quality"]["water_cells"] = json!(cells);
            let map = Map::from(&with(scene, 64, 64));
            let field = &map.stats.fields[0];
            println!("{lights}, {cells} cells: {:.1e}", field.closure);
            assert_eq!(field.through_w.len(), 64);
            assert!(field.closure <= 1e-5, "{:e}", field.closure);
            assert!(map.closure() <= 1e-5, "{:e}", map.closure());
            assert!(field.through_w.iter().flatten().all(|&w| w > 0.0));
        }
    }
    let mut flat = pool(2.0, json!([sun(60.0)]), json!([0.35, 0.07, 0.03]));
    flat["water"]["waves"] = json!([]);
    let resolved = with(flat, 9, 32);
    let map = Map::from(&resolved);
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("a sun");
    };
    let area_m2 = 4.0;
    for (slice, through_w) in map.stats.fields[0].through_w.iter().enumerate() {
        let depth_m = 2.0 * (1.0 - slice as f64 / 8.0);
        let due = flat_water_irradiance(&resolved.scene.water, depth_m, sun).map(|e| e * area_m2);
        let error = harness::largest_relative(through_w, &due);
        assert!(error <= 1e-5, "{error:e} at {depth_m} m");
    }
}

/// A pool with a box at this place, or none.
fn moving(at_m: [f64; 3], camera_x_m: f64) -> Value {
    json!({
        "water": { "waves": waves(), "absorption_per_m": [0.3, 0.1, 0.05] },
        "floor": { "depth_m": 2, "size_m": [4, 4], "albedo": [0.5, 0.5, 0.5] },
        "lights": [sun(60.0)],
        "objects": [{ "mesh": "box.obj", "translation_m": at_m, "scale": 0.4, "albedo": [0.8, 0.8, 0.8] }],
        "camera": { "position_m": [camera_x_m, 1.8, 3], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 128 },
        "output": { "kind": "view", "width": 96, "height": 72 }
    })
}

fn runs(frame: &Frame) -> Vec<&str> {
    frame
        .stats
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect()
}

const OF_LIGHT: [&str; 3] = ["surface", "beams", "field_slices"];

/// Time of the passes that carry light, ms; the look-up counts, for it is what a moved receiver costs.
fn light_ms(frame: &Frame) -> f64 {
    let of_light =
        frame.stats.passes.iter().filter(|pass| {
            OF_LIGHT.contains(&pass.name.as_str()) || pass.name == "field_irradiance"
        });
    of_light.map(|pass| pass.gpu_ms.unwrap()).sum()
}

#[test]
fn a_receiver_that_moves_costs_a_look_up() {
    let mut renderer = harness::new_renderer(&RenderConfig::default());
    let mut frame = |at_m, camera_x_m| {
        let resolved = with(moving(at_m, camera_x_m), 64, 128);
        harness::render_with(&mut renderer, &resolved)
    };
    let first = frame([0.0, -1.2, 0.0], 0.0);
    assert!(OF_LIGHT.iter().all(|name| runs(&first).contains(name)));
    let first_ms = light_ms(&first);
    let mut rest_ms = 0.0;
    for step in 1..=60 {
        let turn = std::f64::consts::TAU * f64::from(step) / 60.0;
        let at_m = [
            0.6 * turn.sin(),
            -1.2 + 0.5 * turn.cos(),
            0.6 * (turn.cos() - 1.0),
        ];
        let next = frame(at_m, 0.3 * turn.sin());
        for name in OF_LIGHT {
            assert!(!runs(&next).contains(&name), "{name} runs again");
        }
        let reason = next
            .stats
            .absent
            .iter()
            .find(|pass| pass.name == "field_slices");
        assert!(reason.unwrap().reason.contains("cached"), "{reason:?}");
        assert!(next.stats.fields[0].was_kept);
        assert_eq!(next.stats.energy, first.stats.energy, "the account is kept");
        assert_eq!(next.stats.memory.fields.hits, 1);
        rest_ms += light_ms(&next) / 60.0;
    }
    println!(
        "first frame {first_ms:.1} ms, later ones {rest_ms:.2} ms: 1 : {:.0}",
        first_ms / rest_ms
    );
    assert!(rest_ms <= 0.1 * first_ms, "{rest_ms} of {first_ms} ms");
}

/// A frame from a kept field has the bytes of one that made it; so has one after the field was evicted.
#[test]
fn a_kept_field_gives_the_same_bytes() {
    let config = RenderConfig {
        // Room for one of the two.
        field_budget_mib: 5,
        ..RenderConfig::default()
    };
    let mut renderer = harness::new_renderer(&config);
    let here = with(moving([0.0, -1.2, 0.0], 0.0), 16, 128);
    let aside = with(moving([0.4, -1.0, 0.3], 0.4), 16, 128);
    let mut at_another_time = here.clone();
    at_another_time.scene.water.absorption_per_m = [0.4, 0.2, 0.1];
    let data = |frame: &Frame| frame.layers[&LayerName::Radiance].data.clone();
    let fresh = harness::render_with(&mut renderer, &here);
    harness::render_with(&mut renderer, &aside);
    let kept = harness::render_with(&mut renderer, &here);
    assert!(kept.stats.fields[0].was_kept);
    assert_eq!(data(&fresh), data(&kept));
    let other = harness::render_with(&mut renderer, &at_another_time);
    assert!(!other.stats.fields[0].was_kept);
    assert_ne!(data(&fresh), data(&other));
    assert_eq!(other.stats.memory.fields.evictions, 1);
    let again = harness::render_with(&mut renderer, &here);
    assert!(!again.stats.fields[0].was_kept);
    assert_eq!(data(&fresh), data(&again));
    // After a camera's move the field was made with other coordinates nowhere.
    let mut other_order = harness::new_renderer(&RenderConfig::default());
    harness::render_with(&mut other_order, &aside);
    assert_eq!(
        data(&fresh),
        data(&harness::render_with(&mut other_order, &here))
    );
}

/// What the field depends on makes a new one, one thing at a time.
#[test]
fn a_change_of_the_water_or_the_light_makes_a_new_field() {
    let key = |scene: &Value| {
        let facts = caustica::methods::facts(&with(scene.clone(), 8, 32)).unwrap();
        facts.lights.beam_sets[0].field.clone().unwrap()
    };
    let scene = moving([0.0, -1.2, 0.0], 0.0);
    let own = key(&scene);
    let changed = |pointer: &str, value: Value| {
        let mut other = scene.clone();
        match other.pointer_mut(pointer) {
            Some(place) => *place = value,
            None => other[pointer.trim_start_matches('/')] = value,
        }
        key(&other)
    };
    for (pointer, value) in [
        ("/water/waves/0/phase_deg", json!(23)),
        ("/water/absorption_per_m", json!([0.3, 0.1, 0.06])),
        ("/lights/0/elevation_deg", json!(60.01)),
        ("/floor/depth_m", json!(2.01)),
        ("/quality/water_cells", json!(129)),
        ("/time_s", json!(0.5)),
    ] {
        assert_ne!(changed(pointer, value), own, "{pointer}");
    }
    for (pointer, value) in [
        ("/objects/0/translation_m", json!([0.3, -0.9, -0.2])),
        ("/objects/0/albedo", json!([0.1, 0.2, 0.3])),
        ("/camera/position_m", json!([0.1, 1.9, 3.1])),
        ("/lights/0/irradiance_w_m2", json!([1, 2, 3])),
        ("/floor/albedo", json!([0.1, 0.2, 0.3])),
    ] {
        assert_eq!(changed(pointer, value), own, "{pointer}");
    }
}

#[test]
fn a_field_beyond_its_budget_is_an_error_with_numbers() {
    let config = RenderConfig {
        field_budget_mib: 8,
        ..RenderConfig::default()
    };
    let mut renderer = harness::new_renderer(&config);
    let too_many = with(moving([0.0, -1.2, 0.0], 0.0), 64, 256);
    let refused = harness::try_render(&mut renderer, &too_many);
    let Err(RenderError::OverBudget {
        what,
        needed_bytes,
        budget_bytes,
    }) = refused
    else {
        panic!("{refused:?}");
    };
    assert!(
        what.contains("CAUSTICA_FIELD_BUDGET_MIB") && what.contains("64 slices of 256"),
        "{what}"
    );
    assert_eq!(budget_bytes, 8 << 20);
    assert_eq!(needed_bytes, 64 * 256 * 256 * 16);
    assert_eq!(renderer.resident_bytes(), 0, "nothing was allocated");
    let fits = with(moving([0.0, -1.2, 0.0], 0.0), 8, 128);
    let frame = harness::render_with(&mut renderer, &fits);
    let memory = &frame.stats.memory;
    assert!(memory.peak_bytes <= memory.planned_peak_bytes, "{memory:?}");
    assert_eq!(memory.fields.bytes, 8 * 128 * 128 * 16);
}

/// The top of a box that moves between slices under flat water has the closed form; the sides have it for their own normals.
#[test]
fn any_receiver_has_the_light_of_its_normal() {
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    for (slices, tilt) in [(2, 0.0_f64), (5, 0.3), (5, -0.2)] {
        let scene = json!({
            "water": { "waves": [] },
            "floor": { "depth_m": 2, "size_m": [6, 6] },
            "lights": [sun(50.0)],
            "objects": [{ "mesh": "box.obj", "translation_m": [0, -0.93, 0], "scale": [2, 0.001, 2],
                          "rotation": [0, 0, (tilt / 2.0).sin(), (tilt / 2.0).cos()] }],
            "camera": { "kind": "orthographic", "position_m": [0, -0.3, 0], "target_m": [0, -1, 0], "up": [0, 0, -1], "height_m": 1 },
            "quality": { "water_cells": 64 },
            "output": { "kind": "view", "width": 24, "height": 24, "layers": ["irradiance"], "format": "exr" }
        });
        let resolved = with(scene, slices, 64);
        let frame = harness::render_with(&mut renderer, &resolved);
        let Light::Sun(sun) = &resolved.scene.lights[0] else {
            panic!("a sun");
        };
        let flat = flat_water_irradiance(&resolved.scene.water, 1.0, sun);
        // The sun stands at −x: its light drifts to +x.
        let sine = 50.0_f64.to_radians().cos() / resolved.scene.water.ior;
        let drift = sine / (1.0 - sine * sine).sqrt();
        // Turned about +z, the upper side leans to −x.
        let share = tilt.cos() + tilt.sin() * drift;
        let due = flat.map(|e| e * share);
        let found = harness::layer(&frame, LayerName::Irradiance);
        let worst = found
            .iter()
            .map(|p| harness::largest_relative(p, &due))
            .fold(0.0, nan_fails);
        println!("{slices} slices, tilt {tilt}: off by {worst:.1e}");
        // The drift is kept in 16 bits.
        assert!(worst <= 5e-4, "{worst:e}");
    }
}
