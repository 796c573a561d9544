//! Height fields: the surface, its rim, its frames, slopes, and what is refused or warned of.

use std::f64::consts::{PI, TAU};

use caustica::physics::fresnel::fresnel_transmittance;
use caustica::scene::{Issue, ResolvedScene};
use caustica::stats::Warning;
use caustica::waves::{ROW_POINTS, RowPoints, Surface};
use glam::DVec2;
use serde_json::{Value, json};

use super::field_support::{self as files, npy, sampled};

/// A scene with a height field with these fields.
pub(crate) fn with(field: Value) -> Value {
    json!({
        "water": { "waves": [field], "ior": 1.333 },
        "floor": { "depth_m": 1, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [3, 2, 1] }],
        "output": { "kind": "irradiance_map", "receiver": "floor" }
    })
}

fn surface(field: Value, file: Vec<u8>) -> Surface {
    Surface::of(&files::scene(with(field), &[file])).unwrap()
}

/// The issues of a scene that is refused.
pub(crate) fn issues(field: Value, files: &[Vec<u8>]) -> Vec<Issue> {
    files::try_scene(with(field), files)
        .expect_err("refused")
        .issues
}

pub(crate) fn refused(field: Value, file: Vec<u8>, pointer: &str, words: &str) {
    let found = issues(field, &[file]);
    let is_there = found.iter().any(|issue| {
        issue.pointer == format!("/water/waves/0/{pointer}")
            && issue.detail.contains(words)
            && !issue.accepted.is_empty()
    });
    assert!(is_there, "{pointer} {words}: {found:?}");
}

pub(crate) fn warnings(resolved: &ResolvedScene) -> Vec<Warning> {
    let facts = caustica::methods::facts_with_warnings(resolved).unwrap();
    facts.warnings
}

/// Two waves that repeat after 2 m along x and 1.5 m along z: height and slopes.
fn waves(x: f64, z: f64) -> [f64; 3] {
    let (kx, kz) = (TAU / 2.0, TAU / 1.5);
    let (a, b) = (kx * x + kz * z, 2.0 * kx * x - kz * z + 0.4);
    [
        0.02 * a.sin() + 0.01 * b.cos(),
        0.02 * kx * a.cos() - 0.02 * kx * b.sin(),
        0.02 * kz * a.cos() + 0.01 * kz * b.sin(),
    ]
}

const PERIODIC: [usize; 2] = [64, 48];

fn periodic_file(channel: usize) -> Vec<f64> {
    sampled(PERIODIC, [0.0; 2], [2.0 / 64.0, 1.5 / 48.0], |x, z| {
        waves(x, z)[channel]
    })
}

fn periodic() -> Value {
    json!({ "sample_m": 0.03125, "edges": "periodic", "min_m": [0, 0] })
}

#[test]
fn a_periodic_field_is_the_waves_it_was_sampled_from() {
    let surface = surface(periodic(), npy(&[48, 64], &periodic_file(0)));
    for i in 0..200 {
        let (x, z) = (f64::from(i) * 0.137 - 9.0, f64::from(i) * 0.211 + 3.0);
        let (point, curvature) = surface.curved_at(x, z);
        let [height, slope_x, slope_z] = waves(x, z);
        assert!((point.height_m - height).abs() < 2e-6, "{x} {z}");
        assert!(
            (point.slope - DVec2::new(slope_x, slope_z)).length() < 5e-5,
            "{x} {z}"
        );
        assert!(curvature.largest_per_m() <= surface.max_second_derivative_per_m());
    }
    let diagonal_m = TAU / DVec2::new(2.0 * TAU / 2.0, TAU / 1.5).length();
    assert!((surface.shortest_wave_m() - diagonal_m).abs() < 1e-12);
    assert_eq!(surface.slope_lost().next(), Some((0, 0.0)));
    assert!(
        warnings(&files::scene(
            with(periodic()),
            &[npy(&[48, 64], &periodic_file(0))]
        ))
        .is_empty()
    );
}

