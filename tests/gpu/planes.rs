//! Light placed on meshes by reference planes and by slice images (the thesis's own methods), compared with hits.

use std::sync::{Arc, OnceLock};

use caustica::accuracy::metrics::relative_l1;
use caustica::config::RenderConfig;
use caustica::lab::shapes::Shape;
use caustica::mesh::Mesh;
use caustica::physics::refraction::{direction_to_light, normal_from_slope, refract_direction};
use caustica::render::RenderError;
use caustica::scene::{ResolvedScene, Wave};
use glam::DVec3;
use serde_json::{Value, json};

use super::harness::{Map, new_renderer, try_render};
use super::scene_files;

/// Texels along a side of the objects' maps.
const SIDE: usize = 64;

/// A shape of the catalogue.
fn shape(name: &str) -> Arc<Mesh> {
    static MADE: OnceLock<Vec<(&str, Arc<Mesh>)>> = OnceLock::new();
    let made = MADE.get_or_init(|| {
        ["sphere", "teapot", "torus_knot", "plate"]
            .map(|name| (name, Arc::new(Shape::named(name).unwrap().mesh().unwrap())))
            .to_vec()
    });
    made.iter().find(|(n, _)| *n == name).unwrap().1.clone()
}

/// A shape 1 m under waves that focus on it; `quality` on top of the dials that all have.
fn under_waves(name: &str, quality: Value, output: Value) -> ResolvedScene {
    let mesh = shape(name);
    let size = (mesh.max_m - mesh.min_m).max_element();
    let mut scene = json!({
        "water": {
            "waves": [
                { "kind": "sine", "amplitude_m": 0.012, "wavelength_m": 0.5, "direction_deg": 20 },
                { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.37, "direction_deg": 110, "phase_deg": 40 }
            ],
            "absorption_per_m": [0.3, 0.07, 0.03]
        },
        "floor": { "depth_m": 1.6, "size_m": [3, 3] },
        "lights": [{ "kind": "sun", "elevation_deg": 65, "azimuth_deg": 30, "irradiance_w_m2": [900, 950, 1000] }],
        "objects": [{ "mesh": mesh.id, "translation_m": [0, -1, 0], "scale": 0.6 / f64::from(size) }],
        "camera": { "position_m": [0.4, -0.2, 1.0], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 96, "level_map_texels": SIDE },
        "output": output
    });
    for (key, value) in quality.as_object().unwrap() {
        scene["quality"][key] = value.clone();
    }
    scene_files::with_meshes(scene, &[mesh])
}

/// The map on the object.
fn on_object(name: &str, quality: Value) -> Map {
    let output = json!({ "kind": "irradiance_map", "receiver": 0 });
    Map::from(&under_waves(name, quality, output))
}

fn planes(count: u32, slicing: &str) -> Value {
    json!({ "method": { "kind": "planes", "planes": count, "slicing": slicing } })
}

fn warns(map: &Map, code: &str) -> bool {
    map.stats.warnings.iter().any(|w| w.code == code)
}

#[test]
fn smart_slicing_gives_the_same_bytes_with_fewer_planes() {
    for (name, most) in [("sphere", 0.6), ("teapot", 0.8), ("torus_knot", 1.0)] {
        for count in [2, 9, 101] {
            let uniform = on_object(name, planes(count, "uniform"));
            let smart = on_object(name, planes(count, "smart"));
            let (all, some) = (&uniform.stats.planes[0], &smart.stats.planes[0]);
            println!("{name}, {count} planes: {some:?}");
            let values =
                |map: &Map| -> Vec<u64> { map.values().iter().map(|v| v.to_bits()).collect() };
            assert_eq!(values(&uniform), values(&smart), "{name}, {count}");
            assert!(uniform.mean(0) > 1.0, "{name} is dark");
            assert_eq!((all.specified, all.used, all.sub_boxes), (count, count, 1));
            assert!(some.used >= 1 && some.used <= count && some.sub_boxes <= some.used);
            if count == 101 {
                assert!(f64::from(some.used) <= most * 101.0, "{name}: {some:?}");
            }
            assert_eq!(all.beams, 2 * 96 * 96);
            assert_eq!(all.beams_kept, some.beams_kept);
            assert!(all.beams_kept > 0 && all.beams_kept < all.beams);
        }
    }
}

