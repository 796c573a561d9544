//! Perceptual metrics, the figures of an image, the order of a sweep and the Pareto front: right for known cases, and able to
//! reject a wrong image.

use caustica::accuracy::LinearImage;
use caustica::accuracy::MetricError;
use caustica::accuracy::display::{SHOWN_WHITE, display_linear, display_rgb};
use caustica::accuracy::flip::flip;
use caustica::accuracy::luv::{luv_distance, luv_from_linear_srgb};
use caustica::lab::study::order::{TRUTH_MARGIN, dial_number, fit_levels, fit_order};
use caustica::lab::study::study::{ErrorFigures, Point, Study, Sweep};
use caustica::lab::study::{error_figures, fit_orders, mark_pareto_front};
use serde_json::json;

const SIZE: u32 = 48;
const PIXELS: usize = (SIZE * SIZE) as usize;
const WHITE_W_M2: f64 = 1000.0;

/// A lopsided caustic on a tinted floor, W/m².
fn truth() -> LinearImage {
    let rgb = (0..PIXELS).map(|i| {
        let (x, y) = (f64::from(i as u32 % SIZE), f64::from(i as u32 / SIZE));
        let ridge = (-(x - 13.0 - 0.3 * y).powi(2) / 18.0).exp();
        let value = 400.0 + 1100.0 * ridge * (0.4 + y / 60.0);
        [0.7 * value, value, 0.9 * value]
    });
    LinearImage {
        width: SIZE,
        height: SIZE,
        rgb: rgb.collect(),
    }
}

fn rearranged(image: &LinearImage, from: impl Fn(u32, u32) -> (u32, u32)) -> LinearImage {
    let pixel = |i: usize| {
        let (x, y) = from(i as u32 % SIZE, i as u32 / SIZE);
        image.rgb[(y * SIZE + x) as usize]
    };
    LinearImage {
        rgb: (0..PIXELS).map(pixel).collect(),
        ..*image
    }
}

fn mapped(image: &LinearImage, map: impl Fn([f64; 3]) -> [f64; 3]) -> LinearImage {
    LinearImage {
        rgb: image.rgb.iter().map(|p| map(*p)).collect(),
        ..*image
    }
}

/// Images that are wrong in one way each.
fn wrong_images() -> Vec<(&'static str, LinearImage)> {
    let truth = truth();
    let mut hot = truth.clone();
    hot.rgb[1234] = [60_000.0, 0.0, 0.0];
    vec![
        (
            "shifted",
            rearranged(&truth, |x, y| ((x + SIZE - 2) % SIZE, y)),
        ),
        ("mirrored", rearranged(&truth, |x, y| (SIZE - 1 - x, y))),
        ("upside down", rearranged(&truth, |x, y| (x, SIZE - 1 - y))),
        ("scaled", mapped(&truth, |p| p.map(|v| 1.1 * v))),
        ("channels swapped", mapped(&truth, |[r, g, b]| [g, r, b])),
        ("one hot texel", hot),
        ("black", mapped(&truth, |_| [0.0; 3])),
    ]
}

fn figures(image: &LinearImage) -> ErrorFigures {
    error_figures(image, &truth(), &[true; PIXELS], None, WHITE_W_M2).unwrap()
}

#[test]
fn the_truth_has_no_error_in_any_figure() {
    assert_eq!(figures(&truth()), ErrorFigures::default());
}

#[test]
fn every_figure_rejects_wrong_images() {
    for (how, image) in wrong_images() {
        let error = figures(&image);
        for (name, value, least) in [
            ("relative_l1", error.relative_l1, 0.01),
            ("rmse", error.rmse_w_m2, 20.0),
            ("flip", error.flip, 1e-3),
            ("luv", error.luv_distance, 0.02),
        ] {
            assert!(value > least, "{name} of the image that is {how}: {value}");
            assert!(value.is_finite(), "{name} of the image that is {how}");
        }
        // A single texel of 2304 is above the 99th percentile: that is what the percentile is for.
        if how != "one hot texel" {
            assert!(error.p99 > 0.05, "p99 of the image that is {how}");
        }
        if matches!(how, "scaled" | "black" | "one hot texel") {
            assert!(error.flux_bias.abs() > 0.01, "bias of {how}");
        }
    }
}

