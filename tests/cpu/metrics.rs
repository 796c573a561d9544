//! Every metric must reject a wrong image: shifted, scaled, flipped, not finite.

use caustica::accuracy::metrics::{
    MetricError, convergence_order, percentile_error, relative_l1, rmse, total_flux_bias,
};

const WIDTH: usize = 32;

type Metric = fn(&[f64], &[f64]) -> Result<f64, MetricError>;

/// Metrics that compare value by value; the bias looks at the sum only.
const POINTWISE: [(&str, Metric); 4] = [
    ("relative_l1", relative_l1),
    ("rmse", rmse),
    ("percentile 50", |image, truth| {
        percentile_error(image, truth, 50.0)
    }),
    ("percentile 100", |image, truth| {
        percentile_error(image, truth, 100.0)
    }),
];

fn all() -> Vec<(&'static str, Metric)> {
    let mut metrics = POINTWISE.to_vec();
    metrics.push(("total_flux_bias", total_flux_bias));
    metrics
}

/// A lopsided bright ridge, RGB.
fn truth() -> Vec<f64> {
    let mut values = Vec::new();
    for y in 0..WIDTH {
        for x in 0..WIDTH {
            let (u, v) = (x as f64 - 9.0, y as f64 - 21.0);
            let value = 1.0 + 5.0 * (-(u * u + 0.3 * v * v + 0.2 * u * v) / 30.0).exp();
            values.extend([value, 0.5 * value, 0.25 * value]);
        }
    }
    values
}

fn rearranged(image: &[f64], from: impl Fn(usize, usize) -> (usize, usize)) -> Vec<f64> {
    let mut values = Vec::new();
    for y in 0..WIDTH {
        for x in 0..WIDTH {
            let (x, y) = from(x, y);
            let start = (y * WIDTH + x) * 3;
            values.extend_from_slice(&image[start..start + 3]);
        }
    }
    values
}

#[test]
fn the_truth_has_no_error() {
    for (name, metric) in all() {
        assert_eq!(metric(&truth(), &truth()), Ok(0.0), "{name}");
    }
}

#[test]
fn wrong_images_are_rejected() {
    let truth = truth();
    let wrong = [
        (
            "shifted",
            rearranged(&truth, |x, y| ((x + WIDTH - 1) % WIDTH, y)),
        ),
        (
            "flipped in x",
            rearranged(&truth, |x, y| (WIDTH - 1 - x, y)),
        ),
        (
            "flipped in z",
            rearranged(&truth, |x, y| (x, WIDTH - 1 - y)),
        ),
        ("transposed", rearranged(&truth, |x, y| (y, x))),
        ("scaled", truth.iter().map(|v| v * 1.05).collect()),
        ("black", vec![0.0; truth.len()]),
    ];
    for (name, metric) in POINTWISE {
        for (how, image) in &wrong {
            let error = metric(image, &truth).unwrap();
            assert!(error > 5e-3, "{name} of the {how} image is {error}");
        }
    }
}

#[test]
fn a_scaled_image_has_the_bias_of_its_scale() {
    let truth = truth();
    for scale in [0.0, 0.5, 1.05, 3.0] {
        let image: Vec<f64> = truth.iter().map(|v| v * scale).collect();
        let bias = total_flux_bias(&image, &truth).unwrap();
        assert!((bias - (scale - 1.0)).abs() < 1e-12, "{scale}: {bias}");
        let l1 = relative_l1(&image, &truth).unwrap();
        assert!((l1 - (scale - 1.0).abs()).abs() < 1e-12, "{scale}: {l1}");
    }
}

#[test]
fn a_single_wrong_channel_is_seen() {
    let truth = truth();
    let mut image = truth.clone();
    image[3 * 700 + 1] += 1000.0;
    for (name, metric) in all() {
        let error = metric(&image, &truth).unwrap();
        if name == "percentile 50" {
            assert_eq!(error, 0.0, "the median does not mind a single value");
        } else {
            assert!(error > 0.1, "{name}: {error}");
        }
    }
}

