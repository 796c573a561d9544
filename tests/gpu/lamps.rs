//! Point lights above and under water: closed forms, the reference, sums of lights, and extreme positions.

use caustica::accuracy::metrics::relative_l1;
use caustica::reference::closed_form::LampOverFlatWater;
use caustica::reference::{self, ReferenceSettings};
use caustica::scene::LayerName;
use serde_json::{Value, json};

use super::harness::{self, Map, largest_relative, largest_to_mean};
use super::scene_files;

/// Share of the emitted flux that may be in no term.
const CLOSURE: f64 = 1e-5;

/// A lamp over a pool of 2 m; the map is 2 m × 2 m.
fn pool(lights: Value, water: Value, cells: u32, side: usize) -> Value {
    json!({
        "water": water,
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": lights,
        "quality": { "water_cells": cells, "split_levels": 3 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": side, "height": side }
    })
}

fn lamp(position_m: [f64; 3]) -> Value {
    json!({ "kind": "point", "position_m": position_m, "intensity_w_sr": [1, 1, 1] })
}

fn waves() -> Value {
    json!({
        "waves": [
            { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20 },
            { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.6, "direction_deg": 100, "phase_deg": 60 }
        ],
        "absorption_per_m": [0.3, 0.06, 0.02]
    })
}

/// Mean over each texel of the closed form, from 4 × 4 points.
fn closed_form_map(lamp: &LampOverFlatWater, foot: [f64; 2], side: usize) -> Vec<f64> {
    let place =
        |k: usize, sub: usize| 2.0 * (k as f64 + (sub as f64 + 0.5) / 4.0) / side as f64 - 1.0;
    let mean = |texel: usize| -> f64 {
        let points = (0..16).map(|p| {
            let x = place(texel % side, p % 4) - foot[0];
            let z = place(texel / side, p / 4) - foot[1];
            lamp.irradiance_at(x.hypot(z))
        });
        points.sum::<f64>() / 16.0
    };
    (0..side * side).map(mean).collect()
}

/// Relative L1 error and that of the worst texel against the closed form.
fn against_closed_form(
    position_m: [f64; 3],
    ior: f64,
    absorption: f64,
    cells: u32,
) -> (f64, f64, f64) {
    let side = 64;
    let water = json!({ "ior": ior, "absorption_per_m": [absorption, absorption, absorption] });
    let map = Map::of(pool(json!([lamp(position_m)]), water, cells, side));
    let expected = closed_form_map(
        &LampOverFlatWater {
            height_m: position_m[1],
            depth_m: 2.0,
            ior,
            extinction_per_m: absorption,
        },
        [position_m[0], position_m[2]],
        side,
    );
    let found: Vec<f64> = map.texels.iter().map(|t| t[0]).collect();
    let l1 = relative_l1(&found, &expected).unwrap();
    let worst = largest_relative(&found, &expected);
    println!(
        "{position_m:?}, n = {ior}, {cells} cells: L1 {l1:.2e}, worst texel {worst:.2e}, closure {:.1e}",
        map.closure()
    );
    assert!(
        map.closure() <= CLOSURE,
        "{position_m:?}: {:e}",
        map.closure()
    );
    (l1, worst, largest_to_mean(&found, &expected))
}

#[test]
fn flat_water_gives_the_closed_form() {
    for (y, ior, absorption) in [
        (0.3, 1.333, 0.1),
        (1.0, 1.333, 0.0),
        (1.0, 1.0, 0.0),
        (4.0, 1.5, 0.2),
        (100.0, 1.333, 0.0),
    ] {
        for (x, z) in [(0.0, 0.0), (0.2, -0.1), (1.7, 0.4)] {
            let (l1, worst, _) = against_closed_form([x, y, z], ior, absorption, 256);
            assert!(l1 <= 3e-4, "{y} m: {l1:e}");
            assert!(worst <= 2e-3, "{y} m: {worst:e}");
        }
    }
}

/// Halved cells, a quarter of the error: also close to the water, where rays spread most.
#[test]
fn a_lamp_close_to_the_water_converges() {
    let errors =
        [64, 128, 256, 512].map(|cells| against_closed_form([0.1, 0.05, 0.0], 1.333, 0.0, cells).0);
    assert!(errors[3] <= 1e-3, "{errors:?}");
    assert!(
        errors[1] <= 0.4 * errors[0] && errors[2] <= 0.4 * errors[1],
        "{errors:?}"
    );
}

#[test]
fn a_lamp_under_water_gives_the_closed_form() {
    for position in [
        [0.0, -1.0, 0.0],
        [0.3, -0.2, -0.5],
        [1.6, -1.5, 0.2],
        [0.0, 0.0, 0.0],
        [0.4, -1.7, 0.4],
    ] {
        // Far aside of a light near the floor texels are too dim to be compared with themselves.
        let (l1, _, to_mean) = against_closed_form(position, 1.333, 0.2, 512);
        assert!(l1 <= 1e-3, "{position:?}: {l1:e}");
        assert!(to_mean <= 3e-2, "{position:?}: {to_mean:e} of the mean");
    }
}

fn assert_like_reference(scene: Value, tolerance: f64, context: &str) {
    let resolved = scene_files::scene(scene);
    let map = Map::from(&resolved);
    let settings = ReferenceSettings {
        target_error: Some(2e-3),
        max_rays: 40_000_000,
        ..ReferenceSettings::default()
    };
    let truth = reference::irradiance_map(&resolved, &settings, &|_| {}).unwrap();
    let error = relative_l1(map.values(), truth.irradiance.as_flattened()).unwrap();
    println!(
        "{context}: L1 {error:.2e}, reference {:.1e}, closure {:.1e}",
        truth.relative_error,
        map.closure()
    );
    assert!(error <= tolerance, "{context}: {error:e}");
    assert!(map.closure() <= CLOSURE, "{context}");
    for c in 0..3 {
        let landed: f64 = map.stats.energy.iter().map(|a| a.landed_w[c]).sum();
        assert!(landed > 0.0);
    }
}

#[test]
fn waves_and_a_shadow_are_those_of_the_reference() {
    for (position, name) in [
        ([0.3, 1.0, -0.2], "above"),
        ([0.5, -0.4, 0.3], "under water"),
    ] {
        let open = pool(json!([lamp(position)]), waves(), 256, 64);
        assert_like_reference(open.clone(), 6e-3, &format!("{name}, open"));
        let mut shaded = open;
        shaded["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4,
                                     "rotation": [0, 0.2588, 0, 0.9659] }]);
        assert_like_reference(shaded, 1e-2, &format!("{name}, with a box"));
    }
}

