//! The reference of views and of maps on objects, against closed forms, against the map on the floor, and against itself.

use std::sync::atomic::{AtomicU32, Ordering};

use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::refraction::{direction_to_light, refract_direction};
use caustica::physics::sky::{sky_irradiance, sky_path_factor};
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::reference::{ReferenceError, Truth, TruthKind, TruthSettings, shadow_edge, truth};
use caustica::scene::{Light, ResolvedScene, Sun};
use caustica::waves::Surface;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use crate::reference::count;
use crate::scene_files::{mesh_of, with_meshes};
use crate::truths::truth_to as find;

/// A closed box of half sizes `half` around the origin, as OBJ; every face has its own normal.
pub(crate) fn box_obj(half: Vec3) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for i in 0..8 {
        let sign = |bit: i32| if i & bit == 0 { -1.0 } else { 1.0 };
        let (x, y, z) = (half.x * sign(1), half.y * sign(2), half.z * sign(4));
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    for n in ["-1 0 0", "1 0 0", "0 -1 0", "0 1 0", "0 0 -1", "0 0 1"] {
        writeln!(text, "vn {n}").unwrap();
    }
    let faces = [
        [1, 5, 7, 3],
        [2, 4, 8, 6],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 3, 4, 2],
        [5, 6, 8, 7],
    ];
    for (n, face) in faces.iter().enumerate() {
        let [a, b, c, d] = face.map(|v| format!("{v}//{}", n + 1));
        writeln!(text, "f {a} {b} {c} {d}").unwrap();
    }
    text
}

/// A pool with a box; `change` edits the JSON.
pub(crate) fn pool(half: Vec3, change: impl FnOnce(&mut Value)) -> ResolvedScene {
    let mesh = mesh_of(box_obj(half).as_bytes());
    let mut value = json!({
        "water": { "waves": [], "absorption_per_m": [0.3, 0.06, 0.0] },
        "floor": { "depth_m": 1.5, "size_m": [20, 20] },
        "lights": [{ "kind": "sun", "elevation_deg": 60, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": [{ "mesh": mesh.id, "translation_m": [0, -1, 0] }],
        "camera": { "position_m": [0.2, 3, 0.3], "target_m": [0, -1.5, 0], "vertical_fov_deg": 20 },
        "quality": { "level_map_texels": 32 },
        "output": { "kind": "view", "width": 32, "height": 24 }
    });
    change(&mut value);
    with_meshes(value, &[mesh])
}

fn waves() -> Value {
    json!([
        { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9, "direction_deg": 10 },
        { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.6, "direction_deg": 110, "phase_deg": 70 }
    ])
}

fn settings(target_error: f64) -> TruthSettings {
    TruthSettings {
        target_error: Some(target_error),
        ..TruthSettings::default()
    }
}

fn sun(scene: &ResolvedScene, index: usize) -> Sun {
    match &scene.scene.lights[index] {
        Light::Sun(sun) => sun.clone(),
        Light::Point(_) | Light::Sky(_) => panic!("a sun"),
    }
}

#[track_caller]
fn assert_near(got: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for c in 0..3 {
        assert!(
            (got[c] - expected[c]).abs() <= tolerance * expected[c],
            "{got:?}, expected {expected:?}"
        );
    }
}

#[test]
fn flat_water_leaves_the_second_surface_of_a_box_dark() {
    let map = |layer: u32| {
        let scene = pool(Vec3::new(0.3, 0.2, 0.1), |v| {
            v["quality"]["layers"] = json!(3);
            v["output"] = json!({ "kind": "irradiance_map", "receiver": 0, "layer": layer });
        });
        find(&scene, 1e-2)
    };
    let (top, bottom, nothing) = (map(0), map(1), map(2));
    // Every ray along the axis that enters a closed box leaves it once, and meets nothing more.
    assert_eq!(top.compared, bottom.compared);
    assert!(top.compared.iter().any(|&compared| compared));
    assert!(nothing.compared.iter().all(|&compared| !compared));
    assert!(bottom.irradiance.iter().all(|&e| e == [0.0; 3]));
    let shadow = bottom.shadow.unwrap();
    let dark = shadow
        .iter()
        .zip(&bottom.compared)
        .filter(|(s, _)| **s == 1.0);
    let inside = bottom.compared.iter().filter(|&&compared| compared).count();
    assert!(
        dark.count() * 10 > inside * 8,
        "the box's own top stops the light"
    );
    assert!(top.irradiance.iter().any(|e| e[0] > 100.0));
}

#[test]
fn flat_water_seen_from_above_is_the_closed_form() {
    let scene = pool(Vec3::new(0.1, 0.1, 0.1), |v| {
        v["camera"]["target_m"] = json!([2, -1.5, 2]);
        v["lights"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "kind": "sky", "radiance_w_m2_sr": [20, 30, 40] }));
    });
    let truth = find(&scene, 1e-3);
    assert_eq!(
        (truth.kind, truth.width, truth.height, truth.pixel_step),
        (TruthKind::View, 32, 24, 1)
    );
    assert_eq!(truth.irradiance.len(), 32 * 24);
    let mut expected = flat_water_irradiance(&scene.scene.water, 1.5, &sun(&scene, 0));
    let through = caustica::physics::fresnel::diffuse_transmittance(1.333);
    for (c, radiance) in [20.0, 30.0, 40.0].into_iter().enumerate() {
        let extinction = scene.scene.water.absorption_per_m[c];
        expected[c] += sky_irradiance(
            radiance,
            through,
            extinction,
            1.5,
            sky_path_factor(1.333),
            1.0,
            1.333f64.powi(-2),
        );
    }
    for value in &truth.irradiance {
        assert_near(*value, expected, 1e-6);
    }
    assert!(truth.compared.iter().all(|&compared| compared));
    assert!(truth.relative_error < 1e-10);
    assert!(truth.shadow.unwrap().iter().all(|&share| share == 0.0));
}

