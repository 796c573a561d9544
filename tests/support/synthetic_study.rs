//! A study made by formulas instead of a sweep: errors fall with known orders down to the reference's own error.

use caustica::accuracy::LinearImage;
use caustica::lab::study::study::{
    CostFigures, ErrorFigures, LeftOut, PassCost, Point, SeriesOf, SpreadMs, Study, StudyImages,
    Sweep, TruthFigures,
};
use caustica::lab::study::{fit_orders, mark_pareto_front};
use caustica::stats::{AdapterStats, Warning};
use serde_json::{Value, json};

/// Relative error of the truth.
pub(crate) const TRUTH_ERROR: f64 = 6e-4;

fn spread(median: f64) -> SpreadMs {
    SpreadMs {
        median,
        min: 0.94 * median,
        max: 1.15 * median,
    }
}

/// One setting with this error, apart from the truth's own, and this time.
pub(crate) fn point(dial: &str, value: Value, error: f64, ms: f64) -> Point {
    let relative_l1 = error.hypot(TRUTH_ERROR);
    Point {
        dials: [(dial.to_owned(), value)].into(),
        error: ErrorFigures {
            relative_l1,
            rmse_w_m2: 900.0 * relative_l1,
            flux_bias: -0.02 * relative_l1,
            p99: 7.5 * relative_l1,
            flip: 0.4 * relative_l1,
            luv_distance: 21.0 * relative_l1,
            shadow_edge_share: Some(0.31),
            estimated: Some(1.2 * error),
        },
        cost: CostFigures {
            runs: 7,
            wall_ms: spread(ms),
            gpu_ms: spread(0.8 * ms),
            passes: vec![
                PassCost {
                    name: "surface".to_owned(),
                    ms: spread(0.1 * ms),
                },
                PassCost {
                    name: "deposit".to_owned(),
                    ms: spread(0.6 * ms),
                },
            ],
            peak_bytes: (2e6 + 3e5 * ms) as u64,
        },
        ..Point::default()
    }
}

/// Three sweeps: beams (order 2), steps (order 1), hits (words).
pub(crate) fn study() -> Study {
    let beams = [64, 128, 256, 512, 1024, 2048].map(|n| {
        let n_f = f64::from(n);
        point(
            "beams",
            json!(n),
            900.0 / (n_f * n_f),
            2.0 + n_f * n_f / 9e3,
        )
    });
    let steps = [4, 8, 16, 32, 64].map(|n| {
        let n_f = f64::from(n);
        point("steps", json!(n), 0.12 / n_f, 4.0 + 0.31 * n_f)
    });
    let hits = [("grid", 0.031, 3.4), ("exact", 0.0034, 9.1)]
        .map(|(word, error, ms)| point("hits", json!(word), error, ms));
    let sweep = |dial: &str, points: &[Point]| Sweep {
        dial: dial.to_owned(),
        points: points.to_vec(),
        ..Sweep::default()
    };
    let mut study = Study {
        version: "0.1.0".to_owned(),
        scene: "pool <deep> & \"clear\", at noon".to_owned(),
        scene_hash: "blake3:00ff".to_owned(),
        adapter: AdapterStats {
            name: "Synthetic Adapter 9000".to_owned(),
            backend: "vulkan".to_owned(),
            driver: "driver 1.2.3".to_owned(),
            software: false,
        },
        cores: 16,
        truth: TruthFigures {
            what: "the floor's map, 256 × 256 texels".to_owned(),
            width: 256,
            height: 256,
            rays: 1_500_000_000,
            relative_error: TRUTH_ERROR,
            seconds: 312.5,
            from_disk: true,
            shadow_edge_area: Some(0.043),
        },
        sweeps: vec![
            sweep("beams", &beams),
            sweep("steps", &steps),
            sweep("hits", &hits),
        ],
        warnings: vec![Warning::new(
            "dial_clamped",
            "beams 4096 was left out: it needs more memory than there is",
        )],
        left_out: Vec::new(),
    };
    mark_pareto_front(&mut study);
    fit_orders(&mut study);
    study
}

/// A caustic of waves that cross, W/m², and renders of it that are blurred the more, the larger their error.
pub(crate) fn images(study: &Study, width: u32, height: u32) -> StudyImages {
    let truth = caustic(width, height, 0.0);
    let points = study.sweeps.iter().map(|sweep| {
        let image = |point: &Point| caustic(width, height, point.error.relative_l1);
        sweep.points.iter().map(image).collect()
    });
    StudyImages {
        points: points.collect(),
        truth,
        white_w_m2: 1000.0,
    }
}

fn caustic(width: u32, height: u32, softness: f64) -> LinearImage {
    let rgb = (0..width * height).map(|i| {
        let (x, y) = (
            f64::from(i % width) / f64::from(width),
            f64::from(i / width) / f64::from(width),
        );
        let wave = |a: f64, b: f64, phase: f64| {
            let ridge = (a * x + b * y + phase + 0.4 * (9.0 * y).sin()).sin();
            1.0 / (ridge * ridge + 0.05 + softness)
        };
        let light = 90.0 * (wave(14.0, 5.0, 0.3) + wave(-7.0, 12.0, 1.1));
        [0.75 * light, light, 0.95 * light]
    });
    LinearImage {
        width,
        height,
        rgb: rgb.collect(),
    }
}

/// A comparison of three methods: `beam` is the first, and falls from 8 % to 0.125 %; `point` is faster where errors are large and stays
/// at 2 %, with a smooth variant that is slower and better; `slow` takes longer than all. `picky` cannot do it.
pub(crate) fn comparison() -> Study {
    let series = |name: &str, method: &str, chief: &str, settings: &[(f64, f64, f64)]| Sweep {
        dial: name.to_owned(),
        series: Some(SeriesOf {
            method: method.to_owned(),
            chief: chief.to_owned(),
        }),
        points: settings
            .iter()
            .map(|(scale, error, ms)| {
                let mut setting = point("method", json!(method), *error, *ms);
                setting.error.relative_l1 = *error;
                setting.scale = Some(*scale);
                let number = (256.0 * scale) as u32;
                setting.dials.insert(chief.to_owned(), json!(number));
                setting.dials.insert("aside".to_owned(), json!(7));
                setting
            })
            .collect(),
        ..Sweep::default()
    };
    let beam = [
        (0.25, 0.08, 5.0),
        (0.5, 0.02, 10.0),
        (1.0, 0.005, 20.0),
        (2.0, 0.00125, 40.0),
    ];
    let rough = [(0.25, 0.06, 3.0), (0.5, 0.03, 6.0), (1.0, 0.025, 12.0)];
    let smooth = [(0.25, 0.05, 4.0), (0.5, 0.02, 8.0), (1.0, 0.019, 16.0)];
    let mut study = Study {
        sweeps: vec![
            series("beam", "beam", "cells", &beam),
            series("point", "point", "grains", &rough),
            series("point, density smooth", "point", "grains", &smooth),
            series(
                "slow",
                "slow",
                "cells",
                &[(0.25, 0.01, 100.0), (0.5, 0.004, 200.0)],
            ),
        ],
        left_out: vec![LeftOut {
            series: "picky".to_owned(),
            method: "picky".to_owned(),
            reason: "it wants a sun".to_owned(),
        }],
        ..study()
    };
    mark_pareto_front(&mut study);
    fit_orders(&mut study);
    study
}
