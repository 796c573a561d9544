//! The same scene in another place, smaller and larger.

use serde_json::{Value, json};

use super::bench::Bench;
use super::case::Family::Place;
use super::case::{Case, Failure};
use super::truths::{largest_to_mean, pool, sun, with};

const MOVED: &str = "largest difference from the scene at the origin, relative to the mean";
const SCALED: &str = "largest difference from the scene of ordinary size, relative to the mean";

pub(super) const CASES: &[Case] = &[
    Place.case(
        "moved_by_100_km",
        "f32 positions far from the origin",
        MOVED,
        1e-4,
        |b| {
            let here = b.map(scene(1.0, [0.0, 0.0], 0.0))?;
            let there = b.map(scene(1.0, [1e5, -1e5], 0.0))?;
            Ok(largest_to_mean(&there, &here))
        },
    ),
    Place.case(
        "lifted_by_100_km",
        "f32 heights far from the origin",
        MOVED,
        1e-4,
        |b| {
            let here = b.map(scene(1.0, [0.0, 0.0], 0.0))?;
            let there = b.map(scene(1.0, [0.0, 0.0], 1e5))?;
            Ok(largest_to_mean(&there, &here))
        },
    ),
    Place.case(
        "a_thousandth_of_the_size",
        "tolerances that are fixed in metres",
        SCALED,
        1e-4,
        |b| scaled(b, 1e-3),
    ),
    Place.case(
        "a_thousand_times_the_size",
        "tolerances that are fixed in metres",
        SCALED,
        1e-4,
        |b| scaled(b, 1e3),
    ),
];

fn scaled(bench: &mut Bench<'_>, scale: f64) -> Result<f64, Failure> {
    let metres = bench.map(scene(1.0, [0.0, 0.0], 0.0))?;
    let other = bench.map(scene(scale, [0.0, 0.0], 0.0))?;
    Ok(largest_to_mean(&other, &metres))
}

/// A pool with waves, absorption and a box in it, `scale` times as large, its middle at `moved_m`, its water at `level_m`.
fn scene(scale: f64, moved_m: [f64; 2], level_m: f64) -> Value {
    let wave = |amplitude: f64, wavelength: f64, direction_deg: f64, phase_deg: f64| {
        let (sin, cos) = direction_deg.to_radians().sin_cos();
        let turns = (moved_m[0] * cos + moved_m[1] * sin) / (wavelength * scale);
        json!({
            "kind": "sine", "amplitude_m": amplitude * scale, "wavelength_m": wavelength * scale,
            "direction_deg": direction_deg, "phase_deg": (phase_deg - 360.0 * turns.rem_euclid(1.0)),
        })
    };
    let at = |x: f64, z: f64| json!([moved_m[0] + x * scale, moved_m[1] + z * scale]);
    with(
        pool(),
        &[
            (
                "/water/waves",
                json!([wave(0.02, 1.3, 0.0, 23.0), wave(0.012, 1.1, 90.0, 97.0)]),
            ),
            ("/water/level_m", json!(level_m)),
            (
                "/water/absorption_per_m",
                json!([0.35 / scale, 0.07 / scale, 0.03 / scale]),
            ),
            ("/floor/depth_m", json!(2.0 * scale)),
            ("/floor/size_m", json!([40.0 * scale, 40.0 * scale])),
            ("/floor/center_m", at(0.0, 0.0)),
            ("/lights/0", sun(60.0, 30.0)),
            ("/output/min_m", at(-1.0, -1.0)),
            ("/output/max_m", at(1.0, 1.0)),
            (
                "/objects",
                json!([{
                    "mesh": super::obj::cuboid([1.0, 1.0, 1.0]), "scale": 0.4 * scale,
                    "translation_m": [moved_m[0], level_m - scale, moved_m[1]],
                }]),
            ),
        ],
    )
}
