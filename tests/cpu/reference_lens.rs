//! The crest between two crossed waves is a lens: brightness on its axis, and the depth of its focus.

use std::f64::consts::TAU;

use caustica::physics::fresnel::fresnel_transmittance;
use caustica::reference::closed_form::ParaboloidBump;
use caustica::scene::ResolvedScene;

use crate::reference::{count, resolved};

const WAVELENGTH_M: f64 = 4.0;
const K_PER_M: f64 = TAU / WAVELENGTH_M;
/// Small, so that what is left out (squares of the slope) stays below 10⁻⁴.
const SLOPE: f64 = 0.01;
const LENS: ParaboloidBump = ParaboloidBump {
    curvature_per_m: SLOPE * K_PER_M,
    ior: 1.333,
};

/// A floor `depth_m` below a crest at (0, 0), and one texel around it.
fn scene(depth_m: f64, texel_m: f64) -> ResolvedScene {
    let amplitude_m = SLOPE / K_PER_M;
    let (half_m, depth_m) = (0.5 * texel_m, depth_m - 2.0 * amplitude_m);
    resolved(&format!(
        r#"{{
            "water": {{ "waves": [
                {{ "kind": "sine", "amplitude_m": {amplitude_m}, "wavelength_m": {WAVELENGTH_M}, "phase_deg": 90 }},
                {{ "kind": "sine", "amplitude_m": {amplitude_m}, "wavelength_m": {WAVELENGTH_M}, "direction_deg": 90, "phase_deg": 90 }}
            ] }},
            "floor": {{ "depth_m": {depth_m}, "size_m": [4, 4] }},
            "lights": [{{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1, 1, 1] }}],
            "output": {{ "kind": "irradiance_map", "receiver": "floor", "min_m": [-{half_m}, -{half_m}], "max_m": [{half_m}, {half_m}], "width": 1, "height": 1 }}
        }}"#
    ))
}

/// What the two sines bring to the axis: beyond the focus also rays from where sin u / u = f/d, u = k x, u not 0.
fn crossed_sines(depth_over_focus: f64) -> f64 {
    let d = depth_over_focus;
    let mut sum = 1.0 / (1.0 - d).abs();
    if d > 1.0 {
        let (mut low, mut high) = (1e-6, TAU / 2.0);
        for _ in 0..100 {
            let u: f64 = 0.5 * (low + high);
            if u.sin() / u > 1.0 / d {
                low = u;
            } else {
                high = u;
            }
        }
        sum += 2.0 / (1.0 - d * low.cos()).abs();
    }
    fresnel_transmittance(1.0, 1.333) * sum * sum
}

#[test]
fn a_crest_brightens_its_axis_as_a_lens_does() {
    let focus_m = LENS.focal_depth_m();
    for (share, rays) in [
        (0.3, 40_000_000),
        (0.5, 40_000_000),
        (0.8, 40_000_000),
        (1.5, 60_000_000),
    ] {
        let texel_m = 0.03 / K_PER_M * (1.0f64 - share).abs();
        let map = count(&scene(share * focus_m, texel_m), rays);
        let got = map.irradiance[0][0];
        let expected = crossed_sines(share);
        if share < 1.0 {
            assert!((expected / LENS.axis_irradiance(share * focus_m) - 1.0).abs() < 1e-12);
        }
        assert!(
            (got / expected - 1.0).abs() < 1e-3,
            "{share}: {got} {expected}"
        );
    }
}

#[test]
fn the_axis_is_brightest_at_the_focus() {
    let focus_m = LENS.focal_depth_m();
    let shares: Vec<f64> = (0..9).map(|i| 0.84 + 0.04 * f64::from(i)).collect();
    let brightness = shares
        .iter()
        .map(|share| count(&scene(share * focus_m, 1e-3 / K_PER_M), 8_000_000).irradiance[0][0]);
    let brightest = brightness
        .zip(&shares)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap();
    assert!((brightest.1 - 1.0).abs() < 0.021, "{brightest:?}");
}

#[test]
fn the_paraboloid_is_consistent_with_itself() {
    let lens = ParaboloidBump {
        curvature_per_m: 0.5,
        ior: 1.333,
    };
    let focus_m = lens.focal_depth_m();
    assert!((focus_m - 1.333 / 0.333 * 2.0).abs() < 1e-12);
    // Near the axis all rays meet at the focus; farther out they cross the axis below it.
    assert!((lens.landing_m(1e-3, focus_m) / 1e-3).abs() < 1e-5);
    let rim_m = lens.landing_m(0.8, focus_m);
    assert!(rim_m > 0.0 && rim_m < 0.05, "{rim_m}");
    for depth_m in [1.0, 5.0, 12.0] {
        let near = lens.disc_irradiance(depth_m, 1e-3, 0.1).unwrap();
        assert!((near / lens.axis_irradiance(depth_m) - 1.0).abs() < 1e-3);
    }
    assert_eq!(lens.disc_irradiance(focus_m, 1.0, 0.1), None);
}
