//! The reference computes the layout of the texels of a map on an object on its own. It has to equal that of the renderer's level
//! map.

use caustica::facts::placement::LevelBox;
use caustica::reference::{TruthKind, TruthSettings, truth};
use caustica::scene::ResolvedScene;
use glam::{DMat3, DVec3, DVec4};
use serde_json::{Value, json};

use crate::scene_files;

const SIDE: u32 = 64;

/// A turned and unevenly scaled teapot far from the world's origin, half out of the water, in this light.
fn scene(light: &Value) -> ResolvedScene {
    scene_files::scene(json!({
        "water": { "level_m": 3.25, "waves": [
            { "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9, "direction_deg": 10 }
        ] },
        "floor": { "depth_m": 2, "size_m": [6, 6], "center_m": [100, -58] },
        "lights": [light],
        "objects": [{
            "mesh": "teapot.obj", "translation_m": [100.8, 3.0, -57.5],
            "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [0.25, 0.3, 0.2]
        }],
        "quality": { "level_map_texels": SIDE },
        "output": { "kind": "irradiance_map", "receiver": 0 }
    }))
}

/// Whether the line from `from` along `way` meets a triangle.
fn meets([a, b, c]: [DVec3; 3], from: DVec3, way: DVec3) -> bool {
    let inside = DMat3::from_cols(b - a, c - a, -way).inverse() * (from - a);
    inside.x >= 0.0 && inside.y >= 0.0 && inside.x + inside.y <= 1.0
}

/// Which texels of the renderer's level map have a surface in their middle.
fn with_surface(scene: &ResolvedScene) -> Vec<bool> {
    let facts = caustica::methods::facts(scene).unwrap();
    let level_box: &LevelBox = facts.lights.lit[0].boxes[0].as_ref().unwrap();
    let rows = level_box.map_from_local;
    let local_from_map = DMat3::from_cols_array_2d(&rows.map(|row| row.truncate().to_array()))
        .transpose()
        .inverse();
    let corner = DVec3::from_array(rows.map(|DVec4 { w, .. }| w));
    let placed: Vec<[DVec3; 3]> = scene.meshes[0]
        .triangles
        .iter()
        .map(|triangle| {
            let place = &facts.receivers.objects[0].local_from_mesh;
            triangle
                .positions_m
                .map(|p| place.transform_point3(p.as_dvec3()))
        })
        .collect();
    let texels = (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| [i, j]));
    texels
        .map(|texel| {
            let [u, v] = texel.map(|t| f64::from(t) + 0.5);
            let from = local_from_map * (DVec3::new(u, v, 0.0) - corner);
            placed.iter().any(|t| meets(*t, from, level_box.axis))
        })
        .collect()
}

#[test]
fn a_map_on_an_object_has_the_texels_of_its_level_map() {
    let lights = [
        json!({ "kind": "sun", "elevation_deg": 40, "azimuth_deg": 30, "irradiance_w_m2": [1, 1, 1] }),
        json!({ "kind": "point", "position_m": [100.3, 3.9, -57.2], "intensity_w_sr": [1, 1, 1] }),
        json!({ "kind": "point", "position_m": [101.9, 2.9, -57.9], "intensity_w_sr": [1, 1, 1] }),
    ];
    let settings = TruthSettings {
        target_error: None,
        max_rays: 2000,
        ..TruthSettings::default()
    };
    let maps = lights.map(|light| {
        let scene = scene(&light);
        let truth = truth(&scene, &settings, &|_| (), &|| false).unwrap();
        assert_eq!((truth.kind, truth.width), (TruthKind::ObjectMap, SIDE));
        assert_eq!(truth.compared, with_surface(&scene), "{light}");
        truth.compared
    });
    // Each light reaches another side, and neither all nor nothing of the map.
    for (i, map) in maps.iter().enumerate() {
        let share = map.iter().filter(|&&has| has).count() as f64 / map.len() as f64;
        assert!((0.1..0.9).contains(&share), "{share}");
        assert!(maps[..i].iter().all(|other| other != map));
    }
}
