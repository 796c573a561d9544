//! Camera rays that split at the water: what is mirrored and what is seen through adds up to what the float64 reference sees.

use caustica::accuracy::metrics;
use caustica::frame::Frame;
use caustica::physics::fresnel::fresnel_reflectance;
use caustica::reference::{TruthSettings, radiance};
use caustica::scene::LayerName;
use serde_json::{Value, json};

use super::harness;
use super::scene_files;

const IOR: f64 = 1.333;

/// Maps and cells as fine as a floor asks for that begins next to the camera.
const FINE: [(&str, &str); 2] = [
    ("/quality/map_texels", "2048"),
    ("/quality/water_cells", "1024"),
];

fn render(scene: Value) -> Frame {
    harness::render(&scene_files::scene(scene))
}

fn pixels(frame: &Frame) -> Vec<[f64; 3]> {
    harness::layer(frame, LayerName::Radiance)
}

/// Relative L1 error of a scene file's radiance against the reference, at every few pixels.
fn error_of(name: &str, overrides: &[(&str, &str)]) -> f64 {
    // The reference has the mean light on what a pixel covers, so pixels have to be small beside the caustics.
    let sharp = [
        ("/output/width", "1200"),
        ("/output/height", "750"),
        ("/output/format", "exr"),
        ("/quality/pixel_samples", "1"),
    ];
    let mut resolved = scene_files::load(name, &[&sharp, overrides].concat());
    if let Some(floor) = &mut resolved.scene.floor {
        // A smaller floor has smaller texels.
        let most_m = if name == "boat_above" { 14.0 } else { 6.0 };
        floor.size_m = floor.size_m.map(|side| f64::min(side, most_m));
    }
    let settings = TruthSettings {
        target_error: Some(3e-3),
        most_points: 2500,
        ..TruthSettings::default()
    };
    let truth = radiance(&resolved, &settings, &|| false).unwrap();
    let frame = harness::render(&resolved);
    let seen = pixels(&frame);
    let mut compared = Vec::new();
    for j in 0..truth.height {
        for i in 0..truth.width {
            let at = [
                truth.first_pixel[0] + i * truth.pixel_step,
                truth.first_pixel[1] + j * truth.pixel_step,
            ];
            compared.push(seen[(at[1] * frame.width + at[0]) as usize]);
        }
    }
    let error =
        metrics::relative_l1(compared.as_flattened(), truth.radiance.as_flattened()).unwrap();
    println!(
        "{name} {overrides:?}: {error:.4}, truth {:.4}",
        truth.relative_error
    );
    error
}

#[test]
fn a_pool_side_with_a_ladder_is_that_of_the_reference() {
    let error = error_of("pool_ladder", &[]);
    assert!(error <= 0.01, "{error}");
    // Without the mirror image of what stands out of the water it is not.
    let without = error_of("pool_ladder", &[("/quality/bounces", "0")]);
    assert!(without > 1.5 * error, "{without} {error}");
}

#[test]
fn a_boat_above_a_camera_under_water_is_that_of_the_reference() {
    let error = error_of("boat_above", &FINE);
    assert!(error <= 0.01, "{error}");
}

#[test]
fn a_split_picture_is_that_of_the_reference() {
    let error = error_of("waterline", &FINE);
    assert!(error <= 0.01, "{error}");
}

#[test]
fn rays_that_meet_the_water_often_are_those_of_the_reference() {
    for bounces in ["2", "4"] {
        let overrides = [&FINE[..], &[("/quality/bounces", bounces)]].concat();
        let error = error_of("waterline", &overrides);
        assert!(error <= 0.01, "{bounces}: {error}");
    }
}

/// A black box in the air under a white sky, over flat water without a floor, far from it.
fn dark_box(at_m: [f64; 3], side_m: f64) -> Value {
    json!({
        "water": {},
        "objects": [{ "mesh": "box.obj", "translation_m": at_m, "scale": side_m, "albedo": [0, 0, 0],
            "rotation": [0.1826, 0.3651, 0.5477, 0.7303] }],
        "lights": [{ "kind": "sky", "radiance_w_m2_sr": [100, 100, 100] }],
        "camera": { "position_m": [0.3, 1.2, 3.0], "target_m": [0, 0, -0.5], "vertical_fov_deg": 40 },
        "quality": { "pixel_samples": 8 },
        "output": { "kind": "view", "width": 160, "height": 120, "format": "exr", "layers": ["radiance"] }
    })
}

