//! Level maps between frames: built once, reused, evicted, built ahead, and freed with their mesh or device. The bytes of a frame
//! never depend on this.

use std::sync::Arc;
use std::time::Duration;

use caustica::cache::{WarmSun, WarmUp};
use caustica::config::RenderConfig;
use caustica::frame::Frame;
use caustica::mesh::Mesh;
use caustica::methods;
use caustica::render::{RenderError, Renderer};
use caustica::scene::ResolvedScene;
use caustica::stats::CacheStats;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::harness::{new_renderer, render_with, renderer, try_render};
use super::scene_files;

/// Bytes of a level map: (front, back) at every level of the pyramid, and a normal per texel.
fn map_bytes(texels: u64) -> u64 {
    let levels = (0..=texels.ilog2()).map(|level| (texels >> level) * (texels >> level));
    4 * (texels * texels + 2 * levels.sum::<u64>())
}

/// A pyramid of its own height on a base of 1 m × 1 m.
fn pyramid(height_m: f64) -> Arc<Mesh> {
    let obj = format!(
        "v -0.5 0 -0.5\nv 0.5 0 -0.5\nv 0.5 0 0.5\nv -0.5 0 0.5\nv 0.1 {height_m} 0.05\n\
         f 1 2 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n"
    );
    scene_files::mesh_of(obj.as_bytes())
}

/// A small view of a pool with waves and these objects, under a sun 60 degrees high.
fn pool(objects: Value, texels: u32) -> Value {
    json!({
        "water": { "waves": [
            { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9, "direction_deg": 20 },
            { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.5, "direction_deg": 100 }
        ] },
        "floor": { "depth_m": 2, "size_m": [5, 5] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": objects,
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 32, "map_texels": 64, "level_map_texels": texels, "split_levels": 1 },
        "output": { "kind": "view", "width": 48, "height": 27, "format": "exr", "layers": ["radiance", "irradiance"] }
    })
}

/// The pool with one object.
fn with_one(mesh: &Arc<Mesh>, texels: u32) -> ResolvedScene {
    let object = json!([{ "mesh": mesh.id, "translation_m": [0, -1.5, 0] }]);
    scene_files::with_meshes(pool(object, texels), std::slice::from_ref(mesh))
}

/// The pool with one object, and a field of the scene replaced or added.
fn changed(mesh: &Arc<Mesh>, texels: u32, pointer: &str, value: Value) -> ResolvedScene {
    let object = json!([{ "mesh": mesh.id, "translation_m": [0, -1.5, 0] }]);
    let mut scene = pool(object, texels);
    let (parent, field) = pointer.rsplit_once('/').unwrap();
    scene.pointer_mut(parent).unwrap()[field] = value;
    scene_files::with_meshes(scene, std::slice::from_ref(mesh))
}

/// The pool's sun.
const SUN: WarmSun = WarmSun {
    elevation_deg: 60.0,
    azimuth_deg: 30.0,
};

fn warm_up(suns: &[WarmSun], texels: u32) -> WarmUp {
    WarmUp {
        suns: suns.to_vec(),
        texels,
        layers: 1,
        ior: 1.333,
    }
}

/// Every bit of a frame's layers.
fn bits(frame: &Frame) -> Vec<u32> {
    let values = frame.layers.values().flat_map(|layer| &layer.data);
    values.map(|value| value.to_bits()).collect()
}

fn cache_of(frame: &Frame) -> &CacheStats {
    &frame.stats.memory.level_maps
}

/// Hits, misses and evictions of a frame.
fn counts(frame: &Frame) -> (u64, u64, u64) {
    let cache = cache_of(frame);
    (cache.hits, cache.misses, cache.evictions)
}

/// Passes of a frame that build level maps, with how often they ran.
fn building(frame: &Frame) -> Vec<u32> {
    let passes = frame.stats.passes.iter();
    passes
        .filter(|pass| pass.name.starts_with("level_map"))
        .map(|pass| pass.runs)
        .collect()
}

/// A renderer with a level-map budget of this number of MiB.
fn renderer_of_mib(level_map_budget_mib: u64) -> Renderer {
    new_renderer(&RenderConfig {
        level_map_budget_mib,
        ..RenderConfig::default()
    })
}

