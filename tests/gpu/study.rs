//! Studies of accuracy with the real renderer, from sweep to report, from the library, the command line and HTTP.

use caustica::config::{Limits, RenderConfig};
use caustica::lab::study::comparison;
use caustica::lab::study::dial::Dial;
use caustica::lab::study::report::write_study;
use caustica::lab::study::study::{Study, StudyImages};
use caustica::lab::study::sweep::{Refusal, StudyError, SweepSettings, run_study};
use caustica::reference::Truth;
use caustica::render::{RenderError, Renderer};
use caustica::scene::ResolvedScene;
use serde_json::json;
use tokio_util::sync::CancellationToken;

use super::truths::truth_to;
use super::{harness, scene_files};

fn small_sine_pool() -> ResolvedScene {
    scene_files::load(
        "sine_pool",
        &[("/output/width", "64"), ("/output/height", "64")],
    )
}

/// The truth about it, well below what is judged by it.
fn small_truth() -> Truth {
    truth_to(&small_sine_pool(), 1e-3)
}

fn study(
    renderer: &mut Renderer,
    scene: &ResolvedScene,
    truth: &Truth,
    dials: &[&str],
    grid: bool,
) -> Result<(Study, StudyImages), StudyError<RenderError>> {
    let settings = SweepSettings {
        dials: dials
            .iter()
            .map(|text| Dial::parse(text).unwrap())
            .collect(),
        grid,
        rungs: comparison::DEFAULT_RUNGS,
        runs: 2,
    };
    run_study(
        scene,
        "small",
        truth,
        &settings,
        &Limits::default(),
        &mut |scene| {
            renderer
                .render(&scene, &CancellationToken::new())
                .map_err(|error| match error {
                    RenderError::OverBudget { .. } => Refusal::Setting(error),
                    _ => Refusal::All(error),
                })
        },
        &mut |_, _, _| true,
    )
}