#[test]
fn the_top_of_a_box_is_as_deep_as_it_lies() {
    let scene = pool(Vec3::new(0.5, 0.1, 0.5), |_| ());
    let found = find(&scene, 1e-3);
    let expected = flat_water_irradiance(&scene.scene.water, 0.9, &sun(&scene, 0));
    // The camera looks at the middle of the top; f32 corners lie within 10⁻⁷ m.
    let middle = found.irradiance[12 * 32 + 16];
    assert_near(middle, expected, 1e-6);
}

#[test]
fn a_tilted_plate_follows_the_cosine() {
    for (tilt_deg, elevation_deg) in [(25.0f64, 60.0), (-30.0, 75.0)] {
        let (sin, cos) = (tilt_deg.to_radians() / 2.0).sin_cos();
        let change = |v: &mut Value| {
            v["objects"][0]["rotation"] = json!([0, 0, sin, cos]);
            v["water"]["absorption_per_m"] = json!([0, 0, 0]);
            v["lights"][0]["elevation_deg"] = json!(elevation_deg);
        };
        let scene = pool(Vec3::new(0.5, 0.005, 0.5), change);
        let sun = sun(&scene, 0);
        let l = direction_to_light(sun.elevation_deg.to_radians(), sun.azimuth_deg.to_radians());
        let t = refract_direction(-l, DVec3::Y, 1.333).unwrap();
        let (sin, cos) = tilt_deg.to_radians().sin_cos();
        let normal = DVec3::new(-sin, cos, 0.0);
        let share = l.y * fresnel_transmittance(l.y, 1.333) * -t.dot(normal) / -t.y;
        let expected = sun.irradiance_w_m2.map(|e| e * share);
        let view = find(&scene, 1e-3);
        assert_near(view.irradiance[12 * 32 + 16], expected, 1e-6);
        let map = pool(Vec3::new(0.5, 0.005, 0.5), |v| {
            change(v);
            v["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
        });
        let map = find(&map, 1e-3);
        assert_eq!(
            (map.kind, map.width, map.height),
            (TruthKind::ObjectMap, 32, 32)
        );
        assert!(map.compared[16 * 32 + 16] && !map.compared[0]);
        assert_near(map.irradiance[16 * 32 + 16], expected, 2e-6);
    }
}

#[test]
fn the_map_on_a_box_has_the_light_that_landed_on_it() {
    // Whole texels: 28 and 20 of them; too thin for its sides to take light.
    let half = Vec3::new(0.4, 0.002, 0.4 * 20.0 / 28.0);
    let flat_or_not = [json!([]), waves()];
    for (wavy, waves) in flat_or_not.into_iter().enumerate() {
        let water = |v: &mut Value| {
            v["water"]["waves"] = waves.clone();
            v["lights"][0]["elevation_deg"] = json!(90);
        };
        let on_object = pool(half, |v| {
            water(v);
            v["output"] = json!({ "kind": "irradiance_map", "receiver": 0 });
        });
        let map = find(&on_object, 4e-3);
        if wavy == 0 {
            let expected =
                flat_water_irradiance(&on_object.scene.water, 0.998, &sun(&on_object, 0));
            for value in [16 * 32 + 16, 10 * 32 + 20].map(|at| map.irradiance[at]) {
                assert_near(value, expected, 2e-6);
            }
        }
        let on_floor = pool(half, |v| {
            water(v);
            v["output"] = json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 32, "height": 32 });
        });
        let counted = count(&on_floor, 2_000_000);
        // Under a sun in the zenith the texels of the map lie level.
        let side = 2.0 * 0.4 * 32.0 / 28.0 / 32.0;
        let total: f64 = map.irradiance.iter().map(|e| e[1]).sum::<f64>() * side * side;
        let landed = counted.landed_w[1][1];
        assert!((total / landed - 1.0).abs() < 2e-3, "{total} {landed}");
    }
}

