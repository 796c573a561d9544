//! Height fields on the GPU: the surface of the CPU, also at the rim and far away, and the light of the sine pool from files of it.

use caustica::accuracy::metrics;
use caustica::scene::{LayerName, ResolvedScene};
use caustica::waves::Surface;
use serde_json::{Value, json};

use super::field_support::{self as files, npy, npy_f32, sampled};
use super::harness::{self, Map};
use super::scene_files;

/// A bounded field of 4 × 3 m with its middle at `middle_m`: two crossing waves.
fn bounded(middle_m: [f64; 2]) -> (Value, Vec<u8>) {
    let numbers = sampled([81, 61], [-2.0, -1.5], [0.05; 2], |x, z| {
        0.02 * (5.0 * x + 2.0 * z).sin() + 0.015 * (3.0 * x - 7.0 * z).cos()
    });
    let min_m = [middle_m[0] - 2.0, middle_m[1] - 1.5];
    let field = json!({ "sample_m": 0.05, "min_m": min_m, "rim_m": 0.4 });
    (field, npy(&[61, 81], &numbers))
}

/// Largest difference of the heights that a camera sees from straight above from those of the CPU, m, and the number of pixels outside the
/// field.
fn seen_from_above(resolved: &ResolvedScene, middle_m: [f64; 2]) -> (f64, usize) {
    const PIXELS: [usize; 2] = [120, 100];
    let surface = Surface::of(resolved).unwrap();
    let frame = harness::render(resolved);
    let step_m = 5.0 / PIXELS[1] as f64;
    let (mut worst, mut outside): (f64, usize) = (0.0, 0);
    for (at, depth_m) in frame.layers[&LayerName::Depth].data.iter().enumerate() {
        let x_m = middle_m[0] + ((at % PIXELS[0]) as f64 + 0.5 - PIXELS[0] as f64 / 2.0) * step_m;
        let z_m = middle_m[1] + ((at / PIXELS[0]) as f64 + 0.5 - PIXELS[1] as f64 / 2.0) * step_m;
        let expected_m = surface.at(x_m, z_m).height_m;
        worst = harness::nan_fails(worst, (2.0 - f64::from(*depth_m) - expected_m).abs());
        outside += usize::from(expected_m == 0.0);
    }
    (worst, outside)
}

