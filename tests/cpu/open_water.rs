//! Basins with absorbing walls and without obstacles: against the integral over wave numbers, and larger basins.

use std::f64::consts::{PI, TAU};

use caustica::physics::dispersion::angular_frequency_with_surface_tension;
use caustica::scene::Scene;
use caustica::waves::{Surface, slope_lost};
use serde_json::{Value, json};

use crate::surfaces::{refined_surface, surface_of};

fn scene(fields: &Value, depth_m: Option<f64>, time_s: f64) -> Scene {
    let mut waves = json!({ "kind": "ripples", "min_m": [-0.5, -0.5], "max_m": [0.5, 0.5], "walls": "absorbing" });
    waves
        .as_object_mut()
        .unwrap()
        .extend(fields.as_object().unwrap().clone());
    let mut scene = json!({ "water": { "waves": [waves] }, "time_s": time_s });
    if let Some(depth_m) = depth_m {
        scene["floor"] = json!({ "depth_m": depth_m, "size_m": [8, 8] });
    }
    serde_json::from_value(scene).unwrap()
}

fn surface(fields: &Value, depth_m: Option<f64>, time_s: f64) -> Surface {
    surface_of(&scene(fields, depth_m, time_s))
}

/// J₀ by its integral over angles, which even steps take to rounding.
fn bessel(x: f64) -> f64 {
    let steps = 64 + 2 * x as u32;
    let angle = |i: u32| PI * (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| (x * angle(i).sin()).cos()).sum::<f64>() / f64::from(steps)
}

/// Height at the distance `r_m` of a drop of height 1, by Simpson's rule with textbook formulas.
fn integral(radius_m: f64, r_m: f64, time_s: f64, gamma: f64, omega: impl Fn(f64) -> f64) -> f64 {
    let (steps, most) = (4000, 9.0 / radius_m);
    let width = most / f64::from(steps);
    let value = |i: i32| {
        let k = f64::from(i) * width;
        let omega = omega(k);
        let swing = if omega > gamma {
            let w = (omega * omega - gamma * gamma).sqrt();
            (-gamma * time_s).exp() * ((w * time_s).cos() + gamma / w * (w * time_s).sin())
        } else {
            let w = (gamma * gamma - omega * omega).sqrt().max(1e-300);
            let (fast, slow) = ((-(gamma + w) * time_s).exp(), (-(gamma - w) * time_s).exp());
            0.5 * (slow + fast) + gamma / w * 0.5 * (slow - fast)
        };
        radius_m * radius_m * (-0.5 * (k * radius_m).powi(2)).exp() * swing * bessel(k * r_m) * k
    };
    let weight = |i: i32| match (i, i % 2) {
        (0, _) => 1.0,
        (_, 0) => 2.0,
        _ => 4.0,
    };
    (0..steps).map(|i| weight(i) * value(i)).sum::<f64>() * width / 3.0
}