#[test]
fn figures_of_a_scaled_image_by_hand() {
    let error = figures(&mapped(&truth(), |p| p.map(|v| 1.25 * v)));
    assert!((error.relative_l1 - 0.25).abs() < 1e-12);
    assert!((error.flux_bias - 0.25).abs() < 1e-12);
    let squares: f64 = truth().rgb.as_flattened().iter().map(|v| v * v).sum();
    let rmse = 0.25 * (squares / (3.0 * PIXELS as f64)).sqrt();
    assert!((error.rmse_w_m2 - rmse).abs() < 1e-9 * rmse);
}

#[test]
fn only_what_is_compared_counts() {
    let compared: Vec<bool> = (0..PIXELS).map(|i| i % 7 != 3).collect();
    let mut image = truth();
    for (pixel, compared) in image.rgb.iter_mut().zip(&compared) {
        if !compared {
            *pixel = [f64::NAN, -1e9, 1e9];
        }
    }
    let error = error_figures(&image, &truth(), &compared, None, WHITE_W_M2).unwrap();
    assert_eq!(error, ErrorFigures::default());
    image.rgb[0] = [0.0; 3];
    let error = error_figures(&image, &truth(), &compared, None, WHITE_W_M2).unwrap();
    assert!(error.relative_l1 > 0.0 && error.flip > 0.0 && error.luv_distance > 0.0);
}

#[test]
fn the_share_at_the_shadow_edge_is_that_of_the_errors() {
    let mut image = truth();
    for (index, watts) in [(10, 30.0), (20, 20.0), (2000, 50.0)] {
        image.rgb[index][1] += watts;
    }
    let mut edge = vec![false; PIXELS];
    edge[10] = true;
    edge[20] = true;
    let share = |compared: &[bool]| {
        error_figures(&image, &truth(), compared, Some(&edge), WHITE_W_M2)
            .unwrap()
            .shadow_edge_share
            .unwrap()
    };
    assert!((share(&[true; PIXELS]) - 0.5).abs() < 1e-12);
    let mut compared = vec![true; PIXELS];
    compared[20] = false;
    assert!((share(&compared) - 30.0 / 80.0).abs() < 1e-12);
    let none = error_figures(&truth(), &truth(), &[true; PIXELS], Some(&edge), WHITE_W_M2);
    assert_eq!(none.unwrap().shadow_edge_share, Some(0.0));
}

#[test]
fn figures_of_nonsense_are_errors() {
    let all = [true; PIXELS];
    let of = |image: &LinearImage, truth: &LinearImage, compared: &[bool], white: f64| {
        error_figures(image, truth, compared, None, white).unwrap_err()
    };
    let black = mapped(&truth(), |_| [0.0; 3]);
    assert_eq!(
        of(&truth(), &black, &all, WHITE_W_M2),
        MetricError::BlackTruth
    );
    for bad in [f64::NAN, f64::INFINITY] {
        for channel in 0..3 {
            let mut image = truth();
            image.rgb[5][channel] = bad;
            for error in [
                of(&image, &truth(), &all, WHITE_W_M2),
                of(&truth(), &image, &all, WHITE_W_M2),
            ] {
                assert!(matches!(error, MetricError::NotFinite { .. }), "{error}");
            }
        }
    }
    assert_eq!(
        of(&truth(), &truth(), &[false; PIXELS], WHITE_W_M2),
        MetricError::NothingCompared
    );
    for white in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = of(&truth(), &truth(), &all, white);
        assert!(matches!(error, MetricError::White(_)), "{error}");
    }
    let narrow = LinearImage {
        width: SIZE - 1,
        ..truth()
    };
    let short = LinearImage {
        rgb: vec![[1.0; 3]; PIXELS - 1],
        ..truth()
    };
    for error in [
        of(&short, &truth(), &all, WHITE_W_M2),
        of(&truth(), &short, &all, WHITE_W_M2),
        of(&truth(), &narrow, &all, WHITE_W_M2),
        of(&truth(), &truth(), &all[1..], WHITE_W_M2),
        of(
            &LinearImage::default(),
            &LinearImage::default(),
            &[],
            WHITE_W_M2,
        ),
        error_figures(&truth(), &truth(), &all, Some(&all[1..]), WHITE_W_M2).unwrap_err(),
    ] {
        assert!(matches!(error, MetricError::Shape { .. }), "{error}");
    }
}

