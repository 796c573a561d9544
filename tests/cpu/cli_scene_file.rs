//! Scene files: meshes and material libraries beside them, fields replaced by flags, and the files that are written.

use std::fs;
use std::path::Path;

use caustica::cli::scene_file::load;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::cli::{CliError, files};
use caustica::config::Limits;
use caustica::scene::{ImageFormat, Issue};

use super::field_support::npy;
use super::folder::{Folder, TRIANGLE, scene_text};

fn scene_args(path: &Path, overrides: &[(&str, &str)]) -> SceneArgs {
    let owned = |(pointer, text): &(&str, &str)| ((*pointer).to_owned(), (*text).to_owned());
    SceneArgs {
        scene: path.to_owned(),
        overrides: SceneOverrides(overrides.iter().map(owned).collect()),
    }
}

fn issues(error: CliError) -> Vec<Issue> {
    match error {
        CliError::Scene { error, .. } => error.issues,
        other => panic!("not a scene error: {other}"),
    }
}

#[test]
fn a_scene_file_is_read_with_its_meshes() {
    let folder = Folder::new();
    folder.write("meshes/a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("meshes/a.obj"));
    let limits = Limits::default();
    let loaded = load(&scene_args(&scene, &[]), None, &limits).unwrap();
    let id = loaded.resolved.scene.objects[0].mesh.clone();
    assert!(id.starts_with("blake3:"), "{id}");
    assert_eq!(loaded.resolved.meshes[0].id, id);

    // The path is not part of the scene's hash, the content is.
    folder.write("elsewhere.obj", TRIANGLE);
    let moved = folder.write("moved.json", &scene_text("elsewhere.obj"));
    let moved = load(&scene_args(&moved, &[]), None, &limits).unwrap();
    assert_eq!(moved.resolved.hash(), loaded.resolved.hash());
    folder.write("elsewhere.obj", &TRIANGLE.replace("v 1 0 0", "v 2 0 0"));
    let moved = folder.write("moved.json", &scene_text("elsewhere.obj"));
    let changed = load(&scene_args(&moved, &[]), None, &limits).unwrap();
    assert_ne!(changed.resolved.hash(), loaded.resolved.hash());
}

/// A scene whose water is given by these files.
fn field_scene(folder: &Folder, frames: &[&str]) -> std::path::PathBuf {
    let scene = serde_json::json!({
        "water": { "waves": [{ "kind": "height_field", "frames": frames, "sample_m": 0.1, "frames_per_s": 10 }] },
        "floor": { "depth_m": 1, "size_m": [2, 2] },
        "output": { "kind": "irradiance_map", "receiver": "floor" }
    });
    folder.write("s/scene.json", &scene.to_string())
}

#[test]
fn a_scene_file_is_read_with_its_height_fields() {
    let folder = Folder::new();
    let scene = field_scene(&folder, &["a.npy", "../b.npy", "a.npy"]);
    let numbers: Vec<f64> = (0..64).map(|i| 1e-3 * f64::from(i)).collect();
    let (a, b) = (npy(&[8, 8], &numbers), npy(&[8, 8], &[0.5; 64]));
    fs::write(scene.with_file_name("a.npy"), &a).unwrap();
    fs::write(scene.parent().unwrap().with_file_name("b.npy"), &b).unwrap();
    let limits = Limits::default();
    let loaded = load(&scene_args(&scene, &[]), None, &limits).unwrap();
    let caustica::scene::Wave::HeightField(field) = &loaded.resolved.scene.water.waves[0] else {
        panic!("no height field")
    };
    let ids = [&a, &b, &a].map(|bytes| format!("blake3:{}", blake3::hash(bytes).to_hex()));
    assert_eq!(field.frames, ids);
    assert_eq!(loaded.resolved.fields[&0].count(), 3);
}

#[test]
fn files_of_height_fields_that_cannot_be_read_are_errors_at_their_place() {
    let folder = Folder::new();
    let scene = field_scene(&folder, &["none.npy", "", "folder", "text.npy", "none.npy"]);
    fs::create_dir(scene.with_file_name("folder")).unwrap();
    fs::write(scene.with_file_name("text.npy"), "1 2 3").unwrap();
    let found = issues(load(&scene_args(&scene, &[]), None, &Limits::default()).unwrap_err());
    for (frame, words) in [
        (0, "`none.npy` cannot be used"),
        (1, "empty"),
        (2, "directory"),
        (3, "neither NPY"),
        (4, "`none.npy`"),
    ] {
        let pointer = format!("/water/waves/0/frames/{frame}");
        let is_there = found.iter().any(|issue| {
            issue.pointer == pointer && issue.detail.contains(words) && !issue.accepted.is_empty()
        });
        assert!(is_there, "{frame}: {found:?}");
    }
}

/// The reflectance of the mesh of a scene in a folder, and the notes.
fn albedo_of(folder: &Folder, mesh: &str) -> ([f32; 3], String) {
    let scene = folder.write("s/scene.json", &scene_text(mesh));
    let loaded = load(&scene_args(&scene, &[]), None, &Limits::default()).unwrap();
    let albedo = loaded.resolved.meshes[0].materials[0].albedo;
    (albedo, loaded.notes.join("\n"))
}

#[test]
fn material_libraries_are_read_inside_the_scenes_folder() {
    let folder = Folder::new();
    for (name, kd) in [
        ("s/m/near.mtl", "0.1"),
        ("s/m/sub/deep.mtl", "0.2"),
        ("s/shared/red.mtl", "0.3"),
        ("s/m/two words.mtl", "0.4"),
        ("s/m/blue.mtl", "0.5"),
        ("secret.mtl", "1"),
        ("s/m/passwd", "0.6"),
    ] {
        let other = if name.ends_with("blue.mtl") {
            "blue"
        } else {
            "red"
        };
        folder.write(name, &format!("newmtl {other}\nKd {kd} 0 0\n"));
    }
    for (library, red, note) in [
        ("near.mtl", 0.1, ""),
        ("./near.mtl", 0.1, ""),
        (".\\near.mtl", 0.1, ""),
        ("sub/deep.mtl", 0.2, ""),
        ("sub\\deep.mtl", 0.2, ""),
        ("../shared/red.mtl", 0.3, ""),
        ("sub/../../shared/./red.mtl", 0.3, ""),
        ("two words.mtl", 0.4, ""),
        ("blue.mtl near.mtl", 0.1, ""),
        ("blue.mtl two words.mtl", 0.4, ""),
        ("blue.mtl\nmtllib near.mtl", 0.1, ""),
        (
            "near.mtl\nmtllib ./near.mtl\nmtllib two words.mtl",
            0.1,
            "`red` on line 1",
        ),
        (
            "C:\\Users\\someone\\near.mtl",
            0.1,
            "`near.mtl` beside the OBJ file was read instead",
        ),
        (
            "D:/near.mtl",
            0.1,
            "`near.mtl` beside the OBJ file was read instead",
        ),
        (
            "../../near.mtl",
            0.1,
            "`near.mtl` beside the OBJ file was read instead",
        ),
        (
            "/etc/passwd",
            0.6,
            "`passwd` beside the OBJ file was read instead",
        ),
        (
            "../../secret.mtl",
            0.8,
            "`../../secret.mtl` cannot be read as",
        ),
        ("gone.mtl", 0.8, "`gone.mtl` cannot be read as"),
        ("..", 0.8, "cannot be read as"),
    ] {
        folder.write("s/m/mesh.obj", &format!("mtllib {library}\n{TRIANGLE}"));
        let (albedo, notes) = albedo_of(&folder, "m/mesh.obj");
        assert!(
            (albedo[0] - red).abs() < 1e-6,
            "{library}: {albedo:?} {notes}"
        );
        assert!(notes.contains(note), "{library}: {notes}");
        let is_noted = notes.contains("material library") || notes.contains("several MTL");
        assert_eq!(is_noted, !note.is_empty(), "{library}: {notes}");
    }
    // An absolute path that leads inside is inside, and links to the folder change nothing.
    let inside = folder.0.join("s/m/near.mtl");
    folder.write(
        "s/m/mesh.obj",
        &format!("mtllib {}\n{TRIANGLE}", inside.display()),
    );
    let (albedo, notes) = albedo_of(&folder, "m/mesh.obj");
    assert!(
        (albedo[0] - 0.1).abs() < 1e-6 && !notes.contains("material library"),
        "{notes}"
    );
    #[cfg(unix)]
    {
        folder.write("models/boat.mtl", "newmtl red\nKd 0.9 0 0\n");
        folder.write("models/boat.obj", &format!("mtllib boat.mtl\n{TRIANGLE}"));
        folder.write(
            "deep/scenes/scene.json",
            &scene_text("../../models/boat.obj"),
        );
        std::os::unix::fs::symlink("deep/scenes", folder.0.join("link")).unwrap();
        let args = scene_args(&folder.0.join("link/scene.json"), &[]);
        let loaded = load(&args, None, &Limits::default()).unwrap();
        let albedo = loaded.resolved.meshes[0].materials[0].albedo;
        assert!((albedo[0] - 0.9).abs() < 1e-6, "{:?}", loaded.notes);
    }
    // A mesh outside of the scene's folder has its own folder.
    folder.write("else/out.mtl", "newmtl red\nKd 0.7 0 0\n");
    for (library, red) in [("out.mtl", 0.7), ("../secret.mtl", 0.8)] {
        folder.write("else/out.obj", &format!("mtllib {library}\n{TRIANGLE}"));
        assert!(
            (albedo_of(&folder, "../else/out.obj").0[0] - red).abs() < 1e-6,
            "{library}"
        );
    }
}

#[test]
fn a_material_library_is_part_of_the_mesh() {
    let folder = Folder::new();
    folder.write("m/near.obj", &format!("mtllib near.mtl\n{TRIANGLE}"));
    let scene = folder.write("scene.json", &scene_text("m/near.obj"));
    let hash = |kd: &str| {
        folder.write("m/near.mtl", &format!("newmtl red\nKd {kd} 0 0\n"));
        load(&scene_args(&scene, &[]), None, &Limits::default())
            .unwrap()
            .resolved
            .hash()
    };
    assert_ne!(hash("0.1"), hash("0.2"));
    assert_eq!(hash("0.1"), hash("0.1"));
}

#[test]
fn unreadable_meshes_are_findings_beside_the_others() {
    let folder = Folder::new();
    folder.write("empty.obj", "");
    let text = r#"{ "water": { "ior": 9 }, "floor": { "depth_m": 2, "size_m": [4, 4] },
        "objects": [{ "mesh": "gone.obj" }, { "mesh": "empty.obj" }, { "mesh": "" }],
        "output": { "kind": "irradiance_map", "receiver": "floor" } }"#;
    let scene = folder.write("scene.json", text);
    let found = issues(load(&scene_args(&scene, &[]), None, &Limits::default()).unwrap_err());
    let pointers: Vec<&str> = found.iter().map(|issue| issue.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/water/ior",
            "/objects/2/mesh",
            "/objects/0/mesh",
            "/objects/1/mesh"
        ]
    );
    assert!(found[2].accepted.contains("relative to the scene file"));

    let scene = folder.write("id.json", &scene_text("blake3:00"));
    let found = issues(load(&scene_args(&scene, &[]), None, &Limits::default()).unwrap_err());
    assert_eq!(found[0].pointer, "/objects/0/mesh");
}

