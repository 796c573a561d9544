//! Kept fields of light: slices through the water, and the look-up between them. The cases run the first method that makes a field and
//! conserves energy.

use serde_json::{Value, json};

use super::bench::Bench;
use super::case::Family::Field;
use super::case::{Case, Failure};
use super::obj::cuboid;
use super::truths::{
    SIDE, flat_error, flat_irradiance, pool, reference_error, seen_error, sun, waves, with, worst,
};
use crate::facts::Product;
use crate::methods;

const CLOSED_FORM: &str = "worst texel against E cos θ T e^(−cd)";
const REFERENCE: &str = "relative L1 against the reference";
const CLOSURE: &str = "largest closure of the accounts of the slices";

pub(super) const CASES: &[Case] = &[
    Field.case(
        "slices_of_flat_water",
        "drifts of beams that are all alike, slices at the surface",
        CLOSED_FORM,
        1e-4,
        |b| flat_error(b, sliced(absorbing(), 64, SIDE)),
    ),
    Field.case(
        "slices_at_one_height",
        "slices without a distance: a floor at depth 0 under flat water",
        CLOSED_FORM,
        1e-4,
        |b| {
            let scene = with(pool(), &[("/floor/depth_m", json!(0))]);
            flat_error(b, sliced(scene, 2, SIDE))
        },
    ),
    Field.case(
        "a_receiver_in_a_box_of_one_layer",
        "a look-up far from both slices",
        "mean of the top of a plate halfway down, against the closed form",
        1e-3,
        |b| {
            let scene = with(
                pool(),
                &[
                    (
                        "/objects",
                        json!([{ "mesh": cuboid([1.0, 0.01, 1.0]), "translation_m": [0.1, -1.005, 0.2] }]),
                    ),
                    ("/lights/0", sun(90.0, 0.0)),
                    ("/quality/level_map_texels", json!(32)),
                    ("/output", json!({ "kind": "irradiance_map", "receiver": 0 })),
                ],
            );
            plate_error(b, sliced(scene, 2, 16), 1.0)
        },
    ),
    Field.case(
        "a_receiver_between_slices_under_a_low_sun",
        "a look-up that does not follow the light, or goes the wrong way",
        "relative L1 of a plate between two slices against the reference, over some pixels of a view",
        0.01,
        |b| {
            let scene = with(
                pool(),
                &[
                    ("/water/waves", waves()),
                    ("/lights/0", sun(30.0, 30.0)),
                    ("/floor/size_m", json!([3, 3])),
                    ("/quality/water_cells", json!(384)),
                    (
                        "/objects",
                        json!([{ "mesh": cuboid([2.0, 0.01, 2.0]), "translation_m": [0, -1.205, 0] }]),
                    ),
                    (
                        "/camera",
                        json!({ "kind": "orthographic", "position_m": [0, -0.1, 0], "target_m": [0, -1, 0],
                                "up": [0, 0, -1], "height_m": 1 }),
                    ),
                    (
                        "/output",
                        json!({ "kind": "view", "width": 48, "height": 48, "layers": ["irradiance"], "format": "exr" }),
                    ),
                ],
            );
            seen_error(b, sliced(scene, 12, 256))
        },
    ),
    Field.case(
        "slices_with_one_wave_per_cell",
        "footprints of a few huge beams that cross each other and the side of the box",
        CLOSURE,
        1e-5,
        |b| {
            let scene = with(
                absorbing(),
                &[
                    (
                        "/water/waves",
                        json!([{ "kind": "sine", "amplitude_m": 0.05, "wavelength_m": 0.3, "phase_deg": 50 }]),
                    ),
                    ("/quality/water_cells", json!(16)),
                ],
            );
            closure(b, sliced(scene, 32, 128))
        },
    ),
    Field.case(
        "slices_under_a_sun_at_10_degrees",
        "slices that move far sideways from one to the next",
        REFERENCE,
        0.01,
        |b| {
            let scene = with(
                pool(),
                &[
                    ("/water/waves", waves()),
                    ("/lights/0", sun(10.0, 30.0)),
                    ("/quality/water_cells", json!(256)),
                ],
            );
            reference_error(b, sliced(scene, 16, SIDE))
        },
    ),
    Field.case(
        "a_sheet_that_folds_within_the_slices",
        "slices with one, two and three sheets of light, and between them",
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
            reference_error(b, sliced(scene, 24, SIDE))
        },
    ),
    Field.case(
        "water_at_the_side_of_the_slices",
        "light that enters beside the box and falls into it",
        CLOSED_FORM,
        1e-4,
        |b| {
            let scene = with(
                absorbing(),
                &[
                    ("/floor/size_m", json!([2, 2])),
                    ("/lights/0", sun(20.0, 30.0)),
                ],
            );
            flat_error(b, sliced(scene, 16, SIDE))
        },
    ),
    Field.case(
        "slices_filled_by_single_footprints",
        "loops over texels by one invocation",
        CLOSED_FORM,
        1e-4,
        |b| {
            let scene = with(absorbing(), &[("/quality/water_cells", json!(2))]);
            flat_error(b, sliced(scene, 4, 512))
        },
    ),
];

/// [`pool`] with water that absorbs each channel differently.
fn absorbing() -> Value {
    with(
        pool(),
        &[("/water/absorption_per_m", json!([0.35, 0.07, 0.03]))],
    )
}

/// A scene with a field of this resolution.
fn sliced(scene: Value, slices: u32, texels: u32) -> Value {
    let mut all = methods::ALL.into_iter();
    let found = all.find(|method| {
        let facts = method.facts_of_default();
        facts.product == Product::Field && facts.conserves_energy
    });
    let name = found.map_or("none", |method| method.name);
    with(
        scene,
        &[(
            "/quality/method",
            json!({ "kind": name, "slices": slices, "slice_texels": texels }),
        )],
    )
}

fn closure(bench: &mut Bench<'_>, scene: Value) -> Result<f64, Failure> {
    let frame = bench.render(scene)?;
    if frame.stats.fields.is_empty() {
        return Err(Failure::Check("there is no field".to_owned()));
    }
    let closures = frame.stats.fields.iter().map(|field| field.closure);
    Ok(closures.fold(0.0, worst))
}

/// The mean of the middle of a map against flat water at a depth.
fn plate_error(bench: &mut Bench<'_>, scene: Value, depth_m: f64) -> Result<f64, Failure> {
    let resolved = bench.scene(scene)?;
    let due = flat_irradiance(&resolved, depth_m);
    let frame = bench.render_resolved(&resolved)?;
    let texels = super::bench::texels(&frame, crate::scene::LayerName::Irradiance);
    let (width, height) = (frame.width as usize, frame.height as usize);
    let is_inside = |i: usize, side: usize| i >= side / 4 && i < side - side / 4;
    let inside = texels
        .iter()
        .enumerate()
        .filter(|(at, _)| is_inside(at % width, width) && is_inside(at / width, height));
    let errors = inside.flat_map(|(_, texel)| texel.iter().zip(due));
    Ok(errors
        .map(|(found, due)| (found / due - 1.0).abs())
        .fold(0.0, worst))
}