#[test]
fn points_on_the_floor_agree_with_the_map_of_the_floor() {
    let change = |v: &mut Value| v["water"]["waves"] = waves();
    let view = pool(Vec3::splat(0.1), |v| {
        change(v);
        v["camera"] = json!({ "kind": "orthographic", "position_m": [0, -1.2, 0], "target_m": [0, -1.5, 0], "up": [0, 0, -1], "height_m": 0.8 });
        v["output"] = json!({ "kind": "view", "width": 16, "height": 16 });
        v["objects"][0]["translation_m"] = json!([0.15, -1, 0]);
    });
    let map = pool(Vec3::splat(0.1), |v| {
        change(v);
        v["output"] = json!({ "kind": "irradiance_map", "receiver": "floor", "min_m": [-0.4, -0.4], "max_m": [0.4, 0.4], "width": 16, "height": 16 });
        v["objects"][0]["translation_m"] = json!([0.15, -1, 0]);
    });
    // Seen from straight above under the water, pixels are texels of 5 cm: the same squares, found two ways.
    let (points, texels) = (find(&view, 2e-3), find(&map, 2e-3));
    let (mut difference, mut total) = (0.0, 0.0);
    for (a, b) in points
        .irradiance
        .iter()
        .flatten()
        .zip(texels.irradiance.iter().flatten())
    {
        difference += (a - b).abs();
        total += b;
    }
    let limit = points.relative_error + texels.relative_error;
    assert!(
        difference / total < 1.5 * limit,
        "{} {limit}",
        difference / total
    );
    let (a, b) = (
        points.shadow.clone().unwrap(),
        texels.shadow.clone().unwrap(),
    );
    assert!(b.iter().any(|&share| share > 0.9), "the box casts a shadow");
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 0.03, "{a} {b}");
    }
    assert_eq!(points.shadow_edge(0), texels.shadow_edge(0));
}

#[test]
fn suns_add_up() {
    let with = |lights: Value| {
        find(
            &pool(Vec3::splat(0.3), |v| {
                v["lights"] = lights;
                v["water"]["waves"] = waves();
                v["output"] = json!({ "kind": "view", "width": 8, "height": 6 });
            }),
            5e-3,
        )
    };
    let one = json!({ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [100, 200, 300] });
    let two = json!({ "kind": "sun", "elevation_deg": 45, "azimuth_deg": 120, "irradiance_w_m2": [300, 100, 0] });
    let set = json!({ "kind": "sun", "elevation_deg": -5, "irradiance_w_m2": [300, 100, 0] });
    let (a, b, both) = (
        with(json!([one])),
        with(json!([two])),
        with(json!([one, two, set])),
    );
    let (mut difference, mut total) = (0.0, 0.0);
    for i in 0..both.irradiance.len() {
        for c in 0..3 {
            difference += (a.irradiance[i][c] + b.irradiance[i][c] - both.irradiance[i][c]).abs();
            total += both.irradiance[i][c];
        }
    }
    assert!(difference / total < 1.5e-2, "{}", difference / total);
}

