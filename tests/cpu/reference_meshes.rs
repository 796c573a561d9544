//! Meshes in the float64 reference: shadows, light, placement.

use std::sync::Arc;

use caustica::mesh::{Material, Mesh, Triangle};
use caustica::physics::fresnel::fresnel_transmittance;
use caustica::reference::{ReferenceError, ReferenceSettings, irradiance_map};
use caustica::scene::ResolvedScene;
use glam::{DVec3, Vec3};

use crate::reference::{assert_energy_closes, count, resolved};

/// Area of a map's texel in these scenes, m².
const TEXEL_M2: f64 = (2.0 / 64.0) * (2.0 / 64.0);

fn mesh(origin_m: DVec3, faces: &[[Vec3; 3]]) -> Arc<Mesh> {
    let corners = || faces.iter().flatten();
    let triangles = faces
        .iter()
        .map(|&positions_m| Triangle {
            positions_m,
            normals: [Vec3::Y; 3],
            material: 0,
        })
        .collect();
    Arc::new(Mesh {
        id: "blake3:test".to_owned(),
        origin_m,
        min_m: corners().fold(Vec3::INFINITY, |a, b| a.min(*b)),
        max_m: corners().fold(Vec3::NEG_INFINITY, |a, b| a.max(*b)),
        triangles,
        materials: vec![Material {
            name: String::new(),
            albedo: [0.8; 3],
        }],
        hierarchy: Vec::new(),
        warnings: Vec::new(),
    })
}

/// A closed box from −`half` to `half` around `origin_m` in file coordinates.
fn a_box(origin_m: DVec3, half: Vec3) -> Arc<Mesh> {
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [-1.0, 1.0] {
            let corner = |a: f32, b: f32| {
                let mut p = Vec3::ZERO;
                p[axis] = side;
                p[u] = a;
                p[v] = b;
                p * half
            };
            let [p, q, r, s] = [
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ];
            faces.extend([[p, q, r], [p, r, s]]);
        }
    }
    mesh(origin_m, &faces)
}

/// Flat, clear water 2 m deep over an 8 m floor, 64² texels over −1 … 1, with these objects (JSON).
fn scene(elevation_deg: f64, objects: &str, meshes: Vec<Arc<Mesh>>) -> ResolvedScene {
    let mut scene = resolved(&format!(
        r#"{{
            "floor": {{ "depth_m": 2, "size_m": [8, 8] }},
            "lights": [{{ "kind": "sun", "elevation_deg": {elevation_deg}, "irradiance_w_m2": [10, 20, 30] }}],
            "objects": [{objects}],
            "output": {{ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 64 }}
        }}"#
    ));
    scene.meshes = meshes;
    scene
}

/// Area that is dark, by missing flux, m².
fn shadow_m2(resolved: &ResolvedScene, rays: u64) -> f64 {
    let mut open = resolved.clone();
    open.scene.objects.clear();
    open.meshes.clear();
    let (lit, shaded) = (count(&open, rays), count(resolved, rays));
    assert_energy_closes(&shaded);
    lit.irradiance
        .iter()
        .zip(&shaded.irradiance)
        .map(|(a, b)| (1.0 - b[0] / a[0]) * TEXEL_M2)
        .sum()
}

