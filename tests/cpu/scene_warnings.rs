//! Warnings about light that is left out state the flux concerned, against closed forms.

use std::f64::consts::{PI, TAU};

use caustica::config::Limits;
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::physics::solid_angle::solid_angle;
use caustica::scene::Scene;
use caustica::stats::Warning;
use glam::DVec3;
use serde_json::{Value, json};

use super::scene_files;

/// A level square of a metre around the origin.
const PLATE: &str = "v -.5 0 -.5\nv .5 0 -.5\nv .5 0 .5\nv -.5 0 .5\nf 1 2 3\nf 1 3 4\n";
/// A level rod of a metre, a tenth of a millimetre across.
const ROD: &str = "v -.5 0 -5e-5\nv .5 0 -5e-5\nv .5 0 5e-5\nv -.5 0 5e-5\nf 1 2 3\nf 1 3 4\n";
/// The plate with a face without area, and a face twice.
const MENDED: &str =
    "v -.5 0 -.5\nv .5 0 -.5\nv .5 0 .5\nv -.5 0 .5\nf 1 2 3\nf 1 3 4\nf 1 1 2\nf 3 4 1\n";

fn sun(elevation_deg: f64) -> Value {
    json!({ "kind": "sun", "elevation_deg": elevation_deg, "irradiance_w_m2": [1, 2, 0] })
}

fn lamp(position_m: [f64; 3]) -> Value {
    json!({ "kind": "point", "position_m": position_m, "intensity_w_sr": [1, 2, 0] })
}

/// A floor of 8 m × 8 m, 2 m down.
fn scene(lights: &[Value], quality: &Value) -> Value {
    json!({
        "water": {},
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": lights,
        "quality": quality,
        "output": { "kind": "irradiance_map", "receiver": "floor" }
    })
}

fn warnings(lights: &[Value], objects: &[(&str, Value)], quality: &Value) -> Vec<Warning> {
    warnings_of(scene(lights, quality), objects)
}

/// Those of a scene with objects (mesh, placement).
fn warnings_of(mut scene: Value, objects: &[(&str, Value)]) -> Vec<Warning> {
    let meshes: Vec<_> = objects
        .iter()
        .map(|(text, _)| match *text {
            "box" => scene_files::mesh("box.obj"),
            text => scene_files::mesh_of(text.as_bytes()),
        })
        .collect();
    let placed = objects
        .iter()
        .zip(&meshes)
        .map(|((_, placement), mesh)| {
            let mut object = placement.clone();
            object["mesh"] = json!(mesh.id);
            object
        })
        .collect::<Vec<_>>();
    scene["objects"] = json!(placed);
    let find = |id: &str| meshes.iter().find(|mesh| mesh.id == id).cloned();
    let resolved = Scene::from_value(scene)
        .and_then(|scene| caustica::methods::resolve(scene, &Limits::default(), find))
        .unwrap();
    caustica::methods::facts_with_warnings(&resolved)
        .unwrap()
        .warnings
}

/// The only warning with this code: its flux of a light of unit power, which all channels must agree on.
#[track_caller]
fn unit_flux(warnings: &[Warning], code: &str) -> f64 {
    let found: Vec<_> = warnings.iter().filter(|w| w.code == code).collect();
    assert_eq!(found.len(), 1, "{warnings:?}");
    let flux_w = found[0].flux_w.unwrap();
    assert_eq!(flux_w, [flux_w[0], 2.0 * flux_w[0], 0.0]);
    flux_w[0]
}

#[track_caller]
fn is_near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance * expected,
        "{found} instead of {expected}"
    );
}

