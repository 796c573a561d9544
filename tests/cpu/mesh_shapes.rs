//! The catalogue of shapes: each matches its description, is closed, faces outward, and is the same on every machine.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use caustica::assets::MeshStore;
use caustica::lab::shapes::{ALL, Shape};
use caustica::mesh::{Mesh, obj};
use glam::DVec3;
use rayon::prelude::*;

use super::teapot::{parts, volume};

/// Every shape with its mesh, read once.
static MESHES: LazyLock<Vec<(&Shape, Mesh)>> = LazyLock::new(|| {
    let read = |shape| (shape, Shape::mesh(shape).unwrap());
    ALL.par_iter().map(read).collect()
});

fn mesh(name: &str) -> &'static Mesh {
    let found = MESHES.iter().find(|(shape, _)| shape.name == name);
    &found.unwrap_or_else(|| panic!("no shape {name}")).1
}

/// Volume of a mesh whose parts do not overlap, m³.
fn whole_volume(name: &str) -> f64 {
    let parts = parts(mesh(name));
    parts.iter().map(|(triangles, _)| volume(triangles)).sum()
}

/// Whether every edge is there twice, once each way.
fn edges_cancel(mesh: &Mesh) -> bool {
    let mut edges: Vec<_> = mesh
        .triangles
        .iter()
        .map(|t| t.positions_m.map(|p| p.to_array().map(f32::to_bits)))
        .flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(from, to)| (from.min(to), from.max(to), from < to))
        .collect();
    edges.sort_unstable();
    let once_each_way = |pair: &[([u32; 3], [u32; 3], bool)]| match pair {
        [one, other] => (one.0, one.1) == (other.0, other.1) && one.2 != other.2,
        _ => false,
    };
    edges.chunks(2).all(once_each_way)
}

/// Name and first digits of the id: of the text, to the last digit.
const IDS: &[(&str, &str)] = &[
    ("bipyramid", "083afa7b7757"),
    ("box", "2cc2b6f9af02"),
    ("icosahedron", "f78f5802bbc8"),
    ("star", "155c0cf06f67"),
    ("gear", "981a92bc22e3"),
    ("icosphere", "7155574e1e4c"),
    ("urchin", "909ae8c209ff"),
    ("boulder", "5be87ee9cd42"),
    ("asteroid", "41b302194cf3"),
    ("pebbles", "9cbcb4625a2e"),
    ("sphere", "8798c1b60d81"),
    ("cylinder", "89caed6eab63"),
    ("cone", "8e8392fbbe48"),
    ("torus", "6f06e4e1cb27"),
    ("washer", "02510c5fcf99"),
    ("pipe", "920d2768dd66"),
    ("bowl", "019a7e19eb42"),
    ("vase", "43deadd6b6b2"),
    ("hourglass", "c1d78c8ea365"),
    ("saucer", "29045b204fc4"),
    ("colonnade", "2e8f528dcdfb"),
    ("hammer", "dd3ba11560d9"),
    ("trefoil_knot", "be6172a8ba65"),
    ("torus_knot", "d8114480f94b"),
    ("spring", "2b1413f5b1ef"),
    ("nautilus", "48780b1a5972"),
    ("snail", "3caac6be8512"),
    ("arch", "6be1161edf46"),
    ("chain", "f74f682786f0"),
    ("rounded_box", "d58c918e5e3a"),
    ("pillow", "73f774239437"),
    ("caltrop", "07e354d77e78"),
    ("supertoroid", "72cd345254dd"),
    ("stairs", "61b5c4d0c0fa"),
    ("cross", "1d7f0ca52225"),
    ("chair", "cb0c61473388"),
    ("sink", "115f59497f85"),
    ("bridge", "fe736375c6c6"),
    ("towers", "508a4973d5e5"),
    ("lattice", "0a7679a00a9e"),
    ("menger_sponge", "f73f648a5215"),
    ("gyroid", "6eb0441a5084"),
    ("sponge", "89d775102ff9"),
    ("coral", "ca3c1ba5dbf1"),
    ("drops", "92daa85f6e16"),
    ("terrain", "4ab7df90fb03"),
    ("coarse_terrain", "cbb26f779434"),
    ("ripples", "91ed70e2403f"),
    ("crater", "7de7f7f3939f"),
    ("cloth", "532620516cf6"),
    ("curtain", "238e44f0ad36"),
    ("plate", "2b2f12971d93"),
    ("tilted_plate", "98de4b9865e4"),
    ("sheets", "79304d5f7f61"),
    ("blinds", "d989029f5a7d"),
    ("leaf", "af15ed7cdf47"),
    ("kelp", "e0d90d3d8f65"),
    ("jellyfish", "b6f92202ea47"),
    ("dolphin", "3228850df481"),
    ("angelfish", "115f625dc08c"),
    ("manta", "360ec7668f84"),
    ("teapot", "73b9ac22501c"),
];

