//! Seas, basins and given heights at the ends of their ranges.

use serde_json::{Value, json};

use super::case::Case;
use super::case::Family::Sea;
use super::obj::cuboid;
use super::truths::{flat_error, largest_to_mean, pool, reference_error, sun, with, worst};

const REFERENCE: &str = "relative L1 against the reference";

pub(super) const CASES: &[Case] = &[
    Sea.case(
        "a_sea_without_wind",
        "a peak frequency of 0/0",
        "worst texel against flat water",
        1e-4,
        |b| flat_error(b, over(2.0, 1.0, spectrum(&json!({ "wind_speed_m_s": 0 })))),
    ),
    Sea.case(
        "a_sea_at_30_metres_per_second",
        "windows for heights and slopes that no wave has",
        REFERENCE,
        0.02,
        |b| {
            let waves = spectrum(&json!({ "wind_speed_m_s": 30, "tile_m": 100 }));
            let scene = over(50.0, 25.0, waves);
            reference_error(b, with(scene, &[("/quality/water_cells", json!(512))]))
        },
    ),
    Sea.case(
        "waves_of_four_samples",
        "the shortest waves that samples may have: their slope is 3 % too small",
        "relative L1 against the reference, which has the whole slope; infinite without the warning `waves_smoothed`",
        0.05,
        |b| {
            let waves = spectrum(&json!({
                "tile_m": 16, "samples": 64, "min_wavelength_m": 1, "max_wavelength_m": 1.01, "significant_height_m": 0.08
            }));
            let error = reference_error(b, over(2.0, 1.0, waves))?;
            let is_said = b.was_warned_of("waves_smoothed");
            Ok(if is_said { error } else { f64::INFINITY })
        },
    ),
    Sea.case(
        "waves_of_one_sample",
        "samples that show another wave",
        "0 if the scene is refused at the wave's min_wavelength_m",
        0.0,
        |b| {
            let waves = spectrum(&json!({ "tile_m": 16, "samples": 64, "min_wavelength_m": 0.25 }));
            b.refused_at(over(2.0, 1.0, waves), "/water/waves/0/min_wavelength_m")
        },
    ),
    Sea.case(
        "a_loop_of_one_frame",
        "frequencies rounded to 0, or a loop that does not close",
        "largest difference between two moments a loop apart",
        0.0,
        |b| {
            let at = |time_s: f64| {
                let waves = spectrum(&json!({ "loop_s": 0.0625 }));
                with(over(2.0, 1.0, waves), &[("/time_s", json!(time_s))])
            };
            let first = b.map(at(3.0))?;
            Ok(largest_to_mean(&b.map(at(3.0625))?, &first))
        },
    ),
    Sea.case(
        "a_sea_after_a_billion_seconds",
        "phases with too few digits",
        "largest difference from the first loop, relative to the mean",
        1e-6,
        |b| {
            let at = |time_s: f64| {
                let waves = spectrum(&json!({ "loop_s": 16 }));
                with(over(2.0, 1.0, waves), &[("/time_s", json!(time_s))])
            };
            let first = b.map(at(10.25))?;
            Ok(largest_to_mean(&b.map(at(1e9 + 10.25))?, &first))
        },
    ),
    Sea.case(
        "a_tile_of_a_centimetre",
        "waves of capillaries, steps far below a millimetre",
        REFERENCE,
        0.01,
        |b| {
            let waves = spectrum(&json!({
                "tile_m": 0.01, "samples": 64, "min_wavelength_m": 1e-3, "significant_height_m": 1e-4
            }));
            reference_error(b, over(0.02, 0.005, waves))
        },
    ),
    Sea.case(
        "a_tile_of_10_kilometres",
        "samples farther apart than the map is wide",
        REFERENCE,
        0.01,
        |b| {
            let waves = spectrum(&json!({ "wind_speed_m_s": 20, "fetch_m": 1e6, "tile_m": 1e4, "samples": 512 }));
            reference_error(b, over(1000.0, 500.0, waves))
        },
    ),
    Sea.case(
        "a_drop_on_a_wall",
        "half a mound that is lost or counted twice",
        REFERENCE,
        0.01,
        |b| {
            let drops = json!([{ "position_m": [1.5, 0.2], "radius_m": 0.2, "height_m": 0.04 }]);
            reference_error(b, basin(0.7, drops))
        },
    ),
    Sea.case(
        "drops_before_at_and_after_the_moment",
        "ripples of a drop that has not fallen yet",
        "error against the reference, or the difference that a later drop makes",
        0.01,
        |b| {
            let drop = |x: f64, at_s: f64| json!({ "position_m": [x, 0.1], "radius_m": 0.2, "height_m": 0.03, "at_s": at_s });
            let (before, at, after) = (drop(-0.5, 0.2), drop(0.4, 0.7), drop(0.0, 0.700_001));
            let both = basin(0.7, json!([before, at]));
            let found = b.map(both.clone())?;
            let too_early = largest_to_mean(&b.map(basin(0.7, json!([before, at, after])))?, &found);
            if too_early > 0.0 {
                return Ok(f64::INFINITY);
            }
            reference_error(b, both)
        },
    ),
    Sea.case(
        "a_basin_after_a_billion_seconds",
        "phases with too few digits, in a basin that never comes to rest",
        "error against the reference, or the difference from the same drop at time 0, relative to the mean",
        0.01,
        |b| {
            let fallen = |at_s: f64| json!([{ "position_m": [0.2, 0.1], "radius_m": 0.2, "height_m": 0.03, "at_s": at_s }]);
            let early = b.map(basin(0.5, fallen(0.0)))?;
            let late = b.map(basin(1e9, fallen(1e9 - 0.5)))?;
            let apart = largest_to_mean(&late, &early);
            Ok(worst(reference_error(b, basin(1e9, fallen(0.0)))?, apart))
        },
    ),
    Sea.case(
        "a_drop_on_a_wall_that_absorbs",
        "a layer of damping that starts with a mound in it",
        REFERENCE,
        0.01,
        |b| {
            let drops = json!([{ "position_m": [1.5, 0.2], "radius_m": 0.2, "height_m": 0.04 }]);
            let scene = with(basin(0.7, drops), &[("/water/waves/0/walls", json!("absorbing"))]);
            reference_error(b, scene)
        },
    ),
    Sea.case(
        "quiet_water_behind_a_wall",
        "ripples that pass through an obstacle",
        "largest difference from flat water behind a wall across the basin, relative to the mean",
        1e-3,
        |b| {
            let drops = json!([{ "position_m": [0.2, -0.7], "radius_m": 0.2, "height_m": 0.04 }]);
            let behind = |drops: Value| {
                let mut scene = basin(1.1, drops);
                scene["water"]["waves"][0]["dispersion"] = json!("shallow");
                scene["water"]["waves"][0]["obstacles"] = json!([0]);
                with(
                    scene,
                    &[
                        ("/objects", json!([{ "mesh": cuboid([4.0, 0.4, 0.2]) }])),
                        ("/lights/0", sun(90.0, 0.0)),
                        ("/output/min_m", json!([-1.0, 0.4])),
                        ("/output/max_m", json!([1.0, 1.4])),
                    ],
                )
            };
            let still = b.map(behind(json!([])))?;
            Ok(largest_to_mean(&b.map(behind(drops))?, &still))
        },
    ),
    Sea.case(
        "heights_that_jump_from_sample_to_sample",
        "bounds of slopes that a spline exceeds between its samples",
        REFERENCE,
        0.02,
        |b| reference_error(b, field(&noise(48), &json!({ "sample_m": 0.08 }))),
    ),
    Sea.case(
        "heights_ten_thousand_kilometres_away",
        "places of samples in f32",
        "largest difference from the same heights at the origin, relative to the mean",
        1e-5,
        |b| {
            let at = |x_m: f64| {
                let scene = field(&noise(48), &json!({ "sample_m": 0.125, "min_m": [x_m - 3.0, -3.0] }));
                with(
                    scene,
                    &[
                        ("/floor/center_m", json!([x_m, 0])),
                        ("/output/min_m", json!([x_m - 1.0, -1.0])),
                        ("/output/max_m", json!([x_m + 1.0, 1.0])),
                    ],
                )
            };
            let here = b.map(at(0.0))?;
            Ok(largest_to_mean(&b.map(at(1e7))?, &here))
        },
    ),
    Sea.case(
        "heights_with_one_that_is_no_number",
        "a hole in the water, or light that is not a number",
        "0 if the scene is refused at the frame",
        0.0,
        |b| {
            let mut heights = noise(48);
            heights[20][31] = Value::Null;
            b.refused_at(field(&heights, &json!({ "sample_m": 0.08 })), "/water/waves/0/frames/0")
        },
    ),
    Sea.case(
        "heights_of_one_sample",
        "a spline without a second point",
        "0 if the scene is refused at the frame",
        0.0,
        |b| b.refused_at(field(&json!([[0.1]]), &json!({ "sample_m": 0.08 })), "/water/waves/0/frames/0"),
    ),
];