#[test]
fn display_is_one_fixed_rule() {
    let white = SHOWN_WHITE * WHITE_W_M2;
    let image = LinearImage {
        width: 5,
        height: 1,
        rgb: vec![
            [0.0; 3],
            [0.25 * white, 0.5 * white, white],
            [2.0 * white; 3],
            [-3.0; 3],
            [0.001 * white; 3],
        ],
    };
    let linear = display_linear(&image, WHITE_W_M2).unwrap();
    assert_eq!(linear[1], [0.25, 0.5, 1.0]);
    assert_eq!([linear[2], linear[3]], [[1.0; 3], [0.0; 3]]);
    // sRGB: 1.055 · 0.25^(1/2.4) − 0.055 = 0.5371, · 0.5 = 0.7354; 12.92 · 0.001 = 0.0129.
    let codes = display_rgb(&image, WHITE_W_M2).unwrap();
    assert_eq!(codes[1], [137, 188, 255]);
    assert_eq!(codes[4], [3; 3]);
}

#[test]
fn luv_of_the_primaries_is_as_published() {
    // CIE Luv of sRGB, D65, as tabulated by colour converters (Lindbloom's calculator).
    for (rgb, expected) in [
        ([1.0, 0.0, 0.0], [53.2408, 175.0151, 37.7564]),
        ([0.0, 1.0, 0.0], [87.7347, -83.0776, 107.3985]),
        ([0.0, 0.0, 1.0], [32.2970, -9.4054, -130.3423]),
        ([1.0, 1.0, 1.0], [100.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ] {
        let luv = luv_from_linear_srgb(rgb);
        for (a, b) in luv.iter().zip(expected) {
            assert!((a - b).abs() < 0.01, "{rgb:?}: {luv:?}, {expected:?}");
        }
    }
    // Mid grey: 18.4187 % of white has L* = 50.
    let grey = luv_from_linear_srgb([0.184_187; 3]);
    assert!((grey[0] - 50.0).abs() < 1e-3, "{grey:?}");
    // The two branches of L* meet.
    let knee = 216.0 / 24389.0;
    let below = luv_from_linear_srgb([knee * (1.0 - 1e-9); 3])[0];
    let above = luv_from_linear_srgb([knee * (1.0 + 1e-9); 3])[0];
    assert!((below - above).abs() < 1e-6 && (below - 8.0).abs() < 1e-5);
}

#[test]
fn luv_distance_is_a_mean_over_what_is_compared() {
    let (black, white) = ([0.0; 3], [1.0; 3]);
    let image = [black, white, white];
    let truth = [white, white, black];
    let distance = |compared: &[bool]| luv_distance(&image, &truth, compared);
    assert!((distance(&[true, true, true]).unwrap() - 200.0 / 3.0).abs() < 1e-4);
    assert!((distance(&[true, true, false]).unwrap() - 50.0).abs() < 1e-4);
    assert_eq!(distance(&[false; 3]), Err(MetricError::NothingCompared));
    assert!(matches!(
        distance(&[true; 2]),
        Err(MetricError::SizeMismatch { .. })
    ));
    assert!(matches!(
        luv_distance(&[[f64::NAN; 3]], &[white], &[true]),
        Err(MetricError::NotFinite { .. })
    ));
    // Red and blue, the most distant primaries.
    let far = luv_distance(&[[1.0, 0.0, 0.0]], &[[0.0, 0.0, 1.0]], &[true]).unwrap();
    assert!((far - 250.4).abs() < 0.1, "{far}");
}

#[test]
fn flip_orders_pictures_as_eyes_do() {
    let picture = |image: &LinearImage| display_rgb(image, WHITE_W_M2).unwrap();
    let reference = picture(&truth());
    let mean = |image: &[[u8; 3]]| flip(image, &reference, SIZE, SIZE).unwrap().mean;
    assert_eq!(mean(&reference), 0.0);
    let scaled = |scale: f64| mean(&picture(&mapped(&truth(), |p| p.map(|v| scale * v))));
    let (faint, clear, black) = (scaled(1.02), scaled(1.2), scaled(0.0));
    assert!(
        0.0 < faint && faint < 0.5 * clear && clear < 0.5 * black && black < 1.0,
        "{faint} {clear} {black}"
    );
    // Black against white is as bad as it can be but for the colours' own distance.
    let full = flip(&[[0; 3]; PIXELS], &[[255; 3]; PIXELS], SIZE, SIZE).unwrap();
    assert!(full.mean > 0.9 && full.mean <= 1.0, "{}", full.mean);
    assert_eq!(full.map.len(), PIXELS);
    // The map says where.
    let mut hot = reference.clone();
    hot[(40 * SIZE + 40) as usize] = [255, 0, 0];
    let map = flip(&hot, &reference, SIZE, SIZE).unwrap().map;
    let largest = (0..PIXELS).max_by(|a, b| map[*a].total_cmp(&map[*b]));
    assert_eq!(largest, Some((40 * SIZE + 40) as usize));
    assert!(map[(5 * SIZE + 5) as usize] < 1e-3);
}

#[test]
fn flip_refuses_pictures_that_do_not_fit() {
    let four = [[1; 3]; 4];
    for (image, truth, width, height) in [
        (&four[..3], &four[..], 2, 2),
        (&four[..], &four[..3], 2, 2),
        (&four[..], &four[..], 4, 2),
        (&[], &[], 0, 0),
    ] {
        let error = flip(image, truth, width, height).unwrap_err();
        assert!(matches!(error, MetricError::Shape { .. }), "{error}");
    }
    assert_eq!(flip(&four[..1], &four[..1], 1, 1).unwrap().mean, 0.0);
}

fn sweep(dial: &str, points: &[(serde_json::Value, f64, f64)]) -> Sweep {
    let point = |(value, error, ms): &(serde_json::Value, f64, f64)| {
        let mut point = Point::default();
        point.dials.insert(dial.to_owned(), value.clone());
        point.error.relative_l1 = *error;
        point.cost.wall_ms.median = *ms;
        point
    };
    Sweep {
        dial: dial.to_owned(),
        points: points.iter().map(point).collect(),
        ..Sweep::default()
    }
}

#[test]
fn the_order_leaves_out_errors_below_that_of_the_truth() {
    let law = |n: f64| 40.0 * n.powi(-2);
    let floor = 2e-4;
    let sweep = sweep(
        "beams",
        &[
            (json!(64), law(64.0), 1.0),
            (json!(128), law(128.0), 1.0),
            (json!(256), law(256.0), 1.0),
            // Flattened by the truth's noise.
            (json!(1024), 2.1e-4, 1.0),
        ],
    );
    let fit = fit_order(&sweep, floor).unwrap();
    assert_eq!(fit.used, [true, true, true, false]);
    assert!((fit.order - 2.0).abs() < 1e-9, "{}", fit.order);
    assert!((fit.error_at(64.0) / law(64.0) - 1.0).abs() < 1e-9);
    let bent = fit_order(&sweep, 0.0).unwrap();
    assert!(bent.order < 1.95, "{}", bent.order);
    assert!(fit_order(&sweep, law(128.0) / TRUTH_MARGIN * 1.01).is_none());

    let mut study = Study {
        sweeps: vec![sweep],
        ..Study::default()
    };
    study.truth.relative_error = floor;
    fit_orders(&mut study);
    assert_eq!(study.sweeps[0].order, Some(fit.order));
}

#[test]
fn a_dial_that_counts_halvings_has_a_factor_per_level() {
    let law = |level: i32| 0.08 * 2.5_f64.powi(-level);
    let floor = 1e-3;
    let points = [0, 1, 2, 4].map(|level| (json!(level), law(level), 1.0));
    let mut levels = sweep("split_levels", &points);
    // Flattened by the truth's noise.
    levels.points[3].error.relative_l1 = 2.9e-3;
    let fit = fit_levels(&levels, floor).unwrap();
    assert_eq!(fit.used, [true, true, true, false], "level 0 takes part");
    assert!((fit.factor - 2.5).abs() < 1e-9, "{}", fit.factor);
    assert!((fit.error_at(2.0) / law(2) - 1.0).abs() < 1e-9);
    assert!(fit_order(&levels, floor).is_none(), "it has no order");
    let beams = sweep("beams", &[(json!(1), 0.1, 1.0), (json!(2), 0.05, 1.0)]);
    assert!(fit_levels(&beams, 0.0).is_none());

    let mut study = Study {
        sweeps: vec![levels, beams],
        ..Study::default()
    };
    study.truth.relative_error = floor;
    fit_orders(&mut study);
    let found = |index: usize| {
        let sweep: &Sweep = &study.sweeps[index];
        (sweep.order.is_some(), sweep.factor_per_level)
    };
    assert_eq!(found(0), (false, Some(fit.factor)));
    assert_eq!(found(1), (true, None));
}

#[test]
fn words_and_several_dials_have_no_order() {
    let words = sweep(
        "hits",
        &[(json!("grid"), 0.1, 1.0), (json!("exact"), 0.01, 1.0)],
    );
    assert!(fit_order(&words, 0.0).is_none());
    let zero = sweep("halvings", &[(json!(0), 0.1, 1.0), (json!(1), 0.05, 1.0)]);
    assert!(fit_order(&zero, 0.0).is_none());
    let mut two = sweep("beams", &[(json!(64), 0.1, 1.0), (json!(128), 0.01, 1.0)]);
    assert_eq!(dial_number(&two, &two.points[0]), Some(64.0));
    two.points[0].dials.insert("steps".to_owned(), json!(3));
    assert_eq!(dial_number(&two, &two.points[0]), None);
}

#[test]
fn the_front_is_what_nothing_beats() {
    let mut study = Study {
        sweeps: vec![
            sweep(
                "beams",
                &[
                    (json!(64), 0.10, 1.0),
                    (json!(128), 0.05, 2.0),
                    (json!(256), 0.06, 3.0),
                    (json!(512), f64::NAN, 0.1),
                ],
            ),
            sweep(
                "steps",
                &[
                    // The same setting as 128 beams.
                    (json!(4), 0.05, 2.0),
                    (json!(8), 0.05, 2.5),
                    (json!(16), 0.01, 9.0),
                ],
            ),
        ],
        ..Study::default()
    };
    mark_pareto_front(&mut study);
    let front: Vec<Vec<bool>> = study
        .sweeps
        .iter()
        .map(|s| s.points.iter().map(|p| p.on_pareto_front).collect())
        .collect();
    assert_eq!(
        front,
        [vec![true, true, false, false], vec![true, false, true]]
    );
}
