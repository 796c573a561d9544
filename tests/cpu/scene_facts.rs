//! What a scene's facts warn of before anything is rendered.

use caustica::scene::facts::SceneFacts;
use serde_json::json;

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
