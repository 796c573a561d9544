//! The water surface: slope, shift, time and bounds.

use caustica::physics::dispersion::angular_frequency;
use caustica::scene::Scene;
use caustica::waves::{WaterSurface, normal};
use glam::DVec2;

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
    let surface = WaterSurface::of(&scene(3.7, ""));
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
    let surface = WaterSurface::of(&scene(0.0, ""));
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
    let surface = WaterSurface::of(&scene(1.3, ""));
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
        WaterSurface::of(&scene(0.0, period)),
        WaterSurface::of(&scene(1e6, period)),
    );
    let half = WaterSurface::of(&scene(1e6 + 1.25, period));
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
    let (start, later) = (WaterSurface::of(&scene(0.0)), WaterSurface::of(&scene(2.0)));
    for p in points() {
        let moved = later.at(p.x, p.y + 1.0).height_m;
        assert!((start.at(p.x, p.y).height_m - moved).abs() < 1e-13);
    }
}

#[test]
fn the_period_follows_from_the_depth() {
    let surface = WaterSurface::of(&scene(0.4, ""));
    let still = WaterSurface::of(&scene(0.0, ""));
    for (late, first) in surface.components.iter().zip(&still.components) {
        let k = std::f64::consts::TAU * late.frequency_per_m.length();
        let turns = angular_frequency(k, 2.0) * 0.4 / std::f64::consts::TAU;
        let difference = first.phase_turns - late.phase_turns - turns;
        assert!(
            (difference - difference.round()).abs() < 1e-12,
            "{difference}"
        );
    }
}

#[test]
fn bounds_hold() {
    let surface = WaterSurface::of(&scene(0.9, ""));
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
    let surface = WaterSurface::of(&serde_json::from_str("{}").unwrap());
    assert!(surface.rim_slopes(64).is_empty());
    assert_eq!(surface.max_height_m(), 0.0);
    assert_eq!(surface.max_slope(), 0.0);
    assert_eq!(surface.at(3.0, 4.0).slope, DVec2::ZERO);
}
