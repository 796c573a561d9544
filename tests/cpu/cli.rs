//! The command line: what may be typed, frame ranges, scene files with meshes, exit codes, health.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Command as Process, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use caustica::cli::args::Command;
use caustica::cli::frames::{FramePattern, FrameSet};
use caustica::cli::health::ServiceUrl;
use caustica::cli::scene_file::{is_plain_name, load, material_library};
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::cli::{Cli, CliError, animate, files, plan, selfcheck, summary};
use caustica::config::{AdapterPolicy, Limits};
use caustica::gpu::GpuError;
use caustica::plan::{Plan, PlannedPass, PlannedSlot};
use caustica::render::{RenderError, SelfCheck, SelfCheckItem};
use caustica::scene::overrides::fields;
use caustica::scene::{ImageFormat, Issue, SceneError};
use caustica::stats::AbsentPass;
use clap::{CommandFactory, Parser};

/// A directory of its own for a test, gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path =
            std::env::temp_dir().join(format!("caustica-cli-{}-{number}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn parsed(words: &[&str]) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(std::iter::once("caustica").chain(words.iter().copied()))
}

fn program(words: &[&str]) -> Output {
    Process::new(env!("CARGO_BIN_EXE_caustica"))
        .args(words)
        .output()
        .unwrap()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n";

/// A small, valid scene with one object.
fn scene_text(mesh: &str) -> String {
    format!(
        r#"{{ "floor": {{ "depth_m": 2, "size_m": [4, 4] }}, "objects": [{{ "mesh": "{mesh}" }}],
        "output": {{ "kind": "irradiance_map", "receiver": "floor", "width": 4, "height": 4 }} }}"#
    )
}

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
fn the_definition_is_consistent() {
    Cli::command().debug_assert();
}

#[test]
fn every_field_has_a_flag_in_every_command_that_reads_a_scene() {
    for name in ["render", "animate", "plan"] {
        let mut root = Cli::command();
        let command = root.find_subcommand_mut(name).unwrap();
        let help = command.render_long_help().to_string();
        for field in fields() {
            assert!(
                help.contains(&format!("--{} <VALUE", field.flag())),
                "{name} --{}",
                field.flag()
            );
            assert!(
                help.contains(&field.help[..20.min(field.help.len())]),
                "{name} --{}",
                field.flag()
            );
        }
    }
    for name in ["serve", "health", "selfcheck"] {
        let mut root = Cli::command();
        let help = root
            .find_subcommand_mut(name)
            .unwrap()
            .render_long_help()
            .to_string();
        assert!(!help.contains("--water-cells"), "{name}");
    }
}

#[test]
fn flags_become_overrides() {
    let words = [
        "render",
        "s.json",
        "-o",
        "x.exr",
        "--water-cells",
        "512",
        "--exposure-ev",
        "-1",
        "--layers",
        "radiance,depth",
        "--min-m",
        "-1,-2",
        "--adapter",
        "software",
        "--max-pixels",
        "77",
    ];
    let cli = parsed(&words).unwrap();
    assert_eq!(cli.render.adapter, AdapterPolicy::Software);
    assert_eq!(cli.limits.max_pixels, 77);
    let Command::Render(args) = cli.command else {
        panic!("render was typed");
    };
    assert_eq!(args.output, Path::new("x.exr"));
    let mut given = args.scene.overrides.0;
    given.sort();
    let owned = |(pointer, text): (&str, &str)| (pointer.to_owned(), text.to_owned());
    let expected = [
        ("/output/exposure_ev", "-1"),
        ("/output/layers", "radiance,depth"),
        ("/output/min_m", "-1,-2"),
        ("/quality/water_cells", "512"),
    ];
    assert_eq!(given, expected.map(owned));
}

#[test]
fn command_lines_that_make_no_sense_are_refused() {
    let table: &[&[&str]] = &[
        &[],
        &["paint"],
        &["render"],
        &["render", "s.json"],
        &["render", "s.json", "-o"],
        &["render", "s.json", "-o", "x.png", "--water-depth", "3"],
        &[
            "render", "s.json", "-o", "x.png", "--width", "3", "--width", "4",
        ],
        &["animate", "s.json", "-o", "x.%04d.png"],
        &["animate", "s.json", "-o", "x.png", "--frames", "0-3"],
        &["animate", "s.json", "-o", "x.%d.png", "--frames", "3-0"],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "0",
        ],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "nan",
        ],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "-30",
        ],
        &["health", "--url", "https://localhost:8080"],
        &["health", "--timeout-s", "0"],
        &["selfcheck", "--adapter", "quantum"],
        &["serve", "--listen", "nowhere"],
    ];
    for words in table {
        let error = parsed(words).map(|_| ()).expect_err(&format!("{words:?}"));
        assert_eq!(error.exit_code(), 2, "{words:?}");
    }
}