#[test]
fn shadows_on_the_water_are_warned_of_with_the_flux_they_would_block() {
    let plate = |y: f64| (PLATE, json!({ "translation_m": [0.3, y, -0.2] }));
    let dry = |light: Value, y: f64| {
        let found = warnings(&[light], &[plate(y)], &json!({}));
        unit_flux(&found, "dry_object_casts_no_shadow")
    };
    is_near(dry(sun(90.0), 1.0), 1.0, 0.02);
    // A level shadow is as large as what casts it.
    let low = dry(sun(30.0), 1.0);
    is_near(low, 0.5, 0.02);
    // So it is under a sun so low and aslant that the shadow is a thin strip across a large square.
    let mut low = sun(1.0);
    low["azimuth_deg"] = json!(45);
    let small = (
        PLATE,
        json!({ "translation_m": [0, 0.01, 0], "scale": 0.5 }),
    );
    let found = warnings(&[low], &[small], &json!({}));
    let expected = 0.25 * 1_f64.to_radians().sin();
    is_near(
        unit_flux(&found, "dry_object_casts_no_shadow"),
        expected,
        0.05,
    );
    // A raft directly on the water blocks what falls on it.
    is_near(dry(sun(50.0), 0.0), 50_f64.to_radians().sin(), 0.02);
    // Half of the plate's shadow falls beside the floor's window of 4 m.
    let beside = (PLATE, json!({ "translation_m": [4.0, 1.0, 0.0] }));
    let found = warnings(&[sun(90.0)], &[beside], &json!({}));
    is_near(unit_flux(&found, "dry_object_casts_no_shadow"), 0.5, 0.02);
    // Under a point light, the solid angle of the plate as seen from there counts.
    let from_m = DVec3::new(0.0, 2.5, 0.0);
    let corner = DVec3::new(-0.2, 1.0, -0.7) - from_m;
    let looks_sr = 2.0 * solid_angle(corner, DVec3::Z, DVec3::X).abs();
    is_near(dry(lamp(from_m.to_array()), 1.0), looks_sr, 0.03);
    // What stands above the light takes nothing from the water.
    let above = dry(lamp([0.0, 0.5, 0.0]), 1.0);
    assert!(above == 0.0, "{above}");
    // Without light through the water there is no shadow.
    let found = warnings(&[lamp([0.0, -1.0, 0.0])], &[plate(1.0)], &json!({}));
    assert!(found.iter().all(|w| w.code != "dry_object_casts_no_shadow"));
}

#[test]
fn objects_that_reach_out_of_the_water_count_with_their_dry_part() {
    // A turned box: of the part above the water an eighth of the width is left.
    let upright = json!({ "translation_m": [0, 0.25, 0], "scale": [0.6, 1.5, 0.4] });
    let found = warnings(&[sun(90.0)], &[("box", upright.clone())], &json!({}));
    let mesh = scene_files::mesh("box.obj");
    let size = (mesh.max_m - mesh.min_m).as_dvec3();
    let top_m2 = 0.6 * size.x * 0.4 * size.z;
    is_near(unit_flux(&found, "object_cuts_surface"), top_m2, 0.02);
    // Lit from the side its sides throw a longer shadow: flux through the top and the dry part of a side.
    let found = warnings(&[sun(45.0)], &[("box", upright)], &json!({}));
    let middle_m = (mesh.origin_m.y + f64::from(mesh.min_m.y) + 0.5 * size.y) * 1.5 + 0.25;
    let dry_m = middle_m + 0.75 * size.y;
    // An azimuth of 0 points along an axis of the box, so that one side is lit.
    let sides = [0.6 * size.x, 0.4 * size.z].map(|width| width * dry_m);
    let slanted = unit_flux(&found, "object_cuts_surface") / 45_f64.to_radians().sin() - top_m2;
    let off = sides
        .map(|side| (slanted / side - 1.0).abs())
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    assert!(off < 0.03, "{slanted}, sides {sides:?}");
}

#[test]
fn objects_in_the_waves_are_warned_of_with_the_flux_they_catch() {
    let flat = json!({});
    let at = |y: f64| {
        let plate = json!({ "translation_m": [0, y, 0] });
        let found = warnings(&[sun(90.0)], &[(PLATE, plate)], &flat);
        found
            .into_iter()
            .filter(|w| w.code.starts_with("object_cuts"))
            .count()
    };
    assert_eq!(at(-0.1), 0);
    let mut wavy = scene(&[sun(90.0)], &flat);
    wavy["water"]["waves"] = json!([{ "kind": "sine", "amplitude_m": 0.5, "wavelength_m": 8 }]);
    let found = warnings_of(wavy, &[(PLATE, json!({ "translation_m": [0, 0.4, 0] }))]);
    is_near(unit_flux(&found, "object_cuts_surface"), 1.0, 0.02);
}