#[test]
fn the_same_text_everywhere() {
    let found: Vec<(&str, &str)> = MESHES
        .iter()
        .map(|(shape, mesh)| (shape.name, &mesh.id["blake3:".len()..][..12]))
        .collect();
    for (found, wanted) in found.iter().zip(IDS) {
        assert_eq!(found, wanted);
    }
    assert_eq!(found.len(), IDS.len());
}

#[test]
fn nothing_asks_the_systems_mathematics_library() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/lab/shapes");
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        files += 1;
        for call in [
            ".sin(",
            ".cos(",
            ".tan(",
            ".sin_cos(",
            "asin(",
            "acos(",
            "atan",
            ".exp(",
            ".exp2(",
            ".ln",
            ".log",
            ".powf(",
            ".powi(",
            ".cbrt(",
            ".hypot(",
            ".mul_add(",
            "sinh",
            "cosh",
            "tanh",
            "rotate",
            "from_angle",
            "angle_between",
            "slerp",
            "Quat",
            "f64::sin",
            "f64::cos",
            "f64::pow",
        ] {
            assert!(
                !text.contains(call),
                "{}: `{call}` may differ in its last digit between machines",
                path.display()
            );
        }
    }
    assert!(files > 15, "{files}");
}

#[test]
fn names_are_unique_and_every_shape_is_described() {
    assert!(ALL.len() >= 32);
    let names: BTreeSet<&str> = ALL.iter().map(|shape| shape.name).collect();
    assert_eq!(names.len(), ALL.len());
    for shape in ALL {
        let name = shape.name;
        let plain = |c: char| c.is_ascii_lowercase() || c == '_';
        assert!(!name.is_empty() && name.chars().all(plain), "{name}");
        let description = shape.description;
        assert!(
            description.starts_with(char::is_uppercase) && !description.ends_with('.'),
            "{description}"
        );
        assert_eq!(Shape::named(name).unwrap().name, name);
    }
    assert!(Shape::named("Sphere").is_none());
}

#[test]
fn the_table_of_the_module_is_the_catalogue() {
    let text = include_str!("../../src/lab/shapes/mod.rs");
    let table: Vec<&str> = text
        .lines()
        .filter(|line| line.starts_with("//! | `"))
        .collect();
    let rows: Vec<String> = ALL
        .iter()
        .map(|shape| {
            format!(
                "//! | `{}` | {} | {} | {} |",
                shape.name, shape.triangles, shape.open_edges, shape.description
            )
        })
        .collect();
    assert_eq!(table, rows);
}

#[test]
fn valid_meshes_are_not_repaired() {
    for (shape, mesh) in &*MESHES {
        assert_eq!(mesh.triangles.len(), shape.triangles, "{}", shape.name);
        let warnings: Vec<(&str, &str)> = mesh
            .warnings
            .iter()
            .map(|w| (w.code.as_str(), w.message.as_str()))
            .collect();
        // The one thing that may be said is that an open shape is open.
        match (shape.open_edges, warnings.as_slice()) {
            (0, []) => {}
            (open, [("mesh_open", said)]) => {
                assert!(said.starts_with(&format!("{open} edges")), "{said}");
            }
            _ => panic!("{}: {warnings:?}", shape.name),
        }
    }
}

#[test]
fn closed_shapes_are_closed_and_face_outward() {
    let mut closed = 0;
    for (shape, mesh) in &*MESHES {
        let parts = parts(mesh);
        let open: usize = parts.iter().map(|(_, open)| open).sum();
        assert_eq!(open, shape.open_edges, "{}", shape.name);
        if open == 0 {
            closed += 1;
            assert!(edges_cancel(mesh), "{}", shape.name);
            for (triangles, _) in &parts {
                let volume = volume(triangles);
                assert!(volume > 1e-7, "{}: {volume}", shape.name);
            }
        }
    }
    assert!(closed >= 32, "{closed}");
    assert!(ALL.len() - closed >= 8, "{closed}");
}

#[test]
fn every_shape_fits_its_box() {
    for (shape, mesh) in &*MESHES {
        let bounds = mesh.info().bounds_m;
        let (min, max) = (DVec3::from(bounds.min), DVec3::from(bounds.max));
        assert!((min + max).abs().max_element() < 2e-6, "{}", shape.name);
        let longest_m = (max - min).max_element();
        assert!(
            (longest_m - 1.0).abs() < 2e-6,
            "{}: {longest_m}",
            shape.name
        );
    }
}

