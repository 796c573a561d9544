//! Power laws from field values to irradiance.

use caustica::fronts::{Distance, FrontError, PowerLaw, fit};

fn points(a: f64, b: f64) -> Vec<(f64, f64)> {
    let values = (1..200).map(|i| 0.02 * f64::from(i));
    values.map(|v| (v, a * v.powf(b))).collect()
}

#[test]
fn a_power_law_is_found_again() {
    for distance in [Distance::Absolute, Distance::Squares] {
        for (a, b) in [(1.0, 1.0), (700.0, 0.4), (3e-4, 2.7)] {
            let found = fit(&points(a, b), distance).unwrap();
            assert!((found.law.b - b).abs() < 1e-6, "{found:?}");
            assert!((found.law.a / a - 1.0).abs() < 1e-5, "{found:?}");
            assert!(found.relative_l1 < 1e-5 && !found.at_end);
        }
    }
}

#[test]
fn one_wild_point_moves_squares_but_not_absolute_distances() {
    let mut wild = points(2.0, 1.2);
    wild[150].1 = 4000.0;
    let absolute = fit(&wild, Distance::Absolute).unwrap().law;
    assert!(
        (absolute.b - 1.2).abs() < 1e-3 && (absolute.a - 2.0).abs() < 1e-3,
        "{absolute:?}"
    );
    let squares = fit(&wild, Distance::Squares).unwrap().law;
    assert!((squares.b - 1.2).abs() > 0.05, "{squares:?}");
}

/// No other exponent on a fine grid, each with its best factor, is closer.
#[test]
fn the_fit_is_the_best_there_is() {
    // A law plus waves.
    let mut noisy = points(1.5, 1.4);
    for (i, (_, r)) in noisy.iter_mut().enumerate() {
        *r *= 1.0 + 0.4 * (1.7 * i as f64).sin();
    }
    let cost = |a: f64, b: f64| {
        let off = noisy.iter().map(|(v, r)| (a * v.powf(b) - r).abs());
        off.sum::<f64>()
    };
    let found = fit(&noisy, Distance::Absolute).unwrap().law;
    let best = cost(found.a, found.b);
    for b in (10..400).map(|i| 0.01 * f64::from(i)) {
        for a in (1..120).map(|i| 0.03 * f64::from(i)) {
            assert!(cost(a, b) > best - 1e-6, "{a} {b} beats {found:?}");
        }
    }
}

#[test]
fn values_without_a_law_are_refused() {
    let refused = |points: &[(f64, f64)]| {
        let error = fit(points, Distance::Squares).unwrap_err();
        assert!(matches!(error, FrontError::Fit { .. }), "{error}");
    };
    refused(&[]);
    refused(&points(1.0, 1.0)[..2]);
    refused(&[(1.0, 1.0), (2.0, f64::NAN), (3.0, 1.0)]);
    refused(&[(1.0, 1.0), (-2.0, 1.0), (3.0, 1.0)]);
    refused(&[(0.0, 1.0); 4]);
    refused(&[(1.0, 0.0); 4]);
    // An exponent beyond the range is reported.
    assert!(fit(&points(1.0, 8.0), Distance::Squares).unwrap().at_end);
}

#[test]
fn flux_is_kept_slice_by_slice() {
    let law = PowerLaw { a: 5.0, b: 2.0 };
    let mut values = vec![1.0, 2.0, 3.0, 0.0, 0.0, 0.0, -1.0, 4.0, 0.0];
    law.keep_flux(&mut values, 3, 10.0);
    let wanted = [
        30.0 / 14.0,
        120.0 / 14.0,
        270.0 / 14.0,
        0.0,
        0.0,
        0.0,
        0.0,
        30.0,
        0.0,
    ];
    for (value, wanted) in values.iter().zip(wanted) {
        assert!((value - wanted as f32).abs() < 1e-5, "{values:?}");
    }
    assert!((law.of(3.0) - 45.0).abs() < 1e-12 && law.of(-3.0) == 0.0);
}