#[test]
fn planes_warn_of_light_that_objects_block_twice() {
    let planes = json!({ "method": "planes" });
    let two = |x: f64| {
        let objects = [
            (PLATE, json!({ "translation_m": [0, -0.5, 0] })),
            (PLATE, json!({ "translation_m": [x, -1, 0] })),
        ];
        warnings(&[sun(90.0)], &objects, &planes)
    };
    let enters = fresnel_transmittance(1.0, 1.333);
    let code = "objects_cast_no_shadows_on_objects";
    is_near(unit_flux(&two(0.0), code), enters, 0.02);
    is_near(unit_flux(&two(0.4), code), 0.6 * enters, 0.03);
    assert!(unit_flux(&two(2.0), code) == 0.0);
    // From under the water, the solid angle of the upper plate counts, which hides part of the lower one.
    let from_m = DVec3::new(0.0, -0.25, 0.0);
    let objects = [
        (PLATE, json!({ "translation_m": [0, -0.5, 0] })),
        (PLATE, json!({ "translation_m": [0, -1, 0] })),
    ];
    let found = warnings(&[lamp(from_m.to_array())], &objects, &planes);
    let corner = DVec3::new(-0.5, -1.0, -0.5) - from_m;
    let looks_sr = 2.0 * solid_angle(corner, DVec3::Z, DVec3::X).abs();
    is_near(unit_flux(&found, code), looks_sr, 0.05);
}

#[test]
fn lights_within_objects_and_at_the_water_are_warned_of_with_their_flux() {
    let around = json!({ "translation_m": [0, -1, 0], "scale": 0.5 });
    let found = warnings(&[lamp([0.0, -1.0, 0.0])], &[("box", around)], &json!({}));
    is_near(unit_flux(&found, "light_within_object"), 2.0 * TAU, 1e-9);
    // Right at the water half of all light goes to the cells around the foot.
    let found = warnings(&[lamp([0.0, 1e-6, 0.0])], &[], &json!({}));
    is_near(unit_flux(&found, "light_close_to_water"), TAU, 1e-3);
    let cells = json!({ "water_cells": 16 });
    let found = warnings(&[lamp([0.0, 0.1, 0.0])], &[], &cells);
    let close = unit_flux(&found, "light_close_to_water");
    assert!(close > 0.5 * PI && close < TAU, "{close}");
}

#[test]
fn objects_thinner_than_a_texel_are_warned_of() {
    let thin = "object_thinner_than_texel";
    let under =
        json!({ "translation_m": [0, -1, 0], "rotation": [0, 0.382_683_432, 0, 0.923_879_533] });
    let found = warnings(&[sun(90.0)], &[(ROD, under.clone())], &json!({}));
    let enters = fresnel_transmittance(1.0, 1.333);
    is_near(unit_flux(&found, thin), enters * 1e-4, 1e-3);
    assert!(
        found.iter().any(|w| w.message.contains("1.0e-4 m wide")),
        "{found:?}"
    );
    for solid in [(PLATE, under.clone()), ("box", under)] {
        let found = warnings(&[sun(90.0)], &[solid], &json!({}));
        assert!(found.iter().all(|w| w.code != thin), "{found:?}");
    }
    // A plate on its edge blocks nothing.
    let upright = json!({ "translation_m": [0, -1, 0], "rotation": [0.707_106_781_186_547_5, 0, 0, 0.707_106_781_186_547_5] });
    let found = warnings(&[sun(90.0)], &[(PLATE, upright)], &json!({}));
    assert!(found.iter().all(|w| w.code != thin), "{found:?}");
    // A lamp amid the rod sends no more to it than half of its light.
    let level = json!({ "translation_m": [0, -1, 0] });
    let found = warnings(
        &[lamp([0.0, -1.0, 0.0])],
        &[(ROD, level.clone())],
        &json!({}),
    );
    let all_sr = unit_flux(&found, thin);
    assert!(all_sr > 0.0 && all_sr <= TAU * (1.0 + 1e-9), "{all_sr}");
    // From far aside it looks small.
    let near = unit_flux(
        &warnings(
            &[lamp([0.0, 1.0, 0.0])],
            &[(ROD, level.clone())],
            &json!({}),
        ),
        thin,
    );
    let aside = unit_flux(
        &warnings(&[lamp([30.0, 1.0, 0.0])], &[(ROD, level)], &json!({})),
        thin,
    );
    assert!(aside < near / 100.0, "{aside}, {near}");
}