#[test]
fn cells_converge_at_second_order_and_cost_more() {
    let scene = small_sine_pool();
    let truth = small_truth();
    let (study, images) = study(
        &mut harness::renderer(),
        &scene,
        &truth,
        &["water_cells=32..256"],
        false,
    )
    .unwrap();
    assert_eq!(study.sweeps.len(), 1);
    let points = &study.sweeps[0].points;
    assert_eq!(points.len(), 4);
    assert_eq!(images.points[0].len(), 4);
    for pair in points.windows(2) {
        assert!(pair[1].error.relative_l1 < 0.5 * pair[0].error.relative_l1);
        assert!(
            pair[1].error.flip <= pair[0].error.flip
                && pair[1].error.luv_distance < pair[0].error.luv_distance
        );
        assert!(pair[1].cost.peak_bytes > pair[0].cost.peak_bytes);
    }
    let order = study.sweeps[0].order.unwrap();
    println!("order {order:.2}");
    assert!((1.7..=2.4).contains(&order), "{order}");
    for point in points {
        let ratio = point.error.estimated.unwrap() / point.error.relative_l1;
        println!("estimate ÷ true error {ratio:.2}");
        assert!((0.5..=2.0).contains(&ratio), "{point:?}");
        assert!(point.error.shadow_edge_share.is_none(), "there is no mesh");
        assert_eq!(point.cost.runs, 2);
        assert!(
            point.cost.wall_ms.min <= point.cost.wall_ms.median
                && point.cost.wall_ms.median <= point.cost.wall_ms.max
        );
        assert!(point.cost.passes.iter().any(|pass| pass.name == "deposit"));
        assert!(
            point.cost.passes.iter().all(|pass| pass.name != "estimate"),
            "timed runs do not estimate"
        );
    }
    assert!(
        points.last().unwrap().on_pareto_front,
        "nothing else is as near to the truth"
    );
    let folder = std::env::temp_dir().join(format!("caustica-study-{}", std::process::id()));
    let files = write_study(&folder, &study, &images).unwrap();
    assert!(files.iter().all(|file| file.is_file()), "{files:?}");
    let report = std::fs::read_to_string(&files[0]).unwrap();
    assert!(report.contains("water") && report.contains("256"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_grid_has_every_combination() {
    let scene = small_sine_pool();
    let truth = small_truth();
    let dials = ["water_cells=32,64", "split_levels=0,1,2"];
    let (study, _) = study(&mut harness::renderer(), &scene, &truth, &dials, true).unwrap();
    assert_eq!(study.sweeps.len(), 1);
    assert_eq!(study.sweeps[0].dial, "water_cells × split_levels");
    assert_eq!(study.sweeps[0].points.len(), 6);
    // Without meshes nothing straddles: only the cells matter.
    let errors: Vec<f64> = study.sweeps[0]
        .points
        .iter()
        .map(|p| p.error.relative_l1)
        .collect();
    assert_eq!(errors[0], errors[2]);
    assert!(errors[3] < errors[0]);
}

#[test]
fn bad_and_too_many_settings_are_refused_before_any_time_is_spent() {
    let scene = small_sine_pool();
    let truth = small_truth();
    let renderer = &mut harness::renderer();
    let error = study(renderer, &scene, &truth, &["water_cells=64,1"], false).unwrap_err();
    let StudyError::Scene(error) = error else {
        panic!("{error}");
    };
    assert_eq!(error.issues[0].pointer, "/quality/water_cells");
    let dials = [
        "water_cells=20,21,22,23,24,25,26,27,28",
        "map_texels=20,21,22,23,24,25,26,27",
    ];
    let error = study(renderer, &scene, &truth, &dials, true).unwrap_err();
    assert!(matches!(error, StudyError::TooMany { .. }), "{error}");
}

#[test]
fn a_setting_that_does_not_fit_is_left_out_and_reported() {
    let scene = small_sine_pool();
    let truth = small_truth();
    let config = RenderConfig {
        memory_budget_mib: 3,
        ..RenderConfig::default()
    };
    let mut renderer = harness::new_renderer(&config);
    let (found, images) = study(
        &mut renderer,
        &scene,
        &truth,
        &["water_cells=64,1024"],
        false,
    )
    .unwrap();
    assert_eq!(found.sweeps[0].points.len(), 1);
    assert_eq!(images.points[0].len(), 1);
    assert_eq!(found.warnings.len(), 1);
    assert_eq!(found.warnings[0].code, "setting_left_out");
    assert!(found.warnings[0].message.contains("water_cells = 1024"));
    let error = study(&mut renderer, &scene, &truth, &["water_cells=1024"], false).unwrap_err();
    assert!(matches!(error, StudyError::NothingLeft(_)), "{error}");
}

#[test]
fn a_view_is_compared_at_its_pixels() {
    let scene = scene_files::load(
        "teapot_pool",
        &[
            ("/output/width", "384"),
            ("/output/height", "216"),
            ("/quality/pixel_samples", "1"),
            ("/quality/water_cells", "256"),
            ("/quality/level_map_texels", "256"),
        ],
    );
    let truth = truth_to(&scene, 2e-2);
    let (study, _) = study(
        &mut harness::renderer(),
        &scene,
        &truth,
        &["map_texels=256,1024"],
        false,
    )
    .unwrap();
    let points = &study.sweeps[0].points;
    println!("{:?}", points.iter().map(|p| &p.error).collect::<Vec<_>>());
    assert!(points[1].error.relative_l1 < 0.6 * points[0].error.relative_l1);
    assert!(
        points[1].error.relative_l1 < 0.12,
        "{}",
        points[1].error.relative_l1
    );
    assert!(
        points[0].error.shadow_edge_share.is_some(),
        "the teapot has a shadow"
    );
    // The truth has every 4th pixel; its edges are those of the picture, not of such a coarse one.
    assert!(truth.pixel_step > 1);
    let coarse = truth.shadow_edge(2).unwrap();
    let coarse = coarse
        .iter()
        .zip(&truth.compared)
        .filter(|(e, c)| **e && **c);
    let compared = truth.compared.iter().filter(|c| **c).count();
    let coarse = coarse.count() as f64 / compared as f64;
    let area = study.truth.shadow_edge_area.unwrap();
    println!("{area:.3} of the pixels near edges, {coarse:.3} as values");
    assert!(area > 0.005 && area < 0.6 * coarse, "{area} {coarse}");
}

#[test]
fn meshes_and_tilted_receivers_agree_with_the_reference() {
    let output = json!({ "kind": "irradiance_map", "receiver": 0 });
    let mut value = json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.9, "direction_deg": 30 }], "absorption_per_m": [0.3, 0.1, 0.05] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 20, "irradiance_w_m2": [1000, 1000, 1000] }],
        // Turned about z by 20°.
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "rotation": [0, 0, 0.173_648_177_666_930_33, 0.984_807_753_012_208], "scale": 0.5 }],
        "quality": { "water_cells": 256, "level_map_texels": 64, "split_levels": 3 },
    });
    value["output"] = output;
    let scene = scene_files::scene(value);
    let truth = truth_to(&scene, 5e-3);
    let (found, _) = study(
        &mut harness::renderer(),
        &scene,
        &truth,
        &["water_cells=128"],
        false,
    )
    .unwrap();
    let error = &found.sweeps[0].points[0].error;
    println!("{error:?}");
    assert!(error.relative_l1 < 0.05, "{error:?}");
    // The map's own size is no dial of its error.
    let other = study(
        &mut harness::renderer(),
        &scene,
        &truth,
        &["level_map_texels=32"],
        false,
    );
    assert!(matches!(other.unwrap_err(), StudyError::Metric(_)));
}
