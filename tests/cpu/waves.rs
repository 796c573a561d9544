//! The water surface: slope, curvature, rows, recentring, time, bounds, and the data for the GPU.

use caustica::physics::dispersion::angular_frequency;
use caustica::scene::{Scene, SineWave, Wave};
use caustica::waves::{ROW_POINTS, RowPoints, Surface, SurfacePoint, normal};
use glam::DVec2;

use crate::surfaces::surface_of;

fn scene(time_s: f64, period: &str) -> Scene {
    serde_json::from_str(&format!(
        r#"{{
            "water": {{ "waves": [
                {{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 1.3, "direction_deg": 20, "phase_deg": 23 {period} }},
                {{ "kind": "sine", "amplitude_m": 0.015, "wavelength_m": 0.8, "direction_deg": 100, "phase_deg": 97 {period} }},
                {{ "kind": "sine", "amplitude_m": 0.006, "wavelength_m": 0.5, "direction_deg": -35, "phase_deg": 166 {period} }}
            ] }},
            "floor": {{ "depth_m": 2, "size_m": [8, 8] }},
            "time_s": {time_s}
        }}"#
    ))
    .unwrap()
}

fn sines(scene: &Scene) -> Vec<&SineWave> {
    let waves = scene.water.waves.iter();
    waves
        .filter_map(|wave| match wave {
            Wave::Sine(sine) => Some(sine),
            _ => None,
        })
        .collect()
}

fn points() -> impl Iterator<Item = DVec2> {
    (0..400).map(|i| {
        let i = f64::from(i);
        DVec2::new(
            (i * 0.618_034).fract() * 9.0 - 4.0,
            (i * 0.754_878).fract() * 7.0 - 3.0,
        )
    })
}

#[test]
fn slope_is_the_derivative_of_height() {
    let surface = surface_of(&scene(3.7, ""));
    let h = 1e-5;
    for p in points() {
        let point = surface.at(p.x, p.y);
        let along = |d: DVec2| {
            (surface.at(p.x + d.x, p.y + d.y).height_m - surface.at(p.x - d.x, p.y - d.y).height_m)
                / (2.0 * h)
        };
        let numeric = DVec2::new(along(DVec2::X * h), along(DVec2::Y * h));
        assert!(
            (numeric - point.slope).length() < 1e-8,
            "{p}: {numeric} {}",
            point.slope
        );
    }
}

#[test]
fn the_normal_is_across_both_tangents() {
    let surface = surface_of(&scene(0.0, ""));
    for p in points() {
        let point = surface.at(p.x, p.y);
        let n = normal(point);
        assert!((n.length() - 1.0).abs() < 1e-15 && n.y > 0.0);
        assert!((n.x + n.y * point.slope.x).abs() < 1e-15);
        assert!((n.z + n.y * point.slope.y).abs() < 1e-15);
    }
}

#[test]
fn a_recentred_surface_is_the_shifted_one() {
    let surface = surface_of(&scene(1.3, ""));
    for origin in [
        DVec2::new(0.3, -7.1),
        DVec2::new(-1234.5, 4321.25),
        DVec2::new(1e6, -3e5),
    ] {
        let recentred = surface.recentred(origin);
        // Turns near 10⁶ hold 10⁻¹⁰ of a turn.
        let tolerance = 1e-13 + 3e-15 * origin.length();
        for p in points() {
            let (a, b) = (
                recentred.at(p.x, p.y),
                surface.at(origin.x + p.x, origin.y + p.y),
            );
            assert!((a.height_m - b.height_m).abs() < tolerance, "{origin} {p}");
            assert!(
                (a.slope - b.slope).length() < 20.0 * tolerance,
                "{origin} {p}"
            );
        }
    }
}

#[test]
fn whole_periods_change_nothing_even_after_a_million_seconds() {
    let period = r#", "period_s": 2.5"#;
    let (start, late) = (
        surface_of(&scene(0.0, period)),
        surface_of(&scene(1e6, period)),
    );
    let half = surface_of(&scene(1e6 + 1.25, period));
    for p in points() {
        let (a, b, c) = (start.at(p.x, p.y), late.at(p.x, p.y), half.at(p.x, p.y));
        assert!((a.height_m - b.height_m).abs() < 1e-10, "{p}");
        assert!((a.slope - b.slope).length() < 1e-9, "{p}");
        assert!(
            (a.height_m + c.height_m).abs() < 1e-10,
            "half a period must turn crests into troughs"
        );
    }
}

