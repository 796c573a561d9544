//! Point lights close to the water, on it and under it.

use serde_json::{Value, json};

use super::bench::Bench;
use super::case::Family::Light;
use super::case::{Case, Failure};
use super::truths::{SIDE, pool, reference_error, relative_l1, waves, waves_at, with};
use crate::reference::closed_form::LampOverFlatWater;

const CLOSED_FORM: &str = "relative L1 against I T h/(ρ² + h²)^(3/2) · (ρ/r)/(dr/dρ) · e^(−cd)";
const STRAIGHT: &str = "relative L1 against I H/(r² + H²)^(3/2) · e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";
const SPREAD: &str = "the light of a hemisphere through a spot of a few millimetres";

/// Extinction of the flat water here, 1/m.
const EXTINCTION_PER_M: f64 = 0.2;
/// Depth of [`pool`], m.
const DEPTH_M: f64 = 2.0;
/// Points along a texel's side at which the closed form is evaluated.
const POINTS: u32 = 4;

pub(super) const CASES: &[Case] = &[
    Light.case(
        "a_lamp_a_millimetre_above_the_water",
        SPREAD,
        CLOSED_FORM,
        5e-5,
        |b| flat_error(b, [0.1, 1e-3, 0.05]),
    ),
    Light.case(
        "a_lamp_on_the_water",
        "a division by the distance to the water",
        STRAIGHT,
        1e-4,
        |b| flat_error(b, [0.1, 0.0, 0.05]),
    ),
    Light.case(
        "a_lamp_a_millimetre_under_the_water",
        "a light assigned to the wrong side of the surface",
        STRAIGHT,
        1e-4,
        |b| flat_error(b, [0.1, -1e-3, 0.05]),
    ),
    Light.case(
        "a_lamp_exactly_above_a_vertex_of_the_grid",
        "a ray straight down: 0/0 in its direction",
        CLOSED_FORM,
        5e-5,
        |b| flat_error(b, [0.0, 0.25, 0.0]),
    ),
    Light.case(
        "a_lamp_a_millimetre_above_a_wave",
        SPREAD,
        REFERENCE,
        3e-2,
        |b| reference_error(b, wavy(1e-3)),
    ),
    Light.case(
        "a_lamp_a_millimetre_under_a_wave",
        "a light above the water at rest but under the wave",
        REFERENCE,
        0.01,
        |b| reference_error(b, wavy(-1e-3)),
    ),
];

fn scene(position_m: [f64; 3], water_waves: Value) -> Value {
    let lamp = json!({ "kind": "point", "position_m": position_m, "intensity_w_sr": [1, 1, 1] });
    with(
        pool(),
        &[
            ("/lights/0", lamp),
            ("/water/waves", water_waves),
            (
                "/water/absorption_per_m",
                json!([EXTINCTION_PER_M, EXTINCTION_PER_M, EXTINCTION_PER_M]),
            ),
            ("/quality/water_cells", json!(512)),
        ],
    )
}

/// A lamp this far above the wave at its place (negative: under it).
fn wavy(above_m: f64) -> Value {
    let (x_m, z_m) = (0.1, 0.05);
    let (height_m, _) = waves_at(x_m, z_m);
    scene([x_m, height_m + above_m, z_m], waves())
}

/// Relative L1 error of the map under flat water against the closed form's means over its texels.
fn flat_error(bench: &mut Bench<'_>, position_m: [f64; 3]) -> Result<f64, Failure> {
    let value = scene(position_m, json!([]));
    let lamp = LampOverFlatWater {
        height_m: position_m[1],
        depth_m: DEPTH_M,
        ior: 1.333,
        extinction_per_m: EXTINCTION_PER_M,
    };
    // The map of the pool is 2 m × 2 m around the origin.
    let place = |texel: u32, point: u32| {
        let texels = f64::from(texel) + (f64::from(point) + 0.5) / f64::from(POINTS);
        2.0 * texels / f64::from(SIDE) - 1.0
    };
    let truth: Vec<[f64; 3]> = (0..SIDE * SIDE)
        .map(|texel| {
            let sum: f64 = (0..POINTS * POINTS)
                .map(|point| {
                    let x_m = place(texel % SIDE, point % POINTS) - position_m[0];
                    let z_m = place(texel / SIDE, point / POINTS) - position_m[2];
                    lamp.irradiance_at(x_m.hypot(z_m))
                })
                .sum();
            [sum / f64::from(POINTS * POINTS); 3]
        })
        .collect();
    relative_l1(&bench.map(value)?, &truth)
}
