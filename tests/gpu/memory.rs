//! What stays on the GPU between frames: never more than the budget, and nothing of freed buffers after some idleness.

use caustica::config::RenderConfig;
use caustica::render::Renderer;
use serde_json::json;
use tokio_util::sync::CancellationToken;

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

#[test]
fn the_geometry_of_a_mesh_that_is_forgotten_or_replaced_is_gone() {
    let scene = |mesh: &str| {
        scene_files::scene(json!({
            "floor": { "depth_m": 2, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "objects": [{ "mesh": mesh, "translation_m": [0, -1, 0], "scale": 0.3 }],
            "quality": { "water_cells": 32, "level_map_texels": 64 },
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 32, "height": 32 }
        }))
    };
    let mut renderer = Renderer::new(&RenderConfig::default()).unwrap();
    let mut allocated = |mesh: &str, forgets: bool| {
        let resolved = scene(mesh);
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
    let with_box = allocated("box.obj", false);
    assert!(
        with_box + 300_000 < with_teapot,
        "{with_box}, {with_teapot}"
    );
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
