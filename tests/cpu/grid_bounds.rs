//! Bounds of water that is computed on a grid, against the surface itself at many points between its samples.

use std::f64::consts::TAU;

use caustica::scene::Scene;
use glam::DVec2;
use serde_json::{Value, json};

use crate::surfaces::surface_of;

/// Each with the side of its tile, m, and the samples along it.
fn waters() -> Vec<(&'static str, Value, [f64; 2], [u32; 2])> {
    let sea = |fields: Value| {
        let mut waves = json!({ "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 8, "tile_m": 50, "samples": 64 });
        for (name, value) in fields.as_object().unwrap() {
            waves[name] = value.clone();
        }
        waves
    };
    let (tile, samples) = ([50.0; 2], [64; 2]);
    vec![
        ("a sea", sea(json!({})), tile, samples),
        (
            "waves in all directions",
            sea(json!({ "spreading": "elfouhaily", "model": "elfouhaily", "seed": 1 })),
            tile,
            samples,
        ),
        (
            "swell, oblique",
            sea(json!({ "swell": 1, "wind_direction_deg": 33, "min_wavelength_m": 9 })),
            tile,
            samples,
        ),
        (
            "the shortest waves only",
            sea(json!({ "max_wavelength_m": 3.2, "wind_direction_deg": 45 })),
            tile,
            samples,
        ),
        // Waves along one direction: of this band the tile has only (1, 0), (0, 1) and their opposites, and no wind along z.
        (
            "one wave",
            sea(json!({ "min_wavelength_m": 49, "spreading": "cos2", "wind_direction_deg": 180 })),
            tile,
            samples,
        ),
        (
            "very low waves",
            sea(json!({ "significant_height_m": 1e-90 })),
            tile,
            samples,
        ),
        (
            "a basin",
            json!({
                "kind": "ripples", "min_m": [0, 0], "max_m": [2.1, 1.3], "samples": 37, "walls": "periodic",
                "drops": [{ "position_m": [0.2, 0.1], "radius_m": 0.15, "height_m": 0.05, "at_s": -0.4 }]
            }),
            [2.1, 1.3],
            [37, 22],
        ),
    ]
}

#[test]
fn bounds_hold_and_are_near() {
    /// Points per sample along each axis; no multiple of 2, so that most are none of those that the bounds are found from.
    const FINER: u32 = 7;
    for (name, waves, tile_m, samples) in waters() {
        let scene: Scene =
            serde_json::from_value(json!({ "water": { "waves": [waves] }, "time_s": 0.3 }))
                .unwrap();
        let surface = surface_of(&scene);
        let directions: Vec<DVec2> = (0..64)
            .map(|i| DVec2::from_angle(TAU * f64::from(i) / 64.0))
            .collect();
        let mut along = vec![0.0_f64; directions.len()];
        let [mut height_m, mut slope, mut second_per_m, mut third_per_m2] = [0.0_f64; 4];
        let step = DVec2::new(
            tile_m[0] / f64::from(samples[0] * FINER),
            tile_m[1] / f64::from(samples[1] * FINER),
        );
        for z in 0..samples[1] * FINER {
            for x in 0..samples[0] * FINER {
                let (x_m, z_m) = (f64::from(x) * step.x, f64::from(z) * step.y);
                let (point, curvature) = surface.curved_at(x_m, z_m);
                height_m = height_m.max(point.height_m.abs());
                slope = slope.max(point.slope.length());
                second_per_m = second_per_m.max(curvature.largest_per_m());
                let (_, beside) = surface.curved_at(x_m + step.x, z_m);
                third_per_m2 =
                    third_per_m2.max((beside.xx_per_m - curvature.xx_per_m).abs() / step.x);
                for (along, u) in along.iter_mut().zip(&directions) {
                    *along = along.max(point.slope.dot(*u));
                }
            }
        }
        let rounding = 1.0 + 1e-12;
        for (what, found, bound, least_share) in [
            ("height", height_m, surface.max_height_m(), 0.8),
            ("slope", slope, surface.max_slope(), 0.8),
            (
                "second",
                second_per_m,
                surface.max_second_derivative_per_m(),
                0.5,
            ),
            (
                "third",
                third_per_m2,
                surface.max_third_derivative_per_m2(),
                0.2,
            ),
        ] {
            assert!(found <= bound * rounding, "{name}: {what} {found} {bound}");
            assert!(
                found >= least_share * bound,
                "{name}: {what} {found} {bound}"
            );
        }
        let rim = surface.rim_slopes(64);
        for ((along, u), rim) in along.iter().zip(&directions).zip(rim) {
            let bound = rim.dot(*u);
            let both = surface.max_slope_along(*u);
            assert!(
                *along <= bound * rounding + 1e-300,
                "{name} {u}: {along} {bound}"
            );
            assert!(bound <= both * rounding, "{name} {u}");
            assert!(both <= surface.max_slope() * rounding, "{name} {u}");
            // Between two of the directions that slopes are searched along, the polygon has corners.
            assert!(
                *along >= 0.8 * bound - 0.1 * slope,
                "{name} {u}: {along} {bound}"
            );
        }
    }
}