#[test]
fn the_estimate_of_the_error_is_honest() {
    let scene = |output: Value| {
        pool(Vec3::new(0.3, 0.1, 0.3), |v| {
            v["water"]["waves"] = waves();
            v["output"] = output;
        })
    };
    for output in [
        json!({ "kind": "view", "width": 16, "height": 12 }),
        json!({ "kind": "irradiance_map", "receiver": 0 }),
    ] {
        let scene = scene(output);
        let short = find(&scene, 2e-2);
        let more = TruthSettings {
            target_error: None,
            max_rays: 20 * short.rays,
            ..TruthSettings::default()
        };
        let long = truth(&scene, &more, &|_| (), &|| false).unwrap();
        assert!(long.rays > 10 * short.rays && long.rays <= 22 * short.rays);
        assert!(short.relative_error <= 2e-2 && long.relative_error < 0.5 * short.relative_error);
        let (mut difference, mut total) = (0.0, 0.0);
        for (a, b) in short
            .irradiance
            .iter()
            .flatten()
            .zip(long.irradiance.iter().flatten())
        {
            difference += (a - b).abs();
            total += b;
        }
        assert!(
            difference / total < 2.0 * short.relative_error,
            "{} {}",
            difference / total,
            short.relative_error
        );
    }
}

#[test]
fn dry_points_and_empty_pixels() {
    // Half the picture is sky; a box stands in the air.
    let scene = pool(Vec3::splat(0.3), |v| {
        v["objects"][0]["translation_m"] = json!([0, 1, 0]);
        v["camera"] =
            json!({ "position_m": [0, 4, 0.01], "target_m": [0, 1, 0], "vertical_fov_deg": 5 });
        v["output"] = json!({ "kind": "view", "width": 6, "height": 4 });
    });
    let found = find(&scene, 1e-3);
    let expected = sun(&scene, 0)
        .irradiance_w_m2
        .map(|e| e * 60f64.to_radians().sin());
    for value in &found.irradiance {
        assert_near(*value, expected, 1e-12);
    }
    let away = pool(Vec3::splat(0.3), |v| {
        v["camera"]["target_m"] = json!([5, 9, 3]);
    });
    let found = find(&away, 1e-3);
    assert!(found.compared.iter().all(|&compared| !compared));
    assert!(found.irradiance.iter().flatten().all(|&value| value == 0.0));
}

#[test]
fn a_floor_map_may_have_the_sky() {
    let scene = |sky: bool| {
        pool(Vec3::splat(0.1), |v| {
            v["lights"]
                .as_array_mut()
                .unwrap()
                .push(json!({ "kind": "sky", "radiance_w_m2_sr": [20, 30, 40] }));
            v["output"] = json!({ "kind": "irradiance_map", "receiver": "floor", "width": 8, "height": 8, "include_sky": sky });
        })
    };
    let (with, without) = (find(&scene(true), 1e-2), find(&scene(false), 1e-2));
    let through = caustica::physics::fresnel::diffuse_transmittance(1.333);
    let expected = sky_irradiance(
        40.0,
        through,
        0.0,
        1.5,
        sky_path_factor(1.333),
        1.0,
        1.333f64.powi(-2),
    );
    for (a, b) in with.irradiance.iter().zip(&without.irradiance) {
        assert!((a[2] - b[2] - expected).abs() < 1e-9);
    }
}

#[test]
fn cancelling_ends_the_computation() {
    for output in [
        json!({ "kind": "view", "width": 64, "height": 64 }),
        json!({ "kind": "irradiance_map", "receiver": 0 }),
        json!({ "kind": "irradiance_map", "receiver": "floor" }),
    ] {
        let scene = pool(Vec3::splat(0.3), |v| {
            v["water"]["waves"] = waves();
            v["output"] = output;
        });
        let asked = AtomicU32::new(0);
        let cancelled = || asked.fetch_add(1, Ordering::Relaxed) > 20;
        let error = truth(&scene, &settings(1e-6), &|_| (), &cancelled).unwrap_err();
        assert_eq!(error, ReferenceError::Cancelled);
    }
}

