//! Reading OBJ and MTL: what is accepted, what is repaired with a warning, what is refused and how.

use caustica::config::Limits;
use caustica::mesh::{DEFAULT_ALBEDO, Mesh, MeshError, obj};
use glam::{DVec3, Vec3};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

fn read(text: &str) -> Result<Mesh, MeshError> {
    obj::read(text.as_bytes(), &[], &Limits::default())
}

fn read_with(text: &str, mtl: &str) -> Result<Mesh, MeshError> {
    obj::read(text.as_bytes(), &[mtl.as_bytes()], &Limits::default())
}

fn good(text: &str) -> Mesh {
    read(text).expect("a valid mesh")
}

fn codes(mesh: &Mesh) -> Vec<&str> {
    mesh.warnings.iter().map(|w| w.code.as_str()).collect()
}

#[track_caller]
fn warned(mesh: &Mesh, code: &str, needle: &str) {
    let warning = mesh.warnings.iter().find(|w| w.code == code);
    let warning = warning.unwrap_or_else(|| panic!("no {code} in {:?}", mesh.warnings));
    assert!(warning.message.contains(needle), "{}", warning.message);
}

#[track_caller]
fn refused(text: &str, needles: &[&str]) -> MeshError {
    let error = read(text).expect_err("a broken mesh");
    let message = error.to_string();
    for needle in needles {
        assert!(message.contains(needle), "`{needle}` not in: {message}");
    }
    error
}

#[test]
fn a_triangle_is_moved_to_its_middle() {
    let mesh = good(TRIANGLE);
    assert_eq!(mesh.origin_m, DVec3::new(0.5, 0.5, 0.0));
    assert_eq!(
        mesh.triangles[0].positions_m,
        [
            Vec3::new(-0.5, -0.5, 0.0),
            Vec3::new(0.5, -0.5, 0.0),
            Vec3::new(-0.5, 0.5, 0.0)
        ]
    );
    assert_eq!(mesh.triangles[0].normals, [Vec3::Z; 3]);
    assert_eq!(mesh.min_m, Vec3::new(-0.5, -0.5, 0.0));
    assert_eq!(mesh.max_m, Vec3::new(0.5, 0.5, 0.0));
    assert_eq!(mesh.materials.len(), 1);
    assert_eq!(mesh.materials[0].albedo, [DEFAULT_ALBEDO; 3]);
    assert_eq!(mesh.hierarchy.len(), 1);
    assert_eq!(codes(&mesh), ["mesh_open"]);
    warned(&mesh, "mesh_open", "3 edges");
}

#[test]
fn a_closed_mesh_has_nothing_to_say() {
    let mesh = good(TETRAHEDRON);
    assert_eq!(mesh.triangles.len(), 4);
    assert!(mesh.warnings.is_empty(), "{:?}", mesh.warnings);
}

#[test]
fn detail_far_from_the_origin_survives() {
    let far = good(
        "v 1000000.01 2e6 -3e6\nv 1000000.02 2e6 -3e6\nv 1000000.01 2000000.01 -3e6\nf 1 2 3\n",
    );
    let [a, b, c] = far.triangles[0].positions_m;
    assert!((b.x - a.x - 0.01).abs() < 1e-8, "{}", b.x - a.x);
    assert!((c.y - a.y - 0.01).abs() < 1e-8, "{}", c.y - a.y);
    let info = far.info();
    assert!((info.bounds_m.min[0] - 1_000_000.01).abs() < 1e-8);
    assert!((info.bounds_m.max[1] - 2_000_000.01).abs() < 1e-8);
}

#[test]
fn unused_vertices_and_flat_slivers_leave_the_origin_alone() {
    let mesh = good(&format!(
        "{TRIANGLE}v 1000 0 0\nv 2000 0 0\nv 9 9 9\nf 1 4 5\n"
    ));
    assert_eq!(mesh.origin_m, DVec3::new(0.5, 0.5, 0.0));
    warned(&mesh, "mesh_degenerate_triangles", "1 triangles");
}

#[test]
fn spellings_of_the_same_mesh_agree() {
    let plain = good(TRIANGLE);
    for text in [
        "\u{feff}v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1",
        "v 0 0 0 # corner\n  v 1 0 0\n\tv\t0 1 0\n\n# f 1 1 1 \\\nf 1 \\\n 2 \\\n3 # face\n",
        "v 0 0 0 1\nv 2 0 0 2\nv 0 .5 0 .5\nf 1 2 3\n",
        "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r",
        "v 0 0 0\r\n\r\nv 1e0 0 0\nv 0 1. 0\rf 1 2 3",
        "mtllib\nusemtl\no\ng\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3/one\n",
        "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/99999\n",
        "o a\ng b\ns off\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng c\nf 1// 2// 3//\ng d\n",
    ] {
        let mesh = good(text);
        assert_eq!(mesh.triangles, plain.triangles, "{text:?}");
        assert_eq!(mesh.warnings, plain.warnings, "{text:?}");
        assert_ne!(mesh.id, plain.id);
    }
}

#[test]
fn polygons_become_fans() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let mesh = good(&format!("{square}f 1 2 3 4\n"));
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(codes(&mesh), ["mesh_open"]);
    warned(&mesh, "mesh_open", "4 edges");
    let pentagon = good("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 2 0\nv -1 1 0\nf 1 2 3 4 5\n");
    assert_eq!(pentagon.triangles.len(), 3);
}