#[test]
fn many_planes_approach_the_result_of_hits() {
    let hit = on_object("sphere", json!({}));
    assert!(hit.stats.planes.is_empty());
    let mut last = f64::INFINITY;
    for count in [5, 17, 65, 257] {
        let map = on_object("sphere", planes(count, "smart"));
        let error = relative_l1(map.values(), hit.values()).unwrap();
        println!(
            "{count} planes: {error:.4} from hits, closure {:.2e}",
            map.closure()
        );
        assert!(error < last, "{count}: {error} after {last}");
        last = error;
    }
    assert!(last < 0.05, "{last}");
}

#[test]
fn a_slice_image_for_each_plane_gives_the_same_picture() {
    for (name, count) in [("sphere", 33), ("teapot", 50), ("torus_knot", 20)] {
        let uniform = on_object(name, planes(count, "uniform"));
        let volumetric = on_object(
            name,
            json!({ "method": { "kind": "volumetric", "planes": count } }),
        );
        let differing = uniform
            .texels
            .iter()
            .zip(&volumetric.texels)
            .filter(|(a, b)| a != b)
            .count();
        let lit = uniform.texels.iter().filter(|t| t[0] > 0.0).count();
        println!("{name}, {count} planes: {differing} of {lit} lit texels differ");
        // A texel whose depth lies on a slice's border to the last bits may go to either; clipping moves such depths.
        assert!(differing <= lit / 200, "{name}: {differing} of {lit}");
        assert!(lit > SIDE * SIDE / 10);
        let stats = &volumetric.stats.planes[0];
        assert_eq!((stats.used, stats.sub_boxes), (count, 1));
        assert_eq!(stats.beams_kept, uniform.stats.planes[0].beams_kept);
        let memory = &volumetric.stats.memory;
        assert_eq!(memory.planned_peak_bytes, memory.peak_bytes);
    }
}

#[test]
fn a_plate_across_the_light_takes_one_plane() {
    let scene = |quality: Value| {
        let mut resolved = under_waves(
            "plate",
            quality,
            json!({ "kind": "irradiance_map", "receiver": 0 }),
        );
        let caustica::scene::Light::Sun(sun) = &mut resolved.scene.lights[0] else {
            panic!("no sun");
        };
        sun.elevation_deg = 90.0;
        resolved
    };
    let hit = Map::from(&scene(json!({})));
    let map = Map::from(&scene(planes(9, "smart")));
    let stats = &map.stats.planes[0];
    let error = relative_l1(map.values(), hit.values()).unwrap();
    println!("{stats:?}, {error:.2e} from hits");
    assert_eq!((stats.specified, stats.used, stats.sub_boxes), (9, 1, 1));
    assert!(error < 0.01, "{error}");
}

#[test]
fn the_floor_gets_nearly_the_same_shadow() {
    let output = json!({ "kind": "irradiance_map", "receiver": "floor", "width": 96, "height": 96,
                         "min_m": [-1, -1], "max_m": [1, 1] });
    let map = |quality: Value| Map::from(&under_waves("sphere", quality, output.clone()));
    let hit = map(json!({}));
    let dark = |map: &Map| map.texels.iter().filter(|t| t[0] < 1.0).count();
    assert!(dark(&hit) > 100, "no shadow");
    let mut bare = under_waves("sphere", json!({}), output.clone());
    bare.scene.objects.clear();
    bare.meshes.clear();
    let bare = Map::from(&bare);
    let lost = relative_l1(bare.values(), hit.values()).unwrap();
    for quality in [
        planes(101, "uniform"),
        planes(101, "smart"),
        json!({ "method": { "kind": "volumetric", "planes": 101 } }),
    ] {
        let placed = map(quality);
        let error = relative_l1(placed.values(), hit.values()).unwrap();
        println!(
            "shadow {lost:.4}, by planes {error:.4} off, {} and {} dark texels",
            dark(&placed),
            dark(&hit)
        );
        assert!(error < 0.1 * lost, "{error} of {lost}");
    }
}

#[test]
fn light_that_a_method_does_not_conserve_is_reported() {
    let few = on_object("sphere", planes(4, "uniform"));
    let many = on_object("sphere", planes(201, "uniform"));
    println!("closure {:.2e} and {:.2e}", few.closure(), many.closure());
    for map in [&few, &many] {
        let warned = map
            .stats
            .warnings
            .iter()
            .find(|w| w.code == "method_does_not_conserve");
        let account = &map.stats.energy[0];
        let flux_w = warned.unwrap().flux_w.unwrap();
        let largest = (0..3).map(|c| flux_w[c].abs() / account.emitted_w[c]);
        let largest = largest.fold(0.0, f64::max);
        assert!((largest / account.closure - 1.0).abs() < 1e-9);
    }
    assert!(many.closure() < 0.01, "{}", many.closure());
    assert!(!warns(
        &on_object("sphere", json!({})),
        "method_does_not_conserve"
    ));
}

