//! Choosing dials: from probes to cells, from a budget to cells, and the calibration behind it.

use std::convert::Infallible;

use caustica::calibration::Calibration;
use caustica::calibration::CalibrationError;
use caustica::calibration::PassRate;
use caustica::plan::{NothingCached, Wanted, plan_scene};
use caustica::scene::Quality;
use caustica::tuning::choose::{self, Prospect};
use caustica::tuning::cost::fit_rate;
use caustica::tuning::ladder;

use super::scene_files;

fn map(most_cells: u32) -> Prospect {
    Prospect {
        most_cells,
        margin: 1.2,
        is_view: false,
    }
}

/// A scene whose error is `at_64` with 64 cells and falls with `order`.
fn scene(at_64: f64, order: f64) -> impl FnMut(u32) -> Result<Option<f64>, Infallible> {
    move |cells| Ok(Some(at_64 * (64.0 / f64::from(cells)).powf(order)))
}

#[test]
fn the_fewest_cells_under_the_target_are_chosen() {
    for target in [0.3, 0.05, 0.02, 0.01, 0.003, 0.0005] {
        let choice = choose::for_error(target, &map(2048), scene(0.04, 2.0)).unwrap();
        let needed = 64.0 * (0.04_f64 * 1.2 / target).sqrt();
        assert!(choice.meets, "{choice:?}");
        assert!(choice.predicted_error <= target, "{choice:?}");
        // The order it reckons with is a little below 2.
        let cells = f64::from(choice.cells) / 1.25;
        assert!(1.25 * cells >= needed.min(2048.0), "{target}: {choice:?}");
        assert!(cells <= (needed + 1.0).max(16.0), "{target}: {choice:?}");
    }
}

#[test]
fn probes_stay_cheaper_than_the_frame() {
    let mut probed = Vec::new();
    let mut error = scene(0.1, 2.0);
    let choice = choose::for_error(0.001, &map(2048), |cells| {
        probed.push(cells);
        error(cells)
    })
    .unwrap();
    let cells = |n: u32| f64::from(n).powi(2);
    let cost: f64 = probed.iter().map(|&n| cells(n)).sum();
    assert!(
        cost <= 0.5 * cells(choice.cells),
        "{probed:?} for {choice:?}"
    );
    assert_eq!(choice.probes as usize, probed.len());
}

/// Water cells, true error and estimate of a scene, as measured; the last rows go on from there.
type Measured = [(u32, f64, f64)];

/// The floor of `steep_pool`.
const STEEP_POOL: &Measured = &[
    (16, 0.9, 0.793),
    (32, 0.576, 0.425),
    (64, 0.307, 0.221),
    (128, 0.115, 0.102),
    (256, 0.0348, 0.0314),
    (512, 0.00815, 0.0082),
    (2048, 0.0005, 0.0005),
];
/// The floor of `teapot_floor`.
const TEAPOT_FLOOR: &Measured = &[
    (16, 0.6, 0.275),
    (32, 0.337, 0.254),
    (64, 0.142, 0.111),
    (96, 0.0759, 0.0581),
    (128, 0.0467, 0.0411),
    (256, 0.0115, 0.0116),
    (2048, 0.0002, 0.0002),
];
/// What the camera of `teapot_pool` sees; with few cells the coarse light knows no more of the waves than the fine.
const TEAPOT_POOL: &Measured = &[
    (16, 0.6, 0.15),
    (32, 0.447, 0.203),
    (64, 0.357, 0.216),
    (128, 0.263, 0.168),
    (256, 0.168, 0.116),
    (512, 0.1, 0.0761),
    (1024, 0.06, 0.0473),
    (2048, 0.039, 0.03),
];

/// True error and estimate with so many cells, between what was measured.
fn between(measured: &Measured, cells: u32) -> (f64, f64) {
    let pair = measured
        .windows(2)
        .find(|pair| cells <= pair[1].0)
        .expect("cells within the table");
    let [(low, a, b), (high, c, d)] = [pair[0], pair[1]];
    let log = |n: u32| f64::from(n).ln();
    let part = (log(cells) - log(low)) / (log(high) - log(low));
    let mix = |from: f64, to: f64| (from.ln() + part * (to / from).ln()).exp();
    (mix(a, c), mix(b, d))
}

