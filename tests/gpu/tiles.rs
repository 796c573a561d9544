//! A floor of 64 separate quads, lit through its level map, against the same floor as the exact rectangle: same light, no seams.

use caustica::accuracy::metrics;
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::scene::{Light, ResolvedScene};
use serde_json::{Value, json};

use super::harness::Map;
use super::scene_files;

/// Texels along each side of the mesh's map.
const TEXELS: usize = 256;
/// Side of the floor, m.
const SIDE_M: f64 = 2.0;
const DEPTH_M: f64 = 2.0;

/// The floor as tiles; the map is that of the mesh.
fn tiled(waves: Value, elevation: f64, azimuth: f64) -> ResolvedScene {
    scene_files::scene(json!({
        "water": { "waves": waves },
        "lights": [{ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": azimuth, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "floor_tiles.obj", "translation_m": [0, -DEPTH_M, 0], "scale": SIDE_M }],
        "quality": { "water_cells": 512, "level_map_texels": TEXELS, "split_levels": 3 },
        "output": { "kind": "irradiance_map", "receiver": 0 }
    }))
}

/// The same floor as a rectangle.
fn plain(waves: Value, elevation: f64, azimuth: f64) -> ResolvedScene {
    scene_files::scene(json!({
        "water": { "waves": waves },
        "floor": { "depth_m": DEPTH_M, "size_m": [SIDE_M, SIDE_M] },
        "lights": [{ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": azimuth, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": 512 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": TEXELS, "height": TEXELS }
    }))
}

fn waves() -> Value {
    json!([
        { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 23, "period_s": 1 },
        { "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 97, "period_s": 1 }
    ])
}

fn landed(map: &Map) -> f64 {
    map.stats.energy[0].landed_w[0]
}

/// Texels well inside the tiles: their neighbours up to `rim` away are lit too.
fn interior(map: &Map, rim: usize) -> Vec<(usize, usize)> {
    let lit = |x: usize, y: usize| map.texels[y * TEXELS + x][0] > 0.0;
    let mut found = Vec::new();
    for y in rim..TEXELS - rim {
        for x in rim..TEXELS - rim {
            let corners = [
                (x - rim, y),
                (x + rim, y),
                (x, y - rim),
                (x, y + rim),
                (x - rim, y - rim),
                (x + rim, y + rim),
                (x - rim, y + rim),
                (x + rim, y - rim),
            ];
            if lit(x, y) && corners.iter().all(|&(x, y)| lit(x, y)) {
                found.push((x, y));
            }
        }
    }
    found
}

fn assert_even(elevation: f64, azimuth: f64) {
    let resolved = tiled(json!([]), elevation, azimuth);
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    let truth = flat_water_irradiance(&resolved.scene.water, DEPTH_M, sun)[0];
    let map = Map::from(&resolved);
    let inside = interior(&map, 4);
    let (mut worst, mut at, mut off) = (0.0, (0, 0), 0);
    for &(x, y) in &inside {
        let error = (map.texels[y * TEXELS + x][0] / truth - 1.0).abs();
        off += usize::from(error > 1e-3);
        if error > worst {
            (worst, at) = (error, (x, y));
        }
    }
    let flux = landed(&map) / (truth * SIDE_M * SIDE_M) - 1.0;
    println!(
        "{elevation}°, {azimuth}°: {} texels inside, {off} off by more than 10⁻³, worst {worst:.1e} at {at:?}; flux {flux:+.1e}; closure {:.1e}",
        inside.len(),
        map.closure()
    );
    assert!(inside.len() > TEXELS * TEXELS / 3);
    assert!(worst <= 1e-3, "{worst:e} at {at:?}, {off} texels");
    // The silhouette is as fine as the level map: half a texel (4 mm) along 8 m of rim is 8·10⁻³ of 4 m² at worst.
    assert!(flux.abs() <= 4e-3, "{flux:e}");
    assert!(map.closure() <= 1e-5);
}

#[test]
fn flat_water_lights_the_tiles_evenly_from_the_zenith() {
    assert_even(90.0, 0.0);
}

#[test]
fn flat_water_lights_the_tiles_evenly_at_a_slant() {
    for (elevation, azimuth) in [(60.0, 0.0), (60.0, 37.0), (25.0, 200.0)] {
        assert_even(elevation, azimuth);
    }
}

#[test]
fn a_finer_level_map_catches_the_light_at_the_rim() {
    let flux_error = |texels: u32| {
        let mut resolved = tiled(json!([]), 60.0, 0.0);
        resolved.scene.quality.level_map_texels = texels;
        let Light::Sun(sun) = &resolved.scene.lights[0] else {
            panic!("no sun");
        };
        let truth = flat_water_irradiance(&resolved.scene.water, DEPTH_M, sun)[0];
        let map = Map::from(&resolved);
        (landed(&map) / (truth * SIDE_M * SIDE_M) - 1.0).abs()
    };
    let errors = [64, 256, 1024].map(flux_error);
    println!("missing flux with 64, 256, 1024 texels: {errors:.6?}");
    assert!(errors[2] <= 1e-3, "{errors:?}");
    assert!(errors[2] < errors[0], "{errors:?}");
}

#[test]
fn waves_light_the_tiles_as_they_light_the_rectangle() {
    for (elevation, azimuth) in [(90.0, 0.0), (60.0, 150.0)] {
        let tiles = Map::from(&tiled(waves(), elevation, azimuth));
        let floor = Map::from(&plain(waves(), elevation, azimuth));
        let flux = landed(&tiles) / landed(&floor) - 1.0;
        println!("{elevation}°: flux {flux:+.1e}");
        assert!(flux.abs() <= 1e-3, "{flux:e}");

        // The maps lie differently on the floor; how bright how much of it is does not depend on that.
        let percentiles = |map: &Map, inside: bool| {
            let mut values: Vec<f64> = if inside {
                interior(map, 4)
                    .iter()
                    .map(|&(x, y)| map.texels[y * TEXELS + x][0])
                    .collect()
            } else {
                map.texels.iter().map(|t| t[0]).collect()
            };
            values.sort_by(f64::total_cmp);
            [5, 25, 50, 75, 90].map(|p| values[(values.len() - 1) * p / 100])
        };
        let (a, b) = (percentiles(&tiles, true), percentiles(&floor, false));
        println!("{elevation}°: percentiles {a:.4?} and {b:.4?}");
        let error = metrics::relative_l1(&a, &b).unwrap();
        assert!(error <= 0.03, "{a:?} {b:?}");
    }
}

#[test]
fn tile_borders_are_no_darker_than_the_rest() {
    // Straight from above the map's axes run along the tiles'.
    let map = Map::from(&tiled(waves(), 90.0, 0.0));
    let jump = |a: usize, b: usize| (map.texels[a][0] - map.texels[b][0]).abs();
    let inside = interior(&map, 4);
    let mut per_column = vec![(0.0, 0_u32); TEXELS];
    for &(x, y) in &inside {
        let at = y * TEXELS + x;
        per_column[x].0 += jump(at, at - 1);
        per_column[x].1 += 1;
    }
    let means: Vec<f64> = per_column
        .iter()
        .filter(|(_, n)| *n > 100)
        .map(|(sum, n)| sum / f64::from(*n))
        .collect();
    let mut sorted = means.clone();
    sorted.sort_by(f64::total_cmp);
    let (median, largest) = (sorted[sorted.len() / 2], sorted[sorted.len() - 1]);
    println!("jump between columns: median {median:.4}, largest {largest:.4}");
    assert!(
        largest <= 4.0 * median,
        "a seam: {largest} against {median}"
    );
}