#[test]
fn questions_without_sense_are_errors() {
    let ask = |scene: &ResolvedScene, settings: &TruthSettings| {
        truth(scene, settings, &|_| (), &|| false)
            .unwrap_err()
            .to_string()
    };
    let good = pool(Vec3::ONE, |_| ());
    let none = TruthSettings {
        most_points: 0,
        ..settings(1e-2)
    };
    assert!(ask(&good, &none).contains("most_points"));
    assert!(ask(&good, &settings(-1.0)).contains("target_error"));
    let mut blind = good.clone();
    blind.scene.camera = None;
    assert!(ask(&blind, &settings(1e-2)).contains("no camera"));
}

/// Plain rays, one in each cell of a fine grid, with the functions of `physics` only: the irradiance of a square.
fn plain_count(scene: &ResolvedScene, center_m: DVec3, normal: DVec3, side_m: f64) -> f64 {
    let surface = Surface::of(scene).unwrap();
    let sun = sun(scene, 0);
    let l = direction_to_light(sun.elevation_deg.to_radians(), sun.azimuth_deg.to_radians());
    let (u, v) = normal.any_orthonormal_pair();
    let (cells, reach_m) = (2400, 1.0);
    let cell_m = 2.0 * reach_m / f64::from(cells);
    let mut sum = 0.0;
    for j in 0..cells {
        for i in 0..cells {
            let jitter = |n: u32| (f64::from(n) * 0.618_033_988_749_895).fract();
            let x = (f64::from(i) + jitter(i + 7 * j)) * cell_m - reach_m + center_m.x + 0.4;
            let z = (f64::from(j) + jitter(5 * i + 3 * j)) * cell_m - reach_m + center_m.z + 0.2;
            let at = surface.at(x, z);
            let n = caustica::waves::normal(at);
            let cos_i = n.dot(l);
            let Some(t) = refract_direction(-l, n, 1.333) else {
                continue;
            };
            let from_m = DVec3::new(x, at.height_m, z);
            let path_m = (center_m - from_m).dot(normal) / t.dot(normal);
            let off_m = from_m + t * path_m - center_m;
            if t.dot(normal) < 0.0
                && off_m.dot(u).abs() <= 0.5 * side_m
                && off_m.dot(v).abs() <= 0.5 * side_m
            {
                let entered = cos_i.max(0.0) / n.y * fresnel_transmittance(cos_i, 1.333);
                sum += entered * (-0.3 * path_m).exp();
            }
        }
    }
    sum * cell_m * cell_m / (side_m * side_m) * sun.irradiance_w_m2[0]
}

#[test]
fn the_search_finds_all_light_on_tilted_squares() {
    // From gentle to steep water; a plate that faces the light, one that lies level, and one that is grazed.
    for (height, tilt_deg) in [
        (1.0, 0.0f64),
        (1.0, -30.0),
        (2.0, 50.0),
        (2.0, 62.0),
        (3.0, -15.0),
    ] {
        let (sin, cos) = tilt_deg.to_radians().sin_cos();
        let (half_sin, half_cos) = (tilt_deg.to_radians() / 2.0).sin_cos();
        let normal = DVec3::new(-sin, cos, 0.0);
        let center_m = DVec3::new(0.0, -1.0, 0.0) + normal * 0.01;
        let eye_m = center_m + normal * 0.3;
        let side_m = 0.12;
        let scene = pool(Vec3::new(0.3, 0.01, 0.3), |v| {
            v["objects"][0]["rotation"] = json!([0, 0, half_sin, half_cos]);
            v["water"]["waves"] = waves();
            for wave in v["water"]["waves"].as_array_mut().unwrap() {
                wave["amplitude_m"] = json!(wave["amplitude_m"].as_f64().unwrap() * height);
            }
            v["camera"] = json!({ "kind": "orthographic", "position_m": eye_m.to_array(), "target_m": center_m.to_array(), "up": [0, 0, 1], "height_m": side_m });
            v["output"] = json!({ "kind": "view", "width": 1, "height": 1 });
        });
        // All rays at once: two halves of one value may be alike by chance.
        let many = TruthSettings {
            target_error: None,
            max_rays: 1_000_000,
            ..TruthSettings::default()
        };
        let got = truth(&scene, &many, &|_| (), &|| false).unwrap().irradiance[0][0];
        let expected = plain_count(&scene, center_m, normal, side_m);
        assert!(expected > 1.0, "{height} {tilt_deg}: {expected}");
        assert!(
            // Some 2000 plain rays hit the grazed square, ten times as many the others.
            (got / expected - 1.0).abs() < if tilt_deg > 60.0 { 5e-3 } else { 5e-4 },
            "{height} {tilt_deg}: {got} {expected}"
        );
    }
}

