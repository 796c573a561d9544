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
    renderer.gpu().check().unwrap();
}
