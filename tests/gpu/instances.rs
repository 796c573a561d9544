//! Many objects: the hierarchy over them changes only the time, map sizes follow the size in the picture, and each object's map
//! has its own scale.

use caustica::accuracy::metrics::relative_l1;
use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::methods;
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::render::{RenderError, Renderer};
use caustica::scene::{LayerName, Light};
use serde_json::{Value, json};

use super::harness::{self, Map};
use super::{instances_scene, scene_files};

fn frame(renderer: &mut Renderer, scene: &Value) -> Frame {
    harness::render_with(renderer, &scene_files::scene(scene.clone()))
}

fn pass_ms(frame: &Frame, name: &str) -> f64 {
    let pass = frame.stats.passes.iter().find(|pass| pass.name == name);
    pass.and_then(|pass| pass.gpu_ms).unwrap_or(f64::NAN)
}

#[test]
fn the_hierarchy_over_instances_changes_no_bit() {
    let [from, to] = instances_scene::WITHOUT_HIERARCHY;
    let plain = methods::embedded().with_replacement("shared/geometry.wgsl", from, to);
    let mut without = Renderer::with_shaders(&RenderConfig::default(), plain.unwrap()).unwrap();
    let mut with = harness::renderer();
    let names = ["hits", "split", "irradiance", "camera_hits"];
    for count in [5, 50, 200] {
        let mut scene = instances_scene::scene(count);
        scene["quality"]["water_cells"] = json!(96);
        scene["output"]["width"] = json!(96);
        scene["output"]["height"] = json!(64);
        let tree = frame(&mut with, &scene);
        let all = frame(&mut without, &scene);
        assert_eq!(tree.layers, all.layers, "{count} instances");
        assert!(
            tree.stats.memory.level_maps.misses <= 5,
            "instances share their meshes' level maps"
        );
        let [tree, all] = [&tree, &all].map(|frame| names.map(|name| pass_ms(frame, name)));
        println!("{count} instances: {names:?} {tree:.1?} ms; without hierarchy {all:.1?} ms");
    }
}

#[test]
fn light_beside_the_objects_tests_no_instances() {
    let [from, to] = [
        "instance_nodes(count), may_meet)",
        "instance_nodes(count), true)",
    ];
    let everywhere = methods::embedded().with_replacement("shared/trace_light.wgsl", from, to);
    let mut everywhere =
        Renderer::with_shaders(&RenderConfig::default(), everywhere.unwrap()).unwrap();
    let mut culled = harness::renderer();
    let mut scene = instances_scene::scene(1);
    scene["quality"]["water_cells"] = json!(512);
    scene["output"] =
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 128, "height": 128 });
    let (a, b) = (frame(&mut culled, &scene), frame(&mut everywhere, &scene));
    assert_eq!(a.layers, b.layers);
    scene["objects"] = json!([]);
    let none = frame(&mut culled, &scene);
    assert_ne!(a.layers, none.layers, "there is a shadow");
    let hits = |frame: &Frame| pass_ms(frame, "hits");
    let least = |a: f64, b: f64| a.min(b);
    let (mut times, empty) = ([hits(&a), hits(&b), hits(&none)], scene.clone());
    let scene = {
        let mut scene = instances_scene::scene(1);
        scene["quality"]["water_cells"] = json!(512);
        scene["output"] = empty["output"].clone();
        scene
    };
    for _ in 0..3 {
        times[0] = least(times[0], hits(&frame(&mut culled, &scene)));
        times[1] = least(times[1], hits(&frame(&mut everywhere, &scene)));
        times[2] = least(times[2], hits(&frame(&mut culled, &empty)));
    }
    println!("hits with one small object: {times:.1?} ms culled, everywhere, without it");
}

#[test]
fn far_objects_get_small_maps_and_the_picture_hardly_changes() {
    let mut scene = instances_scene::scene(60);
    scene["quality"]["level_map_texels"] = json!(256);
    let renderer = &mut harness::renderer();
    let full = frame(renderer, &scene);
    scene["quality"]["level_of_detail"] = json!(2);
    let resolved = scene_files::scene(scene);
    let facts = methods::facts(&resolved).unwrap();
    let mut sizes: Vec<u32> = facts
        .receivers
        .objects
        .iter()
        .map(|o| o.map_texels)
        .collect();
    sizes.sort_unstable();
    let detailed = harness::render_with(renderer, &resolved);
    let [a, b] = [&detailed, &full].map(|frame| harness::layer(frame, LayerName::Irradiance));
    let error = relative_l1(a.as_flattened(), b.as_flattened()).unwrap();
    let [small, large] = [&detailed, &full].map(|frame| frame.stats.memory.peak_bytes);
    // The arena of the level maps is there either way.
    let arena = full.stats.memory.level_maps.budget_bytes;
    println!(
        "maps of {} … {} texels, L1 {error:.2e} apart, {} instead of {} MiB beside the arena",
        sizes[0],
        sizes[sizes.len() - 1],
        (small - arena) >> 20,
        (large - arena) >> 20
    );
    assert!(
        sizes[0] <= 64 && sizes[0] < sizes[sizes.len() - 1],
        "{sizes:?}"
    );
    assert!(error <= 2e-2, "{error}");
    assert!(2 * (small - arena) < large - arena, "{small} {large}");
}

