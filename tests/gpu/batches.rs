//! The program with a GPU: what `render` and `animate` say and write.

use std::process::{Command, Output};

use super::folder::Folder;
use super::scene_files;

/// A small view of the pool that is far too bright, on a machine without display.
fn program(command: &str, more: &[&str]) -> Output {
    asking_for_device(None, command, more)
}

/// The same with a variable by which the user asks Mesa for a device.
fn asking_for_device(variable: Option<&str>, command: &str, more: &[&str]) -> Output {
    let mut process = Command::new(env!("CARGO_BIN_EXE_caustica"));
    for name in [
        "NODEVICE_SELECT",
        "XDG_RUNTIME_DIR",
        "MESA_VK_DEVICE_SELECT",
        "DRI_PRIME",
    ] {
        process.env_remove(name);
    }
    if let Some(variable) = variable {
        process.env(variable, "1");
    }
    process
        .arg(command)
        .arg(scene_files::folder().join("pool.json"))
        .args(["--width", "16", "--height", "12", "--exposure-ev", "20"])
        .args(["--tone-curve", "clip", "--water-cells", "32"])
        .args(more)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    text
}

#[test]
fn a_run_that_succeeds_prints_no_error() {
    let folder = Folder::new();
    let picture = folder.0.join("x.png");
    for variable in [None, Some("DRI_PRIME")] {
        let words = ["-o", picture.to_str().unwrap()];
        let text = said(&asking_for_device(variable, "render", &words));
        assert!(!text.contains("error:"), "{variable:?}: {text}");
    }
}

#[test]
fn a_picture_on_stdout_is_the_one_of_a_file() {
    let folder = Folder::new();
    let stats = folder.0.join("stats.json");
    for format in ["png", "exr"] {
        let picture = folder.0.join(format!("x.{format}"));
        said(&program("render", &["-o", picture.to_str().unwrap()]));
        let mut words = vec!["-o", "-", "--format", format];
        words.extend(["--stats", stats.to_str().unwrap()]);
        let output = program("render", &words);
        assert!(said(&output).starts_with("picture  stdout, 16 × 12"));
        assert!(
            output.stdout == std::fs::read(picture).unwrap(),
            "the same {format}"
        );
    }
}

#[test]
fn a_batch_says_what_render_says_once_and_for_which_frames() {
    let folder = Folder::new();
    let picture = folder.0.join("x.png");
    let render = said(&program("render", &["-o", picture.to_str().unwrap()]));
    let warnings: Vec<&str> = render
        .lines()
        .filter_map(|line| line.strip_prefix("warning "))
        .map(str::trim)
        .collect();
    assert!(
        warnings.iter().any(|line| line.contains("were clipped")),
        "{render}"
    );

    let pattern = folder.0.join("f.###.png");
    let mut words = vec!["--frames", "-2-0,5", "-o", pattern.to_str().unwrap()];
    let batch = said(&program("animate", &words));
    let lines: Vec<&str> = batch.lines().collect();
    // The frame at time 0 is the one of `render`, but only the first frame's warnings are said in full.
    let full: Vec<&&str> = lines
        .iter()
        .filter(|line| line.starts_with("warning: frame -2: "))
        .collect();
    assert_eq!(full.len(), warnings.len(), "{batch}\n{render}");
    assert!(
        lines.contains(&"warning: png_clipped in frames -2-0, 5"),
        "{batch}"
    );
    let first = format!("frame -2, {}: begins, the first of 4", pattern.display());
    assert_eq!(lines[0], first.replace("###", "-002"), "{batch}");
    let last = format!("frame 5, {}: 4 of 4 done, ", pattern.display());
    assert!(batch.contains(&last.replace("###", "005")), "{batch}");
    let end = lines.last().unwrap();
    assert!(end.starts_with("4 frames rendered, 0 skipped"), "{batch}");
    let expected = [
        "f.-001.png",
        "f.-002.png",
        "f.000.png",
        "f.005.png",
        "x.png",
    ];
    assert_eq!(folder.names(), expected);
    assert!(
        std::fs::read(folder.0.join("f.000.png")).unwrap() == std::fs::read(picture).unwrap(),
        "frame 0 is the scene's own time"
    );

    words.push("--skip-existing");
    let again = said(&program("animate", &words));
    assert!(again.starts_with("0 frames rendered, 4 skipped"), "{again}");
}