/// The middle of what is missing from `first_row` of the picture on, in pixels from its upper left corner.
fn shadow_in_the_mirror(frame: &Frame, without: &Frame, first_row: usize) -> [f64; 2] {
    let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
    let pairs = pixels(frame).into_iter().zip(pixels(without)).enumerate();
    for (at, (with, without)) in pairs {
        let [column, row] = [at % 160, at / 160];
        let missing = without[0] - with[0];
        if row < first_row || missing <= 1e-6 * without[0] {
            continue;
        }
        // As a share of what the water mirrors there, so that brighter pixels do not weigh more.
        let share = missing / without[0];
        sum += share;
        x += share * (column as f64 + 0.5);
        y += share * (row as f64 + 0.5);
    }
    [x / sum, y / sum]
}

/// The mirror image of a small cube in flat water lies where the cube itself would be seen at −y.
#[test]
fn flat_water_mirrors_things_at_their_place_under_it() {
    let at_m = [0.2, 0.5, -0.8];
    let scene = dark_box(at_m, 0.1);
    let mut empty = scene.clone();
    empty["objects"][0]["translation_m"] = json!([0, 500, 0]);
    let (seen, without) = (render(scene), render(empty));
    // The cube itself is in the upper half of the picture.
    let middle = shadow_in_the_mirror(&seen, &without, 64);
    let eye = glam::DVec3::new(0.3, 1.2, 3.0);
    let forward = (glam::DVec3::new(0.0, 0.0, -0.5) - eye).normalize();
    let right = forward.cross(glam::DVec3::Y).normalize();
    let up = right.cross(forward);
    let to = glam::DVec3::new(at_m[0], -at_m[1], at_m[2]) - eye;
    let focal = 60.0 / 20.0_f64.to_radians().tan();
    let expected = [
        80.0 + focal * to.dot(right) / to.dot(forward),
        60.0 - focal * to.dot(up) / to.dot(forward),
    ];
    assert!(expected[1] > 66.0, "{expected:?}");
    for axis in [0, 1] {
        let off = middle[axis] - expected[axis];
        assert!(off.abs() <= 0.05, "{middle:?} {expected:?}");
    }
}

/// What flat water mirrors of an even sky and of a black box has Fresnel's share at every pixel.
#[test]
fn a_mirrored_box_takes_away_what_the_water_mirrors_of_the_sky() {
    let seen = render(dark_box([0.0, 0.6, -0.6], 0.6));
    let without = render(dark_box([0.0, 500.0, 0.0], 0.6));
    let (mut dark, mut bright) = (0, 0);
    for (at, (with, without)) in pixels(&seen).iter().zip(pixels(&without)).enumerate() {
        let [x, y] = [at % 160, at / 160];
        if y < 64 {
            continue;
        }
        let focal = 60.0 / 20.0_f64.to_radians().tan();
        let eye = glam::DVec3::new(0.3, 1.2, 3.0);
        let forward = (glam::DVec3::new(0.0, 0.0, -0.5) - eye).normalize();
        let right = forward.cross(glam::DVec3::Y).normalize();
        let up = right.cross(forward);
        let offset = [x as f64 + 0.5 - 80.0, 60.0 - y as f64 - 0.5];
        let d = (forward * focal + right * offset[0] + up * offset[1]).normalize();
        let mirrored = 100.0 * fresnel_reflectance(-d.y, IOR);
        // The mean over a pixel differs from its middle by the curvature of Fresnel's curve.
        assert!(
            (without[0] / mirrored - 1.0).abs() <= 2e-3,
            "{at}: {without:?} {mirrored}"
        );
        if with[0] == 0.0 {
            dark += 1;
        } else if (with[0] - without[0]).abs() <= 1e-4 * without[0] {
            bright += 1;
        }
    }
    // Whole pixels of the mirrored box are black, those beside it are as without it, and few lie on its edge.
    assert!(dark > 500 && bright > 4000, "{dark} {bright}");
    assert!(dark + bright > 56 * 160 - 400, "{dark} {bright}");
}

