//! The generated meshes: the files are what the generator writes, and the shapes are closed and face outward.

#[path = "../../examples/make_teapot/meshes/mod.rs"]
mod meshes;

use std::collections::{BTreeMap, HashMap};

use caustica::config::Limits;
use caustica::mesh::{Mesh, hierarchy, obj};
use glam::Vec3;

fn folder() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes")
}

fn load(name: &str, mtl: Option<&str>) -> Mesh {
    let file = |name: &str| std::fs::read(folder().join(name)).unwrap();
    let mtl = mtl.map(file);
    let mtls: Vec<&[u8]> = mtl.iter().map(Vec::as_slice).collect();
    obj::read(&file(name), &mtls, &Limits::default()).unwrap()
}

/// Triangles of each part (parts hang together by edges), largest first, with the number of open edges.
pub(crate) fn parts(mesh: &Mesh) -> Vec<(Vec<[Vec3; 3]>, usize)> {
    let mut numbers = HashMap::new();
    let mut number = |p: Vec3| {
        let next = numbers.len();
        *numbers
            .entry(p.to_array().map(f32::to_bits))
            .or_insert(next)
    };
    let mut triangles_at: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle.positions_m.map(&mut number);
        for k in 0..3 {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            triangles_at
                .entry((from.min(to), from.max(to)))
                .or_default()
                .push(index);
        }
    }
    let mut neighbours = vec![Vec::new(); mesh.triangles.len()];
    let mut open = vec![0; mesh.triangles.len()];
    for triangles in triangles_at.values() {
        match triangles[..] {
            [one] => open[one] += 1,
            [one, other] => {
                neighbours[one].push(other);
                neighbours[other].push(one);
            }
            _ => panic!("{} triangles at one edge", triangles.len()),
        }
    }
    let mut seen = vec![false; mesh.triangles.len()];
    let mut parts = Vec::new();
    for start in 0..mesh.triangles.len() {
        let (mut part, mut open_edges, mut waiting) = (Vec::new(), 0, vec![start]);
        while let Some(index) = waiting.pop() {
            if !std::mem::replace(&mut seen[index], true) {
                part.push(mesh.triangles[index].positions_m);
                open_edges += open[index];
                waiting.extend(&neighbours[index]);
            }
        }
        if !part.is_empty() {
            parts.push((part, open_edges));
        }
    }
    parts.sort_by_key(|(triangles, _)| std::cmp::Reverse(triangles.len()));
    parts
}

/// Volume inside, seen from the middle of the bounds: positive where the surface faces outward.
pub(crate) fn volume(triangles: &[[Vec3; 3]]) -> f64 {
    let all = || triangles.iter().flatten().map(|p| p.as_dvec3());
    let min = all().reduce(|a, b| a.min(b)).unwrap();
    let max = all().reduce(|a, b| a.max(b)).unwrap();
    let middle = 0.5 * (min + max);
    triangles
        .iter()
        .map(|t| t.map(|p| p.as_dvec3() - middle))
        .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
        .sum()
}

#[test]
fn the_files_are_what_the_generator_writes() {
    let all = meshes::all();
    assert_eq!(all.len(), 6);
    for (name, text) in all {
        let file = std::fs::read_to_string(folder().join(name)).unwrap();
        assert!(
            file == text,
            "scenes/meshes/{name} differs; run `cargo run --release --example make_teapot`"
        );
    }
}

#[test]
fn the_teapot_has_its_size_and_material() {
    let mesh = load("teapot.obj", Some("teapot.mtl"));
    // 32 patches of 8 × 8 squares; those at the poles of lid and bottom lose half of their first row.
    assert_eq!(mesh.triangles.len(), 32 * 128 - 8 * 8);
    assert_eq!(mesh.materials.len(), 1);
    assert_eq!(
        (mesh.materials[0].name.as_str(), mesh.materials[0].albedo),
        ("ceramic", [0.82, 0.80, 0.76])
    );
    let bounds = mesh.info().bounds_m;
    for (found, wanted) in bounds.min.iter().zip([-3.0 * 0.15, 0.0, -2.0 * 0.15]) {
        assert!((found - wanted).abs() < 1e-4, "{bounds:?}");
    }
    for (found, wanted) in bounds.max.iter().zip([0.515, 3.15 * 0.15, 2.0 * 0.15]) {
        assert!((found - wanted).abs() < 1e-3, "{bounds:?}");
    }
    // Nothing to mend but the openings: two rings of 32 edges at lid and rim, and four of 16 at spout and handle.
    assert_eq!(mesh.warnings.len(), 1, "{:?}", mesh.warnings);
    assert!(mesh.warnings[0].message.starts_with("128 edges"));
}

#[test]
fn the_teapot_is_four_parts_that_face_outward() {
    let mesh = load("teapot.obj", None);
    let parts = parts(&mesh);
    let summary: Vec<_> = parts.iter().map(|(t, open)| (t.len(), *open)).collect();
    // Body with rim and bottom, lid; handle and spout, open at both ends.
    assert_eq!(summary, [(2016, 32), (992, 32), (512, 32), (512, 32)]);
    let body = volume(&parts[0].0);
    // A solid of that profile holds about 0.6 of the cylinder around it.
    let cylinder = std::f64::consts::PI * 0.3 * 0.3 * 0.38;
    assert!((0.5..1.0).contains(&(body / cylinder)), "{body}");
    for (triangles, _) in &parts {
        assert!(volume(triangles) > 1e-4);
    }
}

