//! Flat, tiny and steep waves, depths, indices, times, absorption.

use serde_json::{Value, json};

use super::bench::{Bench, reported_w};
use super::case::Family::Water;
use super::case::{Case, Failure};
use super::truths::{
    flat_error, largest_relative, largest_to_mean, pool, reference_error, sun, waves, with, worst,
};
use super::unfollowed::{flux_below_floor_w, flux_leaving_again_w, flux_turned_away_w};
use crate::render::RenderError;

const CLOSED_FORM: &str = "worst texel against E cos θ T e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";
const PERIOD: &str = "largest difference between moments a whole number of periods apart, one of them in the first period, relative to the mean";
const PHASE: &str = "phases in f32, or too few digits in the time";
const AGAIN: &str =
    "rays that would meet the water again, large sideways drift, slopes that face away";

pub(super) const CASES: &[Case] = &[
    Water.case(
        "flat_water",
        "0/0 in windows and slopes",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, pool()),
    ),
    Water.case(
        "ripples_of_a_millimetre",
        "waves far smaller than a cell, heights below the rounding of metres",
        REFERENCE,
        0.01,
        ripples,
    ),
    Water.case("slopes_of_1", AGAIN, REFERENCE, 0.01, |b| {
        reference_error(b, steep(1.0))
    }),
    Water.case("slopes_of_5", AGAIN, REFERENCE, 0.03, |b| {
        reference_error(b, steep(5.0))
    }),
    Water.case("slopes_of_20", AGAIN, REFERENCE, 0.1, |b| {
        reference_error(b, steep(20.0))
    }),
    Water.case(
        "steep_waves_are_warned_of",
        "a limit of the model without a warning",
        "0 if the warning `waves_shade_waves` is present",
        0.0,
        |b| {
            b.map(with(steep(5.0), &[("/lights/0", sun(30.0, 0.0))]))?;
            Ok(f64::from(u8::from(!b.was_warned_of("waves_shade_waves"))))
        },
    ),
    Water.case(
        "light_that_leaves_the_water_again",
        "a missing warning, or one with the wrong flux",
        "largest relative difference between the warning's flux and that of f64 rays; 0 where neither has any",
        0.02,
        |b| {
            let mut worst_so_far = 0.0_f64;
            for (slope, elevation_deg) in [(1.0, 90.0), (5.0, 90.0), (20.0, 90.0), (3.0, 40.0)] {
                let scene = with(steep(slope), &[("/lights/0", sun(elevation_deg, 75.0))]);
                let resolved = b.scene(scene)?;
                let facts = crate::methods::facts(&resolved).map_err(RenderError::from)?;
                let due_w = flux_leaving_again_w(&facts);
                let frame = b.render_resolved(&resolved)?;
                let reported_w = reported_w(&frame, "light_leaves_water_again");
                worst_so_far = worst(worst_so_far, (reported_w - due_w).abs() / due_w.max(1e-9));
            }
            Ok(worst_so_far)
        },
    ),
    Water.case(
        "slopes_that_look_away",
        "light counted twice without a warning",
        "relative difference between the warning's flux and that of the slopes in f64",
        0.01,
        |b| {
            let resolved = b.scene(with(steep(2.0), &[("/lights/0", sun(30.0, 20.0))]))?;
            let facts = crate::methods::facts(&resolved).map_err(RenderError::from)?;
            let due_w = flux_turned_away_w(&facts);
            let frame = b.render_resolved(&resolved)?;
            Ok((reported_w(&frame, "waves_shade_waves") / due_w - 1.0).abs())
        },
    ),
    Water.case(
        "troughs_below_the_floor",
        "light that enters below the floor but still lands on it",
        "relative difference between the warning's flux and that over the bare floor in f64, or the share that misses the floor",
        0.02,
        |b| {
            let resolved = b.scene(with(steep(0.5), &[("/floor/depth_m", json!(0.05))]))?;
            let facts = crate::methods::facts(&resolved).map_err(RenderError::from)?;
            let due_w = flux_below_floor_w(&facts);
            let frame = b.render_resolved(&resolved)?;
            let reported_w = reported_w(&frame, "waves_bare_floor");
            let missed: f64 = frame.stats.energy.iter().map(|a| a.missed_w[0] / a.emitted_w[0]).sum();
            Ok(worst((reported_w / due_w - 1.0).abs(), missed))
        },
    ),
    Water.case(
        "floor_at_depth_0",
        "rays of length 0",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, with(pool(), &[("/floor/depth_m", json!(0))])),
    ),
    Water.case(
        "floor_at_a_tenth_of_a_millimetre",
        "rays of almost no length",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, with(pool(), &[("/floor/depth_m", json!(1e-4))])),
    ),
    Water.case(
        "floor_at_11000_metres",
        "f32 positions at great depth",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, with(pool(), &[("/floor/depth_m", json!(11_000))])),
    ),
    Water.case(
        "waves_over_11000_metres",
        "gentle slopes that move light by hundreds of metres",
        REFERENCE,
        0.01,
        |b| {
            let scene = with(
                pool(),
                &[
                    ("/floor/depth_m", json!(11_000)),
                    ("/floor/size_m", json!([1e6, 1e6])),
                    ("/output/min_m", json!([-4e3, -4e3])),
                    ("/output/max_m", json!([4e3, 4e3])),
                    (
                        "/water/waves",
                        json!([{ "kind": "sine", "amplitude_m": 100, "wavelength_m": 4000.0, "direction_deg": 20 }]),
                    ),
                ],
            );
            reference_error(b, scene)
        },
    ),
    Water.case(
        "index_1",
        "waves that must have no effect",
        "worst texel against an evenly lit floor",
        2e-5,
        |b| {
            let map = b.map(wavy(1.0))?;
            let even = 60_f64.to_radians().sin();
            Ok(map
                .as_flattened()
                .iter()
                .map(|v| (v / even - 1.0).abs())
                .fold(0.0, worst))
        },
    ),
    Water.case(
        "index_1_0001",
        "differences of nearly equal directions",
        REFERENCE,
        5e-3,
        |b| reference_error(b, wavy(1.0001)),
    ),
    Water.case("index_2_4", "strong refraction", REFERENCE, 0.01, |b| {
        reference_error(b, wavy(2.4))
    }),
    Water.case(
        "index_below_1",
        "total reflection of light that enters the water",
        "0 if the scene is refused at /water/ior",
        0.0,
        |b| b.refused_at(wavy(0.9), "/water/ior"),
    ),
    Water.case("a_period_after_0", PHASE, PERIOD, 1e-5, |b| period(b, 0.0)),
    Water.case(
        "a_period_after_a_million_seconds",
        PHASE,
        PERIOD,
        1e-5,
        |b| period(b, 1e6),
    ),
    Water.case(
        "a_period_after_a_billion_seconds",
        PHASE,
        PERIOD,
        1e-5,
        |b| period(b, 1e9),
    ),
    Water.case(
        "a_period_before_minus_a_million_seconds",
        PHASE,
        PERIOD,
        1e-5,
        |b| period(b, -1e6),
    ),
    Water.case(
        "absorption_of_a_billionth",
        "a truncated series of e^x − 1",
        CLOSED_FORM,
        1e-4,
        |b| {
            flat_error(
                b,
                with(
                    pool(),
                    &[("/water/absorption_per_m", json!([1e-9, 0, 1e-9]))],
                ),
            )
        },
    ),
    Water.case(
        "absorption_of_1000_per_metre",
        "underflow of e^(−cd)",
        CLOSED_FORM,
        1e-4,
        |b| {
            flat_error(
                b,
                with(pool(), &[("/water/absorption_per_m", json!([1000, 0, 1]))]),
            )
        },
    ),
    Water.case(
        "scattering_of_1_per_metre",
        "scattered light that is missing in the account",
        CLOSED_FORM,
        1e-4,
        |b| {
            flat_error(
                b,
                with(
                    pool(),
                    &[
                        ("/water/absorption_per_m", json!([0.3, 0.1, 0.02])),
                        ("/water/scattering_per_m", json!([1, 0.5, 0])),
                    ],
                ),
            )
        },
    ),
    Water.case(
        "waves_that_cancel",
        "residues of phases and directions that should be 0",
        "largest difference from flat water, relative to the mean",
        2e-5,
        |b| {
            let one = |direction: f64, phase: f64| json!({ "kind": "sine", "amplitude_m": 0.05, "wavelength_m": 0.9, "direction_deg": direction, "phase_deg": phase });
            // The same crests from the other side are the same wave backwards: −sin(−x) cancels only with its own phase.
            let cancelling = json!([
                one(30.0, 0.0),
                one(30.0, 180.0),
                one(390.0, 77.0),
                one(-330.0, 257.0)
            ]);
            let found = b.map(with(pool(), &[("/water/waves", cancelling)]))?;
            let flat = b.map(pool())?;
            Ok(largest_to_mean(&found, &flat))
        },
    ),
    Water.case(
        "a_line_focus_on_the_floor",
        "footprints that collapse to segments",
        REFERENCE,
        5e-3,
        |b| reference_error(b, focus(&[0.0])),
    ),
    Water.case(
        "a_point_focus_on_the_floor",
        "footprints that collapse to points",
        REFERENCE,
        0.02,
        |b| reference_error(b, focus(&[0.0, 90.0])),
    ),
];