#[test]
fn every_layout_puts_each_number_at_its_place() {
    // The number at (x, z) says where it is: 5 samples along x, 7 along z.
    let value = |x: usize, z: usize| 1e-3 * (10 * x + z) as f64;
    for (rows_along, first_row) in [("x", "min"), ("x", "max"), ("z", "min"), ("z", "max")] {
        let (columns, rows) = if rows_along == "x" { (5, 7) } else { (7, 5) };
        let numbers: Vec<f64> = (0..rows * columns)
            .map(|i| {
                let (row, column) = (i / columns, i % columns);
                let row = if first_row == "min" {
                    row
                } else {
                    rows - 1 - row
                };
                if rows_along == "x" {
                    value(column, row)
                } else {
                    value(row, column)
                }
            })
            .collect();
        let field = json!({
            "sample_m": [0.5, 0.25], "rest_m": 0, "edges": "periodic", "rows_along": rows_along, "first_row": first_row
        });
        let surface = surface(field, npy(&[rows, columns], &numbers));
        for x in 0..5 {
            for z in 0..7 {
                // The middle of the samples is at (0, 0).
                let at = [0.5 * (x as f64 - 2.0), 0.25 * (z as f64 - 3.0)];
                let found = surface.at(at[0], at[1]).height_m;
                assert!(
                    (found - value(x, z)).abs() < 1e-14,
                    "{rows_along} {first_row} {x} {z}: {found}"
                );
            }
        }
    }
}