#[test]
fn waves_run_where_they_point() {
    // A crest moves by a wavelength per period towards the wave's direction.
    let scene = |time_s: f64| {
        serde_json::from_str::<Scene>(&format!(
            r#"{{ "water": {{ "waves": [{{ "kind": "sine", "amplitude_m": 1, "wavelength_m": 4, "direction_deg": 90, "period_s": 8 }}] }}, "time_s": {time_s} }}"#
        ))
        .unwrap()
    };
    let (start, later) = (surface_of(&scene(0.0)), surface_of(&scene(2.0)));
    for p in points() {
        let moved = later.at(p.x, p.y + 1.0).height_m;
        assert!((start.at(p.x, p.y).height_m - moved).abs() < 1e-13);
    }
}

/// Phase, in turns, of a surface that is a single sine of this amplitude, wavelength and direction.
fn phase_turns(surface: &Surface, wave: &SineWave) -> f64 {
    let SurfacePoint { height_m, slope } = surface.at(0.0, 0.0);
    let along = slope.dot(DVec2::from_angle(wave.direction_deg.to_radians()));
    let quarter_later = along * wave.wavelength_m / std::f64::consts::TAU;
    height_m.atan2(quarter_later) / std::f64::consts::TAU
}

#[test]
fn the_period_follows_from_the_depth() {
    let (late, still) = (scene(0.4, ""), scene(0.0, ""));
    for wave in sines(&late) {
        let alone = |scene: &Scene| {
            let mut scene = scene.clone();
            scene.water.waves = vec![Wave::Sine(wave.clone())];
            phase_turns(&surface_of(&scene), wave)
        };
        let k = std::f64::consts::TAU / wave.wavelength_m;
        let turns = angular_frequency(k, 2.0) * 0.4 / std::f64::consts::TAU;
        let difference = alone(&still) - alone(&late) - turns;
        assert!(
            (difference - difference.round()).abs() < 1e-12,
            "{difference}"
        );
    }
}

#[test]
fn rows_and_curved_points_are_those_of_single_points() {
    let surface = surface_of(&scene(5.1, ""));
    let near = |a: SurfacePoint, b: SurfacePoint| {
        (a.height_m - b.height_m).abs() < 1e-14 && (a.slope - b.slope).length() < 1e-13
    };
    for (p, step_m) in points().zip(points().map(|p| p * 0.003)) {
        let mut row = RowPoints::FLAT;
        surface.rows(step_m).evaluate(p, &mut row);
        for i in 0..ROW_POINTS {
            let at = p + step_m * i as f64;
            let got = SurfacePoint {
                height_m: row.height_m[i],
                slope: DVec2::new(row.slope_x[i], row.slope_z[i]),
            };
            assert!(near(got, surface.at(at.x, at.y)), "{p} {step_m} {i}");
        }
        let (curved, _) = surface.curved_at(p.x, p.y);
        assert!(near(curved, surface.at(p.x, p.y)), "{p}");
    }
}