#[test]
fn overrides_are_judged_like_the_scene() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a.obj"));
    let limits = Limits::default();
    let good = load(
        &scene_args(&scene, &[("/output/width", "8")]),
        None,
        &limits,
    )
    .unwrap();
    assert_eq!(
        serde_json::to_value(&good.resolved.scene).unwrap()["output"]["width"],
        8
    );
    for (pointer, text) in [
        ("/output/width", "0"),
        ("/output/width", "wide"),
        ("/output/layers", "depth"),
        ("/quality/water_cells", "1"),
        ("/output/format", "jpg"),
    ] {
        let error = load(&scene_args(&scene, &[(pointer, text)]), None, &limits).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert_eq!(issues(error)[0].pointer, pointer);
    }
}

#[test]
fn the_name_of_the_file_decides_the_format() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a.obj"));
    let limits = Limits::default();
    let format = |asked: &[(&str, &str)], name: &str| {
        let format = files::format_of(Path::new(name))?;
        let loaded = load(&scene_args(&scene, asked), Some(format), &limits)?;
        Ok::<_, CliError>(loaded.resolved.scene.output.encoding().format)
    };
    assert_eq!(format(&[], "x.png").unwrap(), ImageFormat::Png);
    assert_eq!(format(&[], "x.tar.EXR").unwrap(), ImageFormat::Exr);
    assert_eq!(
        format(&[("/output/format", "png")], "x.png").unwrap(),
        ImageFormat::Png
    );
    let error = format(&[("/output/format", "exr")], "x.png").unwrap_err();
    assert!(matches!(error, CliError::Usage(_)), "{error}");
    for name in ["x", "x.jpg", ".png", "png", "x.png.bak"] {
        let error = files::format_of(Path::new(name)).unwrap_err();
        assert!(error.to_string().contains(".png or .exr"), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn files_are_written_whole_and_leave_nothing_beside_them() {
    let folder = Folder::new();
    let path = folder.write("x.png", "old");
    files::write_whole(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(folder.names(), ["x.png"]);

    fs::create_dir(folder.0.join("taken.png")).unwrap();
    let error = files::write_whole(&folder.0.join("taken.png"), b"new").unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert_eq!(
        folder.names(),
        ["taken.png", "x.png"],
        "no half file is left"
    );

    assert_eq!(
        files::check_place(&folder.0.join("taken.png"))
            .unwrap_err()
            .exit_code(),
        2
    );
    assert_eq!(
        files::check_place(&folder.0.join("no/x.png"))
            .unwrap_err()
            .exit_code(),
        2
    );
    files::check_place(&folder.0.join("y.png")).unwrap();
    files::check_place(Path::new("y.png")).unwrap();
}
