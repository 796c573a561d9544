//! Footprints of every size and shape: huge, tiny, segments and points.

use caustica::reference::closed_form::{SineUnderZenith, flat_water_irradiance};
use caustica::scene::Light;
use serde_json::{Value, json};

use super::harness::{Map, largest_relative};
use super::scene_files;

fn flat(cells: u32, width: u32, height: u32, elevation: f64) -> Value {
    json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": 25, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": cells },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": width, "height": height }
    })
}

/// Largest relative error against the closed form, and the closure.
fn flat_error(scene: Value) -> (f64, f64) {
    let resolved = scene_files::scene(scene);
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    let truth = flat_water_irradiance(&resolved.scene.water, 2.0, sun);
    let map = Map::from(&resolved);
    let expected: Vec<f64> = map.texels.iter().flat_map(|_| truth).collect();
    (largest_relative(map.values(), &expected), map.closure())
}

#[test]
fn few_cells_over_many_texels() {
    for (cells, side) in [(2, 2048), (3, 1000), (8, 2048), (5, 257)] {
        let (error, closure) = flat_error(flat(cells, side, side, 50.0));
        println!("{cells} cells, {side}² texels: {error:.1e}, closure {closure:.1e}");
        assert!(error <= 1e-4, "{cells} cells, {side}² texels: {error:e}");
        assert!(
            closure <= 1e-5,
            "{cells} cells, {side}² texels: {closure:e}"
        );
    }
}

#[test]
fn many_cells_on_few_texels() {
    for (cells, width, height) in [(1024, 4, 4), (1024, 3, 64), (1021, 17, 2), (512, 1, 1)] {
        let (error, closure) = flat_error(flat(cells, width, height, 50.0));
        println!("{cells} cells, {width} × {height} texels: {error:.1e}, closure {closure:.1e}");
        assert!(
            error <= 1e-4,
            "{cells} cells, {width} × {height}: {error:e}"
        );
        assert!(
            closure <= 1e-5,
            "{cells} cells, {width} × {height}: {closure:e}"
        );
    }
}

#[test]
fn long_thin_texels() {
    for (width, height) in [(2048, 2), (2, 2048), (1, 777)] {
        let (error, closure) = flat_error(flat(16, width, height, 35.0));
        println!("{width} × {height} texels: {error:.1e}, closure {closure:.1e}");
        assert!(error <= 1e-4, "{width} × {height}: {error:e}");
        assert!(closure <= 1e-5, "{width} × {height}: {closure:e}");
    }
}

/// One sine under a vertical sun whose crest focuses on the floor: beams there have a length and no width.
fn cylinder(amplitude: f64, cells: u32, width: u32) -> Value {
    json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": amplitude, "wavelength_m": 1.0, "direction_deg": 0, "phase_deg": 90 }
        ] },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": cells },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": width, "height": 8 }
    })
}

fn sine(amplitude_m: f64) -> SineUnderZenith {
    SineUnderZenith {
        amplitude_m,
        wavelength_m: 1.0,
        phase_rad: std::f64::consts::FRAC_PI_2,
        ior: 1.333,
        depth_m: 2.0,
        extinction_per_m: 0.0,
    }
}

/// Amplitude whose thin-lens focus lies at 2 m.
fn focal_amplitude() -> f64 {
    let k = std::f64::consts::TAU;
    1.0 / (2.0 * k * k * (1.0 - 1.0 / 1.333))
}