#[test]
fn parts_left_out_of_a_mesh_are_warned_of_once_and_block_nothing() {
    let under = json!({ "translation_m": [0, -1, 0] });
    let twice = [(MENDED, under.clone()), (MENDED, under.clone())];
    let found = warnings(&[sun(90.0)], &twice, &json!({}));
    for code in ["mesh_degenerate_triangles", "mesh_duplicate_triangles"] {
        assert!(unit_flux(&found, code) == 0.0);
    }
    let mut of_meshes = found.iter().filter(|w| w.code.starts_with("mesh_"));
    assert!(of_meshes.all(|w| w.pointer.as_deref() == Some("/objects/0/mesh")));
    let found = warnings(&[sun(90.0)], &[(PLATE, under)], &json!({}));
    assert!(found.iter().all(|w| !w.code.starts_with("mesh_")));
}

#[test]
fn many_objects_share_the_rays_that_sample_their_shadows() {
    let plate = json!({ "translation_m": [0, 1, 0], "scale": 0.5 });
    let many = vec![(PLATE, plate); 256];
    let found = warnings(&[sun(90.0)], &many, &json!({}));
    let dry = found
        .iter()
        .filter(|w| w.code == "dry_object_casts_no_shadow");
    assert_eq!(dry.clone().count(), 256);
    for warning in dry {
        is_near(warning.flux_w.unwrap()[0], 0.25, 0.3);
    }
}

#[test]
fn seas_without_waves_and_smoothed_waves_are_told() {
    let told = |waves: Value| -> Vec<(String, Option<String>)> {
        let mut scene = scene(&[sun(60.0)], &json!({}));
        scene["water"]["waves"] = waves;
        let found = warnings_of(scene, &[]);
        found
            .into_iter()
            .map(|warning| (warning.code, warning.pointer))
            .collect()
    };
    let sea = |fields: Value| {
        let mut sea = json!({ "kind": "spectrum", "model": "jonswap", "wind_speed_m_s": 5, "tile_m": 10, "samples": 64 });
        sea.as_object_mut()
            .unwrap()
            .extend(fields.as_object().unwrap().clone());
        sea
    };
    let sine = json!({ "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 4 });
    let pointer = Some("/water/waves/1".to_owned());
    for fields in [
        json!({ "min_wavelength_m": 8, "max_wavelength_m": 9 }),
        json!({ "wind_speed_m_s": 0, "significant_height_m": 1 }),
    ] {
        let found = told(json!([sine, sea(fields)]));
        assert!(
            found.contains(&("sea_without_waves".to_owned(), pointer.clone())),
            "{found:?}"
        );
    }
    assert!(told(json!([sea(json!({ "significant_height_m": 0 }))])).is_empty());
    let small = json!({ "kind": "ripples", "min_m": [0, 0], "max_m": [4, 4], "samples": 16,
                        "drops": [{ "position_m": [2, 2], "radius_m": 0.05, "height_m": 0.01 }] });
    let found = told(json!([sine, small]));
    assert!(
        found.contains(&("waves_smoothed".to_owned(), pointer)),
        "{found:?}"
    );
}

#[test]
fn obstacles_that_reflect_nothing_are_told() {
    const POST: &str =
        "v 0 -1 0\nv .2 -1 0\nv 0 -1 .2\nv .1 1 .1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    let told = |y_m: f64| -> Vec<Option<String>> {
        let mut scene = scene(&[sun(60.0)], &json!({}));
        scene["water"]["waves"] = json!([{ "kind": "ripples", "min_m": [-1, -1], "max_m": [1, 1], "samples": 64, "dispersion": "shallow",
            "obstacles": [0], "drops": [{ "position_m": [0.5, 0.5], "radius_m": 0.1, "height_m": 0.01 }] }]);
        let found = warnings_of(scene, &[(POST, json!({ "translation_m": [0, y_m, 0] }))]);
        let found = found
            .into_iter()
            .filter(|warning| warning.code == "obstacle_outside_basin");
        found.map(|warning| warning.pointer).collect()
    };
    assert_eq!(told(0.0), []);
    assert_eq!(told(-1.5), [Some("/water/waves/0/obstacles/0".to_owned())]);
}
