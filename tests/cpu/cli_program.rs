//! The program itself: exit codes, messages on stderr, and `health` of a foreign service.

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command as Process, Output};

use caustica::cli::CliError;
use caustica::cli::animate::time_of;
use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::Limits;
use caustica::frame::{Frame, FrameKind, Layer};
use caustica::gpu::GpuError;
use caustica::image::{Metadata, encode};
use caustica::render::RenderError;
use caustica::scene::{ImageFormat, Issue, LayerName, SceneError};
use caustica::stats::Stats;

use super::folder::{Folder, TRIANGLE, scene_text};

fn program(words: &[&str]) -> Output {
    Process::new(env!("CARGO_BIN_EXE_caustica"))
        .args(words)
        .output()
        .unwrap()
}

#[test]
fn exit_codes_say_whether_a_retry_is_worth_it() {
    let scene = || SceneError::from(Issue::invalid("/a", "b", "c"));
    let over = RenderError::OverBudget {
        what: "the frame".to_owned(),
        needed_bytes: 2,
        budget_bytes: 1,
    };
    let gpu = |error: GpuError| CliError::Render(RenderError::Gpu(error));
    let written = |kind: ErrorKind| CliError::write(Path::new("s"), kind.into());
    let not_found = || std::io::Error::from(ErrorKind::NotFound);
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
        (
            CliError::read(Path::new("s"), ErrorKind::PermissionDenied.into()),
            2,
        ),
        (written(ErrorKind::NotFound), 2),
        (written(ErrorKind::PermissionDenied), 2),
        (written(ErrorKind::ReadOnlyFilesystem), 2),
        (written(ErrorKind::NotADirectory), 2),
        (written(ErrorKind::IsADirectory), 2),
        (written(ErrorKind::InvalidFilename), 2),
        (written(ErrorKind::StorageFull), 1),
        (written(ErrorKind::QuotaExceeded), 1),
        (written(ErrorKind::Interrupted), 1),
        (written(ErrorKind::Other), 1),
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
fn a_plan_prints_notes_of_meshes_without_their_control_characters() {
    let folder = Folder::new();
    // The mesh names a material, and there is no MTL.
    folder.write("a\u{1b}b.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a\\u001bb.obj"));
    let out = program(&["plan", scene.to_str().unwrap()]);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.starts_with("note: "), "{said}");
    assert!(said.contains("a\u{fffd}b.obj"), "{said}");
    assert!(!said.contains('\u{1b}'), "{said}");
}

#[test]
fn files_that_would_overwrite_each_other_are_refused_before_rendering() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let text = scene_text("a.obj");
    let scene = folder.write("scene.1.png", &text);
    let scene = scene.to_str().unwrap();
    let path = |name: &str| folder.0.join(name).to_str().unwrap().to_owned();
    let (picture, same, frames) = (path("x.png"), path("./x.png"), path("scene.%d.png"));
    let table: [(&[&str], &str); 4] = [
        (
            &["render", scene, "-o", &picture, "--stats", &same],
            "--output and --stats both lead to",
        ),
        (
            &["render", scene, "-o", scene],
            "--output would overwrite the scene file",
        ),
        (
            &["render", scene, "-o", &picture, "--stats", scene],
            "--stats would overwrite the scene file",
        ),
        (
            &["animate", scene, "--frames", "0-3", "-o", &frames],
            "a frame would overwrite the scene file",
        ),
    ];
    for (words, reason) in table {
        let out = program(words);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(reason), "{words:?}: {said}");
        assert_eq!(folder.names(), ["a.obj", "scene.1.png"], "{words:?}");
        let kept = std::fs::read_to_string(scene).unwrap();
        assert_eq!(kept, text, "{words:?}");
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
    assert!(said.contains("scene.json, frame 59"), "{said}");

    // The first frame can be the one that is beyond the range.
    let text = text.replace("999999999999.5", "-999999999999.5");
    folder.write("scene.json", &text);
    let words = words.map(|word| if word == "0-59" { "-59-0" } else { word });
    let out = program(&words);
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("scene.json, frame -59"), "{said}");
}

/// A picture that says it is of the scene in `file` at `frame`.
pub(crate) fn picture_of(file: &Path, frame: i64) -> Vec<u8> {
    let args = SceneArgs {
        scene: file.to_owned(),
        overrides: SceneOverrides::default(),
    };
    let mut resolved = scene_file::load(&args, Some(ImageFormat::Exr), &Limits::default())
        .unwrap()
        .resolved;
    resolved.scene.time_s = time_of(resolved.scene.time_s, frame, 30.0);
    let frame = Frame {
        kind: FrameKind::View,
        projection: None,
        scene: None,
        width: 1,
        height: 1,
        layers: [(
            LayerName::Radiance,
            Layer {
                channels: 4,
                data: vec![0.0; 4],
            },
        )]
        .into(),
        stats: Stats {
            scene_hash: resolved.hash(),
            ..Stats::default()
        },
    };
    let encoding = resolved.scene.output.encoding();
    encode(&frame, &encoding, &Metadata::of(&frame.stats))
        .unwrap()
        .bytes
}

#[test]
fn an_animation_whose_files_are_there_needs_no_gpu() {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a.obj"));
    for frame in 3..=5 {
        let bytes = picture_of(&scene, frame);
        std::fs::write(folder.0.join(format!("f.{frame}.exr")), bytes).unwrap();
    }
    let left_over = ".f.4.exr.Ab3dE6.tmp";
    folder.write(left_over, "half a picture");
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
    assert!(
        said.contains("0 frames rendered, 3 skipped because their files exist"),
        "{said}"
    );
    let names = folder.names();
    assert!(!names.contains(&left_over.to_owned()), "{names:?}");
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
