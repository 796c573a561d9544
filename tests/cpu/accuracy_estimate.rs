//! The extrapolation from a frame and its coarse twin to its error, against errors that follow the law it assumes.

use caustica::accuracy::estimate::{Compared, FrameComparison, estimate_error};

/// The error where `second_order` grows by second order for ever, and no relative L1 exceeds 2.
fn saturating(second_order: f64) -> f64 {
    second_order / (1.0 + 0.5 * second_order)
}

fn estimated(difference: f64, cells_ratio: f64, texels: Compared) -> f64 {
    estimate_error(&FrameComparison {
        difference,
        cells_ratio,
        texels,
    })
}

/// What errors of the size of a texel hide of small differences: the scale of an estimate.
fn hidden(cells_ratio: f64, texels: Compared) -> f64 {
    let difference = 1e-3;
    let once = estimated(difference, cells_ratio, texels);
    (cells_ratio * cells_ratio - 1.0) * once / difference
}

#[test]
fn errors_that_saturate_are_found_again_while_they_are_small() {
    for texels in [
        Compared::Blocks(1),
        Compared::Blocks(2),
        Compared::Blocks(4),
    ] {
        for ratio in [2.5_f64, 64.0 / 24.0, 3.0] {
            let scale = hidden(ratio, texels);
            assert!((1.5..2.2).contains(&scale), "{scale}");
            for (error, least, most) in [
                (0.01, 0.99, 1.01),
                (0.05, 0.95, 1.0),
                (0.1, 0.87, 1.0),
                (0.3, 0.57, 0.8),
            ] {
                let second_order = error / (1.0 - 0.5 * error);
                assert!((saturating(second_order) - error).abs() < 1e-12);
                let coarse = saturating(second_order * ratio * ratio);
                let found = estimated((coarse - error) / scale, ratio, texels) / error;
                assert!((least..=most).contains(&found), "{error}, {ratio}: {found}");
            }
        }
    }
}

#[test]
fn no_error_is_more_than_all_light_in_the_wrong_place() {
    for texels in [Compared::Blocks(1), Compared::Blocks(4), Compared::Between] {
        let mut before = 0.0;
        for difference in [0.0, 1e-6, 0.01, 0.1, 0.5, 1.0, 2.0] {
            let found = estimated(difference, 2.5, texels);
            assert!(
                found >= before && found <= 2.0 + 1e-5,
                "{difference}: {found}"
            );
            before = found;
        }
    }
}

#[test]
fn a_view_stays_in_proportion() {
    let small = estimated(0.01, 2.5, Compared::Between);
    let large = estimated(0.5, 2.5, Compared::Between);
    assert!(
        (large / small / 50.0 - 1.0).abs() < 1e-3,
        "{small}, {large}"
    );
}