#[test]
fn frame_ranges_are_read() {
    let table: &[(&str, &[u32])] = &[
        ("30", &[30]),
        ("0-3", &[0, 1, 2, 3]),
        ("1-20:4", &[1, 5, 9, 13, 17]),
        ("1-20:4,30", &[1, 5, 9, 13, 17, 30]),
        ("5,1-3,2", &[1, 2, 3, 5]),
        (" 7 , 3-3 ", &[3, 7]),
        ("4294967295", &[u32::MAX]),
        ("4294967290-4294967295:9", &[4_294_967_290]),
    ];
    for (text, frames) in table {
        assert_eq!(
            text.parse::<FrameSet>().unwrap().frames(),
            *frames,
            "{text}"
        );
    }
}

#[test]
fn bad_frame_ranges_are_refused_with_what_is_accepted() {
    for text in [
        "",
        ",",
        "1,",
        "a",
        "-1",
        "1-",
        "-",
        "1-2-3",
        "3-1",
        "1-5:0",
        "1-5:",
        "1:2",
        "+3",
        "1.5",
        "4294967296",
        "0x10",
        "0-4000000000",
    ] {
        let error = text.parse::<FrameSet>().expect_err(text);
        assert!(error.to_string().contains("accepted"), "{text}: {error}");
    }
}

#[test]
fn patterns_hold_the_number_once() {
    let table = [
        ("frame.%04d.png", 7, "frame.0007.png"),
        ("frame.%04d.png", 123_456, "frame.123456.png"),
        ("out/%d.exr", 0, "out/0.exr"),
        ("out dir/a%06db.exr", 12, "out dir/a000012b.exr"),
    ];
    for (pattern, frame, path) in table {
        let pattern: FramePattern = pattern.parse().unwrap();
        assert_eq!(pattern.path(frame), Path::new(path));
    }
    for text in [
        "",
        "frame.png",
        "%d%d.png",
        "%04d/%04d.png",
        "%4d.png",
        "%00d.png",
        "%099d.png",
        "%s.png",
        "%",
        "%0",
        "%04x.png",
        "%03d/frame.png",
    ] {
        let error = text.parse::<FramePattern>().expect_err(text);
        assert!(
            error.to_string().contains("frame.%04d.png"),
            "{text}: {error}"
        );
    }
}