#[test]
fn shadow_edges_are_where_the_shadow_changes() {
    let mut truth = Truth {
        kind: TruthKind::FloorMap,
        width: 7,
        height: 3,
        first_pixel: [0, 0],
        pixel_step: 1,
        irradiance: vec![[0.0; 3]; 21],
        compared: vec![true; 21],
        relative_error: 0.0,
        rays: 0,
        shadow: None,
        seconds: 0.0,
        from_disk: false,
    };
    assert_eq!(truth.shadow_edge(1), None);
    let mut shadow = vec![0.0; 21];
    shadow[7] = 1.0; // first of the middle row
    truth.shadow = Some(shadow);
    let picture = |edge: Vec<bool>| -> Vec<String> {
        let row = |row: &[bool]| row.iter().map(|&e| if e { '#' } else { '.' }).collect();
        edge.chunks(7).map(row).collect()
    };
    assert_eq!(
        picture(truth.shadow_edge(0).unwrap()),
        ["#......", "##.....", "#......"]
    );
    assert_eq!(
        picture(truth.shadow_edge(1).unwrap()),
        ["###....", "###....", "###...."]
    );
    truth.shadow = Some([vec![0.01; 10], vec![0.4], vec![0.01; 10]].concat());
    assert_eq!(
        picture(truth.shadow_edge(0).unwrap()),
        [".......", "...#...", "......."]
    );
    truth.compared[10] = false;
    assert_eq!(picture(truth.shadow_edge(2).unwrap()), ["......."; 3]);
}

#[test]
fn the_shadow_edges_of_a_view_are_found_at_all_its_pixels() {
    let view = pool(Vec3::splat(0.1), |v| {
        v["water"]["waves"] = waves();
        v["camera"] = json!({ "kind": "orthographic", "position_m": [0, -1.2, 0], "target_m": [0, -1.5, 0], "up": [0, 0, -1], "height_m": 0.8 });
        v["output"] = json!({ "kind": "view", "width": 60, "height": 60 });
        v["objects"][0]["translation_m"] = json!([0.15, -1, 0]);
    });
    let look = |most_points| {
        let settings = TruthSettings {
            most_points,
            ..settings(5e-2)
        };
        truth(&view, &settings, &|_| (), &|| false).unwrap()
    };
    let (all, some) = (look(3600), look(100));
    assert_eq!((all.pixel_step, some.pixel_step), (1, 6));
    assert_eq!(
        shadow_edge(&view, &all, 2, &mut || true).unwrap(),
        all.shadow_edge(2),
        "every pixel is there already"
    );
    let wanted = all.shadow_edge(2).unwrap();
    let wanted: Vec<bool> = (0..100)
        .map(|at| [at % 10, at / 10].map(|n| 6 * n + some.first_pixel[0] as usize))
        .map(|[x, y]| wanted[60 * y + x])
        .collect();
    let found = shadow_edge(&view, &some, 2, &mut || true).unwrap().unwrap();
    assert_eq!(
        shadow_edge(&view, &some, 2, &mut || false),
        Err(ReferenceError::Cancelled)
    );
    let count = |edge: &[bool]| edge.iter().filter(|e| **e).count();
    let differ = wanted.iter().zip(&found).filter(|(a, b)| a != b).count();
    // Counted with other rays, which may say otherwise where a share is near a bound.
    assert!(differ <= 2, "{differ} of {}", count(&wanted));
    assert!(count(&wanted) >= 10, "the box casts a shadow");
    // Two of its own values are 12 pixels.
    let coarse = some.shadow_edge(2).unwrap();
    assert!(
        count(&coarse) > 2 * count(&found),
        "{} {}",
        count(&coarse),
        count(&found)
    );
}