/// Area of a mesh.
fn area(mesh: &Mesh) -> f64 {
    let of_triangle = |[a, b, c]: [Vec3; 3]| f64::from(0.5 * (b - a).cross(c - a).length());
    mesh.triangles
        .iter()
        .map(|t| of_triangle(t.positions_m))
        .sum()
}

#[test]
fn concave_polygons_are_cut_by_their_ears() {
    // An arrow head whose fan folds over itself, and a wall with a door, in each of its turns and both directions.
    let arrow = good("v 0 2 0\nv -1 0 0\nv 0 1 0\nv 1 0 0\nf 2 3 4 1\n");
    assert!((area(&arrow) - 1.0).abs() < 1e-6, "{}", area(&arrow));
    assert_eq!(codes(&arrow), ["mesh_open"]);
    let wall = "v 0 0 0\nv 1 0 0\nv 1 2 0\nv 2 2 0\nv 2 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\n";
    for start in 0..8 {
        let mut corners: Vec<String> = (0..8).map(|i| ((start + i) % 8 + 1).to_string()).collect();
        for normal in [Vec3::Z, Vec3::NEG_Z] {
            let mesh = good(&format!("{wall}f {}\n", corners.join(" ")));
            assert!((area(&mesh) - 7.0).abs() < 1e-5, "{}", area(&mesh));
            assert_eq!(mesh.triangles.len(), 6);
            assert!(mesh.triangles.iter().all(|t| t.normals == [normal; 3]));
            warned(&mesh, "mesh_open", "8 edges");
            assert_eq!(codes(&mesh), ["mesh_open"]);
            corners.reverse();
        }
    }
}

#[test]
fn corners_on_straight_edges_stay_corners() {
    // A wall with a door whose lintel and sides have corners in the middle, where neighbours end; the neighbours close the edges.
    let ring = [
        [0, 0],
        [1, 0],
        [1, 1],
        [1, 2],
        [2, 2],
        [2, 1],
        [2, 0],
        [3, 0],
        [3, 1],
        [3, 2],
        [3, 3],
        [2, 3],
        [1, 3],
        [0, 3],
    ];
    let vertices: String = ring.iter().map(|[x, y]| format!("v {x} {y} 0\n")).collect();
    let face = |corners: &[usize]| {
        let words: Vec<String> = corners.iter().map(usize::to_string).collect();
        format!("f {}\n", words.join(" "))
    };
    let whole: Vec<usize> = (1..=14).collect();
    let mesh = good(&format!("{vertices}{}", face(&whole)));
    assert!((area(&mesh) - 7.0).abs() < 1e-5);
    warned(&mesh, "mesh_open", "14 edges");
    // The same wall from behind, in rectangles: the two close each other.
    let back: String = [[1, 14, 13, 2], [4, 13, 12, 5], [7, 12, 11, 8]]
        .iter()
        .map(|c| face(c))
        .collect();
    let sheet = good(&format!("{vertices}{}{back}", face(&whole)));
    assert!((area(&sheet) - 14.0).abs() < 1e-4);
}

#[test]
fn polygons_that_cross_themselves_are_reported() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n";
    let bow = good(&format!("{square}f 1 2 4 3\n"));
    warned(&bow, "mesh_crossed_polygons", "1 polygons cross");
    warned(&bow, "mesh_crossed_polygons", "on line 6");
    let crossed = good(&format!("{square}f 1 5 4 3\n"));
    warned(&crossed, "mesh_crossed_polygons", "1 polygons cross");
}

/// A star with half as many points as corners.
fn star(count: u32) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    for i in 0..count {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(count);
        let radius = if i % 2 == 0 { 2.0 } else { 1.0 };
        writeln!(
            text,
            "v {} {} 0",
            radius * angle.cos(),
            radius * angle.sin()
        )
        .unwrap();
    }
    text.push('f');
    for i in 1..=count {
        write!(text, " {i}").unwrap();
    }
    text
}

#[test]
fn a_polygon_with_very_many_corners_is_cut() {
    let count = 8_000;
    let mesh = good(&star(count));
    assert_eq!(mesh.triangles.len(), count as usize - 2);
    let right = f64::from(count / 2) * 2.0 * (std::f64::consts::TAU / f64::from(count)).sin();
    let area = area(&mesh);
    assert!((area / right - 1.0).abs() < 1e-3, "{area} {right}");
    let error = refused(
        &star(10_002),
        &["OBJ line 10003", "10002 corners", "accepted are 10000"],
    );
    assert!(matches!(error, MeshError::PolygonTooLarge { .. }));
    // Fewer corners each, but too many of them together.
    let face = star(9_000).lines().last().unwrap().to_owned();
    let many = format!("{}\n{}", star(9_000), format!("{face}\n").repeat(12));
    refused(&many, &["9000 corners"]);
}

