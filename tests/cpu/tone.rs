//! Tone curves and the sRGB encoding against the published formulas, worked out by hand.

use caustica::image::tone::{code, display, linear_from_srgb, pbr_neutral, srgb_from_linear};
use caustica::scene::ToneCurve;

fn assert_close(found: [f64; 3], wanted: [f64; 3]) {
    for (f, w) in found.iter().zip(wanted) {
        assert!((f - w).abs() < 1e-12, "{found:?}, expected {wanted:?}");
    }
}

#[test]
fn pbr_neutral_moves_dark_greys_by_a_parabola() {
    // x < 0.08: colour − (x − 6.25 x²) = 6.25 x² for grey.
    assert_close(pbr_neutral([0.0; 3]), [0.0; 3]);
    assert_close(pbr_neutral([0.04; 3]), [0.01; 3]);
    // Only the lowest channel decides: offset(0.04) = 0.04 − 0.01 = 0.03.
    assert_close(pbr_neutral([0.5, 0.04, 0.3]), [0.47, 0.01, 0.27]);
}

#[test]
fn pbr_neutral_moves_mid_tones_by_the_fresnel_offset() {
    assert_close(pbr_neutral([0.18; 3]), [0.14; 3]);
    assert_close(pbr_neutral([0.79, 0.5, 0.2]), [0.75, 0.46, 0.16]);
}

#[test]
fn pbr_neutral_compresses_greys_without_colouring_them() {
    // peak = 1 − 0.04 = 0.96; new peak = 1 − 0.24² / (0.96 + 0.24 − 0.76) = 1 − 0.0576 / 0.44.
    let grey = 1.0 - 0.0576 / 0.44;
    assert_close(pbr_neutral([1.0; 3]), [grey; 3]);
}

#[test]
fn pbr_neutral_bleaches_bright_colours() {
    // (4.04, 1.04, 0.08) − 0.04 = (4, 1, 0.04); new peak = 1 − 0.0576 / 3.48;
    // scaled by new peak / 4; then mixed with white (new peak) by g = 1 − 1 / (0.15 (4 − new peak) + 1).
    let peak = 1.0 - 0.0576 / 3.48;
    let g = 1.0 - 1.0 / (0.15 * (4.0 - peak) + 1.0);
    let mix = |c: f64| c * peak / 4.0 * (1.0 - g) + peak * g;
    assert_close(
        pbr_neutral([4.04, 1.04, 0.08]),
        [mix(4.0), mix(1.0), mix(0.04)],
    );
    // The same in figures, from the published GLSL carried over to another language.
    let found = pbr_neutral([4.04, 1.04, 0.08]);
    for (f, w) in found.iter().zip([0.983_448, 0.475_638, 0.313_138]) {
        assert!((f - w).abs() < 2e-6, "{found:?}");
    }
}

#[test]
fn pbr_neutral_is_continuous_where_its_branches_meet() {
    for seam in [0.08, 0.8] {
        let below = pbr_neutral([seam - 1e-9; 3]);
        let above = pbr_neutral([seam + 1e-9; 3]);
        assert!((below[0] - above[0]).abs() < 1e-8, "at {seam}");
    }
}

#[test]
fn pbr_neutral_grows_and_stays_within_the_screen() {
    let mut last = -1.0;
    for step in 0..2000 {
        let light = f64::from(step) * 0.05;
        let [grey, ..] = pbr_neutral([light; 3]);
        assert!(grey >= last && grey <= 1.0, "{light} -> {grey}");
        last = grey;
    }
    for extreme in [[3.4e38, 0.0, 0.0], [1e238; 3], [0.0, 1e300, 1e-300]] {
        let shown = display(ToneCurve::PbrNeutral, extreme);
        assert!(
            shown
                .rgb
                .iter()
                .all(|v| v.is_finite() && (0.0..=1.0).contains(v)),
            "{shown:?}"
        );
    }
}

#[test]
fn clip_keeps_what_fits_and_says_what_does_not() {
    let inside = display(ToneCurve::Clip, [0.25, 1.0, 0.0]);
    assert_eq!(
        (inside.rgb, inside.clipped, inside.negative),
        ([0.25, 1.0, 0.0], false, false)
    );
    // White that missed 1 by rounding is white, not clipped.
    assert!(!display(ToneCurve::Clip, [1.0 + 1e-9; 3]).clipped);
    let outside = display(ToneCurve::Clip, [1.5, -0.5, 0.5]);
    assert_eq!(
        (outside.rgb, outside.clipped, outside.negative),
        ([1.0, 0.0, 0.5], true, true)
    );
}

#[test]
fn srgb_has_its_published_values() {
    assert_eq!(srgb_from_linear(0.0), 0.0);
    assert!((srgb_from_linear(1.0) - 1.0).abs() < 1e-15);
    // The linear piece, and its end.
    assert!((srgb_from_linear(0.001) - 0.01292).abs() < 1e-15);
    assert!((srgb_from_linear(0.003_130_8) - 0.040_449_936).abs() < 1e-12);
    // 18 % grey is 0.461 356…, and half the signal is 0.214 041….
    assert!((srgb_from_linear(0.18) - 0.461_356_129_5).abs() < 1e-9);
    assert!((linear_from_srgb(0.5) - 0.214_041_140_5).abs() < 1e-9);
}

#[test]
fn every_code_comes_back_from_its_own_light() {
    for wanted in 0..=255_u16 {
        let light = linear_from_srgb(f64::from(wanted) / 255.0);
        assert_eq!(code(srgb_from_linear(light), 255), wanted);
    }
    for wanted in 0..=u16::MAX {
        let light = linear_from_srgb(f64::from(wanted) / 65535.0);
        assert_eq!(code(srgb_from_linear(light), u16::MAX), wanted);
    }
}

#[test]
fn codes_are_rounded_to_nearest() {
    assert_eq!(code(0.499 / 255.0, 255), 0);
    assert_eq!(code(0.501 / 255.0, 255), 1);
    assert_eq!(code(254.499 / 255.0, 255), 254);
    assert_eq!(code(254.501 / 255.0, 255), 255);
    assert_eq!(code(1.0, u16::MAX), u16::MAX);
}