#[test]
fn wide_footprints_light_the_same_texels() {
    // Eight cells over the object: on the finer map every footprint is wide and shared out over lanes, on the coarser none is.
    for quality in [
        planes(33, "smart"),
        json!({ "method": { "kind": "volumetric", "planes": 33 } }),
    ] {
        let landed_w = |texels: u32| {
            let mut quality = quality.clone();
            quality["water_cells"] = json!(8);
            quality["level_map_texels"] = json!(texels);
            on_object("sphere", quality).stats.energy[0].landed_w[1]
        };
        let (wide, narrow) = (landed_w(512), landed_w(64));
        println!("{wide} W and {narrow} W landed");
        assert!(narrow > 1.0 && (wide / narrow - 1.0).abs() < 0.02);
    }
}

#[test]
fn slices_over_budget_are_refused_with_numbers() {
    let config = RenderConfig {
        memory_budget_mib: 128,
        ..RenderConfig::default()
    };
    let mut renderer = new_renderer(&config);
    let output = json!({ "kind": "irradiance_map", "receiver": 0 });
    let scene = |planes: u32| {
        let quality = json!({ "method": { "kind": "volumetric", "planes": planes }, "level_map_texels": 256 });
        under_waves("sphere", quality, output.clone())
    };
    // Once for the level map, which is no slice.
    try_render(&mut renderer, &scene(8)).unwrap();
    let few = try_render(&mut renderer, &scene(8)).unwrap();
    assert!(few.stats.memory.peak_bytes <= 128 << 20);
    let Err(RenderError::OverBudget {
        needed_bytes,
        budget_bytes,
        ..
    }) = try_render(&mut renderer, &scene(512))
    else {
        panic!("512 slices of 256 KiB fit into 128 MiB");
    };
    assert_eq!(budget_bytes, 128 << 20);
    let slices = 4 * 256 * 256;
    assert_eq!(
        needed_bytes - few.stats.memory.planned_peak_bytes,
        (512 - 8) * slices
    );
}

#[test]
fn a_view_shows_what_the_map_holds() {
    let output = json!({ "kind": "view", "width": 96, "height": 64, "layers": ["radiance", "irradiance"], "format": "exr" });
    let scene = |quality: Value| under_waves("sphere", quality, output.clone());
    let hit = Map::from(&scene(json!({})));
    let placed = Map::from(&scene(planes(129, "smart")));
    let error = relative_l1(placed.values(), hit.values()).unwrap();
    println!("views {error:.4} apart");
    assert!(error < 0.1, "{error}");
    assert!(hit.mean(0) > 1.0);
}

/// Planes are treads without risers: on a face that is not across the light they take a tilted ray by the tread it goes through and not
/// by the face. That error has a closed form, and no number of planes changes it.
#[test]
fn a_slope_under_tilted_water_is_off_by_its_closed_form() {
    const IOR: f64 = 1.333;
    const SLOPE: f64 = 0.08;
    const WAVELENGTH_M: f64 = 60.0;
    let to_light = direction_to_light(65_f64.to_radians(), 30_f64.to_radians());
    let axis = refract_direction(-to_light, DVec3::Y, IOR).unwrap();
    for (wave_deg, planes_count) in [(30.0, 65), (30.0, 257), (210.0, 257), (120.0, 257)] {
        let (sin, cos) = f64::to_radians(wave_deg).sin_cos();
        let way =
            refract_direction(-to_light, normal_from_slope(SLOPE * cos, SLOPE * sin), IOR).unwrap();
        let expected = axis.y.abs() * axis.dot(way) / way.y.abs();
        let map = |quality: Value| {
            let output = json!({ "kind": "irradiance_map", "receiver": 0 });
            let mut resolved = under_waves("plate", quality, output);
            resolved.scene.water.waves.truncate(1);
            let Wave::Sine(wave) = &mut resolved.scene.water.waves[0] else {
                panic!("a sine");
            };
            wave.wavelength_m = WAVELENGTH_M;
            wave.amplitude_m = SLOPE * WAVELENGTH_M / std::f64::consts::TAU;
            wave.direction_deg = wave_deg;
            resolved.scene.water.ior = IOR;
            Map::from(&resolved)
        };
        let hit = map(json!({}));
        let placed = map(planes(planes_count, "uniform"));
        // Texels away from the rim, where a texel is lit in part.
        let lit = |x: usize, y: usize| hit.texels[y * SIDE + x][1] > 0.0;
        let (mut sum_hit, mut sum_planes, mut count) = (0.0, 0.0, 0);
        for y in 3..SIDE - 3 {
            for x in 3..SIDE - 3 {
                if (y - 3..=y + 3).all(|y| (x - 3..=x + 3).all(|x| lit(x, y))) {
                    sum_hit += hit.texels[y * SIDE + x][1];
                    sum_planes += placed.texels[y * SIDE + x][1];
                    count += 1;
                }
            }
        }
        let found = sum_planes / sum_hit;
        println!(
            "waves to {wave_deg}°, {planes_count} planes: {found:.5}, closed form {expected:.5}, {count} texels"
        );
        assert!(count > 500);
        assert!((found - expected).abs() <= 1e-3, "{found} for {expected}");
        assert!(wave_deg == 120.0 || (expected - 1.0).abs() > 5e-3);
    }
}

