//! Footprints that fold, collapse and spread.

use serde_json::{Value, json};

use super::case::Family::Fold;
use super::case::{Case, Failure};
use super::truths::{flat_error, largest_relative, pool, reference_error, sun, waves, with};
use crate::scene::ResolvedScene;

const CLOSED_FORM: &str = "worst texel against E cos θ T e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";

pub(super) const CASES: &[Case] = &[
    Fold.case(
        "footprints_that_turn_inside_out",
        "signed areas that are used as flux",
        REFERENCE,
        0.01,
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
        "divisions by the footprint's area",
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
        "rows and columns that are confused",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sized(16, 2048, 2)),
    ),
    Fold.case(
        "every_corner_on_a_texel_corner",
        "boundary points that are counted twice or not at all",
        CLOSED_FORM,
        1e-6,
        |b| {
            let resolved = b.scene(on_corners())?;
            if !is_on_corners(&resolved)? {
                let message = "the vertices of the grid do not lie on corners of texels";
                return Err(Failure::Check(message.to_owned()));
            }
            flat_error(b, on_corners())
        },
    ),
    Fold.case(
        "sums_beyond_32_bits",
        "a focus that overflows a sum",
        "largest relative difference between the maps of a sun and of the same sun scaled",
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
                return Err(Failure::Check("no sum has overflowed".to_owned()));
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

/// Every vertex of the grid over a corner of a texel, in numbers that f32 holds: under the zenith water of index 1 sends its cells
/// straight down. The window is larger than the map by what f32 rounds, 2⁻²⁰ of half the map and the depth: at this depth by one
/// texel of 2⁻⁷ m on every side.
fn on_corners() -> Value {
    with(
        sized(18, 16, 16),
        &[
            ("/lights/0", sun(90.0, 0.0)),
            ("/water/ior", json!(1)),
            ("/floor/depth_m", json!(8192.0 - 0.0625)),
            ("/output/min_m", json!([-0.0625, -0.0625])),
            ("/output/max_m", json!([0.0625, 0.0625])),
        ],
    )
}

/// Checks this, because the margin of the window is not decided here.
fn is_on_corners(resolved: &ResolvedScene) -> Result<bool, Failure> {
    let facts = crate::methods::facts(resolved)?;
    let (Some(light), Some(map)) = (facts.lights.beam_sets.first(), facts.receivers.floor_map)
    else {
        return Ok(false);
    };
    let cells = facts.quality.water_cells;
    // As in the shader.
    let texel = (map.rect.size() / f64::from(map.width)).as_vec2();
    let first = light.grid.places.min.as_vec2();
    let cell = (light.grid.places.size() / f64::from(cells)).as_vec2();
    let is_on = |i: u32| {
        let texels = (first + i as f32 * cell - map.rect.min.as_vec2()) / texel;
        texels == texels.round()
    };
    Ok((0..=cells).all(is_on) && cell == texel)
}

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