#[test]
fn the_shadow_of_a_triangle_is_half_of_its_rectangle() {
    // A box cannot tell a triangle from the rectangle around it: its faces have both halves.
    let corners = [(-0.3, -0.2), (0.3, -0.2), (-0.3, 0.2)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let sail = mesh(DVec3::ZERO, &[corners]);
    let place = r#"{ "mesh": "b", "translation_m": [0.1, -1, -0.2] }"#;
    let shadow_m2 = shadow_m2(&scene(90.0, place, vec![sail]), 2_000_000);
    let triangle_m2 = 0.5 * 0.6 * 0.4;
    assert!((shadow_m2 / triangle_m2 - 1.0).abs() < 1e-3, "{shadow_m2}");
}

#[test]
fn the_shadow_of_a_box_is_its_footprint() {
    let block = a_box(DVec3::ZERO, Vec3::new(0.31, 0.2, 0.17));
    let scene = scene(
        90.0,
        r#"{ "mesh": "b", "translation_m": [0.1, -1, -0.2] }"#,
        vec![block],
    );
    let footprint_m2 = 4.0 * 0.31 * 0.17;
    let shadow_m2 = shadow_m2(&scene, 2_000_000);
    assert!(
        (shadow_m2 / footprint_m2 - 1.0).abs() < 1e-3,
        "{shadow_m2} {footprint_m2}"
    );
    let map = count(&scene, 2_000_000);
    let texel = |x: f64, z: f64| {
        let (i, j) = (((x + 1.0) * 32.0) as usize, ((z + 1.0) * 32.0) as usize);
        map.irradiance[j * 64 + i][0]
    };
    // Where the box stands, and not where its mirror image would.
    assert_eq!(texel(0.1, -0.2), 0.0);
    assert!(texel(-0.35, -0.2) > 0.0 && texel(0.1, 0.2) > 0.0);
    // What is missing on the floor is on the box.
    for (c, irradiance) in [10.0, 20.0, 30.0].into_iter().enumerate() {
        let expected_w = footprint_m2 * irradiance * fresnel_transmittance(1.0, 1.333);
        assert!((map.landed_w[1][c] / expected_w - 1.0).abs() < 1e-3);
    }
}

#[test]
fn a_placed_box_has_its_placed_shadow() {
    // Off-centre in its file, scaled, turned by 30° about Y, moved.
    let block = a_box(DVec3::new(0.2, 0.0, -0.1), Vec3::new(0.1, 0.1, 0.2));
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let scene = scene(
        90.0,
        &format!(
            r#"{{ "mesh": "b", "translation_m": [0.1, -1, 0.3], "rotation": [0, {sin}, 0, {cos}], "scale": [2, 1, 1.5] }}"#
        ),
        vec![block],
    );
    let footprint_m2 = 4.0 * (0.1 * 2.0) * (0.2 * 1.5);
    let shadow_m2 = shadow_m2(&scene, 2_000_000);
    assert!((shadow_m2 / footprint_m2 - 1.0).abs() < 2e-3, "{shadow_m2}");
    // p_world = t + R (s p): (0.4, −0.15) turned about Y by 30° is (0.4 cos − 0.15 sin, −0.4 sin − 0.15 cos).
    let (sin, cos) = 30f64.to_radians().sin_cos();
    let middle = (0.1 + 0.4 * cos - 0.15 * sin, 0.3 - 0.4 * sin - 0.15 * cos);
    let map = count(&scene, 500_000);
    let (mut x, mut z, mut dark) = (0.0, 0.0, 0.0);
    for (index, irradiance) in map.irradiance.iter().enumerate() {
        if irradiance[0] == 0.0 {
            x += -1.0 + ((index % 64) as f64 + 0.5) / 32.0;
            z += -1.0 + ((index / 64) as f64 + 0.5) / 32.0;
            dark += 1.0;
        }
    }
    assert!(
        (x / dark - middle.0).abs() < 0.01,
        "{} {middle:?}",
        x / dark
    );
    assert!(
        (z / dark - middle.1).abs() < 0.01,
        "{} {middle:?}",
        z / dark
    );
}

#[test]
fn slanted_light_casts_a_longer_shadow_elsewhere() {
    // A thin plate 1.5 m above the floor under a sun at 45° from +X: the shadow keeps its area and moves by 1.5 tan θ_t.
    let plate = a_box(DVec3::ZERO, Vec3::new(0.2, 1e-6, 0.2));
    let scene = scene(
        45.0,
        r#"{ "mesh": "b", "translation_m": [0.5, -0.5, 0] }"#,
        vec![plate],
    );
    let area_m2 = shadow_m2(&scene, 2_000_000);
    assert!((area_m2 / 0.16 - 1.0).abs() < 2e-3, "{area_m2}");
    let sin_t: f64 = 0.5f64.sqrt() / 1.333;
    let shift_m = 1.5 * sin_t / (1.0 - sin_t * sin_t).sqrt();
    let map = count(&scene, 500_000);
    let dark_x: Vec<f64> = (0..64)
        .filter(|i| map.irradiance[32 * 64 + i][0] == 0.0)
        .map(|i| -1.0 + (i as f64 + 0.5) / 32.0)
        .collect();
    let middle = dark_x.iter().sum::<f64>() / dark_x.len() as f64;
    assert!(
        (middle - (0.5 - shift_m)).abs() < 0.03,
        "{middle} {shift_m}"
    );
}

#[test]
fn the_upper_of_two_boxes_takes_the_light() {
    let block = a_box(DVec3::ZERO, Vec3::splat(0.2));
    let objects = |lower: &str| {
        format!(
            r#"{{ "mesh": "b", "translation_m": [0, -1.6, 0], {lower} }}, {{ "mesh": "b", "translation_m": [0, -0.6, 0] }}"#
        )
    };
    let hidden = scene(90.0, &objects(r#""scale": 0.99"#), vec![block.clone(); 2]);
    let map = count(&hidden, 500_000);
    assert_eq!(
        map.landed_w[1], [0.0; 3],
        "the lower box lies in the shadow"
    );
    assert!(map.landed_w[2][0] > 0.0);
    let seen = scene(90.0, &objects(r#""scale": 2"#), vec![block; 2]);
    let map = count(&seen, 2_000_000);
    let ratio = map.landed_w[1][0] / map.landed_w[2][0];
    assert!(
        (ratio - 3.0).abs() < 0.01,
        "a frame of 4 − 1 parts: {ratio}"
    );
    assert_energy_closes(&map);
}

#[test]
fn either_side_of_an_open_mesh_takes_light() {
    let (a, b, c) = (
        Vec3::new(-0.3, 0.0, -0.3),
        Vec3::new(0.3, 0.0, -0.3),
        Vec3::new(0.0, 0.0, 0.3),
    );
    for face in [[a, b, c], [a, c, b]] {
        let scene = scene(
            90.0,
            r#"{ "mesh": "t", "translation_m": [0, -1, 0] }"#,
            vec![mesh(DVec3::ZERO, &[face])],
        );
        let area_m2 = shadow_m2(&scene, 1_000_000);
        assert!((area_m2 / 0.18 - 1.0).abs() < 2e-3, "{area_m2}");
    }
}

#[test]
fn dry_and_buried_objects_change_nothing() {
    let block = a_box(DVec3::ZERO, Vec3::splat(0.2));
    let open = count(&scene(60.0, "", vec![]), 200_000);
    for height in [1.0, -3.0] {
        let with = scene(
            60.0,
            &format!(r#"{{ "mesh": "b", "translation_m": [0, {height}, 0] }}"#),
            vec![block.clone()],
        );
        let map = count(&with, 200_000);
        assert_eq!(map.landed_w[1], [0.0; 3]);
        for (a, b) in open.irradiance.iter().zip(&map.irradiance) {
            assert!((a[0] / b[0] - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn the_path_to_a_box_is_shorter_than_to_the_floor() {
    let block = a_box(DVec3::ZERO, Vec3::new(3.0, 0.1, 3.0));
    let mut scene = scene(
        90.0,
        r#"{ "mesh": "b", "translation_m": [0, -0.6, 0] }"#,
        vec![block],
    );
    scene.scene.water.absorption_per_m = [0.7, 0.0, 0.2];
    scene.scene.water.scattering_per_m = [0.0, 0.0, 0.3];
    let map = count(&scene, 200_000);
    assert_energy_closes(&map);
    let clear = map.landed_w[1][1] / 20.0;
    // The top lies 0.5 m deep, to f32.
    assert!((map.landed_w[1][0] / 10.0 / clear / (-0.35f64).exp() - 1.0).abs() < 1e-7);
    assert!((map.landed_w[1][2] / 30.0 / clear / (-0.25f64).exp() - 1.0).abs() < 1e-7);
    assert!(map.irradiance.as_flattened().iter().all(|v| *v == 0.0));
    assert!((map.energy.scattered_w[2] / map.energy.absorbed_w[2] - 1.5).abs() < 0.01);
    assert_eq!(map.energy.scattered_w[0], 0.0);
}

#[test]
fn objects_and_meshes_must_pair_up() {
    let error = irradiance_map(
        &scene(90.0, r#"{ "mesh": "b" }"#, vec![]),
        &ReferenceSettings::default(),
        &|_| (),
    )
    .unwrap_err();
    assert_eq!(
        error,
        ReferenceError::Meshes {
            objects: 1,
            meshes: 0
        }
    );
}

#[test]
fn a_mesh_that_is_not_finite_is_an_error() {
    let broken = a_box(DVec3::new(f64::NAN, 0.0, 0.0), Vec3::ONE);
    let error = irradiance_map(
        &scene(90.0, r#"{ "mesh": "b" }"#, vec![broken]),
        &ReferenceSettings::default(),
        &|_| (),
    )
    .unwrap_err();
    assert!(matches!(error, ReferenceError::Figure { .. }), "{error}");
}