#[test]
fn the_gpu_has_the_field_of_the_cpu_inside_at_the_rim_outside_and_far_away() {
    for middle_m in [[0.0, 0.0], [1e6, -3e5]] {
        let (field, file) = bounded(middle_m);
        let [x, z] = middle_m;
        let scene = json!({
            "water": { "waves": [field] },
            "floor": { "depth_m": 1.5, "size_m": [3, 2], "center_m": middle_m },
            "lights": [{ "kind": "sun", "elevation_deg": 65, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": 16 },
            "camera": { "kind": "orthographic", "position_m": [x, 2, z], "target_m": [x, 0, z], "up": [0, 0, -1], "height_m": 5 },
            "output": { "kind": "view", "width": 120, "height": 100, "format": "exr", "layers": ["depth"] }
        });
        let (worst_m, outside) = seen_from_above(&files::scene(scene, &[file]), middle_m);
        println!("{middle_m:?}: {worst_m:e} m, {outside} pixels outside");
        // The camera stops within 2·10⁻⁵ m of the water.
        assert!(worst_m < 4e-5, "{middle_m:?}: {worst_m:e}");
        assert!(outside > 500, "{outside}");
    }
}

/// Samples of the sine pool's water: 10.5 m around the origin, 32 a metre.
const SIDE: usize = 337;
const STEP_M: f64 = 1.0 / 32.0;
const FIRST_M: f64 = -5.25;

fn sine_pool(cells: &str) -> ResolvedScene {
    scene_files::load("sine_pool", &[("/quality/water_cells", cells)])
}

/// The sine pool whose water is a height field.
fn pool_of(field: Value, file: Vec<u8>, cells: &str) -> ResolvedScene {
    let mut scene = serde_json::to_value(&sine_pool(cells).scene).unwrap();
    scene["water"]["waves"] = json!([field]);
    files::scene(scene, &[file])
}

fn field(more: Value) -> Value {
    let mut field = json!({ "sample_m": STEP_M, "rim_m": 1.0, "rest_m": 0 });
    for (name, value) in more.as_object().unwrap() {
        field[name] = value.clone();
    }
    field
}

/// Heights and slopes of the sine pool's water.
fn pool_samples() -> [Vec<f64>; 3] {
    let surface = Surface::of(&sine_pool("64")).unwrap();
    let of = |part: fn(&Surface, f64, f64) -> f64| {
        sampled([SIDE; 2], [FIRST_M; 2], [STEP_M; 2], |x, z| {
            part(&surface, x, z)
        })
    };
    [
        of(|surface, x, z| surface.at(x, z).height_m),
        of(|surface, x, z| surface.at(x, z).slope.x),
        of(|surface, x, z| surface.at(x, z).slope.y),
    ]
}

#[test]
fn the_sine_pool_from_files_has_the_light_of_its_sines() {
    let [heights, slope_x, slope_z] = pool_samples();
    let codes: Vec<u16> = heights
        .iter()
        .map(|h| ((h + 0.064) / 0.128 * 65535.0).round() as u16)
        .collect();
    let floats = |values: &[f64]| -> Vec<f32> { values.iter().map(|v| *v as f32).collect() };
    let slopes: Vec<f64> = slope_x
        .iter()
        .zip(&slope_z)
        .flat_map(|(x, z)| [*x, *z])
        .collect();
    let mut of_slopes = field(json!({ "holds": "slopes" }));
    of_slopes.as_object_mut().unwrap().remove("rest_m");
    let mut of_exr_slopes = of_slopes.clone();
    of_exr_slopes["channels"] = json!(["dx", "dz"]);
    let cases = [
        (
            "NPY",
            field(json!({})),
            npy_f32(&[SIDE, SIDE], &heights),
            0.002,
        ),
        (
            "EXR",
            field(json!({ "channel": "water.height" })),
            files::exr(
                SIDE,
                SIDE,
                &[
                    ("water.height", floats(&heights)),
                    ("foam", vec![0.5; SIDE * SIDE]),
                ],
            ),
            0.002,
        ),
        // 16 bits over 0.128 m are steps of 2·10⁻⁶ m.
        (
            "PNG",
            field(json!({ "range_m": [-0.064, 0.064] })),
            files::png([SIDE as u32; 2], png::ColorType::Grayscale, 16, &codes),
            0.004,
        ),
        (
            "slopes NPY",
            of_slopes,
            npy_f32(&[SIDE, SIDE, 2], &slopes),
            0.002,
        ),
        (
            "slopes EXR",
            of_exr_slopes,
            files::exr(
                SIDE,
                SIDE,
                &[("dx", floats(&slope_x)), ("dz", floats(&slope_z))],
            ),
            0.002,
        ),
    ];
    let cells = "512";
    let truth = Map::from(&sine_pool(cells));
    for (name, field, file, most) in cases {
        let map = Map::from(&pool_of(field, file, cells));
        assert!(map.closure() <= 1e-5, "{name}: {:e}", map.closure());
        let error = metrics::relative_l1(map.values(), truth.values()).unwrap();
        println!("{name}: {error:.2e}");
        assert!(error <= most, "{name}: {error:e}");
    }
}

#[test]
fn light_through_a_field_with_a_rim_is_that_of_the_reference() {
    let scene = |cells: u32| {
        let (field, file) = bounded([0.0, 0.0]);
        let scene = json!({
            "water": { "waves": [field] },
            "floor": { "depth_m": 1.2, "size_m": [6, 6] },
            "lights": [{ "kind": "sun", "elevation_deg": 70, "azimuth_deg": 30, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": cells },
            "output": {
                "kind": "irradiance_map", "receiver": "floor", "min_m": [0.4, 0.2], "max_m": [2.6, 1.8], "width": 88, "height": 64
            }
        });
        files::scene(scene, &[file])
    };
    let truth = super::truths::floor_map(&scene(64), &harness::truth_settings(1e-3));
    let error = |cells: u32| {
        let map = Map::from(&scene(cells));
        assert!(map.closure() <= 1e-5);
        metrics::relative_l1(map.values(), truth.irradiance.as_flattened()).unwrap()
    };
    let errors = [32, 64, 128].map(error);
    println!("truth {:.1e}, {errors:?}", truth.relative_error);
    assert!(errors[0] > 2.5 * errors[1], "{errors:?}");
    assert!(errors[2] <= 0.002, "{errors:?}");
}

#[test]
fn the_same_sequence_gives_the_same_bytes_and_loops() {
    let numbers: Vec<f64> = (0..4 * 32 * 32)
        .map(|i| 0.01 * (0.7 * f64::from(i % 32) + 1.6 * f64::from(i / 1024)).sin())
        .collect();
    let at = |time_s: f64| {
        let field =
            json!({ "sample_m": 0.1, "edges": "periodic", "frames_per_s": 10, "after": "loop" });
        let scene = json!({
            "water": { "waves": [field] },
            "floor": { "depth_m": 1, "size_m": [2, 2] },
            "lights": [{ "kind": "sun", "elevation_deg": 65, "irradiance_w_m2": [1, 1, 1] }],
            "quality": { "water_cells": 64 },
            "output": { "kind": "irradiance_map", "receiver": "floor", "width": 32, "height": 32 },
            "time_s": time_s
        });
        Map::from(&files::scene(scene, &[npy(&[4, 32, 32], &numbers)]))
            .frame
            .layers
    };
    assert_eq!(at(0.2), at(0.2));
    assert_eq!(at(0.2), at(0.6));
    assert_ne!(at(0.2), at(0.3));
    assert_ne!(at(0.2), at(0.24));
}