#[test]
fn frames_lie_one_period_apart() {
    assert_eq!(animate::time_of(2.0, 0, 30.0), 2.0);
    assert_eq!(animate::time_of(2.0, 45, 30.0), 3.5);
    assert_eq!(animate::time_of(-1.0, 1, 0.5), 1.0);
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

#[test]
fn a_material_library_is_read_only_beside_its_mesh() {
    let folder = Folder::new();
    let limits = Limits::default();
    let hash = |mesh: &str| {
        let scene = folder.write("scene.json", &scene_text(mesh));
        let loaded = load(&scene_args(&scene, &[]), None, &limits).unwrap();
        (loaded.resolved.hash(), loaded.notes.join("\n"))
    };
    folder.write("secret.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("m/near.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("m/near.obj", &format!("mtllib near.mtl\n{TRIANGLE}"));
    folder.write("m/far.obj", &format!("mtllib ../secret.mtl\n{TRIANGLE}"));
    folder.write("m/gone.obj", &format!("mtllib gone.mtl\n{TRIANGLE}"));
    let (near, _) = hash("m/near.obj");
    assert!(hash("m/far.obj").1.contains("`../secret.mtl` is not read"));
    assert!(hash("m/gone.obj").1.contains("`gone.mtl` cannot be read"));
    folder.write("m/near.mtl", "newmtl red\nKd 0 1 0\n");
    assert_ne!(
        hash("m/near.obj").0,
        near,
        "the material is part of the mesh"
    );
    let far = hash("m/far.obj").0;
    folder.write("secret.mtl", "newmtl red\nKd 0 1 0\n");
    assert_eq!(hash("m/far.obj").0, far);
}

#[test]
fn material_libraries_are_found_and_judged_by_name() {
    let table: &[(&str, Option<&str>)] = &[
        ("v 0 0 0\nmtllib a.mtl\nmtllib b.mtl", Some("a.mtl")),
        ("  mtllib\ttwo words.mtl \r\n", Some("two words.mtl")),
        ("# mtllib a.mtl\nmtllibx a.mtl\n", None),
        ("", None),
    ];
    for (obj, name) in table {
        assert_eq!(material_library(obj.as_bytes()).as_deref(), *name, "{obj}");
    }
    for name in ["a.mtl", "two words.mtl", ".hidden"] {
        assert!(is_plain_name(name), "{name}");
    }
    for name in [
        "", ".", "..", "../a", "a/b", "/a", "a\\b", "C:a", "a/", "./a", "a\0b",
    ] {
        assert!(!is_plain_name(name), "{name}");
    }
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
    assert_eq!(error.exit_code(), 1);
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

#[test]
fn exit_codes_say_whether_a_retry_is_worth_it() {
    let scene = || SceneError::from(Issue::invalid("/a", "b", "c"));
    let over = RenderError::OverBudget {
        needed_bytes: 2,
        budget_bytes: 1,
    };
    let gpu = |error: GpuError| CliError::Render(RenderError::Gpu(error));
    let not_found = || std::io::Error::from(std::io::ErrorKind::NotFound);
    let table = [
        (CliError::Render(RenderError::Scene(scene())), 2),
        (CliError::Render(over), 2),
        (CliError::Usage(String::new()), 2),
        (gpu(GpuError::Validation(String::new())), 2),
        (CliError::read(Path::new("s"), not_found()), 2),
        (
            CliError::read(Path::new("s"), std::io::Error::other("disk")),
            1,
        ),
        (CliError::write(Path::new("s"), not_found()), 1),
        (CliError::Render(RenderError::Cancelled), 1),
        (gpu(GpuError::DeviceLost(String::new())), 1),
        (gpu(GpuError::OutOfMemory(String::new())), 1),
        (gpu(GpuError::Timeout(3)), 1),
        (CliError::Gpu(GpuError::NoAdapter(String::new())), 1),
    ];
    for (error, code) in table {
        assert_eq!(error.exit_code(), code, "{error}");
    }
}

#[test]
fn the_program_refuses_a_bad_scene_with_its_places() {
    let folder = Folder::new();
    let text = r#"{ "water": { "ior": 9 }, "floor": { "depth_m": -1, "size_m": [4, 4] } }"#;
    let scene = folder.write("scene.json", text);
    let scene = scene.to_str().unwrap();
    let picture = folder.0.join("x.png");
    let out = program(&["render", scene, "-o", picture.to_str().unwrap()]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    for place in [
        "scene.json",
        "/water/ior: 9",
        "/floor/depth_m: -1",
        "/camera: missing",
        "accepted: ",
    ] {
        assert!(said.contains(place), "{place} in {said}");
    }
    assert_eq!(folder.names(), ["scene.json"]);

    for words in [
        ["render", "no such scene.json", "-o", "x.png"],
        ["render", scene, "-o", "x.jpg"],
        ["render", scene, "-o", "no such folder/x.png"],
    ] {
        assert_eq!(program(&words).status.code(), Some(2), "{words:?}");
    }
}

#[test]
fn an_animation_beyond_the_range_of_time_is_refused_before_it_starts() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let text = scene_text("a.obj").replacen('{', "{ \"time_s\": 999999999999.5,", 1);
    let scene = folder.write("scene.json", &text);
    let pattern = folder.0.join("f.%04d.exr");
    let words = [
        "animate",
        scene.to_str().unwrap(),
        "--frames",
        "0-59",
        "-o",
        pattern.to_str().unwrap(),
    ];
    let out = program(&words);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("/time_s"), "{said}");
}

#[test]
fn an_animation_whose_files_are_there_needs_no_gpu() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a.obj"));
    for frame in 3..=5 {
        folder.write(&format!("f.{frame}.exr"), "whole");
    }
    let pattern = folder.0.join("f.%d.exr");
    let pattern = pattern.to_str().unwrap();
    let scene = scene.to_str().unwrap();
    let out = program(&[
        "animate",
        scene,
        "--frames",
        "3-5",
        "-o",
        pattern,
        "--skip-existing",
    ]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("0 frames rendered, 3 were there"), "{said}");
}

/// A service that gives one answer, and what it was asked.
fn answering(answer: &'static str) -> (String, std::thread::JoinHandle<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("http://{}", listener.local_addr().unwrap());
    let thread = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut asked = Vec::new();
        let mut chunk = [0; 1024];
        while !asked.ends_with(b"\r\n\r\n") {
            let count = stream.read(&mut chunk).unwrap();
            assert!(count > 0, "the request ends with an empty line");
            asked.extend_from_slice(&chunk[..count]);
        }
        stream.write_all(answer.as_bytes()).unwrap();
        String::from_utf8(asked).unwrap()
    });
    (url, thread)
}