/// Under water, an object in the air and the mirror image of the floor add up.
#[test]
fn what_is_seen_through_the_surface_from_below_does_not_hide_what_it_mirrors() {
    let scene = |floor: f64, box_albedo: f64, bounces: u32| {
        json!({
            "water": { "absorption_per_m": [0.2, 0.1, 0.05] },
            "floor": { "depth_m": 2, "size_m": [40, 40], "albedo": [floor, floor, floor] },
            "objects": [{ "mesh": "box.obj", "translation_m": [0, 1.5, 0], "scale": [30, 0.4, 30],
                "albedo": [box_albedo, box_albedo, box_albedo] }],
            "lights": [
                { "kind": "point", "position_m": [0, -1.2, 0], "intensity_w_sr": [50, 50, 50] },
                { "kind": "point", "position_m": [0.5, 0.6, 0.2], "intensity_w_sr": [80, 80, 80] }
            ],
            "camera": { "position_m": [0, -1, 0], "target_m": [0.6, 0, 0.2], "vertical_fov_deg": 50 },
            "quality": { "bounces": bounces, "water_cells": 64, "map_texels": 64, "level_map_texels": 32 },
            "output": { "kind": "view", "width": 32, "height": 24, "format": "exr", "layers": ["radiance"] }
        })
    };
    let both = pixels(&render(scene(0.5, 0.5, 1)));
    let floor = pixels(&render(scene(0.5, 0.0, 1)));
    let object = pixels(&render(scene(0.0, 0.5, 1)));
    let hidden = pixels(&render(scene(0.5, 0.5, 0)));
    let mut both_seen = 0;
    for at in 0..both.len() {
        for c in 0..3 {
            let sum = floor[at][c] + object[at][c];
            assert!(
                (both[at][c] - sum).abs() <= 1e-5 * sum,
                "{at}: {:?}",
                both[at]
            );
        }
        if floor[at][0] > 0.0 && object[at][0] > 0.0 {
            assert!((hidden[at][0] - object[at][0]).abs() <= 1e-5 * object[at][0]);
            both_seen += 1;
        }
    }
    assert!(both_seen > 300, "{both_seen}");
}

/// The rim of Snell's window over flat water, in the row through its middle, to a tenth of a pixel.
#[test]
fn the_rim_of_snells_window_lies_at_the_critical_angle() {
    let frame = render(json!({
        "water": {},
        "lights": [{ "kind": "sky", "radiance_w_m2_sr": [100, 100, 100] }],
        "camera": { "position_m": [0, -2, 0], "target_m": [0, 0, 0], "up": [0, 0, -1], "vertical_fov_deg": 110 },
        "quality": { "pixel_samples": 8 },
        "output": { "kind": "view", "width": 201, "height": 201, "format": "exr", "layers": ["radiance"] }
    }));
    let row = &pixels(&frame)[100 * 201..101 * 201];
    let focal = 100.5 / 55.0_f64.to_radians().tan();
    let critical = (1.0 / IOR).asin();
    // What a pixel from `left` to `right` of the middle (in pixels) shows of a window that ends at `rim`, by its samples.
    let share = |left: f64, rim: f64| {
        let samples = (0..8).map(|i| left + (f64::from(i) + 0.5) / 8.0);
        let inside = samples.filter(|x| x.abs() <= rim).map(|x| {
            let cosine = (x / focal).atan().cos();
            1.0 - fresnel_reflectance(cosine, 1.0 / IOR)
        });
        IOR * IOR * 100.0 * inside.sum::<f64>() / 8.0
    };
    let rim = focal * critical.tan();
    // A row of samples does not run through the middle of the row, so rows differ a little.
    let error_of = |rim: f64| -> f64 {
        let pixels = row.iter().enumerate();
        pixels
            .map(|(x, seen)| (seen[0] - share(x as f64 - 100.5, rim)).abs())
            .sum()
    };
    let middle = 100.0 * IOR * IOR * (1.0 - fresnel_reflectance(1.0, 1.0 / IOR));
    assert!((row[100][0] / middle - 1.0).abs() <= 1e-4, "{:?}", row[100]);
    let best = (-20..=20)
        .map(|step| rim + f64::from(step) * 0.05)
        .min_by(|a, b| error_of(*a).total_cmp(&error_of(*b)))
        .unwrap();
    assert!((best - rim).abs() <= 0.1, "{best} {rim}");
    assert!(row[10] == [0.0; 3] && row[190] == [0.0; 3]);
}

#[test]
fn scenes_without_anything_to_mirror_have_one_way_for_each_ray() {
    let submerged = scene_files::load("teapot_pool", &[]);
    let facts = caustica::methods::facts(&submerged).unwrap();
    assert_eq!(facts.legs().count(), 1, "{}", facts.legs().reason);
    let ladder = scene_files::load("pool_ladder", &[]);
    let facts = caustica::methods::facts(&ladder).unwrap();
    assert_eq!(facts.legs().count(), 2, "{}", facts.legs().reason);
    let ladder = scene_files::load("pool_ladder", &[("/quality/bounces", "3")]);
    assert_eq!(caustica::methods::facts(&ladder).unwrap().legs().count(), 8);
}
