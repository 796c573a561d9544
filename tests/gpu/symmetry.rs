//! Symmetries: scale of the light, quarter turns, position in the world, order of adding suns.

use serde_json::{Value, json};

use super::harness::{Map, largest_relative, largest_to_mean};

const SIDE: usize = 96;

/// A pool with two waves, a sun, and a square map.
fn pool() -> Value {
    json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 30 },
                { "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 70 }
            ]
        },
        "floor": { "depth_m": 2, "size_m": [6, 6] },
        "lights": [sun(60.0, 35.0, [1.0, 1.0, 1.0])],
        "quality": { "water_cells": 128 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": SIDE, "height": SIDE }
    })
}

fn sun(elevation: f64, azimuth: f64, irradiance: [f64; 3]) -> Value {
    json!({ "kind": "sun", "elevation_deg": elevation, "azimuth_deg": azimuth, "irradiance_w_m2": irradiance })
}

fn with(key: &str, value: Value) -> Value {
    let mut scene = pool();
    scene[key] = value;
    scene
}

#[test]
fn twice_the_sun_is_twice_the_light() {
    let once = Map::of(pool());
    let twice = Map::of(with("lights", json!([sun(60.0, 35.0, [2.0, 2.0, 2.0])])));
    let doubled: Vec<f64> = once.values().iter().map(|v| 2.0 * v).collect();
    let error = largest_relative(twice.values(), &doubled);
    assert!(error <= 1e-6, "{error:e}");
}

#[test]
fn a_coloured_sun_is_a_white_one_per_channel() {
    let white = Map::of(pool());
    let colour = [0.9, 0.25, 1e6];
    let coloured = Map::of(with("lights", json!([sun(60.0, 35.0, colour)])));
    let expected: Vec<f64> = white
        .texels
        .iter()
        .flat_map(|t| [t[0] * colour[0], t[1] * colour[1], t[2] * colour[2]])
        .collect();
    let error = largest_relative(coloured.values(), &expected);
    assert!(error <= 1e-6, "{error:e}");
}

#[test]
fn three_suns_are_the_sum_of_three() {
    let suns = [
        sun(60.0, 35.0, [1.0, 0.5, 0.2]),
        sun(80.0, 200.0, [0.3, 0.5, 0.2]),
        sun(25.0, 110.0, [1.0, 2.0, 3.0]),
    ];
    let together = Map::of(with("lights", json!(suns)));
    let mut sum = vec![0.0; together.values().len()];
    for single in &suns {
        let map = Map::of(with("lights", json!([single])));
        for (s, v) in sum.iter_mut().zip(map.values()) {
            *s += v;
        }
    }
    let error = largest_to_mean(together.values(), &sum);
    assert!(error <= 1e-6, "{error:e}");
    assert_eq!(together.stats.energy.len(), 3);
    // One of them alone, picked from the three.
    let mut picked = with("lights", json!(suns));
    picked["output"]["light"] = json!(2);
    let alone = Map::of(with("lights", json!([suns[2]])));
    assert_eq!(Map::of(picked).texels, alone.texels);
}

#[test]
fn a_quarter_turn_turns_the_map() {
    let straight = Map::of(pool());
    let mut turned = pool();
    for wave in turned["water"]["waves"].as_array_mut().unwrap() {
        wave["direction_deg"] = json!(wave["direction_deg"].as_f64().unwrap() + 90.0);
    }
    turned["lights"] = json!([sun(60.0, 125.0, [1.0, 1.0, 1.0])]);
    let turned = Map::of(turned);
    // (x, z) goes to (−z, x): texel (i, j) of the turned map is texel (j, n − 1 − i) of the straight one.
    let back: Vec<f64> = (0..SIDE * SIDE)
        .flat_map(|at| {
            let (i, j) = (at % SIDE, at / SIDE);
            straight.texels[(SIDE - 1 - i) * SIDE + j]
        })
        .collect();
    let error = largest_to_mean(turned.values(), &back);
    let unturned = largest_to_mean(turned.values(), straight.values());
    println!("quarter turn: {error:.2e} of the mean; {unturned:.2} if the map is not turned");
    assert!(error <= 2e-4, "{error:e}");
    assert!(unturned > 0.5, "{unturned}");
}

#[test]
fn far_from_the_origin_the_map_is_the_same() {
    let here = Map::of(pool());
    // Waves of whole metres in a place of whole metres: the same water.
    let waves = |turns: f64| {
        json!([
            { "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.25, "direction_deg": 0, "phase_deg": 30.0 + 360.0 * turns },
            { "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.8, "direction_deg": 90, "phase_deg": 70 }
        ])
    };
    let mut near = pool();
    near["water"]["waves"] = waves(0.0);
    let near = Map::of(near);
    for (x, y, z) in [(1e5, 0.0, -1e5), (0.0, 3000.0, 0.0), (-1e5, -250.5, 1e5)] {
        let mut far = pool();
        far["water"]["waves"] = waves(0.0);
        far["water"]["level_m"] = json!(y);
        far["floor"]["center_m"] = json!([x, z]);
        far["output"]["min_m"] = json!([x - 1.0, z - 1.0]);
        far["output"]["max_m"] = json!([x + 1.0, z + 1.0]);
        let far = Map::of(far);
        let error = largest_to_mean(far.values(), near.values());
        println!("moved by ({x}, {y}, {z}): {error:.2e}");
        assert!(error <= 1e-4, "({x}, {y}, {z}): {error:e}");
    }
    assert!(largest_to_mean(here.values(), near.values()) > 0.1);
}

#[test]
fn large_times_are_as_accurate_as_small_ones() {
    // After a whole number of periods the water is where it was.
    let mut scene = pool();
    for wave in scene["water"]["waves"].as_array_mut().unwrap() {
        wave["period_s"] = json!(0.5);
    }
    let early = Map::of(scene.clone());
    scene["time_s"] = json!(1e6);
    let late = Map::of(scene.clone());
    let error = largest_to_mean(late.values(), early.values());
    assert!(error <= 1e-4, "{error:e}");
    scene["time_s"] = json!(1e6 + 0.25);
    let between = Map::of(scene);
    assert!(largest_to_mean(between.values(), early.values()) > 0.1);
}

/// Means over blocks of `block` × `block` texels of a square map of `side` texels.
pub(crate) fn pooled(texels: &[[f64; 3]], side: usize, block: usize) -> Vec<[f64; 3]> {
    let count = side / block;
    let mut sums = vec![[0.0; 3]; count * count];
    for (at, texel) in texels.iter().enumerate() {
        let (column, row) = (at % side / block, at / side / block);
        for c in 0..3 {
            sums[row * count + column][c] += texel[c] / (block * block) as f64;
        }
    }
    sums
}