#[test]
fn health_is_what_readyz_says() {
    let (url, thread) =
        answering("HTTP/1.1 200 OK\r\nContent-Length: 2\r\nConnection: close\r\n\r\nok");
    let out = program(&["health", "--url", &format!("{url}/under/")]);
    assert_eq!(
        out.status.code(),
        Some(0),
        "{:?}",
        String::from_utf8(out.stderr)
    );
    let asked = thread.join().unwrap();
    assert!(
        asked.starts_with("GET /under/readyz HTTP/1.1\r\nHost: 127.0.0.1:"),
        "{asked}"
    );

    for (answer, reason) in [
        (
            "HTTP/1.1 503 Service Unavailable\r\n\r\nthe GPU is being\nrecovered",
            "HTTP 503 the GPU is being recovered",
        ),
        ("HTTP/1.1 404 Not Found\r\n\r\n", "HTTP 404"),
        ("SSH-2.0-OpenSSH_9.2\r\n", "not HTTP"),
        ("", "not HTTP"),
    ] {
        let (url, thread) = answering(answer);
        let out = program(&["health", "--url", &url]);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(1), "{said}");
        assert!(said.contains(reason), "{reason} in {said}");
        thread.join().unwrap();
    }
}

#[test]
fn health_does_not_wait_for_ever() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let url = format!("http://{address}");
    let out = program(&["health", "--url", &url, "--timeout-s", "1"]);
    assert_eq!(out.status.code(), Some(1));
    assert!(
        String::from_utf8(out.stderr)
            .unwrap()
            .contains("no answer within 1s")
    );
    drop(listener);
    assert_eq!(program(&["health", "--url", &url]).status.code(), Some(1));
}

#[test]
fn service_urls_are_plain_http() {
    let table = [
        ("http://127.0.0.1:8080", "127.0.0.1:8080", ""),
        ("http://caustica", "caustica:80", ""),
        ("http://[::1]:8080/", "[::1]:8080", ""),
        ("http://[::1]", "[::1]:80", ""),
        ("http://host:81/a/b/", "host:81", "/a/b"),
    ];
    for (text, authority, prefix) in table {
        let url: ServiceUrl = text.parse().unwrap();
        assert_eq!(
            (url.authority.as_str(), url.prefix.as_str()),
            (authority, prefix),
            "{text}"
        );
    }
    for text in [
        "",
        "localhost",
        "https://x",
        "http://",
        "http://:80",
        "http://x:port",
        "http://x:99999",
        "http://u@x",
        "http://x/?q",
        "http://x/a b",
        "http://x/\r\nHost: y",
    ] {
        assert!(text.parse::<ServiceUrl>().is_err(), "{text}");
    }
}

#[test]
fn a_selfcheck_that_checks_nothing_has_not_passed() {
    let item = |passed| SelfCheckItem {
        name: "fresnel".to_owned(),
        error: 1e-7,
        tolerance: 1e-6,
        passed,
    };
    let check = |passed, checks| SelfCheck { passed, checks };
    assert!(selfcheck::verdict(&check(true, vec![item(true)])).is_ok());
    for bad in [
        check(true, vec![]),
        check(false, vec![item(true)]),
        check(true, vec![item(true), item(false)]),
    ] {
        assert_eq!(selfcheck::verdict(&bad).unwrap_err().exit_code(), 1);
    }
    let text = selfcheck::in_words(&check(false, vec![item(true), item(false)]));
    assert_eq!(
        text,
        "ok      fresnel  error 1.0e-7 of 1.0e-6\nFAILED  fresnel  error 1.0e-7 of 1.0e-6\n"
    );
}

#[test]
fn a_plan_reads_well() {
    let plan = Plan {
        passes: vec![PlannedPass {
            name: "surface".to_owned(),
            reason: "beams read it".to_owned(),
            runs: 2,
        }],
        absent: vec![AbsentPass {
            name: "level_map".to_owned(),
            reason: "no objects".to_owned(),
        }],
        slots: vec![PlannedSlot {
            name: "water".to_owned(),
            bytes: 3 << 20,
            holds: "height, m".to_owned(),
        }],
        peak_bytes: 1536,
        warnings: Vec::new(),
    };
    assert_eq!(
        plan::in_words(&plan),
        "Passes\n  surface  2 ×  beams read it\n\n\
         Not needed\n  level_map  no objects\n\n\
         Memory\n  water  3.0 MiB  height, m\n\n\
         Peak: 1.5 KiB\n"
    );
}

#[test]
fn sizes_have_the_unit_that_suits_them() {
    let table = [
        (0, "0 B"),
        (1023, "1023 B"),
        (1024, "1.0 KiB"),
        (5 << 30, "5.0 GiB"),
    ];
    for (count, text) in table {
        assert_eq!(summary::bytes(count), text);
    }
}