#[test]
fn after_a_warm_up_the_first_frame_finds_its_map() {
    let mut shared = renderer();
    let mesh = pyramid(0.71);
    let scene = with_one(&mesh, 64);
    let none = CancellationToken::new();
    let warmed = shared.warm(&mesh, &warm_up(&[SUN], 64), &none).unwrap();
    assert_eq!(warmed.len(), 1);
    let map = &warmed[0];
    assert_eq!((map.elevation_deg, map.azimuth_deg), (60.0, 30.0));
    assert_eq!((map.texels, map.layers), (64, 1));
    assert_eq!((map.bytes, map.cached), (map_bytes(64), false));

    let plan = shared.plan(&scene, &none).unwrap();
    let absent: Vec<&str> = plan.absent.iter().map(|p| p.name.as_str()).collect();
    for pass in ["level_map", "level_map_pyramid"] {
        assert!(plan.passes.iter().all(|p| p.name != pass), "{pass} is in");
        assert!(absent.contains(&pass), "{pass} is not among {absent:?}");
    }
    let first = render_with(&mut shared, &scene);
    assert_eq!(counts(&first), (1, 0, 0));
    assert_eq!(building(&first), Vec::<u32>::new());

    // It is the map that the frame would have built.
    shared.forget_mesh(&mesh.id);
    let built = render_with(&mut shared, &scene);
    assert_eq!((counts(&built), building(&built)), ((0, 1, 0), vec![1, 1]));
    assert!(bits(&first) == bits(&built), "a warm map is another map");

    let again = shared.warm(&mesh, &warm_up(&[SUN], 64), &none).unwrap();
    assert!(again[0].cached);
}

#[test]
fn a_warm_map_serves_all_scenes_with_the_same_key_and_no_other() {
    let mut shared = renderer();
    let mesh = pyramid(0.72);
    let none = CancellationToken::new();
    shared.warm(&mesh, &warm_up(&[SUN], 64), &none).unwrap();
    let quarter_turn = [0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()];
    let cases = [
        (
            "elsewhere",
            "/objects/0/translation_m",
            json!([0.3, -1.7, -0.4]),
            true,
        ),
        ("smaller", "/objects/0/scale", json!(0.37), true),
        ("another moment", "/time_s", json!(12.5), true),
        ("deeper water", "/floor/depth_m", json!(3), true),
        ("stretched", "/objects/0/scale", json!([1, 0.5, 1]), false),
        ("turned", "/objects/0/rotation", json!(quarter_turn), false),
        ("a higher sun", "/lights/0/elevation_deg", json!(61), false),
        (
            "a sun from the side",
            "/lights/0/azimuth_deg",
            json!(31),
            false,
        ),
        ("other water", "/water/ior", json!(1.34), false),
        ("finer", "/quality/level_map_texels", json!(128), false),
        ("deeper", "/quality/layers", json!(2), false),
    ];
    for (name, pointer, value, hits) in cases {
        let frame = render_with(&mut shared, &changed(&mesh, 64, pointer, value));
        let expected = if hits { (1, 0, 0) } else { (0, 1, 0) };
        assert_eq!(counts(&frame), expected, "{name}");
    }
    shared.forget_mesh(&mesh.id);
    let deep = WarmUp {
        layers: 2,
        ..warm_up(&[SUN], 64)
    };
    let warmed = shared.warm(&mesh, &deep, &none).unwrap();
    assert_eq!((warmed[0].layers, warmed[0].cached), (2, false));
    let two_layers = changed(&mesh, 64, "/quality/layers", json!(2));
    assert_eq!(counts(&render_with(&mut shared, &two_layers)), (1, 0, 0));
    shared.forget_mesh(&mesh.id);
}