#[test]
fn curvature_is_the_derivative_of_slope_and_keeps_to_its_bounds() {
    let surface = surface_of(&scene(2.2, ""));
    let h = 1e-5;
    let (mut most_bend, mut most_twist) = (0.0f64, 0.0f64);
    for p in points() {
        let slope = |d: DVec2| surface.at(p.x + d.x, p.y + d.y).slope;
        let along_x = (slope(DVec2::X * h) - slope(DVec2::NEG_X * h)) / (2.0 * h);
        let along_z = (slope(DVec2::Y * h) - slope(DVec2::NEG_Y * h)) / (2.0 * h);
        let (_, curvature) = surface.curved_at(p.x, p.y);
        for (got, numeric) in [
            (curvature.xx_per_m, along_x.x),
            (curvature.xz_per_m, along_x.y),
            (curvature.xz_per_m, along_z.x),
            (curvature.zz_per_m, along_z.y),
        ] {
            assert!((got - numeric).abs() < 1e-7, "{p}: {got} {numeric}");
        }
        let bend = curvature.largest_per_m();
        assert!(bend <= surface.max_second_derivative_per_m());
        most_bend = most_bend.max(bend);
        for i in 0..16 {
            let u = DVec2::from_angle(std::f64::consts::PI * f64::from(i) / 16.0);
            let along = |at: DVec2| {
                let (_, c) = surface.curved_at(at.x, at.y);
                c.xx_per_m * u.x * u.x + 2.0 * c.xz_per_m * u.x * u.y + c.zz_per_m * u.y * u.y
            };
            assert!(along(p).abs() <= bend + 1e-12, "{p} {u}");
            let twist = (along(p + u * h) - along(p - u * h)).abs() / (2.0 * h);
            assert!(twist <= surface.max_third_derivative_per_m2() + 1e-6);
            most_twist = most_twist.max(twist);
        }
    }
    // The bounds must not be idle.
    assert!(most_bend > 0.5 * surface.max_second_derivative_per_m());
    assert!(most_twist > 0.5 * surface.max_third_derivative_per_m2());
}

