//! Memory kept on the GPU between frames: never above the budget, and freed buffers are released when idle.

use std::sync::Arc;

use caustica::config::RenderConfig;
use caustica::mesh::Mesh;
use caustica::render::Renderer;
use caustica::scene::ResolvedScene;
use serde_json::json;
use tokio_util::sync::CancellationToken;

use super::harness::render_with;
use super::scene_files;

#[test]
fn freed_buffers_stay_within_the_budget_and_go_when_idle() {
    let budget_mib = 64;
    let config = RenderConfig {
        memory_budget_mib: budget_mib,
        ..RenderConfig::default()
    };
    let mut renderer = Renderer::new(&config).unwrap();
    let allocated_before = allocated_bytes(&renderer);
    for step in 0..8 {
        // Every frame has sizes of its own, so that nothing can be used again.
        let resolved = scene_files::scene(json!({
            "floor": { "depth_m": 1, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "camera": { "position_m": [0, 3, 0.1], "target_m": [0, 0, 0] },
            "quality": { "water_cells": 64 + step, "map_texels": 256 },
            "output": { "kind": "view", "width": 400 + 16 * step, "height": 400 }
        }));
        let frame = renderer
            .render(&resolved, &CancellationToken::new())
            .unwrap();
        let resident = renderer.resident_bytes();
        let budget = frame.stats.memory.budget_bytes;
        assert!(resident <= budget, "frame {step}: {resident} of {budget}");
    }
    assert!(renderer.resident_bytes() > 0);
    for _ in 0..10 {
        renderer.idle().unwrap();
    }
    assert_eq!(renderer.resident_bytes(), 0);
    assert!(allocated_bytes(&renderer) <= allocated_before);
    renderer.gpu().check().unwrap();
}

/// What the device's allocator has given out and not got back.
fn allocated_bytes(renderer: &Renderer) -> u64 {
    renderer.gpu().tidy();
    let report = renderer.gpu().device.generate_allocator_report();
    let report = report.expect("the allocator says what it has given out");
    report.total_allocated_bytes
}

/// What a plan says a frame holds at its peak is what it holds.
#[test]
fn the_planned_peak_is_the_true_one() {
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    let mut shared = 0;
    for name in scene_files::names() {
        for estimate in ["false", "true"] {
            let scene = scene_files::load(&name, &[("/quality/estimate_error", estimate)]);
            let never = CancellationToken::new();
            let plan = renderer.plan(&scene, &never).unwrap();
            let memory = renderer.render(&scene, &never).unwrap().stats.memory;
            assert_eq!(memory.planned_peak_bytes, plan.peak_bytes, "{name}");
            assert_eq!(
                memory.peak_bytes, memory.planned_peak_bytes,
                "{name}, estimate {estimate}"
            );
            shared += plan
                .slots
                .iter()
                .filter(|slot| slot.shares.is_some())
                .count();
        }
    }
    assert!(shared > 20, "{shared}");
}

/// A small map of the floor below a mesh of the project, by its file name.
fn below(mesh: &str) -> ResolvedScene {
    below_mesh(&scene_files::mesh(mesh))
}

/// The same below any mesh.
fn below_mesh(mesh: &Arc<Mesh>) -> ResolvedScene {
    let scene = json!({
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": mesh.id, "translation_m": [0, -1, 0], "scale": 0.3 }],
        "quality": { "water_cells": 32, "level_map_texels": 64 },
        "output": { "kind": "irradiance_map", "receiver": "floor", "width": 32, "height": 32 }
    });
    scene_files::with_meshes(scene, std::slice::from_ref(mesh))
}

/// Bytes of the geometry of a scene by its plan.
fn planned_geometry(renderer: &mut Renderer, resolved: &ResolvedScene) -> u64 {
    let plan = renderer.plan(resolved, &CancellationToken::new()).unwrap();
    let slot = plan.slots.iter().find(|slot| slot.name == "geometry");
    slot.expect("the plan has geometry").bytes
}

#[test]
fn alternating_scenes_upload_their_meshes_once() {
    let scenes = [below("teapot.obj"), below("box.obj")];
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    let planned = scenes
        .each_ref()
        .map(|scene| planned_geometry(&mut renderer, scene));
    let mut expected = 0;
    for (scene, planned) in scenes.iter().zip(planned) {
        let frame = render_with(&mut renderer, scene);
        expected += planned;
        assert_eq!(renderer.geometry_uploaded_bytes(), expected);
        // Of other scenes' meshes nothing counts as the frame's.
        let memory = &frame.stats.memory;
        assert!(memory.peak_bytes <= memory.planned_peak_bytes, "{memory:?}");
    }
    let resident = renderer.resident_bytes();
    for scene in scenes.iter().cycle().take(4) {
        render_with(&mut renderer, scene);
    }
    assert_eq!(renderer.geometry_uploaded_bytes(), expected);
    assert_eq!(renderer.resident_bytes(), resident);

    // What is forgotten is gone, and what is left is not touched.
    renderer.forget_mesh(&scenes[0].meshes[0].id);
    assert_eq!(renderer.resident_bytes(), resident - planned[0]);
    render_with(&mut renderer, &scenes[1]);
    assert_eq!(renderer.geometry_uploaded_bytes(), expected);
    render_with(&mut renderer, &scenes[0]);
    assert_eq!(renderer.geometry_uploaded_bytes(), expected + planned[0]);
}

#[test]
fn meshes_are_evicted_in_the_order_of_their_last_use_where_memory_is_short() {
    // Each takes some megabytes.
    let meshes: Vec<Arc<Mesh>> = (0..3).map(|step| grid(150 + step)).collect();
    let scenes: Vec<ResolvedScene> = meshes.iter().map(below_mesh).collect();
    let mut roomy = Renderer::new(&RenderConfig::default()).unwrap();
    let geometry_bytes = planned_geometry(&mut roomy, &scenes[2]);
    assert!(geometry_bytes > 4 << 20, "{geometry_bytes}");
    let mut config = RenderConfig {
        level_map_budget_mib: 4,
        ..RenderConfig::default()
    };
    let mut roomy = Renderer::new(&config).unwrap();
    let plan = roomy.plan(&scenes[2], &CancellationToken::new()).unwrap();
    // Room for a frame and one more mesh, not for two more.
    let bytes = plan.peak_bytes + geometry_bytes + geometry_bytes / 2;
    config.memory_budget_mib = bytes.div_ceil(1 << 20);
    let mut renderer = Renderer::new(&config).unwrap();
    let mut uploads = |index: usize| {
        let before = renderer.geometry_uploaded_bytes();
        let frame = render_with(&mut renderer, &scenes[index]);
        let memory = &frame.stats.memory;
        assert!(renderer.resident_bytes() <= memory.budget_bytes);
        assert!(memory.peak_bytes <= memory.planned_peak_bytes, "{memory:?}");
        renderer.geometry_uploaded_bytes() > before
    };
    let turns = [0, 1, 0, 2, 0, 2, 1, 2, 0];
    let expected = [true, true, false, true, false, false, true, false, true];
    assert_eq!(turns.map(&mut uploads), expected);
}

/// A flat square of 2 n² triangles.
fn grid(n: usize) -> Arc<Mesh> {
    let mut obj = String::new();
    for i in 0..=n {
        for j in 0..=n {
            let place = |k: usize| k as f64 / n as f64 - 0.5;
            obj.push_str(&format!("v {} 0 {}\n", place(i), place(j)));
        }
    }
    for i in 0..n {
        for j in 1..=n {
            let [a, b] = [i * (n + 1) + j, (i + 1) * (n + 1) + j];
            obj.push_str(&format!("f {a} {} {}\nf {a} {} {b}\n", a + 1, b + 1, b + 1));
        }
    }
    scene_files::mesh_of(obj.as_bytes())
}

#[test]
fn the_geometry_of_a_mesh_that_is_forgotten_is_gone() {
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    let mut allocated = |mesh: &str, forgets: bool| {
        let resolved = below(mesh);
        renderer
            .render(&resolved, &CancellationToken::new())
            .unwrap();
        if forgets {
            renderer.forget_mesh(&resolved.meshes[0].id);
        }
        allocated_bytes(&renderer)
    };
    // The teapot's triangles take 400 KB, the box's less than one.
    let with_teapot = allocated("teapot.obj", false);
    let forgotten = allocated("teapot.obj", true);
    assert!(
        forgotten + 300_000 < with_teapot,
        "{forgotten}, {with_teapot}"
    );
    assert!(allocated("teapot.obj", false) > forgotten + 300_000);
}

#[test]
fn buffers_that_make_room_for_a_frame_are_gone_when_it_is_done() {
    let scene = |step: u32| {
        scene_files::scene(json!({
            "floor": { "depth_m": 1, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "camera": { "position_m": [0, 3, 0.1], "target_m": [0, 0, 0] },
            "quality": { "water_cells": 64 + step, "map_texels": 1024 + step },
            "output": { "kind": "view", "width": 800 + 16 * step, "height": 800 }
        }))
    };
    let mut roomy = Renderer::new(&RenderConfig::default()).unwrap();
    let plan = roomy.plan(&scene(0), &CancellationToken::new()).unwrap();
    let config = RenderConfig {
        // For one frame, and not for what the frame before has left.
        memory_budget_mib: plan.peak_bytes.div_ceil(1 << 20) * 5 / 4,
        ..RenderConfig::default()
    };
    let mut renderer = Renderer::new(&config).unwrap();
    for step in 0..4 {
        let resolved = scene(step);
        renderer
            .render(&resolved, &CancellationToken::new())
            .unwrap();
        // Beside those that are kept there are constants, and what the host reads and writes through.
        let allocated = allocated_bytes(&renderer);
        let kept = renderer.resident_bytes();
        assert!(
            allocated <= kept + (2 << 20),
            "frame {step}: {allocated} bytes, {kept} of them kept"
        );
        assert!(kept > 8 << 20, "{kept}");
    }
}