#[test]
fn several_suns_are_warmed_at_once() {
    let mut shared = renderer();
    let mesh = pyramid(0.73);
    let none = CancellationToken::new();
    let other = WarmSun {
        elevation_deg: 25.0,
        azimuth_deg: -100.0,
    };
    // The same sun twice is one map.
    let suns = [other, SUN, other];
    let before = shared.level_map_cache();
    let warmed = shared.warm(&mesh, &warm_up(&suns, 64), &none).unwrap();
    let told: Vec<(f64, bool)> = warmed.iter().map(|m| (m.elevation_deg, m.cached)).collect();
    assert_eq!(told, [(25.0, false), (60.0, false), (25.0, false)]);
    let after = shared.level_map_cache();
    assert_eq!(
        (after.hits - before.hits, after.misses - before.misses),
        (0, 2)
    );
    let suns = json!([
        { "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [1, 1, 1] },
        { "kind": "sun", "elevation_deg": 25, "azimuth_deg": -100, "irradiance_w_m2": [1, 1, 1] }
    ]);
    let frame = render_with(&mut shared, &changed(&mesh, 64, "/lights", suns));
    assert_eq!(counts(&frame), (2, 0, 0));
    shared.forget_mesh(&mesh.id);
}

#[test]
fn five_meshes_alternate_in_a_budget_for_two() {
    let budget = 2 << 20;
    assert!(2 * map_bytes(256) <= budget && budget < 3 * map_bytes(256));
    let mut small = renderer_of_mib(2);
    let meshes: Vec<Arc<Mesh>> = (0..5).map(|i| pyramid(0.4 + 0.2 * f64::from(i))).collect();
    let mut pictures: Vec<Vec<u32>> = Vec::new();
    let mut evictions = 0;
    for round in 0..3 {
        for (index, mesh) in meshes.iter().enumerate() {
            let frame = render_with(&mut small, &with_one(mesh, 256));
            let cache = cache_of(&frame);
            assert_eq!((cache.hits, cache.misses), (0, 1), "round {round}, {index}");
            assert_eq!(cache.budget_bytes, budget);
            assert_eq!(cache.bytes, cache.entries * map_bytes(256));
            assert!(cache.bytes <= budget);
            assert!(small.level_map_cache().bytes <= budget);
            evictions += cache.evictions;
            match pictures.get(index) {
                None => pictures.push(bits(&frame)),
                Some(first) => assert!(*first == bits(&frame), "round {round}, mesh {index}"),
            }
        }
    }
    // All of the fifteen except the last two have been evicted.
    assert_eq!(evictions, 13);
    let total = small.level_map_cache();
    assert_eq!((total.hits, total.misses, total.evictions), (0, 15, 13));
    assert_eq!((total.entries, total.bytes), (2, 2 * map_bytes(256)));
    // Five meshes, five pictures: the comparison above could have failed.
    assert!((1..5).all(|i| pictures[i] != pictures[0]));
    // The two that were used last are there.
    for index in [3, 4] {
        let frame = render_with(&mut small, &with_one(&meshes[index], 256));
        assert_eq!(counts(&frame), (1, 0, 0));
        assert!(pictures[index] == bits(&frame));
    }
}

/// Checks that an error names the setting and both figures.
fn assert_over_budget(error: &RenderError, needed: u64, budget: u64) {
    let RenderError::OverBudget {
        what,
        needed_bytes,
        budget_bytes,
    } = error
    else {
        panic!("{error}");
    };
    assert!(what.contains("CAUSTICA_LEVEL_MAP_BUDGET_MIB"), "{what}");
    assert_eq!((*needed_bytes, *budget_bytes), (needed, budget));
    let text = error.to_string();
    assert!(text.contains(&needed.to_string()) && text.contains(&budget.to_string()));
}

#[test]
fn a_map_that_does_not_fit_is_refused_before_anything_is_allocated() {
    let mut small = renderer_of_mib(1);
    let mesh = pyramid(0.8);
    let allocated = |renderer: &Renderer| {
        let report = renderer.gpu().device.generate_allocator_report();
        report.map(|report| report.total_allocated_bytes)
    };
    let before = allocated(&small);
    for _ in 0..2 {
        let error = try_render(&mut small, &with_one(&mesh, 512)).unwrap_err();
        assert_over_budget(&error, map_bytes(512), 1 << 20);
        let warm = small.warm(&mesh, &warm_up(&[SUN], 512), &CancellationToken::new());
        assert_over_budget(&warm.unwrap_err(), map_bytes(512), 1 << 20);
    }
    assert_eq!(small.resident_bytes(), 0);
    assert_eq!(allocated(&small), before);
    let cache = small.level_map_cache();
    assert_eq!((cache.hits, cache.misses, cache.entries), (0, 0, 0));

    // Scenes without meshes, and with smaller maps, are none the worse.
    let empty = scene_files::scene(pool(json!([]), 512));
    let frame = render_with(&mut small, &empty);
    assert!(frame.layers.values().all(|layer| !layer.data.is_empty()));
    let one = render_with(&mut small, &with_one(&mesh, 256));
    assert_eq!(counts(&one), (0, 1, 0));
    // Two of those at once are too much again, and harm neither.
    let turned = json!([
        { "mesh": mesh.id, "translation_m": [0, -1.5, 0] },
        { "mesh": mesh.id, "translation_m": [1, -1.5, 0], "rotation": [0, 1, 0, 0] }
    ]);
    let two = scene_files::with_meshes(pool(turned, 256), std::slice::from_ref(&mesh));
    let error = try_render(&mut small, &two).unwrap_err();
    assert_over_budget(&error, 2 * map_bytes(256), 1 << 20);
    let again = render_with(&mut small, &with_one(&mesh, 256));
    assert_eq!(counts(&again), (1, 0, 0));
    assert!(bits(&again) == bits(&one));
}

#[test]
fn sixty_frames_build_a_map_once() {
    let mut shared = renderer();
    let mesh = pyramid(0.91);
    let mut sums = (0, 0, 0);
    let mut pictures: Vec<Vec<u32>> = Vec::new();
    for frame in 0..60 {
        let time_s = f64::from(frame) / 30.0;
        let rendered = render_with(&mut shared, &changed(&mesh, 64, "/time_s", json!(time_s)));
        let (hits, misses, evictions) = counts(&rendered);
        sums = (sums.0 + hits, sums.1 + misses, sums.2 + evictions);
        pictures.push(bits(&rendered));
    }
    assert_eq!(sums, (59, 1, 0));
    assert!(
        pictures.windows(2).all(|pair| pair[0] != pair[1]),
        "the waves stand still"
    );
    shared.forget_mesh(&mesh.id);
}

#[test]
fn instances_with_the_same_rotation_share_a_map() {
    let mut shared = renderer();
    let mesh = pyramid(0.92);
    let turn = [0.0, 0.6, 0.0, 0.8];
    let object = |index: i32, rotation: [f64; 4]| {
        json!({
            "mesh": mesh.id, "rotation": rotation, "scale": 0.2 + 0.05 * f64::from(index),
            "translation_m": [0.6 * f64::from(index) - 1.2, -1.0 - 0.1 * f64::from(index), 0.3 * f64::from(index)]
        })
    };
    let mut objects: Vec<Value> = (0..5).map(|index| object(index, turn)).collect();
    let scene = |objects: &[Value]| {
        scene_files::with_meshes(pool(json!(objects), 64), std::slice::from_ref(&mesh))
    };
    let five = render_with(&mut shared, &scene(&objects));
    assert_eq!((counts(&five), building(&five)), ((0, 1, 0), vec![1, 1]));
    // A turned one has its own.
    objects.push(object(5, [0.0, 0.0, 0.6, 0.8]));
    let six = render_with(&mut shared, &scene(&objects));
    assert_eq!((counts(&six), building(&six)), ((1, 1, 0), vec![1, 1]));
    shared.forget_mesh(&mesh.id);
}

#[test]
fn maps_in_the_way_are_moved_and_reported() {
    // A small map, then a large one behind it: two large ones fit the budget, but not around the first where it lies.
    let budget = 8 << 20;
    assert!(2 * map_bytes(512) <= budget && budget < 2 * map_bytes(512) + map_bytes(256));
    let mut small = renderer_of_mib(8);
    let (a, b) = (pyramid(0.5), pyramid(0.6));
    render_with(&mut small, &with_one(&a, 256));
    let alone = render_with(&mut small, &with_one(&a, 512));
    assert_eq!(counts(&alone), (0, 1, 0));
    let both = pool(
        json!([
            { "mesh": a.id, "translation_m": [-0.7, -1.5, 0] },
            { "mesh": b.id, "translation_m": [0.7, -1.5, 0] }
        ]),
        512,
    );
    let both = scene_files::with_meshes(both, &[Arc::clone(&a), Arc::clone(&b)]);
    let moved = render_with(&mut small, &both);
    // The one that was there is built again: no hit, and the passes ran for both.
    assert_eq!((counts(&moved), building(&moved)), ((0, 2, 2), vec![2, 2]));
    let warm = render_with(&mut small, &both);
    assert_eq!(counts(&warm), (2, 0, 0));
    assert!(bits(&moved) == bits(&warm));
    // As a renderer draws it that never had to move anything.
    let mut large = renderer_of_mib(64);
    assert!(bits(&render_with(&mut large, &both)) == bits(&warm));
    let again = render_with(&mut small, &with_one(&a, 512));
    assert_eq!(counts(&again), (1, 0, 0));
    assert!(bits(&again) == bits(&alone));
}

#[test]
fn a_frame_that_is_cancelled_leaves_whole_maps_or_none() {
    let mut own = renderer_of_mib(16);
    let mesh = pyramid(0.55);
    let suns: Vec<Value> = (0..4)
        .map(|i| json!({ "kind": "sun", "elevation_deg": 40 + 10 * i, "irradiance_w_m2": [1, 1, 1] }))
        .collect();
    let scene = changed(&mesh, 256, "/lights", json!(suns));
    let wanted: Vec<WarmSun> = (0..4)
        .map(|i| WarmSun {
            elevation_deg: f64::from(40 + 10 * i),
            azimuth_deg: 0.0,
        })
        .collect();
    let truth = bits(&render_with(&mut own, &scene));
    own.forget_mesh(&mesh.id);

    // Before anything has begun.
    let cancelled = CancellationToken::new();
    cancelled.cancel();
    let error = own.render(&scene, &cancelled).unwrap_err();
    assert_eq!(error, RenderError::Cancelled);
    let error = own.warm(&mesh, &warm_up(&wanted, 256), &cancelled);
    assert_eq!(error.unwrap_err(), RenderError::Cancelled);
    assert_eq!(own.level_map_cache().entries, 0);

    // At any time: what is said to be there is whole, and what is not is built.
    let (mut broken_off, mut kept) = (0, 0);
    for step in 0..24_u64 {
        let token = CancellationToken::new();
        let canceller = token.clone();
        let alarm = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(4 * step));
            canceller.cancel();
        });
        let before = own.level_map_cache();
        let ended = if step % 2 == 0 {
            own.render(&scene, &token).map(|_| ())
        } else {
            let warmed = own.warm(&mesh, &warm_up(&wanted, 256), &token);
            warmed.map(|maps| assert_eq!(maps.len(), 4))
        };
        alarm.join().unwrap();
        let after = own.level_map_cache();
        assert_eq!(after.entries, after.misses - before.misses, "step {step}");
        assert_eq!(after.bytes, after.entries * map_bytes(256));
        match ended {
            Ok(()) => assert_eq!(after.entries, 4),
            Err(RenderError::Cancelled) => {
                broken_off += 1;
                kept += after.entries;
            }
            Err(error) => panic!("{error}"),
        }
        let whole = render_with(&mut own, &scene);
        assert_eq!(counts(&whole), (after.entries, 4 - after.entries, 0));
        assert!(bits(&whole) == truth, "step {step}");
        own.forget_mesh(&mesh.id);
    }
    println!("{broken_off} of 24 were broken off, with {kept} maps whole");
}