/// Of a lamp the planes' error is bounded by how far from the surface they put light, and by their stair.
#[test]
fn lamps_above_and_under_water_light_by_planes_too() {
    const RADIUS_M: f64 = 0.3;
    /// A quarter of the shortest wave: how far apart bright and dark are.
    const FEATURE_M: f64 = 0.37 / 4.0;
    // Mean tilt that the waves give a ray: mean |slope| times 1 − 1/n.
    const WAVE_TILT: f64 = 0.04;
    for (position_m, seen_from_m, wave_tilt) in [
        // From the part that is nearest: there rays are tilted most. 1.5 m of air are n times as much of water.
        ([0.3, 1.5, 0.2], 1.0 + 1.5 * 1.333 - RADIUS_M, WAVE_TILT),
        ([0.25, -0.2, 0.15], 0.85 - RADIUS_M, 0.0),
    ] {
        let output = json!({ "kind": "irradiance_map", "receiver": 0 });
        let map = |quality: Value| {
            let resolved = under_waves("sphere", quality, output.clone());
            let mut value = serde_json::to_value(&resolved.scene).unwrap();
            value["lights"] = json!([{ "kind": "point", "position_m": position_m, "intensity_w_sr": [900, 900, 900] }]);
            Map::from(&scene_files::with_meshes(value, &resolved.meshes))
        };
        let hit = map(json!({}));
        assert!(hit.mean(0) > 1.0, "dark");
        // A point of a sphere is 2/3 of the radius off the axis in the mean.
        let tilt = 2.0 / 3.0 * RADIUS_M / seen_from_m + wave_tilt;
        let mut last = f64::INFINITY;
        for count in [5, 17, 65] {
            let uniform = map(planes(count, "uniform"));
            let smart = map(planes(count, "smart"));
            let volumetric = map(json!({ "method": { "kind": "volumetric", "planes": count } }));
            let distance_m = 2.0 * RADIUS_M / f64::from(count - 1);
            // Half a distance nearer or farther: the inverse square, and light that is aside by the tilt. Besides the stair.
            let bound = tilt + 0.5 * distance_m * (2.0 / seen_from_m + tilt / FEATURE_M);
            let error = relative_l1(uniform.values(), hit.values()).unwrap();
            println!(
                "{position_m:?}, {count} planes: {error:.4} from hits, bound {bound:.4}, {:?}",
                smart.stats.planes[0]
            );
            assert!(error <= bound, "{error} with {count} planes, bound {bound}");
            assert!(
                error < last,
                "{error} with {count} planes, {last} with fewer"
            );
            last = error;
            assert_eq!(uniform.values(), smart.values());
            assert!(smart.stats.planes[0].used < count);
            let pairs = uniform.texels.iter().zip(&volumetric.texels);
            let differing = pairs.filter(|(a, b)| a != b).count();
            let lit = uniform.texels.iter().filter(|t| t[0] > 0.0).count();
            assert!(lit > SIDE * SIDE / 10);
            assert!(differing <= lit / 200, "{differing} of {lit}");
        }
    }
}