#[test]
fn corners_on_straight_edges_of_convex_polygons_stay_corners() {
    // A triangle with a corner in the middle of its first side, and neighbours that end there: closed but for the outer sides.
    let mesh = good("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 2 0\nv 1 -1 0\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\n");
    assert!((area(&mesh) - 3.0).abs() < 1e-6, "{}", area(&mesh));
    warned(&mesh, "mesh_open", "4 edges");
    assert_eq!(codes(&mesh), ["mesh_open"]);
    // Corners in the middle of all sides of a square, in each of its turns.
    let ring = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\nv 0 2 0\nv 0 1 0\n";
    for start in 0..8 {
        let corners: Vec<String> = (0..8).map(|i| ((start + i) % 8 + 1).to_string()).collect();
        let mesh = good(&format!("{ring}f {}\n", corners.join(" ")));
        assert!((area(&mesh) - 4.0).abs() < 1e-6);
        warned(&mesh, "mesh_open", "8 edges");
        assert_eq!(codes(&mesh), ["mesh_open"], "{start}");
    }
}

#[test]
fn lines_and_points_are_not_triangles() {
    let mesh = good(&format!(
        "{TRIANGLE}l 1 2 3\np 1\ncurv2 1 2\nf 1 2\nf 1\nf\n"
    ));
    assert_eq!(mesh.triangles.len(), 1);
    warned(&mesh, "mesh_ignored_lines", "3 lines");
    warned(&mesh, "mesh_ignored_lines", "line 5 (`l`)");
    warned(&mesh, "mesh_small_faces", "3 faces");
    warned(&mesh, "mesh_small_faces", "line 8");
}

#[test]
fn normals_come_from_the_file_where_it_has_good_ones() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let mesh = good(&format!(
        "{vertices}vn 0 3 4\nvn 0 0 0\nvn nan 1 0\nvn 1e-200 0 1e-200\nf 1//1 2//2 3//3\nf 3//-1 2 1\n"
    ));
    assert_eq!(
        mesh.triangles[0].normals,
        [Vec3::new(0.0, 0.6, 0.8), Vec3::Z, Vec3::Z]
    );
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let [first, second, third] = mesh.triangles[1].normals;
    assert!(
        (first - Vec3::new(half, 0.0, half)).length() < 1e-6,
        "{first}"
    );
    // A corner without a normal takes the face's, not that of the corner before it.
    assert_eq!([second, third], [Vec3::NEG_Z; 2]);
    warned(&mesh, "mesh_bad_normals", "2 normals");
    for words in [
        "-nan(ind) -nan(ind) -nan(ind)",
        "-1.#IND 1.#QNAN0 0",
        "1.#INF00 0 1",
        "0 1",
        "a b c",
        "",
        "0 +nan(0x8000) 1",
    ] {
        let mesh = good(&format!("{vertices}vn {words}\nf 1//1 2//1 3//1\n"));
        assert_eq!(mesh.triangles[0].normals, [Vec3::Z; 3], "{words}");
        warned(&mesh, "mesh_bad_normals", "1 normals");
        warned(&mesh, "mesh_bad_normals", "The first is line 4.");
    }
    // An exporter's "none here", indices beyond the file, and words that are no index.
    for normal in ["0", "2", "-2", "99999999999999999999", "x", "1.0"] {
        let mesh = good(&format!("{vertices}vn 0 1 0\nf 1//1 2//{normal} 3/0/1\n"));
        assert_eq!(
            mesh.triangles[0].normals,
            [Vec3::Y, Vec3::Z, Vec3::Y],
            "{normal}"
        );
        warned(&mesh, "mesh_missing_normals", "1 corners");
        warned(&mesh, "mesh_missing_normals", "line 5");
    }
    let turned = good(&format!("{vertices}vn 0 0 -1\nf 1//1 2//1 3//1\n"));
    assert_eq!(turned.triangles[0].normals, [Vec3::NEG_Z; 3]);
    warned(&turned, "mesh_normals_against_winding", "1 triangles");
}

#[test]
fn degenerate_and_doubled_triangles_are_left_out() {
    let mesh = good(&format!(
        "{TETRAHEDRON}v 2 0 0\nf 1 1 2\nf 1 2 5\nf 2 2 2\nf 3 2 1\nv -0 0 0\nf 6 3 2\n"
    ));
    assert_eq!(mesh.triangles.len(), 4);
    warned(&mesh, "mesh_degenerate_triangles", "3 triangles");
    warned(&mesh, "mesh_duplicate_triangles", "2 triangles");
    assert_eq!(mesh.warnings.len(), 2, "{:?}", mesh.warnings);
    // The same corners the other way round are the back of a sheet, and stay.
    let sheet = good(&format!("{TRIANGLE}f 1 3 2\n"));
    assert_eq!(sheet.triangles.len(), 2);
    assert!(sheet.warnings.is_empty(), "{:?}", sheet.warnings);
}

#[test]
fn thin_triangles_are_not_degenerate() {
    let mesh = good("v 0 0 0\nv 1000 0 0\nv 500 1e-5 0\nf 1 2 3\n");
    assert_eq!(mesh.triangles.len(), 1);
    assert_eq!(mesh.triangles[0].normals, [Vec3::Z; 3]);
    let small = good("v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n");
    assert_eq!(small.triangles.len(), 1);
    let edge = good("v 1e9 1e9 1e9\nv -1e9 1e9 1e9\nv -1e9 -1e9 -1e9\nf 1 2 3\n");
    assert!(edge.triangles[0].normals[0].is_normalized());
}