/// Ripples of a tenth of a micrometre, whose crests focus at a depth of a metre, over a map that resolves them, and over one that does
/// not. The latter has a warning, and as the ripples move light by 0.42 mm, no texel of 62.5 mm may gain or lose more than twice that.
fn ripples(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let coarse = with(
        pool(),
        &[(
            "/water/waves",
            json!([{ "kind": "sine", "amplitude_m": 1e-7, "wavelength_m": 1e-3 }]),
        )],
    );
    let fine = with(
        coarse.clone(),
        &[
            ("/quality/water_cells", json!(512)),
            ("/output/min_m", json!([-4e-3, -4e-3])),
            ("/output/max_m", json!([4e-3, 4e-3])),
            ("/output/width", json!(64)),
            ("/output/height", json!(8)),
        ],
    );
    let error = reference_error(bench, fine)?;
    let aside = largest_relative(&bench.map(coarse)?, &bench.map(pool())?);
    let is_near = aside <= 2.0 * 0.42 / 62.5;
    if !is_near {
        return Err(Failure::Check(format!(
            "ripples change a texel by {aside:e}"
        )));
    }
    if !bench.was_warned_of("waves_undersampled") {
        return Err(Failure::Check(
            "waves of less than a cell have no warning".to_owned(),
        ));
    }
    Ok(error)
}

