//! Chosen dials depend on the documented settings only, not on what happens to be cached.

use caustica::calibration::Calibration;
use caustica::config::RenderConfig;
use caustica::scene::ResolvedScene;
use caustica::stats::ChosenDials;
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::harness::{new_renderer, render_with};
use super::scene_files;

/// A pool for which the most cells that fit are chosen, with a box in it or without.
fn pool(has_box: bool) -> ResolvedScene {
    let object = json!({ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.5 });
    let objects: Vec<Value> = has_box.then_some(object).into_iter().collect();
    scene_files::scene(json!({
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
        "objects": objects,
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1, 0] },
        "quality": { "time_budget_ms": 1e6 },
        "output": { "kind": "view", "width": 32, "height": 32 }
    }))
}

/// Room for few cells only: memory is what decides.
fn narrow() -> RenderConfig {
    RenderConfig {
        memory_budget_mib: 24,
        level_map_budget_mib: 8,
        ..RenderConfig::default()
    }
}

#[test]
fn cached_maps_do_not_affect_the_chosen_dials() {
    for scene in [pool(true), pool(false)] {
        let mut renderer = new_renderer(&narrow());
        let mut chosen = || -> ChosenDials {
            let plan = renderer.plan(&scene, &CancellationToken::new());
            let chosen = plan.unwrap().chosen.unwrap();
            // Now the chosen frame's level maps are there, and the arena of all frames.
            render_with(&mut renderer, &scene);
            render_with(&mut renderer, &pool(true));
            chosen
        };
        let first = chosen();
        assert!(
            (17..1024).contains(&first.water_cells),
            "memory does not decide: {first:?}"
        );
        assert_eq!(chosen(), first);
    }
}

#[test]
fn another_calibration_or_budget_is_another_basis() {
    let base = RenderConfig::default();
    let basis = |config: &RenderConfig| new_renderer(config).dial_basis();
    let of_base = basis(&base);
    assert_eq!(basis(&base), of_base);
    let calibration = Calibration::default();
    let calibrations = [
        Calibration {
            error_margin: calibration.error_margin + 0.5,
            ..calibration.clone()
        },
        Calibration {
            frame_ms: calibration.frame_ms + 1.0,
            ..calibration.clone()
        },
        Calibration {
            adapter: "another".to_owned(),
            ..calibration
        },
    ];
    let mut others: Vec<RenderConfig> = calibrations
        .into_iter()
        .map(|calibration| RenderConfig {
            calibration: Some(calibration),
            ..base.clone()
        })
        .collect();
    others.push(RenderConfig {
        memory_budget_mib: base.memory_budget_mib / 2,
        ..base.clone()
    });
    others.push(RenderConfig {
        level_map_budget_mib: base.level_map_budget_mib / 2,
        ..base.clone()
    });
    let mut all: Vec<String> = others.iter().map(basis).collect();
    all.push(of_base);
    for (index, one) in all.iter().enumerate() {
        assert!(!all[..index].contains(one), "{index}: {all:?}");
    }
}