#[test]
fn bad_topology_is_kept_and_reported() {
    let mesh = good(&format!("{TETRAHEDRON}v 0 -1 0\nf 1 2 5\nf 1 3 4\n"));
    assert_eq!(mesh.triangles.len(), 6);
    warned(&mesh, "mesh_non_manifold", "4 edges");
    warned(&mesh, "mesh_open", "2 edges");
    let turned = good(&TETRAHEDRON.replace("f 1 4 3", "f 1 3 4"));
    assert_eq!(turned.triangles.len(), 4);
    warned(&turned, "mesh_winding", "3 edges");
}

const PAINTED: &str =
    "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 2\n";

#[test]
fn materials_come_from_the_mtl() {
    let mtl =
        "newmtl unused\nKd 1 1 1\nnewmtl blue\nKa 1\nKd 0 0 1\nnewmtl red\nKd 0.9 0.1 0.1\nNs\n";
    let mesh = read_with(PAINTED, mtl).unwrap();
    let materials: Vec<_> = mesh
        .materials
        .iter()
        .map(|m| (m.name.as_str(), m.albedo))
        .collect();
    assert_eq!(
        materials,
        [("blue", [0.0, 0.0, 1.0]), ("red", [0.9, 0.1, 0.1])]
    );
    assert_eq!(
        mesh.triangles
            .iter()
            .map(|t| t.material)
            .collect::<Vec<_>>(),
        [1, 0]
    );
    assert!(mesh.warnings.is_empty(), "{:?}", mesh.warnings);
    // The MTL counts wherever, and whether or not, the OBJ names a library.
    for text in [
        PAINTED.replace("mtllib paint.mtl\n", ""),
        format!(
            "{}mtllib late.mtl\n",
            PAINTED.replace("mtllib paint.mtl\n", "")
        ),
        PAINTED.replace("paint.mtl", "../../etc/passwd"),
    ] {
        assert_eq!(read_with(&text, mtl).unwrap().materials, mesh.materials);
    }
}

#[test]
fn a_library_path_is_never_opened() {
    // The file exists and is a valid MTL; without it in the request the material stays unknown.
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/teapot.mtl");
    assert!(std::path::Path::new(path).exists());
    let text = PAINTED.replace("paint.mtl", path).replace("red", "ceramic");
    let mesh = good(&text);
    assert_eq!(mesh.materials.len(), 1);
    assert_eq!(mesh.materials[0].albedo, [DEFAULT_ALBEDO; 3]);
    warned(&mesh, "mesh_missing_material", "there is no MTL");
}

#[test]
fn missing_and_unused_materials_are_reported() {
    warned(&good(PAINTED), "mesh_missing_material", "`paint.mtl`");
    let unnamed = PAINTED.replace("mtllib paint.mtl\n", "");
    warned(&good(&unnamed), "mesh_missing_material", "`blue`, `red`");
    let half = read_with(PAINTED, "newmtl red\nKd 0.5\n").unwrap();
    warned(&half, "mesh_missing_material", "1 materials");
    warned(&half, "mesh_missing_material", "`blue`");
    assert_eq!(half.materials[0].albedo, [0.5; 3]);
    assert_eq!(half.materials[1].albedo, [DEFAULT_ALBEDO; 3]);
    assert_eq!(half.triangles[1].material, 1);
    for mtl in ["", "newmtl green\nKd 0 1 0\n"] {
        let mesh = read_with(TRIANGLE, mtl).unwrap();
        warned(&mesh, "mesh_mtl_ignored", "no effect");
        assert_eq!(mesh.materials[0].name, "");
    }
    let textured = read_with(
        PAINTED,
        "newmtl red\nmap_Kd a.png\nnewmtl blue\nKd spectral b.rfl\n",
    )
    .unwrap();
    warned(
        &textured,
        "mesh_textures_ignored",
        "1 materials have textures",
    );
    warned(&textured, "mesh_textures_ignored", "`red` (`map_Kd a.png`)");
    warned(&textured, "mesh_spectra_ignored", "1 spectral");
    assert_eq!(textured.materials[0].albedo, [DEFAULT_ALBEDO; 3]);
}

#[test]
fn reflectances_are_clamped_and_reported() {
    let mesh = read_with(
        PAINTED,
        "newmtl red\nKd 1.5 -1 0.25\nnewmtl blue\nKd nan inf -inf\n",
    )
    .unwrap();
    assert_eq!(mesh.materials[0].albedo, [1.0, 0.0, 0.25]);
    assert_eq!(mesh.materials[1].albedo, [DEFAULT_ALBEDO, 1.0, 0.0]);
    warned(&mesh, "mesh_material_clamped", "`blue`");
    assert_eq!(codes(&mesh), ["mesh_material_clamped"; 2]);
}

#[test]
fn a_trailing_material_without_faces_is_harmless() {
    let mesh = read_with(&format!("{TRIANGLE}usemtl red\n"), "newmtl red\nKd 1 0 0\n").unwrap();
    assert_eq!(mesh.materials.len(), 1);
    assert_eq!(mesh.materials[0].name, "");
}

#[test]
fn empty_and_binary_bodies_are_refused() {
    for text in ["", " \n\t\r\n", "\u{feff}"] {
        assert_eq!(refused(text, &["empty", "`f a b c`"]), MeshError::Empty);
    }
    let picture = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\xff\xfe";
    let error = obj::read(picture, &[], &Limits::default()).unwrap_err();
    assert_eq!(error, MeshError::NoFaces { vertices: 0 });
    let mesh = obj::read(TRIANGLE.as_bytes(), &[picture], &Limits::default()).unwrap();
    warned(&mesh, "mesh_mtl_ignored", "none of its 0 materials");
}

