//! Suns at and below the horizon, along slopes, dim and bright.

use serde_json::{Value, json};

use super::bench::{Bench, texels};
use super::case::Family::Light;
use super::case::{Case, Failure};
use super::truths::{
    flat_error, largest_relative, largest_to_mean, pool, reference_error, sun, waves, with, worst,
};
use crate::frame::Frame;
use crate::scene::LayerName;

const CLOSED_FORM: &str = "worst texel against E cos θ T e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";
const DARK: &str = "share of texels that are not black";
const GRAZING: &str = "cosines near 0, Fresnel near 1, windows of very long rays";

pub(super) const CASES: &[Case] = &[
    Light.case(
        "sun_in_the_zenith",
        "an azimuth that is undefined",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, flat(90.0)),
    ),
    Light.case("sun_at_10_degrees", GRAZING, CLOSED_FORM, 1e-4, |b| {
        flat_error(b, flat(10.0))
    }),
    Light.case("sun_at_1_degree", GRAZING, CLOSED_FORM, 1e-4, |b| {
        flat_error(b, flat(1.0))
    }),
    Light.case(
        "sun_at_a_hundredth_of_a_degree",
        GRAZING,
        CLOSED_FORM,
        2e-4,
        |b| flat_error(b, flat(0.01)),
    ),
    Light.case("sun_on_the_horizon", "0/0 in refraction", DARK, 0.0, |b| {
        dark(b, flat(0.0))
    }),
    Light.case(
        "sun_below_the_horizon",
        "light that comes from below",
        DARK,
        0.0,
        |b| dark(b, flat(-5.0)),
    ),
    Light.case(
        "waves_under_a_sun_at_10_degrees",
        "waves that face away from the sun",
        REFERENCE,
        0.01,
        |b| reference_error(b, wavy(10.0)),
    ),
    Light.case(
        "waves_under_a_sun_at_1_degree",
        "waves that face away from the sun",
        REFERENCE,
        0.01,
        |b| reference_error(b, wavy(1.0)),
    ),
    Light.case(
        "waves_under_a_sun_at_a_hundredth_of_a_degree",
        "waves that face away from the sun",
        REFERENCE,
        0.01,
        |b| reference_error(b, wavy(0.01)),
    ),
    Light.case(
        "sun_along_the_steepest_slope",
        "cos θ_i = 0 where Fresnel and refraction are steepest",
        REFERENCE,
        0.03,
        |b| {
            let slope: f64 = std::f64::consts::TAU * 0.05;
            let scene = with(
                pool(),
                &[
                    (
                        "/water/waves",
                        json!([{ "kind": "sine", "amplitude_m": 0.05, "wavelength_m": 1.0 }]),
                    ),
                    ("/lights/0", sun(slope.atan().to_degrees(), 0.0)),
                ],
            );
            reference_error(b, scene)
        },
    ),
    Light.case("no_irradiance", "a division by the flux", DARK, 0.0, |b| {
        dark(
            b,
            with(
                wavy(60.0),
                &[("/lights/0/irradiance_w_m2", json!([0, 0, 0]))],
            ),
        )
    }),
    Light.case(
        "one_dark_channel",
        "a division by the flux of a channel",
        "worst texel against E cos θ T e^(−cd)",
        1e-4,
        |b| {
            flat_error(
                b,
                with(
                    flat(50.0),
                    &[("/lights/0/irradiance_w_m2", json!([0, 1, 0]))],
                ),
            )
        },
    ),
    Light.case(
        "dim_and_bright_suns_together",
        "rounding in the bright sun's sums that hides the dim sun",
        "largest difference: of both suns together from the sum of each alone, of the dim sun from the scaled bright one, and of the dim sun's channel and account from those it has alone",
        1e-6,
        dim_and_bright,
    ),
];

/// The two suns together against each alone. Where both shine in all channels the dim one is less than the rounding of the bright one:
/// what becomes of it shows where it has a channel for itself, and in its account.
fn dim_and_bright(bench: &mut Bench<'_>) -> Result<f64, Failure> {
    let of = |suns: &[[f64; 3]]| {
        let lights: Vec<Value> = suns
            .iter()
            .map(|power| with(sun(60.0, 30.0), &[("/irradiance_w_m2", json!(power))]))
            .collect();
        with(wavy(60.0), &[("/lights", Value::Array(lights))])
    };
    let (dim, bright) = ([1e-6; 3], [1e6; 3]);
    let both = bench.map(of(&[dim, bright]))?;
    let one = bench.map(of(&[bright]))?;
    let other = bench.map(of(&[dim]))?;
    let scaled: Vec<[f64; 3]> = other.iter().map(|t| t.map(|v| v * 1e12)).collect();
    let mut error = largest_to_mean(&both, &add(&one, &other));
    error = worst(error, largest_to_mean(&scaled, &one));

    let (dim, bright) = ([1e-6, 0.0, 0.0], [0.0, 1e6, 1e6]);
    let both = bench.render(of(&[dim, bright]))?;
    let alone = bench.render(of(&[dim]))?;
    let red = |frame: &Frame| -> Vec<[f64; 3]> {
        let map = texels(frame, LayerName::Irradiance);
        map.iter().map(|t| [t[0]; 3]).collect()
    };
    error = worst(error, largest_relative(&red(&both), &red(&alone)));
    let landed = |frame: &Frame| {
        let account = frame.stats.energy.iter().find(|a| a.light == 0);
        account.map_or(0.0, |a| a.landed_w[0])
    };
    Ok(worst(error, (landed(&both) / landed(&alone) - 1.0).abs()))
}

fn add(a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<[f64; 3]> {
    a.iter()
        .zip(b)
        .map(|(a, b)| std::array::from_fn(|c| a[c] + b[c]))
        .collect()
}

/// Flat water that absorbs.
fn flat(elevation_deg: f64) -> Value {
    with(
        pool(),
        &[
            ("/water/absorption_per_m", json!([0.35, 0.07, 0.03])),
            ("/lights/0", sun(elevation_deg, 25.0)),
        ],
    )
}

fn wavy(elevation_deg: f64) -> Value {
    with(
        pool(),
        &[
            ("/water/waves", waves()),
            ("/lights/0", sun(elevation_deg, 25.0)),
            ("/quality/water_cells", json!(256)),
        ],
    )
}

/// Share of texels that are not black.
fn dark(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let map = bench.map(scene)?;
    let lit = map.iter().filter(|t| t.iter().any(|&v| v != 0.0)).count();
    Ok(lit as f64 / map.len() as f64)
}