fn many_lights() -> Value {
    json!([
        { "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [3, 2, 1] },
        { "kind": "sun", "elevation_deg": 25, "azimuth_deg": 200, "irradiance_w_m2": [1, 2, 3] },
        { "kind": "sun", "elevation_deg": -5, "azimuth_deg": 0, "irradiance_w_m2": [9, 9, 9] },
        { "kind": "sun", "elevation_deg": 88, "azimuth_deg": 120, "irradiance_w_m2": [2, 2, 2] },
        { "kind": "point", "position_m": [0.3, 0.8, -0.2], "intensity_w_sr": [4, 5, 6] },
        { "kind": "point", "position_m": [-0.6, -0.3, 0.4], "intensity_w_sr": [3, 1, 2] }
    ])
}

#[test]
fn the_map_of_all_lights_is_the_sum_of_the_maps_of_each() {
    let scene = || {
        let mut scene = pool(many_lights(), waves(), 128, 64);
        scene["objects"] =
            json!([{ "mesh": "box.obj", "translation_m": [0.1, -1, 0], "scale": 0.4 }]);
        scene
    };
    let all = Map::of(scene());
    assert_eq!(
        all.stats.energy.len(),
        5,
        "a sun under the horizon gives nothing"
    );
    let mut sum = vec![0.0; all.values().len()];
    for light in 0..6 {
        let mut single = scene();
        single["output"]["light"] = json!(light);
        for (sum, value) in sum.iter_mut().zip(Map::of(single).values()) {
            *sum += value;
        }
    }
    let error = largest_to_mean(&sum, all.values());
    println!("sum of single maps: {error:.1e} of the mean");
    assert!(error <= 1e-6, "{error:e}");
    assert!(all.closure() <= CLOSURE, "{:?}", all.stats.energy);
}

#[test]
fn dozens_of_lights_shine_together() {
    let lights: Vec<Value> = (0..64)
        .map(|i| {
            let at = |k: i32| 0.3 * f64::from(k) - 1.0;
            lamp([at(i % 8), if i % 3 == 0 { -0.5 } else { 0.7 }, at(i / 8)])
        })
        .collect();
    let map = Map::of(pool(json!(lights), json!({}), 32, 32));
    assert_eq!(map.stats.energy.len(), 64);
    assert!(map.closure() <= CLOSURE, "{:e}", map.closure());
    assert!(map.values().iter().all(|e| *e > 0.0));
}

#[test]
fn twice_the_intensity_is_twice_the_light_to_the_bit() {
    for y in [0.7, -0.7] {
        let scene = |intensity: f64| {
            let light = json!({ "kind": "point", "position_m": [0.1, y, 0.2], "intensity_w_sr": [intensity, intensity, intensity] });
            pool(json!([light]), waves(), 64, 32)
        };
        let (one, two) = (Map::of(scene(1.5)), Map::of(scene(3.0)));
        assert!(
            one.values()
                .iter()
                .zip(two.values())
                .all(|(a, b)| 2.0 * a == *b)
        );
        assert!(one.mean(0) > 0.0);
    }
}

#[test]
fn a_lamp_far_away_is_a_sun() {
    let (elevation, azimuth) = (60.0_f64.to_radians(), 25.0_f64.to_radians());
    let distance = 2e4;
    let position = [
        distance * elevation.cos() * azimuth.cos(),
        distance * elevation.sin(),
        distance * elevation.cos() * azimuth.sin(),
    ];
    let intensity = distance * distance;
    let far = json!([{ "kind": "point", "position_m": position, "intensity_w_sr": [intensity, intensity, intensity] }]);
    let sun = json!([{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 25, "irradiance_w_m2": [1, 1, 1] }]);
    let water = json!({ "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.3, "direction_deg": 20 }] });
    let far = Map::of(pool(far, water.clone(), 256, 64));
    let sun = Map::of(pool(sun, water, 256, 64));
    let error = relative_l1(far.values(), sun.values()).unwrap();
    println!("20 km away: {error:.2e}");
    assert!(error <= 2e-3, "{error:e}");
    assert!(far.closure() <= CLOSURE);
}

/// Where a light can hardly stand: in, on and just over the water, over and on a grid vertex, on the floor, inside an object.
#[test]
fn every_place_is_finite_and_closes() {
    let places = [
        [0.0, 1e-3, 0.0],
        [0.013, 1e-3, -0.2],
        [0.0, 1e-6, 0.0],
        [0.0, 1e-9, 0.0],
        [0.0, 0.0, 0.0],
        [0.2, -1e-6, 0.1],
        [0.0, -1e-3, 0.0],
        [0.0, 0.02, 0.0],
        [0.0, -1.999, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, -0.8, 0.0],
        [1e6, 1e-3, 0.0],
        [0.0, 1e6, 0.0],
        [0.0, -2.0, 0.0],
        [0.0, -5.0, 0.0],
    ];
    for with_box in [false, true] {
        for water in [json!({}), waves()] {
            for place in places {
                let mut scene = pool(json!([lamp(place)]), water.clone(), 64, 32);
                if with_box {
                    scene["objects"] =
                        json!([{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }]);
                }
                let map = Map::of(scene);
                let codes: Vec<&str> = map.stats.warnings.iter().map(|w| w.code.as_str()).collect();
                println!(
                    "{place:?}, box {with_box}: mean {:.3e}, {codes:?}",
                    map.mean(2)
                );
                assert!(map.values().iter().all(|e| e.is_finite() && *e >= 0.0));
                // A light on the floor or under it is not followed, and said to be there.
                if place[1] <= -2.0 {
                    assert!(map.stats.energy.is_empty() && map.mean(2) == 0.0);
                    assert!(codes.contains(&"light_under_floor"), "{codes:?}");
                    continue;
                }
                assert!(
                    map.closure() <= CLOSURE,
                    "{place:?}: {:?}",
                    map.stats.energy
                );
            }
        }
    }
}

/// What falls on the water of a lamp 1 mm above it is nearly half of all directions, and all of it is accounted for.
#[test]
fn a_lamp_on_the_water_gives_half_its_light_to_it() {
    let mut scene = pool(json!([lamp([0.0, 1e-3, 0.0])]), json!({}), 64, 32);
    scene["output"]["min_m"] = json!([-4, -4]);
    scene["output"]["max_m"] = json!([4, 4]);
    scene["quality"]["water_cells"] = json!(1024);
    let map = Map::of(scene);
    // Far cells are a million times smaller to the light than near ones, and none is lost.
    println!("on the water: closure {:.1e}", map.closure());
    assert!(map.closure() <= CLOSURE, "{:?}", map.stats.energy);
    let emitted = map.stats.energy[0].emitted_w[0];
    assert!(emitted <= std::f64::consts::TAU, "{emitted}");
    assert!(emitted > 0.9 * std::f64::consts::TAU, "{emitted}");
}

/// A mesh above a light under water is lit from below: all directions are followed then, and they are 4π together.
#[test]
fn a_light_under_an_object_shines_up_at_it() {
    let mut scene = pool(json!([lamp([0.1, -1.5, 0.0])]), json!({}), 128, 32);
    scene["objects"] = json!([{ "mesh": "box.obj", "translation_m": [0, -0.7, 0], "scale": 0.4 }]);
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
    scene["quality"]["level_map_texels"] = json!(64);
    let map = Map::of(scene);
    let account = &map.stats.energy[0];
    println!("{account:?}");
    assert!((account.emitted_w[0] / (2.0 * std::f64::consts::TAU) - 1.0).abs() <= 1e-5);
    assert!(map.closure() <= CLOSURE);
    // The lower face, 0.6 m above the light, sees it through the clear water: I/h² under the middle.
    let brightest = map.values().iter().copied().fold(0.0, f64::max);
    assert!((brightest * 0.36 - 1.0).abs() <= 0.05, "{brightest}");
}

#[test]
fn dry_surfaces_are_lit_by_lamps_in_the_air_with_shadows() {
    let view = |lamp_x: f64, objects: Value| {
        let resolved = scene_files::scene(json!({
            "lights": [{ "kind": "point", "position_m": [lamp_x, 3, 0], "intensity_w_sr": [8, 4, 2] }],
            "objects": objects,
            "camera": { "kind": "orthographic", "position_m": [0, 10, 0], "target_m": [0, 0, 0],
                        "up": [0, 0, -1], "height_m": 0.5 },
            "output": { "kind": "view", "width": 9, "height": 9, "layers": ["irradiance"], "format": "exr" }
        }));
        harness::layer(&harness::render(&resolved), LayerName::Irradiance)
    };
    // The top of a box of 1 m, 2 m under the light: I cos³/h² there.
    let table = json!({ "mesh": "box.obj", "translation_m": [0, 0.5, 0] });
    let seen = view(0.0, json!([table]));
    for (at, e) in seen.iter().enumerate() {
        let place = |k: usize| (k as f64 - 4.0) * 0.5 / 9.0;
        let aside = place(at % 9).hypot(place(at / 9));
        let expected = 2.0 / f64::hypot(2.0, aside).powi(3);
        for c in 0..3 {
            let error = (e[c] / ([8.0, 4.0, 2.0][c] * expected) - 1.0).abs();
            assert!(error <= 2e-3, "{at}: {e:?}");
        }
    }
    // A small box half way down from a light aside shades the middle, and not the corners: its shadow is a square of 0.4 m, as seen from its
    // upper side. One above the light shades nothing. Neither is in the picture.
    let lid =
        |x: f64, y: f64| json!({ "mesh": "box.obj", "translation_m": [x, y, 0], "scale": 0.2 });
    let seen = view(1.0, json!([table]));
    let shaded = view(1.0, json!([table, lid(0.5, 2.0)]));
    let open = view(1.0, json!([table, lid(0.9, 3.5)]));
    let middle = 4 * 9 + 4;
    assert!(seen[middle][0] > 0.5, "{:?}", seen[middle]);
    assert_eq!(shaded[middle], [0.0; 3]);
    for corner in [0, 8, 72, 80] {
        assert_eq!(shaded[corner], seen[corner], "corner {corner}");
    }
    assert_eq!(open, seen);
}
