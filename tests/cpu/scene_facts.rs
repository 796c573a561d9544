//! What a scene's facts warn of before anything is rendered.

use caustica::scene::facts::SceneFacts;
use serde_json::{Value, json};

use super::scene_files;

fn warnings(cells: u32) -> Vec<(String, Option<String>)> {
    let resolved = scene_files::scene(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.8 }] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
        "quality": { "water_cells": cells },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 64, "height": 64 }
    }));
    let facts = SceneFacts::of(&resolved).unwrap();
    facts
        .warnings
        .into_iter()
        .map(|warning| (warning.code, warning.pointer))
        .collect()
}

#[test]
fn cells_too_coarse_for_the_waves_are_warned_of() {
    let coarse = (
        "waves_undersampled".to_owned(),
        Some("/quality/water_cells".to_owned()),
    );
    assert_eq!(warnings(32), [coarse]);
    assert_eq!(warnings(256), []);
}

#[test]
fn the_light_done_coarsely_has_coarser_maps_that_divide_the_fine_ones() {
    let coarse = |cells: u32, output: Value| {
        let resolved = scene_files::scene(json!({
            "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.8 }] },
            "floor": { "depth_m": 2, "size_m": [8, 8] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "camera": { "position_m": [0, 2, 2], "target_m": [0, -1.5, 0] },
            "quality": { "water_cells": cells, "map_texels": 255 },
            "output": output
        }));
        let fine = SceneFacts::of(&resolved).unwrap();
        let coarse = fine.coarse();
        let sides = |facts: &SceneFacts| facts.floor_map.map(|map| [map.width, map.height]);
        let cells = coarse.quality.water_cells;
        (cells, sides(&coarse).unwrap(), sides(&fine).unwrap())
    };
    let of_map = |cells: u32, [width, height]: [u32; 2]| {
        let output = json!({ "kind": "irradiance_map", "receiver": "floor", "width": width, "height": height });
        let (cells, low, _) = coarse(cells, output);
        (cells, low)
    };
    // A quarter as long as that has a texel for each cell, else half.
    assert_eq!(of_map(64, [256, 256]), (25, [64, 64]));
    assert_eq!(of_map(65, [256, 256]), (26, [128, 128]));
    assert_eq!(of_map(64, [256, 252]), (25, [128, 126]));
    assert_eq!(of_map(16, [2048, 1024]), (6, [512, 256]));
    // What does not divide stays.
    assert_eq!(of_map(64, [255, 258]), (25, [255, 129]));
    // A camera looks between the texels.
    let view = json!({ "kind": "view", "width": 64, "height": 36 });
    let (cells, low, fine) = coarse(16, view);
    assert_eq!((cells, low), (6, fine.map(|texels| texels.div_ceil(2))));
    assert_eq!(fine[0], 255);
}