#[test]
fn two_hundred_large_maps_are_refused_with_what_would_help() {
    let mut scene = instances_scene::scene(200);
    scene["quality"]["level_map_texels"] = json!(1024);
    let config = RenderConfig {
        memory_budget_mib: 1 << 20,
        ..RenderConfig::default()
    };
    let mut renderer = harness::new_renderer(&config);
    let limit = renderer.gpu().limits.max_storage_buffer_binding_size;
    let refused = harness::try_render(&mut renderer, &scene_files::scene(scene.clone()));
    let Err(RenderError::OverBudget {
        what, needed_bytes, ..
    }) = refused
    else {
        panic!("{limit} bytes in one binding");
    };
    println!("{what}: {needed_bytes}");
    assert!(what.contains("quality.level_of_detail"), "{what}");
    scene["quality"]["level_of_detail"] = json!(1);
    frame(&mut renderer, &scene);
}

#[test]
fn every_object_has_the_measure_of_its_own_map() {
    // Tops at the same depth under flat water, of different sizes and map sizes, and a dry one between them in the list.
    let scene = json!({
        "floor": { "depth_m": 2, "size_m": [20, 20] },
        "lights": [
            { "kind": "sun", "elevation_deg": 70, "irradiance_w_m2": [1, 1, 1] },
            { "kind": "sun", "elevation_deg": 50, "azimuth_deg": 90, "irradiance_w_m2": [2, 2, 2] }
        ],
        "objects": [
            { "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 1.0 },
            { "mesh": "box.obj", "translation_m": [0, 6, 9], "scale": 0.3 },
            { "mesh": "box.obj", "translation_m": [1.2, -0.75, 0], "scale": 0.5 },
            { "mesh": "box.obj", "translation_m": [-1.2, -0.6, 0], "scale": 0.2 }
        ],
        "camera": { "kind": "orthographic", "position_m": [0, 3, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "height_m": 2 },
        "quality": { "water_cells": 256, "level_map_texels": 256, "level_of_detail": 1, "layers": 2 },
        "output": { "kind": "view", "width": 96, "height": 48, "format": "exr", "layers": ["irradiance", "position"] }
    });
    let resolved = scene_files::scene(scene);
    let facts = methods::facts(&resolved).unwrap();
    let sizes: Vec<u32> = facts
        .receivers
        .objects
        .iter()
        .map(|o| o.map_texels)
        .collect();
    assert_eq!(sizes, [64, 16, 32, 16], "by the size on the picture");
    let expected: f64 = resolved
        .scene
        .lights
        .iter()
        .map(|light| match light {
            Light::Sun(sun) => flat_water_irradiance(&resolved.scene.water, 0.5, sun)[0],
            Light::Point(_) | Light::Sky(_) => 0.0,
        })
        .sum();
    let frame = harness::render(&resolved);
    let seen = harness::layer(&frame, LayerName::Irradiance);
    let places = harness::layer(&frame, LayerName::Position);
    let mut counts = [0; 3];
    for (place, seen) in places.iter().zip(&seen) {
        // Inside each top, a few texels from its edge and out of the others' shadows.
        for (k, (x, half)) in [(0.0, 0.3), (1.2, 0.12), (-1.2, 0.04)]
            .into_iter()
            .enumerate()
        {
            if (place[0] - x).abs() < half && place[2].abs() < half {
                counts[k] += 1;
                assert!((place[1] + 0.5).abs() < 1e-3);
                assert!(
                    (seen[0] / expected - 1.0).abs() <= 5e-3,
                    "object {k}: {seen:?}, {expected}"
                );
            }
        }
    }
    assert!(counts.iter().all(|&c| c > 0), "{counts:?}");
}

#[test]
fn an_irradiance_map_ignores_the_picture() {
    let mut scene = instances_scene::scene(5);
    scene["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
    let plain = Map::of(scene.clone());
    scene["quality"]["level_of_detail"] = json!(0.5);
    let detailed = Map::of(scene);
    assert_eq!(plain.texels, detailed.texels);
    let absent = detailed
        .stats
        .absent
        .iter()
        .find(|pass| pass.name == "level_of_detail");
    assert!(absent.is_some_and(|pass| pass.reason.contains("level_map_texels")));
}