#[test]
fn triangles_range_from_ten_to_three_hundred_thousand() {
    let with = |least: usize, most: usize| {
        let counts = ALL.iter().map(|shape| shape.triangles);
        counts.filter(|n| (least..most).contains(n)).count()
    };
    assert_eq!(with(0, 10), 0);
    for (least, wanted) in [(10, 5), (100, 8), (1_000, 10), (10_000, 8), (70_000, 4)] {
        let found = with(least, 10 * least);
        assert!(found >= wanted, "{found} from {least}");
    }
    assert_eq!(with(290_000, 310_000), 1);
    // The sphere and the dolphin of Tipprasert (2006), Table 5-2.
    assert_eq!(Shape::named("sphere").unwrap().triangles, 1_984);
    assert_eq!(Shape::named("dolphin").unwrap().triangles, 4_442);
}

#[test]
fn an_upload_of_the_text_is_the_same_mesh() {
    for name in ["box", "dolphin", "teapot"] {
        let shape = Shape::named(name).unwrap();
        let text = shape.obj();
        let inserted = MeshStore::default()
            .insert_obj(text.as_bytes(), &[])
            .unwrap();
        assert!(inserted.created);
        assert_eq!(inserted.mesh.id, mesh(name).id);
        assert_eq!(inserted.mesh.triangles, mesh(name).triangles);
        assert_eq!(obj::id(text.as_bytes(), &[]), mesh(name).id);
    }
}

#[test]
fn normals_are_smooth_where_the_surface_is() {
    for (shape, mesh) in &*MESHES {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.positions_m.map(|p| p.as_dvec3());
            let face = (b - a).cross(c - a).normalize();
            for normal in triangle.normals {
                // No face that is turned by more than 40° (0.766) counts; the text has four digits.
                let cos = normal.as_dvec3().dot(face);
                assert!(cos > 0.76, "{}: {cos}", shape.name);
            }
        }
    }
    for name in ["box", "star", "menger_sponge", "icosahedron"] {
        for triangle in &mesh(name).triangles {
            assert_eq!(triangle.normals[0], triangle.normals[1], "{name}");
            assert_eq!(triangle.normals[0], triangle.normals[2], "{name}");
        }
    }
    for name in ["sphere", "icosphere"] {
        for triangle in &mesh(name).triangles {
            for (p, normal) in triangle.positions_m.iter().zip(triangle.normals) {
                assert!(normal.distance(2.0 * *p) < 1e-3, "{name}: {p} {normal}");
            }
        }
    }
}

#[test]
fn sines_are_those_of_the_textbook() {
    let sphere = Shape::named("sphere").unwrap().outline();
    // 31 parallels of 32 points from below, then the poles.
    for (index, p) in sphere.positions_m[..31 * 32].iter().enumerate() {
        let polar = std::f64::consts::PI * (1 + index / 32) as f64 / 32.0;
        let east = std::f64::consts::TAU * (index % 32) as f64 / 32.0;
        let wanted = 0.5
            * DVec3::new(
                polar.sin() * east.cos(),
                -polar.cos(),
                -polar.sin() * east.sin(),
            );
        assert!(p.distance(wanted) < 1e-15, "{index}: {p} {wanted}");
    }
}

#[test]
fn volumes_are_those_of_the_textbook() {
    use std::f64::consts::{PI, TAU};
    let polygon = |sides: f64| 0.5 * sides * (TAU / sides).sin();
    let near = |name: &str, wanted: f64, tolerance: f64| {
        let found = whole_volume(name);
        assert!(
            (found / wanted - 1.0).abs() < tolerance,
            "{name}: {found}, {wanted}"
        );
    };
    near("box", 1.0, 1e-6);
    near("plate", 0.01, 1e-4);
    // Ten steps: 55 of 100 squares, 0.8 m deep.
    near("stairs", 0.55 * 0.8, 1e-5);
    // A level takes 7 of 27 cubes.
    near("menger_sponge", (20.0_f64 / 27.0).powi(3), 1e-5);
    near("cylinder", polygon(48.0) * 0.35 * 0.35, 1e-5);
    near("cone", polygon(64.0) * 0.25 / 3.0, 1e-5);
    near("pipe", polygon(80.0) * (0.3 * 0.3 - 0.27 * 0.27), 1e-4);
    // The regular icosahedron of edge a holds 5/12 (3 + √5) a³; 1 m from edge to edge is golden × a.
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let icosahedron = 5.0 / 12.0 * (3.0 + 5.0_f64.sqrt()) / (golden * golden * golden);
    near("icosahedron", icosahedron, 1e-5);
    // Curved ones, less what their chords cut off.
    near("icosphere", PI / 6.0, 0.004);
    near("sphere", PI / 6.0, 0.012);
    let ring = 2.0 * PI * PI * 1.0 * 0.35 * 0.35 / 2.7_f64.powi(3);
    near("torus", ring, 0.014);
}
