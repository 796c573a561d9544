//! Awkward cameras and sizes of pictures.

use serde_json::{Value, json};

use super::bench::{Bench, texels};
use super::case::Family::Camera;
use super::case::{Case, Failure};
use super::truths::{pool, sun, waves, with, worst};
use crate::physics::fresnel::fresnel_transmittance;
use crate::scene::LayerName;

const RADIANCE: &str = "the middle pixel against ρE/π through the water's surface";
const LIT: &str = "share of pixels that are negative or all black";
const REFUSED: &str = "0 where it is refused at that field";

pub(super) const CASES: &[Case] = &[
    Camera.case(
        "a_micrometre_under_the_surface",
        "a start on the wrong side",
        RADIANCE,
        2e-3,
        |b| looking_down(b, -1e-6),
    ),
    Camera.case(
        "a_micrometre_over_the_surface",
        "a start on the wrong side",
        RADIANCE,
        2e-3,
        |b| looking_down(b, 1e-6),
    ),
    Camera.case("on_the_surface", "a start on neither side", LIT, 0.0, |b| {
        lit(
            b,
            camera(
                [0.0, 0.0, 0.0],
                [0.0, -1.0, 0.0],
                json!({ "up": [0, 0, -1] }),
            ),
        )
    }),
    Camera.case("on_a_wave", "a start within a crest", LIT, 0.05, |b| {
        let scene = with(
            camera([0.3, 0.0, 0.1], [0.5, -1.0, 0.4], json!({})),
            &[("/water/waves", waves())],
        );
        lit(b, scene)
    }),
    Camera.case(
        "along_its_own_up",
        "a basis without a right",
        REFUSED,
        0.0,
        |b| {
            b.refused_at(
                camera(
                    [0.0, 2.0, 0.0],
                    [0.0, -1.0, 0.0],
                    json!({ "up": [0, 1, 0] }),
                ),
                "/camera/up",
            )
        },
    ),
    Camera.case(
        "a_field_of_view_of_a_tenth_of_a_degree",
        "pixels of almost one ray",
        LIT,
        0.0,
        |b| {
            lit(
                b,
                camera(
                    [0.0, 30.0, 10.0],
                    [0.0, -2.0, 0.0],
                    json!({ "vertical_fov_deg": 0.1 }),
                ),
            )
        },
    ),
    Camera.case(
        "a_field_of_view_of_179_degrees",
        "pixels of grazing rays",
        LIT,
        0.0,
        |b| {
            let sky = json!({ "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] });
            let scene = with(
                camera(
                    [0.0, 1.0, 0.0],
                    [0.0, -1.0, -0.1],
                    json!({ "vertical_fov_deg": 179 }),
                ),
                &[("/lights", json!([sun(60.0, 30.0), sky]))],
            );
            lit(b, scene)
        },
    ),
    Camera.case(
        "under_water_at_the_critical_angle",
        "total reflection at its very edge",
        LIT,
        0.0,
        |b| {
            let sky = json!({ "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] });
            let scene = with(
                camera(
                    [0.0, -1.0, 0.0],
                    [(1.0_f64 / 1.333).asin().tan(), 0.0, 0.0],
                    json!({ "vertical_fov_deg": 5 }),
                ),
                &[("/lights", json!([sun(60.0, 30.0), sky]))],
            );
            lit(b, scene)
        },
    ),
    Camera.case(
        "one_pixel",
        "a picture without neighbours",
        RADIANCE,
        2e-3,
        |b| {
            middle(
                b,
                with(
                    looking(-0.5),
                    &[("/output/width", json!(1)), ("/output/height", json!(1))],
                ),
                -0.5,
            )
        },
    ),
    Camera.case(
        "one_column_of_8192_pixels",
        "bands and aspects",
        LIT,
        0.0,
        |b| {
            let scene = with(
                camera(
                    [0.0, 3.0, 0.0],
                    [0.0, -1.0, 0.0],
                    json!({ "up": [0, 0, -1], "vertical_fov_deg": 20 }),
                ),
                &[("/output/width", json!(1)), ("/output/height", json!(8192))],
            );
            lit(b, scene)
        },
    ),
    Camera.case(
        "pictures_of_8192_by_8192_pixels",
        "memory without end",
        REFUSED,
        0.0,
        |b| {
            b.refused_at(
                with(
                    looking(1.0),
                    &[
                        ("/output/width", json!(8192)),
                        ("/output/height", json!(8192)),
                    ],
                ),
                "/output",
            )
        },
    ),
];

fn camera(position_m: [f64; 3], target_m: [f64; 3], mut more: Value) -> Value {
    let mut camera = json!({ "position_m": position_m, "target_m": target_m });
    if let (Some(camera), Some(more)) = (camera.as_object_mut(), more.as_object_mut()) {
        camera.append(more);
    }
    with(
        pool(),
        &[
            ("/camera", camera),
            (
                "/output",
                json!({ "kind": "view", "width": 48, "height": 32 }),
            ),
        ],
    )
}

/// Straight down from this height.
fn looking(y_m: f64) -> Value {
    camera(
        [0.0, y_m, 0.0],
        [0.0, -2.0, 0.0],
        json!({ "up": [0, 0, -1], "vertical_fov_deg": 20 }),
    )
}

fn looking_down(bench: &mut Bench<'_>, y_m: f64) -> Result<f64, Failure> {
    middle(bench, looking(y_m), y_m)
}

/// Relative error of the middle pixel of flat water seen straight down.
fn middle(bench: &mut Bench<'_>, scene: Value, y_m: f64) -> Result<f64, Failure> {
    let frame = bench.render(scene)?;
    let cos_i = 60_f64.to_radians().sin();
    let irradiance = cos_i * fresnel_transmittance(cos_i, 1.333);
    let out = if y_m > 0.0 {
        fresnel_transmittance(1.0, 1.333) / (1.333 * 1.333)
    } else {
        1.0
    };
    let pixels = texels(&frame, LayerName::Radiance);
    let at = (frame.height / 2 * frame.width + frame.width / 2) as usize;
    let albedo = [0.7, 0.65, 0.5];
    Ok((0..3)
        .map(|c| {
            let truth = albedo[c] * irradiance / std::f64::consts::PI * out;
            (pixels[at][c] / truth - 1.0).abs()
        })
        .fold(0.0, worst))
}

fn lit(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let frame = bench.render(scene)?;
    let pixels = texels(&frame, LayerName::Radiance);
    let bad = pixels
        .iter()
        .filter(|p| p.iter().any(|v| *v < 0.0) || p.iter().all(|v| *v == 0.0))
        .count();
    Ok(bad as f64 / pixels.len() as f64)
}