fn wavy(ior: f64) -> Value {
    with(
        pool(),
        &[
            ("/water/waves", waves()),
            ("/water/ior", json!(ior)),
            ("/quality/water_cells", json!(256)),
        ],
    )
}

/// One sine of this steepest slope under the zenith.
fn steep(slope: f64) -> Value {
    with(
        pool(),
        &[
            (
                "/water/waves",
                json!([{ "kind": "sine", "amplitude_m": slope / std::f64::consts::TAU, "wavelength_m": 1.0, "direction_deg": 20 }]),
            ),
            ("/floor/depth_m", json!(5)),
            ("/lights/0", sun(90.0, 0.0)),
            ("/quality/water_cells", json!(512)),
        ],
    )
}

/// Sines whose crests focus a sun in the zenith on the floor at 2 m: f = 1/(A k² (1 − 1/n)).
fn focus(directions_deg: &[f64]) -> Value {
    let k = std::f64::consts::TAU;
    let amplitude_m = 1.0 / (2.0 * k * k * (1.0 - 1.0 / 1.333));
    let waves: Vec<Value> = directions_deg
        .iter()
        .map(|direction| {
            json!({ "kind": "sine", "amplitude_m": amplitude_m, "wavelength_m": 1.0, "direction_deg": direction, "phase_deg": 90 })
        })
        .collect();
    with(
        pool(),
        &[
            ("/water/waves", Value::Array(waves)),
            ("/lights/0", sun(90.0, 0.0)),
            ("/quality/water_cells", json!(256)),
        ],
    )
}

/// Two moments a period apart, and the moment of the first period with the same waves. The third is needed because a clock that has lost
/// its last digits is wrong by the same amount at the first two.
fn period(bench: &mut Bench<'_>, time_s: f64) -> Result<f64, Failure> {
    let at = |time_s: f64| {
        let mut waves = waves();
        // Both have the same period, of a length that f64 holds exactly at any of the times.
        for wave in waves.as_array_mut().into_iter().flatten() {
            wave["period_s"] = json!(1.5);
        }
        with(
            pool(),
            &[("/water/waves", waves), ("/time_s", json!(time_s))],
        )
    };
    let now = bench.map(at(time_s))?;
    let later = bench.map(at(time_s + 1.5))?;
    let early = bench.map(at(time_s.rem_euclid(1.5)))?;
    Ok(largest_to_mean(&later, &now).max(largest_to_mean(&early, &now)))
}