/// Heights of ±2 mm, `side` × `side`, that follow no pattern.
fn noise(side: u64) -> Value {
    let mut state = 1_u64;
    let row = |_| {
        let heights = (0..side).map(|_| {
            // Source of the constants: Knuth, MMIX.
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) as f64 / f64::from(1 << 24) - 0.5) * 4e-3
        });
        heights.collect::<Vec<f64>>()
    };
    json!((0..side).map(row).collect::<Vec<_>>())
}

/// The pool under these heights, with other values for some fields.
fn field(heights: &Value, fields: &Value) -> Value {
    let mut waves = json!({ "kind": "height_field", "frames": [heights] });
    for (name, value) in fields.as_object().into_iter().flatten() {
        waves[name] = value.clone();
    }
    over(2.0, 1.0, json!([waves]))
}

/// A floor at `depth_m` under these waves, its map over the middle `half_m` to each side.
fn over(depth_m: f64, half_m: f64, waves: Value) -> Value {
    with(
        pool(),
        &[
            ("/water/waves", waves),
            ("/floor/depth_m", json!(depth_m)),
            ("/floor/size_m", json!([1e3 * half_m, 1e3 * half_m])),
            ("/output/min_m", json!([-half_m, -half_m])),
            ("/output/max_m", json!([half_m, half_m])),
            ("/quality/water_cells", json!(256)),
        ],
    )
}

/// A JONSWAP sea, with other values for some fields.
fn spectrum(fields: &Value) -> Value {
    let mut waves = json!({
        "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 5, "fetch_m": 20_000, "tile_m": 20, "samples": 256, "seed": 7
    });
    for (name, value) in fields.as_object().into_iter().flatten() {
        waves[name] = value.clone();
    }
    json!([waves])
}

/// The pool under a basin of 3 m × 3 m with these drops.
#[expect(
    clippy::needless_pass_by_value,
    reason = "a literal is shorter without a reference"
)]
fn basin(time_s: f64, drops: Value) -> Value {
    let waves = json!([{
        "kind": "ripples", "min_m": [-1.5, -1.5], "max_m": [1.5, 1.5], "samples": 128, "drops": drops
    }]);
    with(over(2.0, 1.0, waves), &[("/time_s", json!(time_s))])
}