#[test]
fn names_and_comments_may_have_any_encoding() {
    // "stein äöü" in Windows-1252, UTF-8 and, as characters that end in a backslash's byte, Shift JIS.
    let names: [&[u8]; 3] = [b"stein \xe4\xf6\xfc", "stein äöü".as_bytes(), b"\x95\x5c"];
    for name in names {
        let mut obj = b"# gr\xfc\xdfe \\\no ".to_vec();
        obj.extend_from_slice(name);
        obj.extend_from_slice(b"\ng ");
        obj.extend_from_slice(name);
        obj.extend_from_slice(b"\nv 0 0 0\nv 1 0 0 # \xe9\nv 0 1 0\nusemtl ");
        obj.extend_from_slice(name);
        obj.extend_from_slice(b"\nf 1 2 3\n");
        let mut mtl = b"# \xff\xfe\nnewmtl ".to_vec();
        mtl.extend_from_slice(name);
        mtl.extend_from_slice(b"\r\nKd 0.1 0.7 0.2\r\n");
        let mesh = obj::read(&obj, &[&mtl], &Limits::default()).unwrap();
        assert_eq!(mesh.materials[0].albedo, [0.1, 0.7, 0.2]);
        assert_eq!(codes(&mesh), ["mesh_open"]);
    }
    // The same name in a file of each encoding.
    let obj = PAINTED.replace("red", "röd");
    let mtl = b"newmtl r\xf6d\nKd 0.1 0.7 0.2\nnewmtl blue\nKd 0 0 1\n";
    let mesh = obj::read(obj.as_bytes(), &[mtl], &Limits::default()).unwrap();
    assert_eq!(mesh.materials[0].name, "röd");
    assert_eq!(mesh.warnings, vec![]);
}

#[test]
fn utf_16_is_read() {
    for (mark, big_endian) in [(true, false), (true, true), (false, false), (false, true)] {
        let encode = |text: &str| -> Vec<u8> {
            let marked = if mark {
                format!("\u{feff}{text}")
            } else {
                text.to_owned()
            };
            let unit = |unit: u16| {
                if big_endian {
                    unit.to_be_bytes()
                } else {
                    unit.to_le_bytes()
                }
            };
            marked.encode_utf16().flat_map(unit).collect()
        };
        let obj = encode(&PAINTED.replace("red", "röd").replace('\n', "\r\n"));
        let mtl = encode("newmtl röd\r\nKd 0.1 0.7 0.2\r\nnewmtl blue\r\nKd 0 0 1\r\n");
        let mesh = obj::read(&obj, &[&mtl], &Limits::default()).unwrap();
        assert_eq!(mesh.materials[0].albedo, [0.1, 0.7, 0.2]);
        assert_eq!(mesh.warnings, vec![]);
    }
}

#[test]
fn a_mesh_without_faces_is_refused() {
    for (text, vertices) in [
        ("v 0 0 0\nv 1 0 0\n", 2),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", 2),
        ("solid ascii_stl\n facet normal 0 0 1\n", 0),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n", 3),
    ] {
        assert_eq!(
            refused(text, &["no face", "f 1 2 3"]),
            MeshError::NoFaces { vertices }
        );
    }
}

#[test]
fn indices_out_of_range_are_refused() {
    for (face, index) in [
        ("1 2 4", 4),
        ("0 1 2", 0),
        ("1 2 -4", -4),
        ("1 2 4294967296", 4_294_967_296),
        ("1 2 18446744073709551", 18_446_744_073_709_551),
        ("1 2 -9223372036854775808", i64::MIN),
    ] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1 2 3\nf {face}\n");
        let needle = format!("position index {index} is out of range");
        let error = refused(&text, &["line 6, face 2", &needle, "accepted are 1 … "]);
        assert!(matches!(
            error,
            MeshError::FaceIndex {
                line: 6,
                face: 2,
                ..
            }
        ));
    }
}

#[test]
fn coordinates_beyond_sense_are_refused_where_a_face_uses_them() {
    let bad = |vertex: &str| format!("v 0 0 0\nv {vertex}\nv 0 1 0\nf 1 2 3\n");
    for word in [
        "nan",
        "inf",
        "-infinity",
        "1e999",
        "-nan(ind)",
        "1.#INF",
        "-1.#IND0",
    ] {
        let error = refused(
            &bad(&format!("0 {word} 0")),
            &["line 2", word, "not finite"],
        );
        assert!(matches!(error, MeshError::NonFinite { line: 2, .. }));
    }
    let error = refused(
        &bad("1.5e9 0 0"),
        &["line 2", "`1.5e9`", "too large", "-1e9 … 1e9"],
    );
    assert!(matches!(error, MeshError::TooLarge { line: 2, .. }));
    // A weight divides: 5e8 / 0.1.
    assert!(matches!(
        read(&bad("5e8 0 0 0.1")),
        Err(MeshError::TooLarge { .. })
    ));
    // The geometry does not need a vertex of no face.
    let mesh = good(&format!("{TRIANGLE}v nan 0 0\nv 1,5 0 0\nv 1\n"));
    assert_eq!(mesh.triangles.len(), 1);
    warned(&mesh, "mesh_bad_vertices", "3 vertices");
    warned(
        &mesh,
        "mesh_bad_vertices",
        "OBJ line 5: coordinate `nan` is not finite",
    );
}

