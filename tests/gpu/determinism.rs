//! The same request gives the same bytes, whatever the caches hold.

use std::collections::BTreeMap;

use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::image::{Metadata, encode};
use caustica::render::Renderer;
use caustica::scene::{Encoding, ImageFormat, LayerName, ResolvedScene};
use serde_json::json;

use super::harness::{new_renderer, render_with, renderer};
use super::scene_files;

fn teapot() -> ResolvedScene {
    scene_files::load(
        "teapot_pool",
        &[
            ("/output/width", "320"),
            ("/output/height", "180"),
            ("/output/layers", "radiance,depth,irradiance"),
            ("/output/format", "exr"),
        ],
    )
}

/// Every bit of a frame and of its files.
fn bits(frame: &Frame, resolved: &ResolvedScene) -> (BTreeMap<LayerName, Vec<u32>>, Vec<Vec<u8>>) {
    let layers = frame
        .layers
        .iter()
        .map(|(name, layer)| (*name, layer.data.iter().map(|v| v.to_bits()).collect()))
        .collect();
    let files = [ImageFormat::Png, ImageFormat::Exr]
        .map(|format| {
            let encoding = Encoding {
                format,
                ..resolved.scene.output.encoding()
            };
            // Times are no part of the picture.
            let mut stats = frame.stats.clone();
            stats.time_ms = caustica::stats::TimeStats::default();
            let file = encode(frame, &encoding, &Metadata::of(&stats)).unwrap();
            file.bytes
        })
        .to_vec();
    (layers, files)
}

fn has_pass(frame: &Frame, name: &str) -> bool {
    frame.stats.passes.iter().any(|pass| pass.name == name)
}

fn frame_bits(renderer: &mut Renderer) -> (Frame, impl PartialEq + use<>) {
    let resolved = teapot();
    let frame = render_with(renderer, &resolved);
    let bits = bits(&frame, &resolved);
    (frame, bits)
}

#[test]
fn the_same_request_gives_the_same_bytes() {
    let mut shared = renderer();
    for mesh in &teapot().meshes {
        shared.forget_mesh(&mesh.id);
    }
    let (first, first_bits) = frame_bits(&mut shared);
    assert!(has_pass(&first, "level_map") && has_pass(&first, "level_map_pyramid"));
    let cache = &first.stats.memory.level_maps;
    assert_eq!((cache.hits, cache.misses), (0, 1));

    let (second, second_bits) = frame_bits(&mut shared);
    assert!(!has_pass(&second, "level_map") && !has_pass(&second, "level_map_pyramid"));
    let cache = &second.stats.memory.level_maps;
    assert_eq!((cache.hits, cache.misses), (1, 0));
    assert!(
        first_bits == second_bits,
        "a cached level map changes the picture"
    );
    drop(shared);

    let mut fresh = new_renderer(&RenderConfig::default());
    let (_, fresh_bits) = frame_bits(&mut fresh);
    assert!(
        first_bits == fresh_bits,
        "another renderer draws another picture"
    );
}

#[test]
fn a_rebuilt_level_map_gives_the_same_bytes() {
    // 4 MiB hold one map of 512 texels a side and not two.
    let mut small = new_renderer(&RenderConfig {
        level_map_budget_mib: 4,
        ..RenderConfig::default()
    });
    let (_, first_bits) = frame_bits(&mut small);
    let knot = scene_files::scene(json!({
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 58, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "torus_knot.obj", "translation_m": [0, -1, 0], "scale": 0.3 }],
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] },
        "quality": { "level_map_texels": 512, "water_cells": 32, "map_texels": 64 },
        "output": { "kind": "view", "width": 32, "height": 32 }
    }));
    let other = render_with(&mut small, &knot);
    assert_eq!(other.stats.memory.level_maps.evictions, 1);
    let (rebuilt, rebuilt_bits) = frame_bits(&mut small);
    let cache = &rebuilt.stats.memory.level_maps;
    assert_eq!((cache.hits, cache.misses, cache.evictions), (0, 1, 1));
    assert!(has_pass(&rebuilt, "level_map"));
    assert!(first_bits == rebuilt_bits);
}

#[test]
fn another_moment_gives_other_bytes() {
    let resolved = scene_files::load("sine_pool", &[("/quality/water_cells", "64")]);
    let later = scene_files::load(
        "sine_pool",
        &[("/quality/water_cells", "64"), ("/time_s", "0.01")],
    );
    let mut shared = renderer();
    let now = render_with(&mut shared, &resolved);
    let then = render_with(&mut shared, &later);
    assert!(now.layers[&LayerName::Irradiance] != then.layers[&LayerName::Irradiance]);
}

#[test]
fn bind_groups_are_reused_frame_after_frame() {
    let at = |moment_s: f64, red_w_m2: f64| {
        scene_files::scene(json!({
            "time_s": moment_s,
            "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.8 }] },
            "floor": { "depth_m": 2, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [red_w_m2, 2, 1] }],
            "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.5 }],
            "camera": { "position_m": [0, 2, 2], "target_m": [0, -1.5, 0] },
            "quality": { "water_cells": 64, "map_texels": 128, "level_map_texels": 64, "estimate_error": true },
            "output": { "kind": "view", "width": 64, "height": 36, "format": "exr", "layers": ["radiance", "depth"] }
        }))
    };
    let scenes = [at(0.0, 3.0), at(0.7, 3.0), at(0.7, 5.0), at(0.0, 3.0)];
    let mut one = new_renderer(&RenderConfig::default());
    let mut made = Vec::new();
    for scene in &scenes {
        let frame = render_with(&mut one, scene);
        let alone = render_with(&mut new_renderer(&RenderConfig::default()), scene);
        assert!(bits(&frame, scene).0 == bits(&alone, scene).0);
        assert_eq!(frame.stats.energy, alone.stats.energy);
        assert_eq!(frame.stats.accuracy, alone.stats.accuracy);
        made.push(one.bind_groups_made());
    }
    // Another moment and another sun are other constants, in the same buffers.
    assert!(made[0] > 10, "{made:?}");
    assert_eq!(made[1..], [made[0]; 3]);
    // Scenes in turn keep theirs, sizes of their own and all.
    let mut other = scenes[0].clone();
    other.scene.quality.water_cells = 48;
    render_with(&mut one, &other);
    let made = one.bind_groups_made();
    for scene in [&scenes[0], &other, &scenes[1], &other] {
        render_with(&mut one, scene);
    }
    assert_eq!(one.bind_groups_made(), made);
}