#[test]
fn a_frame_that_fails_leaves_no_map_behind() {
    // The level map is built, and then a pass behind it cannot be.
    let broken = methods::embedded()
        .with_replacement("stages/irradiance.wgsl", "fn ", "fn fn ")
        .unwrap();
    let mut own = Renderer::with_shaders(&RenderConfig::default(), broken).unwrap();
    let mesh = pyramid(0.65);
    for _ in 0..2 {
        let error = try_render(&mut own, &with_one(&mesh, 64)).unwrap_err();
        assert!(matches!(error, RenderError::Gpu(_)), "{error}");
        let cache = own.level_map_cache();
        assert_eq!((cache.entries, cache.bytes, cache.hits), (0, 0, 0));
    }
    // A warm-up needs no such pass, and a frame that fails after it takes its map along: the device may be what is broken.
    let none = CancellationToken::new();
    let warmed = own.warm(&mesh, &warm_up(&[SUN], 64), &none).unwrap();
    assert!(!warmed[0].cached);
    assert_eq!(own.level_map_cache().entries, 1);
    try_render(&mut own, &with_one(&mesh, 64)).unwrap_err();
    assert_eq!(own.level_map_cache().entries, 0);
    assert!(!own.warm(&mesh, &warm_up(&[SUN], 64), &none).unwrap()[0].cached);
}
