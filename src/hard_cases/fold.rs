//! Footprints that fold, collapse and spread.

use serde_json::{Value, json};

use super::case::Family::Fold;
use super::case::{Case, Failure};
use super::truths::{flat_error, largest_relative, pool, reference_error, sun, waves, with};

const CLOSED_FORM: &str = "worst texel against E cos θ T e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";

pub(super) const CASES: &[Case] = &[
    Fold.case(
        "footprints_that_turn_inside_out",
        "signed areas taken for flux",
        REFERENCE,
        0.02,
        |b| {
            let scene = with(
                pool(),
                &[
                    ("/water/waves", waves()),
                    ("/floor/depth_m", json!(6)),
                    ("/quality/water_cells", json!(512)),
                ],
            );
            reference_error(b, scene)
        },
    ),
    Fold.case(
        "footprints_within_one_texel",
        "divisions by footprints",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sized(1024, 2, 2)),
    ),
    Fold.case(
        "footprints_of_a_hundred_thousand_texels",
        "loops over texels by one invocation",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sized(4, 1024, 1024)),
    ),
    Fold.case(
        "footprints_of_millions_of_texels",
        "loops over texels by one invocation",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sized(2, 2048, 2048)),
    ),
    Fold.case(
        "texels_long_and_thin",
        "rows and columns taken alike",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sized(16, 2048, 2)),
    ),
    Fold.case(
        "every_corner_on_a_texel_corner",
        "boundaries counted twice or not at all",
        CLOSED_FORM,
        1e-4,
        |b| {
            // Under the zenith flat water sends cells straight down.
            let scene = with(
                sized(64, 32, 32),
                &[("/lights/0", sun(90.0, 0.0)), ("/water/ior", json!(1))],
            );
            flat_error(b, scene)
        },
    ),
    Fold.case(
        "sums_beyond_32_bits",
        "a focus that wraps a sum",
        "largest relative difference of the scaled sun's map from the sun's",
        1e-6,
        |b| {
            let k = std::f64::consts::TAU;
            let amplitude_m = 1.0 / (2.0 * k * k * (1.0 - 1.0 / 1.333));
            let scene = |power: f64| {
                let waves = [0.0, 90.0].map(|direction| {
                    json!({ "kind": "sine", "amplitude_m": amplitude_m, "wavelength_m": 1.0, "direction_deg": direction, "phase_deg": 90 })
                });
                with(
                    sized(256, 1024, 1024),
                    &[
                        ("/water/waves", json!(waves)),
                        (
                            "/lights/0",
                            with(
                                sun(90.0, 0.0),
                                &[("/irradiance_w_m2", json!([power, power, power]))],
                            ),
                        ),
                    ],
                )
            };
            b.scene(scene(1.0))?;
            let before = b.renderer()?.wide_sum_reruns();
            let one = b.map(scene(1.0))?;
            if b.renderer()?.wide_sum_reruns() == before {
                return Err(Failure::Check("no sum has wrapped".to_owned()));
            }
            let large: Vec<[f64; 3]> = b
                .map(scene(1e9))?
                .iter()
                .map(|t| t.map(|v| v * 1e-9))
                .collect();
            Ok(largest_relative(&large, &one))
        },
    ),
];

fn sized(cells: u32, width: u32, height: u32) -> Value {
    with(
        pool(),
        &[
            ("/quality/water_cells", json!(cells)),
            ("/output/width", json!(width)),
            ("/output/height", json!(height)),
        ],
    )
}