#[test]
fn scales_ranges_and_the_water_at_rest_are_applied() {
    let codes: Vec<u16> = (0..64).map(|i| i * 1040).collect();
    let png = files::png([8, 8], png::ColorType::Grayscale, 16, &codes);
    let high = f64::from(codes[63]);
    let cases: [(Value, Vec<u8>, f64); 4] = [
        (
            json!({ "range_m": [-0.1, 0.3], "rest_m": 0 }),
            png.clone(),
            -0.1 + 0.4 * high / 65535.0,
        ),
        (json!({ "range_m": [-0.1, 0.3] }), png, 0.2 * high / 65535.0),
        (
            json!({ "scale_m": 0.01, "rest_m": 10 }),
            npy(&[4, 4], &[1003.0; 16]),
            0.03,
        ),
        (json!({ "scale_m": 0.01 }), npy(&[4, 4], &[1003.0; 16]), 0.0),
    ];
    for (mut field, file, expected) in cases {
        field["sample_m"] = json!(0.1);
        field["edges"] = json!("periodic");
        field["min_m"] = json!([0, 0]);
        let side = if expected == 0.03 || expected == 0.0 {
            0.3
        } else {
            0.7
        };
        let found = surface(field, file).at(side, side).height_m;
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

/// A bounded field of 81 × 61 samples, 0.05 m apart, with its lowest corner at (1, −2).
fn bounded(rim_m: f64) -> (Value, Vec<u8>, Vec<f64>) {
    let numbers = sampled([81, 61], [1.0, -2.0], [0.05; 2], |x, z| waves(x, z)[0]);
    let field = json!({ "sample_m": 0.05, "min_m": [1, -2], "rest_m": 0, "rim_m": rim_m });
    (field, npy(&[61, 81], &numbers), numbers)
}

#[test]
fn a_bounded_field_is_itself_within_its_rim_and_flat_beyond() {
    let (field, file, numbers) = bounded(0.5);
    let surface = surface(field, file);
    let step = |t: f64| t * t * t * (10.0 + t * (6.0 * t - 15.0));
    for z in 0..61 {
        for x in 0..81 {
            let share =
                |i: usize, count: usize| step((i.min(count - 1 - i) as f64 / 10.0).min(1.0));
            let expected = numbers[z * 81 + x] * share(x, 81) * share(z, 61);
            let found = surface
                .at(1.0 + 0.05 * x as f64, -2.0 + 0.05 * z as f64)
                .height_m;
            assert!(
                (found - expected).abs() < 1e-12,
                "{x} {z}: {found} {expected}"
            );
        }
    }
    // 18 samples beyond the edges, what the spline swings out is over.
    for (x, z) in [
        (0.0999, 0.0),
        (5.9, 0.0),
        (3.0, -2.9001),
        (3.0, 1.9001),
        (1e9, -1e9),
        (f64::MAX, 0.0),
    ] {
        let (point, curvature) = surface.curved_at(x, z);
        assert_eq!(
            (point.height_m, point.slope, curvature.largest_per_m()),
            (0.0, DVec2::ZERO, 0.0),
            "{x} {z}"
        );
    }
    let just_beyond = surface.at(5.02, 0.0);
    assert!(just_beyond.height_m.abs() < 1e-4 && just_beyond.slope.length() < 5e-3);
    // 16 samples beyond, where the coefficients are cut off, nothing jumps.
    for i in 0..4000 {
        let at = surface.at(5.7 + f64::from(i) * 1e-4, 0.013 * f64::from(i % 100) - 1.0);
        assert!(at.height_m.abs() < 1e-10 && at.slope.length() < 1e-8);
    }
}

#[test]
fn bounds_hold_for_a_bounded_field_at_its_rim_too() {
    let (field, file, _) = bounded(0.15);
    let surface = surface(field, file);
    let (mut height, mut slope, mut curvature) = (0.0_f64, 0.0_f64, 0.0_f64);
    for i in 0..700 {
        for j in 0..600 {
            let (point, curved) =
                surface.curved_at(f64::from(i) * 0.01 - 0.4, f64::from(j) * 0.01 - 3.3);
            height = height.max(point.height_m.abs());
            slope = slope.max(point.slope.length());
            curvature = curvature.max(curved.largest_per_m());
            assert!(point.slope.x <= surface.max_slope_along(DVec2::X));
        }
    }
    for (found, bound) in [
        (height, surface.max_height_m()),
        (slope, surface.max_slope()),
        (curvature, surface.max_second_derivative_per_m()),
    ] {
        assert!(found <= bound && bound < 1.6 * found, "{found} {bound}");
    }
}

#[test]
fn rows_and_other_origins_have_the_same_surface() {
    let (mut field, file, _) = bounded(0.5);
    field["min_m"] = json!([1e6 + 1.0, -2e6 - 2.0]);
    let surface = surface(field, file);
    let origin = DVec2::new(1e6, -2e6);
    let moved = surface.recentred(origin);
    let step = DVec2::new(0.043, 0.019);
    let mut points = RowPoints::FLAT;
    moved
        .rows(step)
        .evaluate(DVec2::new(0.3, -1.7), &mut points);
    let mut highest: f64 = 0.0;
    for i in 0..ROW_POINTS {
        let at = DVec2::new(0.3, -1.7) + step * i as f64;
        let found = surface.at(origin.x + at.x, origin.y + at.y);
        assert!((points.height_m[i] - found.height_m).abs() < 1e-9);
        assert!((points.slope_x[i] - found.slope.x).abs() < 1e-8);
        highest = highest.max(found.height_m);
    }
    assert!(highest > 0.01);
    // It does not repeat: a copy at the far side of the origin would be wrong.
    assert_eq!(moved.at(-30.0, 0.0).height_m, 0.0);
}

/// Frames whose heights are a + b t + c t² at each sample: t is the frame's number.
fn sequence(count: usize) -> Vec<u8> {
    let numbers: Vec<f64> = (0..count)
        .flat_map(|frame| (0..36).map(move |i| at_frame(i, frame as f64)))
        .collect();
    npy(&[count, 6, 6], &numbers)
}

fn at_frame(sample: usize, t: f64) -> f64 {
    1e-3 * (sample as f64 + (3.0 - sample as f64 % 5.0) * t + 0.5 * t * t)
}

fn height_at(more: &Value, time_s: f64, sample: usize) -> f64 {
    let mut field = json!({ "sample_m": 0.1, "min_m": [0, 0], "edges": "periodic", "rest_m": 0, "frames_per_s": 30, "start_s": 2 });
    for (name, value) in more.as_object().unwrap() {
        field[name] = value.clone();
    }
    let mut scene = with(field);
    scene["time_s"] = json!(time_s);
    let surface = Surface::of(&files::scene(scene, &[sequence(7)])).unwrap();
    surface
        .at(0.1 * (sample % 6) as f64, 0.1 * (sample / 6) as f64)
        .height_m
}

#[test]
fn frames_are_exact_at_their_times_and_smooth_between() {
    let close =
        |found: f64, expected: f64| assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    for frame in (0..7).map(f64::from) {
        // The time as it is written in a file of frames.
        let time_s = 2.0 + frame / 30.0;
        close(height_at(&json!({}), time_s, 8), at_frame(8, frame));
    }
    // Between two frames that have neighbours, a parabola in time is exact.
    for t in [1.25, 2.5, 4.9] {
        close(height_at(&json!({}), 2.0 + t / 30.0, 21), at_frame(21, t));
    }
    for (time_s, frame) in [(-50.0, 0.0), (1.99, 0.0), (2.5, 6.0), (1e12, 6.0)] {
        close(
            height_at(&json!({ "after": "hold" }), time_s, 3),
            at_frame(3, frame),
        );
    }
    let looped = json!({ "after": "loop" });
    for (frames, frame) in [(0, 0), (7, 0), (8, 1), (-1, 6), (-7, 0), (700_003, 3)] {
        let time_s = 2.0 + f64::from(frames) / 30.0;
        close(height_at(&looped, time_s, 3), at_frame(3, f64::from(frame)));
    }
    // From the last frame to the first it goes smoothly on.
    let between = height_at(&looped, 2.0 + 6.5 / 30.0, 3);
    let [a, b, c, d] = [5.0, 6.0, 0.0, 1.0].map(|frame| at_frame(3, frame));
    close(between, (-a + 9.0 * b + 9.0 * c - d) / 16.0);
}

#[test]
fn frames_may_be_files_of_their_own_and_repeat() {
    let file = |height: f64| npy(&[4, 4], &[height; 16]);
    let mut scene =
        with(json!({ "sample_m": 1, "edges": "periodic", "rest_m": 0, "frames_per_s": 1 }));
    let ids: Vec<Vec<u8>> = [0.1, 0.2, 0.1].map(file).into();
    for (time_s, height_m) in [(0, 0.1), (1, 0.2), (2, 0.1)] {
        scene["time_s"] = json!(time_s);
        let found = Surface::of(&files::scene(scene.clone(), &ids))
            .unwrap()
            .at(0.3, 0.4)
            .height_m;
        assert!((found - height_m).abs() < 1e-14);
    }
    // The mean of all frames is the water at rest.
    scene["water"]["waves"][0]["rest_m"] = Value::Null;
    let found = Surface::of(&files::scene(scene, &ids))
        .unwrap()
        .at(0.3, 0.4)
        .height_m;
    assert!((found - (0.1 - 0.4 / 3.0)).abs() < 1e-14, "{found}");
}

#[test]
fn slopes_of_a_surface_give_it_back() {
    let slopes: Vec<f64> = periodic_file(1)
        .into_iter()
        .zip(periodic_file(2))
        .flat_map(|(x, z)| [x, z])
        .collect();
    let mut field = periodic();
    field["holds"] = json!("slopes");
    let surface = surface(field, npy(&[48, 64, 2], &slopes));
    for i in 0..100 {
        let (x, z) = (f64::from(i) * 0.137, f64::from(i) * 0.211);
        assert!((surface.at(x, z).height_m - waves(x, z)[0]).abs() < 2e-6);
    }

    // Bounded, on a grid that no wave fits, with far steeper slopes along z.
    let size = [90, 70];
    let heights = sampled(size, [0.0; 2], [0.02, 0.015], |x, z| waves(x, z)[0]);
    let slopes = sampled(size, [0.0; 2], [0.02, 0.015], |x, z| waves(x, z)[1]);
    let slopes = slopes
        .into_iter()
        .zip(sampled(size, [0.0; 2], [0.02, 0.015], |x, z| {
            waves(x, z)[2]
        }));
    let slopes: Vec<f64> = slopes.flat_map(|(x, z)| [x, z]).collect();
    let field =
        json!({ "holds": "slopes", "sample_m": [0.02, 0.015], "min_m": [0, 0], "rim_m": 0.2 });
    let resolved = files::scene(with(field), &[npy(&[70, 90, 2], &slopes)]);
    let surface = Surface::of(&resolved).unwrap();
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let mut worst: f64 = 0.0;
    for z in 14..56 {
        for x in 10..80 {
            let found = surface.at(0.02 * x as f64, 0.015 * z as f64).height_m;
            worst = worst.max((found - heights[z * 90 + x] + mean).abs());
        }
    }
    println!("bounded slopes: {worst:e} m of 0.03");
    assert!(worst < 3e-7, "{worst:e}");
    assert!(
        warnings(&resolved)
            .iter()
            .all(|warning| warning.code != "slopes_are_no_gradient")
    );
}

#[test]
fn slopes_that_no_surface_has_are_reported_with_their_share() {
    // A wave along x whose slope is along x, and one whose slope is across: the second belongs to no surface.
    let share_of = |across: f64, edges: &str, side: u32| {
        let numbers: Vec<f64> = (0..side * side)
            .flat_map(|i| {
                let wave = (TAU * 2.0 * (f64::from(i % side) + 0.5) / f64::from(side)).cos();
                [0.1 * wave, 0.1 * across * wave]
            })
            .collect();
        let field = json!({ "holds": "slopes", "sample_m": 6.4 / f64::from(side), "edges": edges });
        let resolved = files::scene(
            with(field),
            &[npy(&[side as usize, side as usize, 2], &numbers)],
        );
        let all = warnings(&resolved);
        let found = all
            .into_iter()
            .find(|warning| warning.code == "slopes_are_no_gradient");
        found.map(|warning| {
            assert_eq!(warning.pointer.as_deref(), Some("/water/waves/0"));
            let (percent, _) = warning.message.split_once(" %").unwrap();
            percent.parse::<f64>().unwrap()
        })
    };
    assert_eq!(share_of(0.0, "periodic", 64), None);
    assert_eq!(share_of(0.09, "periodic", 64), None);
    assert_eq!(share_of(1.0, "periodic", 64), Some(50.0));
    assert_eq!(share_of(0.5, "periodic", 64), Some(20.0));
    assert_eq!(share_of(0.0, "bounded", 64), None);
    // Within edges, a surface takes a part: f(z) cos kx with f = sinh(kz)/(k cosh(kL/2)), whose share of a length L is 2 tanh(kL/2)/(kL).
    // Two waves fit into the length. The rises end half a sample from the edges, which is 0.3 % here.
    let half = TAU * 2.0 / 2.0;
    let expected = 50.0 * (1.0 - half.tanh() / half);
    let bounded = share_of(1.0, "bounded", 256).unwrap();
    assert!((bounded - expected).abs() < 0.4, "{bounded} {expected}");
}

#[test]
fn light_through_the_rim_is_that_of_its_area() {
    // Nearly flat, so that the window is the floor of 4 × 4 m.
    let numbers: Vec<f64> = (0..41 * 41)
        .map(|i| if i % 2 == 0 { 1e-9 } else { -1e-9 })
        .collect();
    let field = json!({ "sample_m": 0.05, "rim_m": 0.25, "min_m": [-1.5, -1] });
    let resolved = files::scene(with(field), &[npy(&[41, 41], &numbers)]);
    let all = warnings(&resolved);
    let rim = all
        .iter()
        .find(|warning| warning.code == "height_field_rim")
        .unwrap();
    assert_eq!(rim.pointer.as_deref(), Some("/water/waves/0"));
    let area_m2 = 2.0 * 2.0 - 1.5 * 1.5;
    let entering = fresnel_transmittance(1.0, 1.333);
    for (found, irradiance) in rim.flux_w.unwrap().into_iter().zip([3.0, 2.0, 1.0]) {
        assert!(
            (found / (irradiance * area_m2 * entering) - 1.0).abs() < 1e-9,
            "{found}"
        );
    }
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    assert!(
        rim.message.contains(&percent(area_m2 / 16.0)),
        "{}",
        rim.message
    );
    assert!(
        rim.message
            .contains(&format!("and {} beyond", percent(12.0 / 16.0))),
        "{}",
        rim.message
    );

    // A field that is flat at its rim has none.
    let middle = sampled([41, 41], [-1.0; 2], [0.05; 2], |x, z| {
        if x.abs().max(z.abs()) < 0.7 {
            1e-3 * (PI * x).cos()
        } else {
            0.0
        }
    });
    let field = json!({ "sample_m": 0.05, "rim_m": 0.25, "rest_m": 0 });
    let resolved = files::scene(with(field), &[npy(&[41, 41], &middle)]);
    assert!(
        warnings(&resolved)
            .iter()
            .all(|warning| warning.code != "height_field_rim")
    );
}

#[test]
fn light_of_a_lamp_through_the_rim_is_that_of_its_solid_angle() {
    let numbers: Vec<f64> = (0..41 * 41)
        .map(|i| if i % 2 == 0 { 1e-9 } else { -1e-9 })
        .collect();
    let mut scene = with(json!({ "sample_m": 0.05, "rim_m": 0.5 }));
    scene["water"]["ior"] = json!(1.0);
    scene["lights"] =
        json!([{ "kind": "point", "position_m": [0, 1.2, 0], "intensity_w_sr": [1, 1, 1] }]);
    let all = warnings(&files::scene(scene, &[npy(&[41, 41], &numbers)]));
    let rim = all
        .iter()
        .find(|warning| warning.code == "height_field_rim")
        .unwrap();
    // Solid angle of a square of half side a at the distance h: 4 asin(a²/(a² + h²)).
    let solid = |a: f64| 4.0 * (a * a / (a * a + 1.44)).asin();
    let expected = solid(1.0) - solid(0.5);
    let found = rim.flux_w.unwrap()[0];
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
}

#[test]
fn coarse_numbers_are_warned_of() {
    let numbers = periodic_file(0);
    let codes = |steps: f64| -> Vec<u16> {
        let codes = numbers
            .iter()
            .map(|h| ((h + 0.05) / 0.1 * steps).round() as u16);
        codes.collect()
    };
    let coarse = |range_m: f64, steps: f64| {
        let mut field = periodic();
        field["range_m"] = json!([0, range_m]);
        let png = files::png([64, 48], png::ColorType::Grayscale, 16, &codes(steps));
        let all = warnings(&files::scene(with(field), &[png]));
        all.iter()
            .any(|warning| warning.code == "height_field_coarse_numbers")
    };
    // All 16 bits, and as many steps as 8 bits have.
    assert!(!coarse(0.1, 65535.0));
    assert!(coarse(0.1 * 257.0, 255.0));
}

/// Absolute heights: water at rest is what a bounded field has at its edges, so that a bump stays where it is.
#[test]
fn the_water_at_rest_of_a_bounded_field_is_that_of_its_edges() {
    let bump = |i: usize| {
        let (x, z) = ((i % 41) as f64 - 20.0, (i / 41) as f64 - 20.0);
        7.0 + 0.2 * (-(x * x + z * z) / 18.0).exp()
    };
    let numbers: Vec<f64> = (0..41 * 41).map(bump).collect();
    let surface = surface(json!({ "sample_m": 0.1 }), npy(&[41, 41], &numbers));
    assert!((surface.at(0.0, 0.0).height_m - 0.2).abs() < 1e-8);
    assert!(surface.at(1.99, 1.99).height_m.abs() < 1e-8);
    // A periodic one has no edges: the mean is.
    let field = json!({ "sample_m": 0.1, "edges": "periodic" });
    let mean = numbers.iter().sum::<f64>() / 1681.0;
    let found = self::surface(field, npy(&[41, 41], &numbers)).at(0.0, 0.0);
    assert!((found.height_m - (7.2 - mean)).abs() < 1e-12);
}

#[test]
fn the_same_field_is_computed_once_and_a_changed_one_anew() {
    let scene = |more: Value, time_s: f64, file: Vec<u8>| {
        let mut field = periodic();
        for (name, value) in more.as_object().unwrap() {
            field[name] = value.clone();
        }
        let mut scene = with(field);
        scene["time_s"] = json!(time_s);
        files::scene(scene, &[file])
    };
    let file = || npy(&[48, 64], &periodic_file(0));
    let first = scene(json!({}), 0.0, file());
    let surface = Surface::of(&first).unwrap();
    let bytes = first.kept.bytes();
    assert!(bytes >= 64 * 48 * 8);
    // Of a single frame the surface does not depend on time.
    let at = |more: Value, time_s: f64, file: Vec<u8>| {
        let again = ResolvedScene {
            kept: first.kept.clone(),
            ..scene(more, time_s, file)
        };
        (
            Surface::of(&again).unwrap() == surface,
            again.kept.bytes() == bytes,
        )
    };
    assert_eq!(at(json!({}), 7.0, file()), (true, true));
    assert_eq!(at(json!({ "scale_m": 2 }), 0.0, file()), (false, false));
    let mut other = periodic_file(0);
    other[5] += 1e-3;
    assert!(!at(json!({}), 0.0, npy(&[48, 64], &other)).0);
}
