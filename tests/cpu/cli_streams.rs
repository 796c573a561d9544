//! The program with stdout and stderr that are closed, full, or not read.

#![cfg(unix)]

use std::fs::OpenOptions;
use std::io::Write;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::channel;
use std::time::Duration;

use super::cli_program::picture_of;
use super::folder::{Folder, TRIANGLE, scene_text};

/// Long enough for a busy machine; reached only by a failing test.
const LONG: Duration = Duration::from_secs(60);

fn program(words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    command
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// A disk that is full.
fn full() -> Stdio {
    let device = OpenOptions::new().write(true).open("/dev/full");
    device.unwrap().into()
}

/// A pipe whose reader has gone.
fn closed() -> Stdio {
    let (_, writer) = std::io::pipe().unwrap();
    writer.into()
}

/// A folder with a scene and its only frame, which needs no GPU.
fn finished_batch() -> (Folder, [String; 2]) {
    let folder = Folder::new();
    folder.write("a.obj", TRIANGLE);
    let scene = folder.write("scene.json", &scene_text("a.obj"));
    std::fs::write(folder.0.join("f.1.exr"), picture_of(&scene, 1)).unwrap();
    let pattern = folder.0.join("f.%d.exr");
    let texts = [scene, pattern].map(|path| path.to_str().unwrap().to_owned());
    (folder, texts)
}

fn batch(texts: &[String; 2]) -> [&str; 7] {
    let [scene, pattern] = texts;
    [
        "animate",
        scene,
        "--frames",
        "1",
        "--skip-existing",
        "-o",
        pattern,
    ]
}

#[test]
fn a_broken_stderr_changes_no_exit_code() {
    let (_folder, texts) = finished_batch();
    let batch = batch(&texts);
    let table: [(&[&str], i32); 4] = [
        (&batch, 0),
        (&["plan", "nothing.json"], 2),
        (&["plan", &texts[1]], 2),
        (&["paint"], 2),
    ];
    for (words, code) in table {
        for stderr in [full, closed] {
            let status = program(words).stderr(stderr()).status().unwrap();
            assert_eq!(status.code(), Some(code), "{words:?}");
        }
    }
}

#[test]
fn a_stalled_reader_of_stderr_holds_nothing_up() {
    let (_folder, texts) = finished_batch();
    let (reader, writer) = std::io::pipe().unwrap();
    let mut filler = writer.try_clone().unwrap();
    // Fills the pipe, and waits then until the reader goes.
    let filling = std::thread::spawn(move || while filler.write_all(&[b'x'; 4096]).is_ok() {});
    let mut child = program(&batch(&texts)).stderr(writer).spawn().unwrap();
    let (done, status) = channel::<ExitStatus>();
    std::thread::spawn(move || done.send(child.wait().unwrap()));
    let status = status.recv_timeout(LONG).expect("the program ends");
    assert_eq!(status.code(), Some(0));
    drop(reader);
    filling.join().unwrap();
}

#[test]
fn stdout_is_a_result() {
    let (_folder, texts) = finished_batch();
    let plan = ["plan", &texts[0]];
    let help = ["--help"];
    let version = ["--version"];
    for words in [&plan[..], &help, &version] {
        let status = |stdout: Stdio| program(words).stdout(stdout).status().unwrap().code();
        assert_eq!(status(closed()), Some(0), "{words:?}: nobody reads further");
        assert_eq!(status(full()), Some(1), "{words:?}: the result is lost");
    }
}

#[test]
fn stdout_takes_one_result() {
    let (_folder, texts) = finished_batch();
    for stdout in ["-", "/dev/stdout"] {
        let words = ["render", &texts[0], "-o", "-", "--stats", stdout];
        let out = program(&words).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert!(
            said.contains("--output and --stats are both stdout"),
            "{said}"
        );
    }
    let words = ["animate", &texts[0], "--frames", "1", "-o", "-"];
    let out = program(&words).stderr(Stdio::piped()).output().unwrap();
    let said = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("cannot take several files"), "{said}");
}

/// The program starts itself again where Mesa's layer would print an error, but it can only do so if it is the process's own file.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
#[test]
fn the_program_starts_however_it_is_loaded() {
    let version = format!("caustica {}\n", env!("CARGO_PKG_VERSION"));
    let caustica = env!("CARGO_BIN_EXE_caustica");
    let direct = ["--version"];
    let loaded = [caustica, "--version"];
    let starts: [(&str, &[&str]); 2] = [
        (caustica, &direct),
        ("/lib64/ld-linux-x86-64.so.2", &loaded),
    ];
    for (file, words) in starts {
        for directory in [None, Some("/run/user/1000"), Some("relative")] {
            let mut command = Command::new(file);
            command.env_clear().args(words);
            if let Some(directory) = directory {
                command.env("XDG_RUNTIME_DIR", directory);
            }
            let out = command.output().unwrap();
            assert_eq!(String::from_utf8(out.stdout).unwrap(), version, "{file}");
            assert_eq!(out.status.code(), Some(0), "{file}");
        }
    }
}