#[test]
fn a_line_focus_on_the_floor_keeps_its_light() {
    let amplitude = focal_amplitude();
    let closed = sine(amplitude);
    for cells in [64, 256, 512] {
        let width = 64;
        let map = Map::of(cylinder(amplitude, cells, width));
        assert!(map.closure() <= 1e-5, "{:?}", map.stats.energy);
        let truth = closed.texel_means(-1.0, 2.0 / f64::from(width), width as usize);
        let (mut difference, mut total) = (0.0, 0.0);
        for (at, texel) in map.texels.iter().enumerate() {
            let truth = truth[at % width as usize];
            difference += (texel[0] - truth).abs();
            total += truth;
        }
        println!("{cells} cells: relative L1 {:.2e}", difference / total);
        let bound = match cells {
            64 => 0.03,
            256 => 3e-3,
            _ => 1e-3,
        };
        assert!(
            difference / total <= bound,
            "{cells}: {}",
            difference / total
        );
        // Along the line nothing changes.
        let rows: Vec<&[[f64; 3]]> = map.texels.chunks_exact(width as usize).collect();
        for row in &rows[1..] {
            for (a, b) in row.iter().zip(rows[0]) {
                assert!((a[0] - b[0]).abs() <= 2e-3 * map.mean(0), "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn footprints_of_no_area_keep_their_light() {
    // Index 4 and a crossed pair: beams around the crests end in points.
    let k = std::f64::consts::TAU;
    let amplitude = 1.0 / (2.0 * k * k * (1.0 - 1.0 / 4.0));
    for (cells, side) in [(64, 1024), (1024, 16), (512, 2048)] {
        let map = Map::of(json!({
            "water": { "ior": 4, "waves": [
                { "kind": "sine", "amplitude_m": amplitude, "wavelength_m": 1.0, "direction_deg": 0, "phase_deg": 90 },
                { "kind": "sine", "amplitude_m": amplitude, "wavelength_m": 1.0, "direction_deg": 90, "phase_deg": 90 }
            ] },
            "floor": { "depth_m": 2, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": cells },
            "output": { "kind": "irradiance_map", "receiver": "floor",
                        "min_m": [-1, -1], "max_m": [1, 1], "width": side, "height": side }
        }));
        println!(
            "{cells} cells, {side}² texels: closure {:.1e}",
            map.closure()
        );
        assert!(map.closure() <= 1e-5, "{:?}", map.stats.energy);
        let landed = map.stats.energy[0].landed_w[0];
        assert!((map.mean(0) * 4.0 / landed - 1.0).abs() <= 1e-5);
    }
}

#[test]
fn a_floor_at_the_surface_is_lit_like_the_water() {
    // Depth 0: every beam ends where it begins.
    let mut scene = flat(64, 32, 32, 50.0);
    scene["floor"]["depth_m"] = json!(0);
    let resolved = scene_files::scene(scene);
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("no sun");
    };
    let truth = flat_water_irradiance(&resolved.scene.water, 0.0, sun);
    let map = Map::from(&resolved);
    let expected: Vec<f64> = map.texels.iter().flat_map(|_| truth).collect();
    let error = largest_relative(map.values(), &expected);
    assert!(error <= 1e-4, "{error:e}");
}

#[test]
fn thin_footprints_lose_nothing() {
    // Crests across the texels that focus a little before or behind the floor: footprints far longer than wide, but not so thin
    // that they count as segments. Of few cells over many texels each is shared out over lanes.
    let focus = 1.0 / (2.0 * std::f64::consts::TAU.powi(2) * (1.0 - 1.0 / 1.333));
    for (cells, side) in [(8, 512), (5, 1024)] {
        for strength in [0.5, 0.9, 0.97, 1.003, 1.02, 1.1, 3.0, 20.0] {
            let mut scene = cylinder(strength * focus, cells, side);
            scene["water"]["waves"][0]["direction_deg"] = json!(33);
            scene["output"]["height"] = json!(side);
            let map = Map::from(&scene_files::scene(scene));
            let closure = map.closure();
            println!(
                "{cells} cells, {side}² texels, {strength} of the focus: closure {closure:.1e}"
            );
            // Of quotients that a GPU may have 2.5 ulp off, each texel's share is more so: 2.9e-6 on an H200.
            let most = if map.stats.adapter.software {
                1e-6
            } else {
                5e-6
            };
            assert!(
                closure <= most,
                "{cells} cells, {side}², {strength}: {closure:e}"
            );
            let landed = map.stats.energy[0].landed_w[0];
            assert!((map.mean(0) * 4.0 / landed - 1.0).abs() <= 1e-5);
        }
    }
}