#[test]
fn the_teapot_is_mirrored_front_to_back_only() {
    let mesh = load("teapot.obj", None);
    let places = |mirror: Vec3| {
        let mut places: Vec<[i64; 3]> = mesh
            .triangles
            .iter()
            .flat_map(|t| t.positions_m)
            .map(|p| {
                (p * mirror)
                    .to_array()
                    .map(|x| (f64::from(x) * 1e5).round() as i64)
            })
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    };
    let plain = places(Vec3::ONE);
    assert_eq!(plain, places(Vec3::new(1.0, 1.0, -1.0)));
    assert_ne!(plain, places(Vec3::new(-1.0, 1.0, 1.0)));
}

#[test]
fn the_teapot_blocks_what_falls_on_it() {
    let mesh = load("teapot.obj", None);
    // Down on the knob, the handle and the spout; and past the handle and the spout.
    let down = |x: f32, z: f32| {
        let origin = Vec3::new(x, 1.0, z) - mesh.origin_m.as_vec3();
        hierarchy::first_hit(
            &mesh.hierarchy,
            &mesh.triangles,
            origin,
            Vec3::NEG_Y,
            0.0,
            2.0,
        )
        .map(|h| 1.0 - h.t)
    };
    let near = |found: Option<f32>, wanted: f32| found.is_some_and(|y| (y - wanted).abs() < 0.01);
    assert!(near(down(0.0, 0.0), 0.4725), "{:?}", down(0.0, 0.0));
    assert!(near(down(-0.35, 0.01), 0.332), "{:?}", down(-0.35, 0.01));
    assert!(
        down(0.4, 0.02).is_some_and(|y| y > 0.15),
        "{:?}",
        down(0.4, 0.02)
    );
    // The spout's upper line begins level, 1.425 of 0.15 m above the table.
    assert!(near(down(0.29, 0.0), 0.215), "{:?}", down(0.29, 0.0));
    assert_eq!(down(-0.40, 0.1), None);
    assert_eq!(down(0.35, 0.35), None);
}

#[test]
fn normals_agree_with_the_winding() {
    for name in [
        "teapot.obj",
        "torus_knot.obj",
        "box.obj",
        "post.obj",
        "floor_tiles.obj",
    ] {
        let mut sharp = 0;
        let mesh = load(name, None);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.positions_m;
            let face = (b - a).cross(c - a).normalize();
            for normal in triangle.normals {
                // The tight curve at the lip of the spout turns by nearly 90° within a square.
                let least = if name == "teapot.obj" { 0.05 } else { 0.8 };
                assert!(
                    normal.dot(face) > least,
                    "{name}: {} {triangle:?}",
                    normal.dot(face)
                );
                sharp += usize::from(normal.dot(face) < 0.7);
            }
        }
        assert!(sharp <= mesh.triangles.len() / 20, "{name}: {sharp}");
    }
}

#[test]
fn the_solids_are_closed_and_face_outward() {
    let unit_box = load("box.obj", None);
    assert!(unit_box.warnings.is_empty(), "{:?}", unit_box.warnings);
    assert_eq!(parts(&unit_box).len(), 1);
    assert!((volume(&parts(&unit_box)[0].0) - 1.0).abs() < 1e-6);

    let post = parts(&load("post.obj", None));
    assert_eq!((post.len(), post[0].0.len(), post[0].1), (1, 188, 0));
    // A prism over a 48-gon of radius ½ m.
    let area = 6.0 * (std::f64::consts::TAU / 48.0).sin();
    assert!((volume(&post[0].0) / area - 1.0).abs() < 1e-5);

    let knot = load("torus_knot.obj", None);
    assert!(knot.warnings.is_empty(), "{:?}", knot.warnings);
    let parts = parts(&knot);
    assert_eq!((parts.len(), parts[0].0.len(), parts[0].1), (1, 4_000, 0));
    // A tube of radius r around a curve of length L holds π r² L (Pappus); a decagon has 0.935 of the circle's area.
    let length: f64 = (0..10_000)
        .map(|i| {
            let t = std::f64::consts::TAU * f64::from(i) / 10_000.0;
            (9.0 + 4.0 * (2.0 + (3.0 * t).cos()).powi(2)).sqrt() * std::f64::consts::TAU / 10_000.0
        })
        .sum();
    let tube = std::f64::consts::PI * 0.4_f64.powi(2) * length * 0.145_f64.powi(3);
    let ratio = volume(&parts[0].0) / tube;
    assert!((0.92..0.95).contains(&ratio), "{ratio}");
}

#[test]
fn the_tiles_are_apart_and_face_up() {
    let tiles = load("floor_tiles.obj", None);
    assert_eq!(tiles.triangles.len(), 128);
    assert!(tiles.triangles.iter().all(|t| t.normals == [Vec3::Y; 3]));
    let info = tiles.info();
    assert_eq!(
        (info.bounds_m.min, info.bounds_m.max),
        ([-0.5, 0.0, -0.5], [0.5, 0.0, 0.5])
    );
    let text = std::fs::read_to_string(folder().join("floor_tiles.obj")).unwrap();
    assert_eq!(
        text.lines().filter(|line| line.starts_with("v ")).count(),
        4 * 64
    );
}
