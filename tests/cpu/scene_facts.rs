//! Facts of a scene, and the warnings they give before anything is rendered.

use caustica::facts::SceneFacts;
use caustica::facts::source::Source;
use caustica::physics::refraction::refract_direction;
use caustica::waves::normal;
use glam::DVec3;
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
    let facts = caustica::methods::facts_with_warnings(&resolved).unwrap();
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
        let fine = caustica::methods::facts(&resolved).unwrap();
        let coarse = fine.coarse();
        let sides =
            |facts: &SceneFacts| facts.receivers.floor_map.map(|map| [map.width, map.height]);
        let cells = coarse.quality.water_cells;
        (cells, sides(&coarse).unwrap(), sides(&fine).unwrap())
    };
    let of_map = |cells: u32, [width, height]: [u32; 2]| {
        let output = json!({ "kind": "irradiance_map", "receiver": "floor", "width": width, "height": height });
        let (cells, low, _) = coarse(cells, output);
        (cells, low)
    };
    // A quarter as long as that has a texel for each cell, else half.
    assert_eq!(of_map(64, [256, 256]), (24, [64, 64]));
    assert_eq!(of_map(65, [256, 256]), (24, [128, 128]));
    assert_eq!(of_map(64, [256, 252]), (24, [128, 126]));
    assert_eq!(of_map(16, [2048, 1024]), (6, [512, 256]));
    // What does not divide stays.
    assert_eq!(of_map(64, [255, 258]), (24, [255, 129]));
    // Whole workgroups, where a third of the cells remain.
    let cells = |cells: u32| of_map(cells, [256, 256]).0;
    assert_eq!([256, 512, 1000, 1024].map(cells), [96, 200, 400, 408]);
    assert_eq!([24, 25, 48, 49].map(cells), [8, 10, 16, 19]);
    assert_eq!([2, 3, 5].map(cells), [1, 1, 2]);
    // A camera looks between the texels.
    let view = json!({ "kind": "view", "width": 64, "height": 36 });
    let (cells, low, fine) = coarse(16, view);
    assert_eq!((cells, low), (6, fine.map(|texels| texels.div_ceil(2))));
    assert_eq!(fine[0], 255);
}

/// Whether any of many rays through a wave's first metre comes out of the water again, by small steps.
fn comes_out(facts: &SceneFacts) -> bool {
    let Source::Sun { to_light } = facts.lights.beam_sets[0].source else {
        panic!("no sun");
    };
    (0..40 * 40).any(|at| {
        let (x_m, z_m) = (f64::from(at % 40) / 40.0, f64::from(at / 40) / 40.0);
        let water = facts.water.surface.at(x_m, z_m);
        let up = normal(water);
        if up.dot(to_light) <= 0.0 {
            return false;
        }
        let way = refract_direction(-to_light, up, facts.water.ior).unwrap();
        (1..4000)
            .map(|k| DVec3::new(x_m, water.height_m, z_m) + way * (0.002 * f64::from(k)))
            .take_while(|p| p.y > -facts.water.surface.max_height_m())
            .any(|p| facts.water.surface.at(p.x, p.z).height_m < p.y)
    })
}

#[test]
fn waves_that_let_light_leave_again_are_recognised() {
    let (mut seen, mut spared) = (0, 0);
    for slope in [0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 6.0] {
        for elevation_deg in [90.0, 60.0, 30.0, 10.0] {
            for directions_deg in [vec![0.0], vec![20.0, 100.0]] {
                let share = slope / directions_deg.len() as f64;
                let waves: Vec<Value> = directions_deg
                    .iter()
                    .map(|direction| json!({ "kind": "sine", "amplitude_m": share / std::f64::consts::TAU, "wavelength_m": 1, "direction_deg": direction }))
                    .collect();
                let resolved = scene_files::scene(json!({
                    "water": { "waves": waves },
                    "floor": { "depth_m": 50, "size_m": [400, 400] },
                    "lights": [{ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 33, "irradiance_w_m2": [1, 1, 1] }],
                    "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 16, "height": 16 }
                }));
                let facts = caustica::methods::facts(&resolved).unwrap();
                let (comes_out, known) = (comes_out(&facts), facts.unfollowed_paths().leaves_again);
                assert!(known || !comes_out, "{slope}, {elevation_deg}°");
                seen += u32::from(comes_out);
                spared += u32::from(!known);
            }
        }
    }
    println!("light comes out in {seen} of 64 scenes, {spared} are spared the count");
    assert!(seen >= 10 && spared >= 10, "{seen}, {spared}");
}