#[test]
fn the_surface_is_the_integral_over_wave_numbers() {
    let radius_m = 0.04;
    for damping_per_s in [0.0, 0.8, 40.0] {
        for (dispersion, depth_m) in [
            ("shallow", Some(0.1)),
            ("finite_depth", Some(0.1)),
            ("finite_depth", Some(1e-3)),
            ("finite_depth", None),
        ] {
            let omega = |k: f64| match (dispersion, depth_m) {
                ("shallow", Some(depth_m)) => k * f64::sqrt(9.80665 * depth_m),
                (_, depth_m) => {
                    let tanh = depth_m.map_or(1.0, |depth_m| (k * depth_m).tanh());
                    ((9.80665 * k + 7.28e-5 * k.powi(3)) * tanh).sqrt()
                }
            };
            // The longest waves of deep water are soon far away: those that would be 2 times as far as the basin's end fade.
            let tolerance = if depth_m.is_none() { 3e-4 } else { 1e-7 };
            for time_s in [0.0, 0.2, 0.6] {
                let fields = json!({ "samples": 100, "damping_per_s": damping_per_s, "dispersion": dispersion, "drops": [
                    { "position_m": [0.105, -0.205], "radius_m": radius_m, "height_m": 1.0 }] });
                let surface = surface(&fields, depth_m, time_s);
                // Places are samples, at which the spline is exact.
                for (x_m, z_m) in [
                    (0.105, -0.205),
                    (0.145, -0.235),
                    (-0.195, 0.195),
                    (-0.495, 0.495),
                ] {
                    let r_m = (x_m - 0.105_f64).hypot(z_m + 0.205);
                    let expected = integral(radius_m, r_m, time_s, damping_per_s, omega);
                    let found = surface.at(x_m, z_m).height_m;
                    assert!(
                        (found - expected).abs() < tolerance,
                        "γ {damping_per_s} {dispersion} {depth_m:?} t {time_s} r {r_m}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// Until waves reach the walls, a basin whose walls reflect has the same surface, but for the level from which it takes the drop's water.
#[test]
fn walls_do_not_matter_before_they_are_reached() {
    let drops = json!([
        { "position_m": [0.05, 0.1], "radius_m": 0.05, "height_m": 1.0, "at_s": -0.1 },
        { "position_m": [-0.2, -0.1], "radius_m": 0.04, "height_m": -2.0, "at_s": 0.0 },
        { "position_m": [0.2, -0.2], "radius_m": 0.04, "height_m": 5.0, "at_s": 0.5 }
    ]);
    let open = surface(
        &json!({ "samples": 128, "dispersion": "shallow", "drops": drops }),
        Some(0.1),
        0.4,
    );
    let wide = json!({ "samples": 512, "min_m": [-2, -2], "max_m": [2, 2], "walls": "reflecting", "dispersion": "shallow", "drops": drops });
    let wide = surface(&wide, Some(0.1), 0.4);
    let level_m = TAU * (0.05 * 0.05 - 2.0 * 0.04 * 0.04) / 16.0;
    let place = |i: i32| -0.49 + 0.02 * f64::from(i);
    for (x, z) in (0..2500).map(|i| (place(i % 50), place(i / 50))) {
        let difference_m = open.at(x, z).height_m - (wide.at(x, z).height_m + level_m);
        assert!(difference_m.abs() < 1e-5, "{x} {z} {difference_m}");
    }
}

/// A basin is a part of wider water: the same drops in a larger one have the same surface.
#[test]
fn nothing_comes_back_from_absorbing_walls() {
    let drops = json!([{ "position_m": [0.4, 0.1], "radius_m": 0.05, "height_m": 1.0 }]);
    for (depth_m, damping_per_s) in [(Some(0.1), 0.0), (Some(0.1), 0.5), (None, 0.0)] {
        let fields = |half_m: f64, samples: u32| json!({ "samples": samples, "min_m": [-half_m, -half_m], "max_m": [half_m, half_m], "damping_per_s": damping_per_s, "drops": drops });
        for time_s in [0.3, 1.0, 2.5] {
            let one = surface(&fields(0.5, 128), depth_m, time_s);
            let three = surface(&fields(1.5, 384), depth_m, time_s);
            let place = |i: i32| -0.49 + 0.02 * f64::from(i);
            for (x, z) in (0..2500).map(|i| (place(i % 50), place(i / 50))) {
                let difference_m = one.at(x, z).height_m - three.at(x, z).height_m;
                assert!(
                    difference_m.abs() < 1e-3,
                    "{depth_m:?} {time_s} {x} {z} {difference_m}"
                );
            }
        }
    }
}

#[test]
fn it_becomes_quiet() {
    let fields = json!({ "samples": 64, "drops": [
        { "position_m": [0.4, 0.1], "radius_m": 0.05, "height_m": 1.0, "at_s": 2.0 }] });
    for depth_m in [Some(0.1), None, Some(1e-3)] {
        assert_eq!(surface(&fields, depth_m, 1.999).max_slope(), 0.0);
        let fallen = surface(&fields, depth_m, 2.0);
        assert!(fallen.max_slope() > 5.0);
        assert!((fallen.at(0.4, 0.1).height_m - 1.0).abs() < 2e-3);
        assert!(surface(&fields, depth_m, 2.3).max_slope() > 0.05);
        assert!(surface(&fields, depth_m, 60.0).max_slope() < 1e-3);
        for time_s in [1e6, 1e9, 1e12] {
            let quiet = surface(&fields, depth_m, time_s);
            assert_eq!(quiet.max_slope(), 0.0, "{depth_m:?} {time_s}");
            assert_eq!(quiet.shortest_wave_m(), f64::INFINITY);
        }
    }
    // Without depth nothing moves.
    let still = |time_s: f64| surface(&fields, Some(0.0), time_s);
    assert!(still(1e12) == still(2.0));
}

#[test]
fn a_drop_in_the_middle_of_a_square_stays_symmetric() {
    for time_s in [0.0, 0.2, 0.9] {
        let fields = json!({ "samples": 64, "drops": [
            { "position_m": [0, 0], "radius_m": 0.05, "height_m": 1.0 }] });
        let surface = surface(&fields, None, time_s);
        for i in 0..200 {
            let (x, z) = (
                (f64::from(i) * 0.618_034) % 0.6,
                (f64::from(i) * 0.754_878) % 0.6,
            );
            let first = surface.at(x, z).height_m;
            for (x, z) in [(z, x), (-x, z), (x, -z), (-z, x)] {
                assert!((surface.at(x, z).height_m - first).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_refined_basin_has_the_same_waves() {
    let fields = json!({ "samples": 64, "drops": [
        { "position_m": [0.3, 0], "radius_m": 0.03, "height_m": 1.0 }] });
    let scene = scene(&fields, Some(0.2), 0.4);
    let (once, thrice) = (surface_of(&scene), refined_surface(&scene, 3));
    for (i, k) in (0..64).flat_map(|i| (0..64).map(move |k| (i, k))) {
        let place = |i: i32| -0.5 + (f64::from(i) + 0.5) / 64.0;
        let difference_m =
            once.at(place(i), place(k)).height_m - thrice.at(place(i), place(k)).height_m;
        assert!(difference_m.abs() < 1e-12);
    }
    assert_eq!(once.shortest_wave_m(), thrice.shortest_wave_m());
}

#[test]
fn the_lost_slope_is_that_of_the_waves_left_out() {
    let lost = |radius_m: f64, samples: u32| {
        let fields = json!({ "samples": samples, "drops": [
            { "position_m": [0, 0], "radius_m": radius_m, "height_m": 3.0 }] });
        let scene = scene(&fields, None, 0.0);
        match &scene.water.waves[0] {
            caustica::scene::Wave::Ripples(ripples) => slope_lost(ripples),
            other => panic!("{other:?}"),
        }
    };
    assert!(lost(0.05, 256) < 1e-12 && lost(1e-4, 64) > 0.999);
    // x = kR = π/2 · R / step: (1 + x²) e^(−x²).
    let x: f64 = (0.5 * PI * 1.5_f64).powi(2);
    assert!((lost(1.5 / 64.0, 64) - (1.0 + x) * (-x).exp()).abs() < 1e-12);
}

#[test]
fn hard_cases_are_finite() {
    for (min_m, max_m) in [
        ([0.0, 0.0], [0.01, 0.01]),
        ([-5e3, 0.0], [5e3, 0.01]),
        ([1e7, -1e7], [1.0001e7, -9.9999e6]),
    ] {
        for (depth_m, damping_per_s) in [
            (None, 0.0),
            (Some(1e-300), 1e-9),
            (Some(11e3), 1000.0),
            (Some(1e-4), 3.0),
        ] {
            for dispersion in ["shallow", "finite_depth"] {
                let fields = json!({ "samples": 17, "min_m": min_m, "max_m": max_m, "damping_per_s": damping_per_s, "dispersion": dispersion,
                    "drops": [
                        { "position_m": min_m, "radius_m": 1e-4, "height_m": 100, "at_s": -1e12 },
                        { "position_m": max_m, "radius_m": 0.01, "height_m": -100, "at_s": 0 },
                        { "position_m": min_m, "radius_m": 0.005, "height_m": 1, "at_s": 0.2 }] });
                for time_s in [-1.0, 0.0, 0.25, 1e9] {
                    let surface = surface(&fields, depth_m, time_s);
                    let point = surface.at(min_m[0], min_m[1]);
                    assert!(point.height_m.is_finite() && point.slope.is_finite());
                    assert!(surface.max_slope().is_finite() && surface.shortest_wave_m() > 0.0);
                    assert!(point.height_m.abs() <= surface.max_height_m());
                }
            }
        }
    }
    // The frequency is that of the test of the integral.
    assert!(angular_frequency_with_surface_tension(100.0, 0.1) > 30.0);
}
