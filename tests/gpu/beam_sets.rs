//! Beam sets: several of a light share its level maps and add into its maps; each has the water of its own band.

use caustica::facts::SceneFacts;
use caustica::frame::Frame;
use caustica::render::Prepared;
use caustica::scene::LayerName;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::{harness, scene_files};

/// A pool with a box under one sun, in water of this index of refraction.
fn pool(ior: f64, output: Value) -> Prepared {
    let resolved = scene_files::scene(json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20 }],
            "ior": ior, "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 55, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1.2, 0], "scale": 0.5 }],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0] },
        "quality": { "water_cells": 64, "map_texels": 96, "level_map_texels": 64 },
        "output": output
    }));
    Prepared::new(resolved).unwrap()
}

fn outputs() -> [Value; 3] {
    [
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 80, "height": 64 }),
        json!({ "kind": "irradiance_map", "receiver": 0 }),
        json!({ "kind": "view", "width": 64, "height": 48, "layers": ["irradiance"], "format": "exr" }),
    ]
}

fn render(prepared: &Prepared) -> Frame {
    let mut renderer = harness::renderer();
    let frame = renderer.render_prepared(prepared, &CancellationToken::new());
    renderer.gpu().check().unwrap();
    frame.unwrap_or_else(|error| panic!("{error}"))
}

/// The one beam set of the sun becomes two with these shares of its power.
fn split(facts: &mut SceneFacts, shares: [f64; 2]) {
    let sets = &mut facts.lights.beam_sets;
    assert_eq!(sets.len(), 1, "a sun is one beam set");
    sets.push(sets[0].clone());
    for (set, share) in sets.iter_mut().zip(shares) {
        set.power = set.power.map(|power| power * share);
    }
}

/// Halves are exact in floating point, so two halves of a sun give its light to the bit.
#[test]
fn two_halves_of_a_sun_are_the_sun() {
    for output in outputs() {
        let whole = render(&pool(1.333, output.clone()));
        let halves = render(&pool(1.333, output.clone()).with_facts(|f| split(f, [0.5, 0.5])));
        assert_eq!(whole.layers, halves.layers, "{output}");
        let [a, b] = [&whole, &halves].map(|frame| frame.stats.energy.clone());
        assert_eq!(b.len(), 1, "one account for each light");
        assert_eq!(a[0].emitted_w, b[0].emitted_w);
        assert_eq!(a[0].landed_w, b[0].landed_w);
        assert!(b[0].closure <= 1e-5);
        let runs = |frame: &Frame, name: &str| {
            let pass = frame.stats.passes.iter().find(|pass| pass.name == name);
            pass.map_or(0, |pass| pass.runs)
        };
        assert_eq!(runs(&halves, "deposit"), 2);
        // The level map of the box under this sun, whoever built it.
        let maps = &halves.stats.memory.level_maps;
        assert_eq!(maps.hits + maps.misses, 1, "{maps:?}");
    }
}

/// A comparison that passes for everything would pass for wrong shares too.
#[test]
fn wrong_shares_are_seen() {
    let output = outputs()[0].clone();
    let whole = render(&pool(1.333, output.clone()));
    let wrong = render(&pool(1.333, output).with_facts(|f| split(f, [0.5, 0.49])));
    assert_ne!(whole.layers, wrong.layers);
}

/// Red in water of one index and green with blue in water of another: each channel is as in water that has the index for all.
#[test]
fn bands_see_water_of_their_own() {
    for output in outputs() {
        let [red, others] = [1.30, 1.36].map(|ior| pool(ior, output.clone()));
        let [red_frame, others_frame] = [&red, &others].map(render);
        let mut set = others.facts().lights.beam_sets[0].clone();
        let both = red.with_facts(|facts| {
            let sets = &mut facts.lights.beam_sets;
            sets[0].power[1] = 0.0;
            sets[0].power[2] = 0.0;
            set.power[0] = 0.0;
            sets.push(set);
        });
        let both = render(&both);
        let texels = |frame: &Frame| harness::layer(frame, LayerName::Irradiance);
        let (red, others, both) = (texels(&red_frame), texels(&others_frame), texels(&both));
        // The camera's own refraction, and the box's level map, are those of the first index: only light is compared, and on the floor.
        if output["receiver"] == "floor" {
            for ((red, others), both) in red.iter().zip(&others).zip(&both) {
                assert_eq!(*both, [red[0], others[1], others[2]]);
            }
        }
        assert!(
            both.iter().any(|texel| texel.iter().all(|&v| v > 0.0)),
            "{output}"
        );
    }
}
