//! Energy accounts: every scene's account closes, and its terms equal those of the maps, the closed form and the reference.

use caustica::physics::fresnel::fresnel_transmittance;
use caustica::reference::{self, ReferenceSettings};
use caustica::scene::{Output, ResolvedScene};
use serde_json::json;

use super::harness::{self, Map};
use super::scene_files;

/// Share of the emitted flux that may be in no term: rounding of fixed-point sums.
const CLOSURE: f64 = 1e-5;

fn map_area_m2(resolved: &ResolvedScene) -> f64 {
    let Output::IrradianceMap(map) = &resolved.scene.output else {
        panic!("no map");
    };
    let floor = resolved.scene.floor.as_ref().unwrap();
    let size = |axis: usize| match (map.min_m, map.max_m) {
        (Some(min), Some(max)) => max[axis] - min[axis],
        _ => floor.size_m[axis],
    };
    size(0) * size(1)
}

#[test]
fn every_scene_closes() {
    for name in scene_files::names() {
        let frame = harness::render(&scene_files::load(&name, &[]));
        // Only where there is no water no light is followed.
        assert_eq!(frame.stats.energy.is_empty(), name == "dry", "{name}");
        for account in &frame.stats.energy {
            println!(
                "{name}: light {} closes to {:.1e}",
                account.light, account.closure
            );
            assert!(account.closure <= CLOSURE, "{name}: {account:?}");
            for term in [
                account.landed_w,
                account.absorbed_w,
                account.scattered_w,
                account.reflected_w,
                account.left_region_w,
                account.missed_w,
            ] {
                assert!(term.iter().all(|w| *w >= 0.0), "{name}: {account:?}");
            }
        }
    }
}

#[test]
fn the_landed_flux_is_that_on_the_map() {
    for name in ["flat", "sine_pool"] {
        let resolved = scene_files::load(name, &[]);
        let map = Map::from(&resolved);
        for c in 0..3 {
            let on_map = map.mean(c) * map_area_m2(&resolved);
            let landed: f64 = map.stats.energy.iter().map(|a| a.landed_w[c]).sum();
            let error = (on_map / landed - 1.0).abs();
            assert!(error <= 1e-5, "{name}, channel {c}: {on_map} and {landed}");
        }
    }
}

#[test]
fn flat_water_splits_its_light_as_fresnel_and_beer_say() {
    let resolved = scene_files::scene(json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.0], "scattering_per_m": [0.05, 0.0, 0.1] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": 40, "azimuth_deg": 70, "irradiance_w_m2": [1000, 500, 250] }],
        "quality": { "water_cells": 64 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 64 }
    }));
    let map = Map::from(&resolved);
    let account = &map.stats.energy[0];
    let cos_i = 40_f64.to_radians().sin();
    let transmittance = fresnel_transmittance(cos_i, 1.333);
    let sin_t = (1.0 - cos_i * cos_i).sqrt() / 1.333;
    let path_m = 2.0 / (1.0 - sin_t * sin_t).sqrt();
    let (a, b) = ([0.35, 0.07, 0.0], [0.05, 0.0, 0.1]);
    for c in 0..3 {
        let emitted = account.emitted_w[c];
        let under = emitted * transmittance;
        let lost = under * (1.0 - (-(a[c] + b[c]) * path_m).exp());
        let expected = [
            (account.reflected_w[c], emitted - under),
            (account.absorbed_w[c], lost * a[c] / (a[c] + b[c])),
            (account.scattered_w[c], lost * b[c] / (a[c] + b[c])),
            (account.landed_w[c] + account.left_region_w[c], under - lost),
            (account.missed_w[c], 0.0),
        ];
        for (found, expected) in expected {
            let error = (found - expected).abs() / emitted;
            assert!(
                error <= 2e-6,
                "channel {c}: {found} W, {expected} W expected"
            );
        }
        let window_m2 = emitted / ([1000.0, 500.0, 250.0][c] * cos_i);
        let landed = under - lost - account.left_region_w[c];
        let per_m2 = landed / 4.0;
        assert!((per_m2 / map.mean(c) - 1.0).abs() <= 1e-5);
        // The window is the map moved along the light, and a margin of 10⁻⁵ of it.
        assert!((4.0..4.001).contains(&window_m2), "{window_m2} m²");
    }
}

#[test]
fn waves_split_their_light_as_the_reference_says() {
    let small = [("/output/width", "32"), ("/output/height", "32")];
    let mut resolved = scene_files::load("sine_pool", &small);
    resolved.scene.water.absorption_per_m = [0.3, 0.06, 0.02];
    let map = Map::from(&resolved);
    let settings = ReferenceSettings {
        target_error: None,
        max_rays: 1 << 24,
        ..ReferenceSettings::default()
    };
    let truth = reference::irradiance_map(&resolved, &settings, &|_| {}).unwrap();
    let account = &map.stats.energy[0];
    for c in 0..3 {
        // The windows differ by their margins; what lands on the map does not.
        let landed = (account.landed_w[c] / truth.landed_w[0][c] - 1.0).abs();
        assert!(landed <= 5e-4, "landed, channel {c}: {landed:e}");
        let share = |part: f64, whole: f64| part / whole;
        for (ours, theirs) in [
            (account.reflected_w[c], truth.energy.reflected_w[c]),
            (account.absorbed_w[c], truth.energy.absorbed_w[c]),
        ] {
            let ours = share(ours, account.emitted_w[c]);
            let theirs = share(theirs, truth.energy.emitted_w[c]);
            println!("channel {c}: {ours:.5} and {theirs:.5}");
            assert!((ours - theirs).abs() <= 2e-3, "{ours} and {theirs}");
        }
    }
}

#[test]
fn a_steep_sea_under_a_low_sun_closes() {
    let map = Map::of(json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.2, "wavelength_m": 1.0, "direction_deg": 10 },
                { "kind": "sine", "amplitude_m": 0.1, "wavelength_m": 0.4, "direction_deg": 95 }
            ],
            "absorption_per_m": [0.3, 0.06, 0.02]
        },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 4, "azimuth_deg": 20, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": 128 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 128, "height": 128 }
    }));
    println!("steep sea: {:.1e}", map.closure());
    assert!(map.closure() <= CLOSURE, "{:?}", map.stats.energy);
    assert!(map.mean(2) > 0.0);
}

#[test]
fn cells_too_coarse_for_the_waves_are_warned_of_with_the_flux_through_them() {
    // The lamp's window is small, so that its cells are fine enough; the sun's are not.
    let scene = json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.5 }] },
        "floor": { "depth_m": 1, "size_m": [8, 8] },
        "lights": [
            { "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 2, 3] },
            { "kind": "point", "position_m": [0, -0.5, 0], "intensity_w_sr": [1, 1, 1] }
        ],
        "quality": { "water_cells": 32 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 64, "height": 64 }
    });
    let map = Map::of(scene);
    let mut warnings = map.stats.warnings.iter();
    let found = warnings.find(|w| w.code == "waves_undersampled").unwrap();
    assert_eq!(found.flux_w, Some(map.stats.energy[0].emitted_w));
    assert!(map.stats.energy[0].emitted_w[0] > 0.0);
}