#[test]
fn coarse_probes_that_underestimate_their_error_are_not_trusted() {
    for (measured, is_view, targets) in [
        (STEEP_POOL, false, [0.5, 0.25, 0.12, 0.06, 0.01]),
        (TEAPOT_FLOOR, false, [0.5, 0.25, 0.12, 0.06, 0.01]),
        (TEAPOT_POOL, true, [0.5, 0.35, 0.25, 0.12, 0.06]),
    ] {
        for target in targets {
            let prospect = Prospect {
                margin: choose::margin(1.2, is_view),
                is_view,
                ..map(2048)
            };
            let probe = |cells| Ok::<_, Infallible>(Some(between(measured, cells).1));
            let choice = choose::for_error(target, &prospect, probe).unwrap();
            let (error, _) = between(measured, choice.cells);
            assert!(choice.meets, "{target}: {choice:?}");
            assert!(error <= target, "{target}: {error} with {choice:?}");
            // Not for any price: fewer than half as many would not do.
            let (half, _) = between(measured, (choice.cells / 2).max(16));
            assert!(
                half > 0.45 * target,
                "{target}: {half} with half of {choice:?}"
            );
        }
    }
}

#[test]
fn what_is_never_trusted_promises_only_what_is_safe() {
    for (target, most, expected) in [
        // Even twice the error stays under the target: the probed cells will do, no fewer.
        (0.5, 2048, (1024, true, 5)),
        (0.47, 2048, (2048, false, 5)),
        (0.5, 100, (100, true, 2)),
        (0.12, 100, (100, false, 2)),
        (0.12, 40, (40, false, 1)),
    ] {
        for is_view in [false, true] {
            let prospect = Prospect {
                is_view,
                ..map(most)
            };
            let stubborn = |_| Ok::<_, Infallible>(Some(0.2));
            let choice = choose::for_error(target, &prospect, stubborn).unwrap();
            let found = (choice.cells, choice.meets, choice.probes);
            assert_eq!(found, expected, "{target}, {most}: {choice:?}");
            assert_eq!(choice.predicted_error <= target, choice.meets, "{choice:?}");
        }
    }
}

#[test]
fn what_cannot_be_met_is_said_with_the_best_there_is() {
    let choice = choose::for_error(1e-4, &map(256), scene(0.04, 2.0)).unwrap();
    assert!(!choice.meets);
    assert_eq!(choice.cells, 256);
    assert!(choice.predicted_error > 1e-4);
}

#[test]
fn of_a_view_the_order_is_measured() {
    let view = Prospect {
        is_view: true,
        ..map(2048)
    };
    let choice = choose::for_error(0.02, &view, scene(0.1, 0.8)).unwrap();
    let needed = 64.0 * (0.1_f64 * 1.2 / 0.02).powf(1.0 / 0.8);
    assert!(choice.probes >= 2, "{choice:?}");
    assert!(
        (f64::from(choice.cells) / needed - 1.0).abs() < 0.02,
        "{choice:?}, {needed}"
    );
}

#[test]
fn darkness_needs_the_fewest() {
    let dark = |_| Ok::<_, Infallible>(None);
    let choice = choose::for_error(0.01, &map(2048), dark).unwrap();
    assert_eq!(choice.cells, ladder::FEWEST_CELLS);
    assert!(choice.meets);
}

#[test]
fn an_error_of_a_probe_is_passed_on() {
    assert_eq!(
        choose::for_error(0.01, &map(2048), |_| Err("lost")),
        Err("lost")
    );
}