#[test]
fn further_values_of_vertices_are_named() {
    let mesh = good("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 1 0\nf 1 2 3\n");
    assert_eq!(mesh.triangles, good(TRIANGLE).triangles);
    warned(&mesh, "mesh_vertex_colours_ignored", "3 vertices");
    // Seven values are a colour with alpha or with a weight; five and more than seven are in no description of the format.
    let mesh = good("v 0 0 0 1 0 0 1\nv 1 0 0 a b\nv 0 1 0 1 2 3 4 5 6\nf 1 2 3\n");
    assert_eq!(mesh.triangles, good(TRIANGLE).triangles);
    warned(&mesh, "mesh_extra_values_ignored", "3 vertices");
    warned(&mesh, "mesh_extra_values_ignored", "line 1");
}

#[test]
fn what_is_no_part_of_the_geometry_is_left_out() {
    let plain = good(TRIANGLE);
    let with =
        |second: &str, face: &str| good(&format!("v 0 0 0\nv {second}\nv 0 1 0\nf {face}\n"));
    for weight in ["0", "nan", "-nan(ind)", "1.#INF", "x"] {
        let mesh = with(&format!("1 0 0 {weight}"), "1 2 3");
        assert_eq!(mesh.triangles, plain.triangles, "{weight}");
        warned(&mesh, "mesh_bad_weights", "line 2");
    }
    for (second, face) in [
        ("1 0 0#corner", "1 2 3#face"),
        ("1 0 0 # x", "1 2 \\ # goes on\n3"),
        ("1 0 0\0\0", "1 2 3\0"),
        ("1 0 0\x0b", "1 2 \\\r\r\n3\r\r"),
        ("1 0 0", "1 2 3;"),
        ("1 0 0", "1, 2, 3"),
    ] {
        let mesh = with(second, face);
        assert_eq!(mesh.triangles, plain.triangles, "{second:?} {face:?}");
        assert_eq!(mesh.warnings, plain.warnings, "{second:?} {face:?}");
    }
    let mesh = with("1 0 0", "1 2 3 // front");
    assert_eq!(mesh.triangles, plain.triangles);
    warned(&mesh, "mesh_trailing_words", "`//` on line 4");
}

#[test]
fn tiny_numbers_and_bad_vertices_do_not_take_much_memory() {
    // Written out, each of these numbers has 300 digits.
    let tiny = good("v 1e-300 0 0\nv 1 1e-300 0\nv 0 1 -1e-300\nvn 1e-300 0 1\nf 1//1 2//1 3//1\n");
    assert_eq!(tiny.triangles[0].normals, [Vec3::Z; 3]);
    let many = format!("{}{TRIANGLE}", "v\n".repeat(100_000)).replace("f 1 2 3", "f -3 -2 -1");
    let mesh = good(&many);
    warned(&mesh, "mesh_bad_vertices", "100000 vertices");
    refused(&many.replace("f -3", "f 7"), &["OBJ line 7", "0 values"]);
}

#[test]
fn free_form_surfaces_are_left_out() {
    let mesh = good(&format!(
        "{TRIANGLE}vp 0.5 0.5\ncstype bezier\ndeg 3 3\nsurf 0 1 0 1 1 2 \\\n3 1\nparm u 0 1\nend\nbevel on\nlod 2\n"
    ));
    assert_eq!(mesh.triangles.len(), 1);
    warned(&mesh, "mesh_ignored_lines", "8 lines");
    warned(&mesh, "mesh_ignored_lines", "line 5 (`vp`)");
}

#[test]
fn too_many_triangles_are_refused_early() {
    let limits = Limits {
        max_triangles: 3,
        ..Limits::default()
    };
    let read = |text: &str| obj::read(text.as_bytes(), &[], &limits);
    assert!(read(&format!("{TRIANGLE}f 1 3 2\n")).is_ok());
    // What follows the face that is too many is not looked at.
    let error = read(&format!("{TETRAHEDRON}v broken\n")).unwrap_err();
    assert_eq!(error, MeshError::TooManyTriangles { line: 8, limit: 3 });
    assert!(error.to_string().contains("more than 3 triangles"));
    // A polygon of six corners is four triangles.
    let error = read("v 0 0 0\nf 1 1 1 1 1 1\n").unwrap_err();
    assert_eq!(error, MeshError::TooManyTriangles { line: 2, limit: 3 });
}

#[test]
fn a_mesh_of_slivers_is_refused() {
    let error = refused(
        "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\nf 1 1 2\n",
        &["none of the 2 triangles has an area"],
    );
    assert_eq!(error, MeshError::NoArea { triangles: 2 });
    assert!(matches!(
        read("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nf 1 2 3\n"),
        Err(MeshError::NoArea { .. })
    ));
}

