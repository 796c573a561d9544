//! Flat water against its closed form, E cos θ_i T(θ_i) e^(−c d), at every texel.

use caustica::config::RenderConfig;
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::scene::{LayerName, Light, ResolvedScene};
use serde_json::json;

use super::harness::{self, Map, largest_relative};
use super::scene_files;

/// Relative error allowed per texel: rounding of f32 in the corners of beams.
const TOLERANCE: f64 = 1e-4;

/// What every texel must hold.
fn truth(resolved: &ResolvedScene) -> [f64; 3] {
    let scene = &resolved.scene;
    let depth_m = scene.floor.as_ref().unwrap().depth_m;
    let mut sum = [0.0; 3];
    for light in &scene.lights {
        if let Light::Sun(sun) = light {
            for (s, e) in sum
                .iter_mut()
                .zip(flat_water_irradiance(&scene.water, depth_m, sun))
            {
                *s += e;
            }
        }
    }
    sum
}

fn assert_flat(resolved: &ResolvedScene, context: &str) {
    let map = Map::from(resolved);
    let truth = truth(resolved);
    let expected: Vec<f64> = map.texels.iter().flat_map(|_| truth).collect();
    let error = largest_relative(map.values(), &expected);
    println!(
        "{context}: largest relative error {error:.2e}, closure {:.1e}",
        map.closure()
    );
    assert!(error <= TOLERANCE, "{context}: {error:e}");
    assert!(
        map.closure() <= 1e-5,
        "{context}: closure {:e}",
        map.closure()
    );
}

#[test]
fn every_elevation_azimuth_and_water_gives_the_closed_form() {
    let elevations = [90.0, 75.0, 60.0, 45.0, 30.0, 15.0, 5.0, 2.0];
    let azimuths = [0.0, 37.0, 180.0, 261.0];
    for (i, elevation) in elevations.into_iter().enumerate() {
        for (j, azimuth) in azimuths.into_iter().enumerate() {
            // Clear and coloured water alternate, so that every elevation has both.
            let absorption = if (i + j) % 2 == 0 {
                [0.0; 3]
            } else {
                [0.35, 0.07, 0.03]
            };
            let resolved = scene_files::scene(json!({
                "water": { "absorption_per_m": absorption },
                "floor": { "depth_m": 2, "size_m": [8, 8] },
                "lights": [{ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": azimuth,
                             "irradiance_w_m2": [1000, 800, 600] }],
                "quality": { "water_cells": 64 },
                "output": { "kind": "irradiance_map", "receiver": "floor",
                            "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 48 }
            }));
            assert_flat(
                &resolved,
                &format!("{elevation}°, {azimuth}°, a = {absorption:?}"),
            );
        }
    }
}

#[test]
fn the_scene_in_the_folder_is_flat() {
    assert_flat(&scene_files::load("flat", &[]), "flat.json");
}

#[test]
fn every_index_of_refraction_and_depth_gives_the_closed_form() {
    for (ior, depth) in [(1.0, 1.0), (1.0001, 0.01), (1.5, 20.0), (4.0, 300.0)] {
        let resolved = scene_files::scene(json!({
            "water": { "ior": ior, "absorption_per_m": [0.002, 0.001, 0.001], "scattering_per_m": [0.001, 0, 0.001] },
            "floor": { "depth_m": depth, "size_m": [8, 8] },
            "lights": [{ "kind": "sun", "elevation_deg": 40, "azimuth_deg": 200, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": 32 },
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 32, "height": 32 }
        }));
        assert_flat(&resolved, &format!("ior {ior}, {depth} m"));
    }
}

#[test]
fn a_view_shows_the_same_irradiance() {
    let resolved = scene_files::scene(json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
        "floor": { "depth_m": 2, "size_m": [30, 30] },
        "lights": [{ "kind": "sun", "elevation_deg": 55, "irradiance_w_m2": [1000, 1000, 1000] }],
        "camera": { "position_m": [0, 3, 0.1], "target_m": [0, -1, 0], "vertical_fov_deg": 40 },
        "quality": { "water_cells": 64, "map_texels": 64 },
        "output": { "kind": "view", "width": 48, "height": 32, "layers": ["irradiance"], "format": "exr" }
    }));
    let frame = harness::render(&resolved);
    let seen = harness::layer(&frame, LayerName::Irradiance);
    let expected: Vec<f64> = seen.iter().flat_map(|_| truth(&resolved)).collect();
    let error = largest_relative(seen.as_flattened(), &expected);
    assert!(error <= TOLERANCE, "{error:e}");
}

#[test]
fn a_sun_that_does_not_shine_leaves_the_floor_dark() {
    for elevation in [0.0, -5.0] {
        let map = Map::of(json!({
            "floor": { "depth_m": 2, "size_m": [8, 8] },
            "lights": [{ "kind": "sun", "elevation_deg": elevation, "irradiance_w_m2": [1, 1, 1] }],
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 16, "height": 16 }
        }));
        assert!(map.values().iter().all(|&e| e == 0.0));
        assert!(map.stats.energy.is_empty());
    }
}

#[test]
fn the_finest_water_is_as_even_as_any() {
    // Its vertices are more workgroups than fit one row of a dispatch.
    let resolved = scene_files::scene(json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 37, "irradiance_w_m2": [1000, 800, 600] }],
        "quality": { "water_cells": 2048 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 48 }
    }));
    assert_flat(&resolved, "2048 cells");
}

#[test]
fn a_grid_of_512_cells_runs_in_one_dispatch_and_a_larger_one_in_pieces() {
    let mut renderer = harness::new_renderer(&RenderConfig::default());
    for (cells, in_pieces) in [(512, false), (1024, true)] {
        let resolved = scene_files::scene(json!({
            "floor": { "depth_m": 2, "size_m": [8, 8] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": cells, "estimate_error": true },
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 64, "height": 64 }
        }));
        let (before, _) = renderer.pieces();
        harness::render_with(&mut renderer, &resolved);
        assert_eq!(renderer.pieces().0 > before, in_pieces, "{cells} cells");
    }
}