#[test]
fn a_budget_gets_the_most_cells_it_pays_for() {
    let ms = |cells: u32| Ok::<_, Infallible>(2.0 + 1e-3 * f64::from(cells).powi(2));
    let (cells, meets) = choose::for_time(100.0, 2048, ms).unwrap();
    assert!(meets);
    assert!(
        ms(cells).unwrap() <= 100.0 && ms(cells + 100).unwrap() > 80.0,
        "{cells}"
    );
    assert_eq!(choose::for_time(100.0, 64, ms).unwrap(), (64, true));
    assert_eq!(
        choose::for_time(1.0, 2048, ms).unwrap(),
        (ladder::FEWEST_CELLS, false)
    );
}

#[test]
fn rungs_are_valid_and_keep_what_is_no_matter_of_light() {
    let given = Quality {
        pixel_samples: 3,
        target_error: Some(0.01),
        ..Quality::default()
    };
    let output = caustica::scene::Output::default();
    for cells in [1, 16, 100, 777, 2048, 9999] {
        let rung = ladder::rung(&given, &output, cells);
        assert!((16..=2048).contains(&rung.water_cells));
        assert!((16..=4096).contains(&rung.map_texels));
        assert!(rung.level_map_texels.is_power_of_two());
        assert!((16..=2048).contains(&rung.level_map_texels));
        assert_eq!(rung.pixel_samples, 3);
        assert_eq!(rung.target_error, None, "a rung asks for nothing");
    }
}

#[test]
fn rates_are_found_again() {
    let truth = PassRate {
        start_ms: 0.5,
        unit_ns: 20.0,
    };
    let measured: Vec<(f64, f64)> = [1e3, 1e5, 1e6]
        .map(|work| (work, truth.start_ms + truth.unit_ns * 1e-6 * work))
        .to_vec();
    let found = fit_rate(&measured);
    assert!(
        (found.start_ms - 0.5).abs() < 1e-9 && (found.unit_ns - 20.0).abs() < 1e-6,
        "{found:?}"
    );
    // Nothing is ever negative, whatever was measured.
    for odd in [
        vec![(1e3, 5.0), (1e6, 1.0)],
        vec![(1e3, 0.001), (1e6, 50.0)],
        vec![(5.0, 1.0)],
        vec![],
    ] {
        let found = fit_rate(&odd);
        assert!(
            found.start_ms >= 0.0 && found.unit_ns >= 0.0,
            "{odd:?}: {found:?}"
        );
    }
}

#[test]
fn the_built_in_calibration_knows_every_pass() {
    let built_in = Calibration::default();
    let mut seen = 0;
    for name in scene_files::names() {
        let scene = scene_files::load(&name, &[("/quality/estimate_error", "true")]);
        let facts = caustica::methods::facts(&scene).unwrap();
        let cold = NothingCached {
            arena_bytes: 1 << 20,
            field_arena_bytes: 1 << 20,
        };
        let plan = plan_scene(&facts, Wanted::Frame, &cold).unwrap();
        for (pass, _) in &plan.graph.passes {
            assert!(
                built_in.passes.contains_key(pass.name),
                "{} of {name}",
                pass.name
            );
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
    let text = serde_json::to_string(&built_in).unwrap();
    assert_eq!(Calibration::read(&text, "it").unwrap(), built_in);
}

#[test]
fn a_file_that_is_no_calibration_is_refused() {
    let good = serde_json::to_value(Calibration::default()).unwrap();
    let mut cases = vec![("{}".to_owned(), "missing field")];
    for (field, value, complaint) in [
        ("form", serde_json::json!(2), "form"),
        ("error_margin", serde_json::json!(0.5), "error_margin"),
        ("frame_ms", serde_json::json!(-1), "-1 is no time"),
        ("speed", serde_json::json!(1), "unknown field"),
    ] {
        let mut bad = good.clone();
        bad[field] = value;
        cases.push((bad.to_string(), complaint));
    }
    for (text, complaint) in cases {
        let error = Calibration::read(&text, "file.json").unwrap_err();
        assert!(matches!(error, CalibrationError::Form { .. }));
        let words = error.to_string();
        assert!(
            words.contains(complaint) && words.contains("file.json"),
            "{words}"
        );
    }
    let missing = Calibration::load(std::path::Path::new("no/such/file.json")).unwrap_err();
    assert!(missing.to_string().contains("no/such/file.json"));
}