#[test]
fn the_gpu_gets_the_waves_of_its_shaders() {
    let scene = scene(0.0, r#", "period_s": 2.5"#);
    let surface = surface_of(&scene);
    let elements = surface.gpu_elements();
    assert_eq!(elements.len(), 1 + scene.water.waves.len());
    assert_eq!(elements.len(), surface.gpu_element_count());
    assert_eq!(elements[0], [3.0, 0.0, 0.0, 0.0]);
    for (gpu, wave) in elements[1..].iter().zip(sines(&scene)) {
        let per_m = DVec2::from_angle(wave.direction_deg.to_radians()) / wave.wavelength_m;
        let turns = wave.phase_deg / 360.0;
        for (got, expected) in [
            (gpu[0], wave.amplitude_m),
            (gpu[1], per_m.x),
            (gpu[2], per_m.y),
            (gpu[3], turns - turns.round()),
        ] {
            assert!((f64::from(got) - expected).abs() < 1e-6, "{gpu:?}");
        }
    }
}

#[test]
fn water_is_described_by_its_kind() {
    let flat = surface_of(&serde_json::from_str("{}").unwrap());
    assert_eq!(flat.description(), "flat water");
    let waves = surface_of(&scene(0.0, ""));
    assert_eq!(waves.description(), "water with 3 wave components");
}

#[test]
fn bounds_hold() {
    let surface = surface_of(&scene(0.9, ""));
    let rim = surface.rim_slopes(64);
    assert_eq!(rim.len(), 64);
    let mut highest = 0.0f64;
    for p in points() {
        let point = surface.at(p.x, p.y);
        highest = highest.max(point.height_m.abs());
        assert!(point.height_m.abs() <= surface.max_height_m());
        assert!(point.slope.length() <= surface.max_slope());
        for (i, rim_slope) in rim.iter().enumerate() {
            let u = DVec2::from_angle(std::f64::consts::TAU * i as f64 / 64.0);
            assert!(point.slope.dot(u) <= rim_slope.dot(u) + 1e-12, "{p} {u}");
            assert!((rim_slope.dot(u) - surface.max_slope_along(u)).abs() < 1e-12);
        }
    }
    assert!(
        highest > 0.5 * surface.max_height_m(),
        "the bound must not be idle"
    );
}

#[test]
fn flat_water_has_no_rim() {
    let surface = surface_of(&serde_json::from_str("{}").unwrap());
    assert!(surface.rim_slopes(64).is_empty());
    assert_eq!(surface.max_height_m(), 0.0);
    assert_eq!(surface.max_slope(), 0.0);
    assert_eq!(surface.at(3.0, 4.0).slope, DVec2::ZERO);
}

fn gerstner(fields: &str) -> Scene {
    serde_json::from_str(&format!(
        r#"{{ "water": {{ "waves": [{{ "kind": "gerstner", "amplitude_m": 0.05, "wavelength_m": 1.2, {fields} }}] }} }}"#
    ))
    .unwrap()
}

/// Points of the trochoid x = (α − s sin α)/k, h = A cos α + ½ s A lie on the surface, with its slope −A k sin α/(1 − s cos α).
#[test]
fn gerstner_waves_are_trochoids() {
    for (steepness, direction_deg) in [(0.0, 0.0), (0.3, 40.0), (0.8, -130.0), (0.95, 90.0)] {
        let fields = format!(
            r#""steepness": {steepness}, "direction_deg": {direction_deg}, "phase_deg": 30"#
        );
        let surface = surface_of(&gerstner(&fields));
        let (amplitude_m, k) = (0.05, std::f64::consts::TAU / 1.2);
        let along = DVec2::from_angle(f64::to_radians(direction_deg));
        let mut mean = 0.0;
        for i in 0..720 {
            let alpha = f64::from(i).to_radians() * 0.5 - 3.0;
            let x = (alpha - steepness * alpha.sin() - 30_f64.to_radians()) / k;
            let p = along * x + along.perp() * f64::from(i);
            let (point, _) = surface.curved_at(p.x, p.y);
            let height_m = amplitude_m * (alpha.cos() + 0.5 * steepness);
            assert!((point.height_m - height_m).abs() < 1e-12, "{steepness} {i}");
            let slope = -amplitude_m * k * alpha.sin() / (1.0 - steepness * alpha.cos());
            assert!(
                (point.slope - along * slope).length() < 1e-10,
                "{steepness} {i}"
            );
            assert_eq!(surface.at(p.x, p.y), point);
            mean += height_m * (1.0 - steepness * alpha.cos()) / 720.0;
        }
        assert!(mean.abs() < 1e-15, "{mean}");
        assert!(surface.max_height_m() >= amplitude_m * (1.0 + 0.5 * steepness));
        let steepest = amplitude_m * k / (1.0 - steepness * steepness).sqrt();
        assert!((surface.max_slope() / steepest - 1.0).abs() < 1e-12);
    }
    // Without a steepness, points move on circles: s = k A. With 0 it is a sine.
    let (plain, sine) = (
        surface_of(&gerstner(r#""phase_deg": 0"#)),
        surface_of(&gerstner(r#""steepness": 0"#)),
    );
    let k_a = std::f64::consts::TAU * 0.05 / 1.2;
    assert!((plain.at(0.0, 0.0).height_m - 0.05 * (1.0 + 0.5 * k_a)).abs() < 1e-12);
    assert!(
        (sine.at(0.2, 0.0).height_m - 0.05 * (std::f64::consts::TAU / 6.0).cos()).abs() < 1e-12
    );
}

#[test]
fn gerstner_waves_run_and_keep_to_their_bounds() {
    let at = |time_s: f64| {
        let mut scene = gerstner(r#""steepness": 0.9, "period_s": 2, "direction_deg": 20"#);
        scene.time_s = time_s;
        surface_of(&scene)
    };
    let (start, quarter, later) = (at(0.0), at(0.5), at(1e9 + 0.5));
    let along = DVec2::from_angle(20_f64.to_radians()) * 0.3;
    let h = 1e-5;
    for p in points() {
        let moved = start.at(p.x - along.x, p.y - along.y).height_m;
        assert!((quarter.at(p.x, p.y).height_m - moved).abs() < 1e-12);
        assert!((later.at(p.x, p.y).height_m - moved).abs() < 1e-9);
        let (point, curvature) = start.curved_at(p.x, p.y);
        let slope = |d: DVec2| start.at(p.x + d.x, p.y + d.y).slope;
        let numeric = (slope(DVec2::X * h) - slope(DVec2::NEG_X * h)) / (2.0 * h);
        // Third derivatives reach 10⁵/m² at the crests.
        assert!(
            (numeric.x - curvature.xx_per_m).abs() < 1e-3 * start.max_second_derivative_per_m()
        );
        assert!(curvature.largest_per_m() <= start.max_second_derivative_per_m() * (1.0 + 1e-12));
        assert!(point.height_m.abs() <= start.max_height_m());
        assert!(point.slope.length() <= start.max_slope());
        let recentred = start.recentred(DVec2::new(1e6, -2e6) + p).at(-1e6, 2e6);
        assert!((recentred.height_m - point.height_m).abs() < 1e-7);
    }
}