#[test]
fn syntax_errors_name_the_line() {
    let bad = |vertex: &str| format!("v 0 0 0\n{vertex}\nv 0 1 0\nf 1 2 3\n");
    for (text, needles) in [
        (bad("v 0 0"), ["OBJ line 2", "2 values"]),
        (bad("v 1,5 0 0"), ["OBJ line 2", "`1,5` is not a number"]),
        (
            "v 0 0 0\nf 1 one 1\n".to_owned(),
            ["OBJ line 2", "`one` is not a face corner"],
        ),
        (
            "v 0 0 0\nf 1 /1 1\n".to_owned(),
            ["OBJ line 2", "`/1` is not"],
        ),
        (
            "v 0 0 0\nf 1 1.5 1\n".to_owned(),
            ["OBJ line 2", "whole numbers"],
        ),
    ] {
        let error = refused(&text, &needles);
        assert!(matches!(error, MeshError::Syntax { .. }), "{error:?}");
    }
}

#[test]
fn what_cannot_be_read_in_an_mtl_is_named() {
    for (mtl, needles) in [
        (
            "newmtl red\nKd 0.5 0.5\n",
            ["1 lines", "line 2 (`Kd 0.5 0.5`)"],
        ),
        ("newmtl red\nKd\n", ["1 lines", "line 2 (`Kd `)"]),
        ("newmtl red\nkd .1 .2\n", ["1 lines", "line 2 (`kd .1 .2`)"]),
        (
            "newmtl red\nKd red\n",
            ["expected `newmtl name`", "line 2 (`Kd red`)"],
        ),
        ("Kd 1 1 1\nnewmtl red\n", ["1 lines", "line 1"]),
    ] {
        let mesh = read_with(PAINTED, mtl).unwrap();
        assert_eq!(mesh.materials[0].albedo, [DEFAULT_ALBEDO; 3]);
        for needle in needles {
            warned(&mesh, "mesh_material_unreadable", needle);
        }
    }
    let long = "x".repeat(3000);
    let obj = PAINTED.replace("red", &long);
    let mesh = read_with(
        &obj,
        &format!("newmtl\nKd 1 0 0\nnewmtl {long}\nKd 0.5\nnewmtl blue\n"),
    )
    .unwrap();
    assert_eq!(mesh.materials[0].name, long);
    assert_eq!(mesh.materials[0].albedo, [0.5; 3]);
}

#[test]
fn a_look_that_is_not_drawn_is_named() {
    for (statement, code) in [
        ("d 0.05", "mesh_transparency_ignored"),
        ("d -halo 0.5", "mesh_transparency_ignored"),
        ("Tr 0.95", "mesh_transparency_ignored"),
        ("Tf 0.5 1 1", "mesh_transparency_ignored"),
        ("illum 4", "mesh_transparency_ignored"),
        ("illum 3", "mesh_gloss_ignored"),
        ("Ks 0.5 0.5 0.5", "mesh_gloss_ignored"),
        ("Pm 1", "mesh_gloss_ignored"),
        ("Ke 1 1 0", "mesh_emission_ignored"),
        ("map_Kd -s 2 2 2 a.png", "mesh_textures_ignored"),
        ("map_d a.png", "mesh_textures_ignored"),
        ("bump a.png", "mesh_textures_ignored"),
    ] {
        let mtl = format!("newmtl red\nKd 1 0 0\n{statement}\nnewmtl blue\nKd 0 0 1\n");
        let mesh = read_with(PAINTED, &mtl).unwrap();
        assert_eq!(codes(&mesh), [code], "{statement}");
        warned(&mesh, code, "1 materials ");
        warned(&mesh, code, &format!("`red` (`{statement}`)"));
        // A material that no face uses has no look.
        let unused = format!("{mtl}newmtl other\nKe 1 1 1\nd 0\n");
        assert_eq!(read_with(PAINTED, &unused).unwrap().warnings, mesh.warnings);
    }
    for statement in [
        "d 1",
        "d 1.0 # opaque",
        "Tr 0",
        "Tf 1 1 1",
        "illum 1",
        "illum 2",
        "Ks 0 0 0",
        "Ke 0.0 0.0 0.0",
        "Ns 250",
        "Ni 1.45",
        "Ka 1 1 1",
        "Pm 0",
    ] {
        let mtl = format!("newmtl red\nKd 1 0 0\n{statement}\nnewmtl blue\nKd 0 0 1\n");
        assert_eq!(
            read_with(PAINTED, &mtl).unwrap().warnings,
            vec![],
            "{statement}"
        );
    }
}

#[test]
fn colours_are_read_as_programs_write_them() {
    for kd in [
        "Kd .1 \\\n.7 .2",
        "kd .1 .7 .2",
        "KD .1 .7 .2 1.0",
        "Kd .1 .7 .2 # green",
        "\tKd\t.1 .7 .2\0",
    ] {
        for name in ["newmtl red", "NewMtl red", "newmtl red # of the hull"] {
            let mtl = format!("{name}\n{kd}\nnewmtl blue\nKd 0 0 1\n");
            for obj in [
                PAINTED.to_owned(),
                PAINTED.replace("usemtl red", "usemtl red # hull"),
            ] {
                let mesh = read_with(&obj, &mtl).unwrap();
                assert_eq!(mesh.materials[0].albedo, [0.1, 0.7, 0.2], "{mtl:?}");
                assert_eq!(mesh.warnings, vec![], "{mtl:?}");
            }
        }
    }
    // A name with such a sign in it is that name.
    let mtl = "newmtl red # 2\nKd 1 0 0\nnewmtl red\nKd 0 1 0\nnewmtl blue\n";
    let mesh = read_with(&PAINTED.replace("usemtl red", "usemtl red # 2"), mtl).unwrap();
    assert_eq!(mesh.materials[0].albedo, [1.0, 0.0, 0.0]);
}