#[test]
fn figures_by_hand() {
    let (image, truth) = ([1.0, 2.0, 5.0, 0.0], [1.0, 4.0, 2.0, 1.0]);
    assert_eq!(relative_l1(&image, &truth), Ok(6.0 / 8.0));
    assert_eq!(rmse(&image, &truth), Ok((14.0f64 / 4.0).sqrt()));
    assert_eq!(total_flux_bias(&image, &truth), Ok(0.0));
    // Errors 0, 2, 3, 1 over a mean of 2.
    for (percentile, expected) in [
        (0.0, 0.0),
        (25.0, 0.0),
        (26.0, 0.5),
        (50.0, 0.5),
        (75.0, 1.0),
        (76.0, 1.5),
        (100.0, 1.5),
    ] {
        assert_eq!(
            percentile_error(&image, &truth, percentile),
            Ok(expected),
            "{percentile}"
        );
    }
}

#[test]
fn f32_and_f64_compare() {
    let (image, truth) = ([1.5f32, 2.0, 0.5], [1.0f64, 2.0, 1.0]);
    assert_eq!(relative_l1(&image, &truth), Ok(0.25));
}

#[test]
fn values_that_are_not_finite_are_errors() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (name, metric) in all() {
            for (which, side) in [(0, "image"), (1, "truth")] {
                let mut images = [truth(), truth()];
                images[which][17] = bad;
                let error = metric(&images[0], &images[1]).unwrap_err();
                assert!(
                    matches!(error, MetricError::NotFinite { which, index: 17, .. } if which == side),
                    "{name}, {side} {bad}: {error}"
                );
            }
        }
    }
}

#[test]
fn sizes_must_match() {
    let truth = truth();
    for (name, metric) in all() {
        let error = metric(&truth[3..], &truth).unwrap_err();
        assert!(
            matches!(error, MetricError::SizeMismatch { .. }),
            "{name}: {error}"
        );
        assert_eq!(metric(&[], &[]), Err(MetricError::Empty), "{name}");
    }
}

#[test]
fn relative_figures_need_a_truth_with_light() {
    for (name, metric) in all() {
        let result = metric(&[1.0, 2.0, 3.0], &[0.0; 3]);
        if name == "rmse" {
            assert!(result.is_ok(), "{name} has a unit and needs no light");
        } else {
            assert_eq!(result, Err(MetricError::BlackTruth), "{name}");
        }
    }
}

#[test]
fn percentiles_outside_their_range_are_errors() {
    for bad in [-0.1, 100.1, f64::NAN] {
        let error = percentile_error(&[1.0], &[1.0], bad).unwrap_err();
        assert!(matches!(error, MetricError::Percentile(_)), "{error}");
    }
}

#[test]
fn convergence_order_is_the_slope() {
    for order in [-1.0, 0.0, 0.75, 2.0] {
        let points: Vec<(f64, f64)> = [64.0, 128.0, 256.0, 1024.0f64]
            .iter()
            .map(|n| (*n, 3.0 * n.powf(-order)))
            .collect();
        assert!((convergence_order(&points) - order).abs() < 1e-12);
    }
    // The published figures of exact coverage, n = 64 … 512, are of second order.
    let measured = [
        (64.0, 0.054),
        (128.0, 0.016),
        (256.0, 0.0032),
        (512.0, 0.0008),
    ];
    assert!((convergence_order(&measured) - 2.0).abs() < 0.1);
}

#[test]
fn convergence_order_needs_two_points() {
    assert!(convergence_order(&[]).is_nan());
    assert!(convergence_order(&[(64.0, 0.1)]).is_nan());
    assert!(convergence_order(&[(64.0, 0.1), (64.0, 0.2)]).is_nan());
    assert!(convergence_order(&[(64.0, 0.1), (128.0, 0.0)]).is_nan());
}