#[test]
fn several_libraries_are_read_and_the_first_counts() {
    let first: &[u8] = b"newmtl red\nKd 1 0 0\nnewmtl red\nKd 0.9 0 0\n";
    let second: &[u8] = b"newmtl red\nKd 0 1 0\nKe 1 1 1\nnewmtl blue\nKd 0 0 1\n";
    let read = |files: &[&[u8]]| obj::read(PAINTED.as_bytes(), files, &Limits::default()).unwrap();
    let mesh = read(&[first, second]);
    let albedo: Vec<[f32; 3]> = mesh.materials.iter().map(|m| m.albedo).collect();
    assert_eq!(albedo, [[0.9, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(codes(&mesh), ["mesh_material_repeated"]);
    warned(&mesh, "mesh_material_repeated", "`red` on line 1");
    let turned = read(&[second, first]);
    assert_eq!(turned.materials[0].albedo, [0.0, 1.0, 0.0]);
    assert_ne!(turned.id, mesh.id);
    assert_eq!(
        obj::material_libraries(
            b"mtllib a.mtl b.mtl\n# mtllib c.mtl\nmtllibx d\n  mtllib\ttwo words.mtl \r\nmtllib\n"
        ),
        ["a.mtl b.mtl", "two words.mtl"]
    );
}

#[test]
fn different_uploads_have_different_ids() {
    assert_eq!(
        obj::id(TRIANGLE.as_bytes(), &[]),
        format!("blake3:{}", blake3::hash(TRIANGLE.as_bytes()).to_hex())
    );
    assert_eq!(good(TRIANGLE).id, obj::id(TRIANGLE.as_bytes(), &[]));
    let pairs: [(&[u8], &[&[u8]]); 8] = [
        (b"ab", &[]),
        (b"ab", &[b""]),
        (b"a", &[b"b"]),
        (b"a", &[b"", b"b"]),
        (b"a", &[b"b", b""]),
        (b"", &[b"ab"]),
        (b"ba", &[b""]),
        // What the hash of a pair takes in, sent as one file.
        (b"\x01\0\0\0\0\0\0\0a\x01\0\0\0\0\0\0\0b", &[]),
    ];
    let ids: std::collections::BTreeSet<String> =
        pairs.iter().map(|(o, m)| obj::id(o, m)).collect();
    assert_eq!(ids.len(), pairs.len());
}

#[test]
fn the_same_bytes_give_the_same_mesh() {
    let text = std::fs::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/meshes/torus_knot.obj"
    ))
    .unwrap();
    let read = || obj::read(&text, &[], &Limits::default()).unwrap();
    let (first, second) = (read(), read());
    assert_eq!(first.triangles, second.triangles);
    assert_eq!(first.hierarchy, second.hierarchy);
    assert_eq!(first.info(), second.info());
}

#[test]
fn damaged_files_give_a_sound_mesh_or_an_error() {
    const TOKENS: [&str; 24] = [
        "v",
        "vn",
        "vt",
        "f",
        "l",
        "usemtl",
        "mtllib",
        "newmtl",
        "Kd",
        "0",
        "1",
        "-1",
        "3",
        "1e9",
        "-1e-40",
        "nan",
        "inf",
        "1//1",
        "2/7/2",
        "-3//-1",
        "\\",
        "#",
        "\u{feff}",
        "9223372036854775807",
    ];
    let mut state = 42_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let start = format!("{TETRAHEDRON}vn 0 0 1\nf 1//1 2//1 3//1 4//1\nusemtl red\nf -1 -2 -3\n");
    let (mut read, mut refused) = (0, 0);
    for _ in 0..4_000 {
        let mut damaged = [start.clone(), "newmtl red\nKd 1 0 0\nKa 1\n".to_owned()];
        for text in &mut damaged {
            for _ in 0..random(4) {
                let mut words: Vec<&str> = text.split_inclusive([' ', '\n']).collect();
                let at = random(words.len());
                match random(4) {
                    0 => words.insert(at, " "),
                    1 => drop(words.remove(at)),
                    2 => words.insert(at, "\n"),
                    _ => words.insert(at, TOKENS[random(TOKENS.len())]),
                }
                *text = words.concat();
            }
        }
        match read_with(&damaged[0], &damaged[1]) {
            Err(error) => {
                refused += 1;
                assert!(!error.to_string().is_empty());
                assert!(
                    !matches!(error, MeshError::Unreadable { .. }),
                    "{error} {damaged:?}"
                );
            }
            Ok(mesh) => {
                read += 1;
                assert!(!mesh.triangles.is_empty());
                assert_eq!(mesh.hierarchy.len(), 2 * mesh.triangles.len() - 1);
                for triangle in &mesh.triangles {
                    assert!(
                        triangle.positions_m.iter().all(|p| p.is_finite()),
                        "{damaged:?}"
                    );
                    assert!(
                        triangle.normals.iter().all(|n| n.is_normalized()),
                        "{damaged:?}"
                    );
                    assert!((triangle.material as usize) < mesh.materials.len());
                }
            }
        }
    }
    assert!(read > 500 && refused > 500, "{read} {refused}");
}
