//! Accuracy from the command line: the program itself, with a GPU.

use std::path::Path;
use std::process::{Command, Output};

use caustica::lab::study::study::Study;

use super::folder::Folder;
use super::scene_files;

/// The sine pool with few texels, through the program, with truths kept in `cache`.
fn program(command: &str, more: &[&str], cache: &Path) -> Output {
    let scene = scene_files::folder().join("sine_pool.json");
    Command::new(env!("CARGO_BIN_EXE_caustica"))
        .arg(command)
        .arg(scene)
        .args(["--width", "32", "--height", "32"])
        .args(more)
        .env("CAUSTICA_TRUTH_CACHE", cache)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn study(folder: &Path) -> Study {
    let text = std::fs::read_to_string(folder.join("study.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_study_is_written_and_its_truth_kept() {
    let folder = Folder::new();
    let (cache, out) = (folder.0.join("truths"), folder.0.join("study"));
    let mut words = vec!["--dial", "water_cells=16,32", "--truth-error", "0.05"];
    words.extend(["--runs", "1", "-o", out.to_str().unwrap()]);
    let first = program("accuracy", &words, &cache);
    assert_eq!(first.status.code(), Some(0), "{}", said(&first));
    let text = said(&first);
    for line in ["water_cells 16", "water_cells 32", "study.md"] {
        assert!(text.contains(line), "{line} in {text}");
    }
    // stderr is no terminal: a line for each step, before any result.
    let steps: Vec<&str> = text.lines().take(4).collect();
    let expected = [
        "the float64 truth",
        "1 of 2: water_cells = 16",
        "2 of 2: water_cells = 32",
        "tables and plots",
    ];
    assert_eq!(steps, expected, "{text}");
    for file in ["study.md", "study.json", "study.csv"] {
        assert!(out.join(file).is_file(), "{file} of {text}");
    }
    let plots: Vec<String> = std::fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".svg"))
        .collect();
    assert_eq!(plots.len(), 2, "error against time, convergence: {plots:?}");
    let found = study(&out);
    assert!(!found.truth.from_disk);
    assert_eq!(found.sweeps[0].points.len(), 2);

    let second = program("accuracy", &words, &cache);
    assert_eq!(second.status.code(), Some(0), "{}", said(&second));
    assert!(
        said(&second).contains("kept from before"),
        "{}",
        said(&second)
    );
    let again = study(&out);
    assert!(again.truth.from_disk);
    let errors = |study: &Study| -> Vec<_> {
        let points = study.sweeps[0].points.iter();
        points.map(|point| point.error.clone()).collect()
    };
    assert_eq!(errors(&again), errors(&found), "same frames, same truth");
}

#[test]
fn bad_dials_are_refused_before_any_time_is_spent() {
    let folder = Folder::new();
    let cache = folder.0.join("truths");
    let out = folder.0.join("study");
    for (dial, wanted) in [
        (
            "water_cell=16",
            "level_map_texels, level_of_detail, map_texels",
        ),
        ("water_cells", "name=a..b"),
        ("water_cells=64..16", "a below b"),
        ("water_cells=", "1 … 32"),
        ("water_cells=16,1", "/quality/water_cells"),
    ] {
        // A truth this exact would take hours.
        let mut words = vec!["--dial", dial, "--truth-error", "0.000001"];
        words.extend(["-o", out.to_str().unwrap()]);
        let output = program("accuracy", &words, &cache);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{dial}: {said}");
        assert!(said.contains(wanted), "{wanted} in {said}");
    }
    for error in ["0", "0.2", "small"] {
        let words = ["--truth-error", error, "-o", out.to_str().unwrap()];
        let output = program("accuracy", &words, &cache);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(said(&output).contains("0.000001 … 0.1"));
    }
    assert!(!out.exists() && !cache.exists(), "nothing was written");
}

#[test]
fn plan_says_what_was_chosen() {
    let folder = Folder::new();
    let output = program("plan", &["--target-error", "0.1"], &folder.0);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let (head, rest) = text.split_once('\n').unwrap();
    assert_eq!(head, "Chosen dials", "{text}");
    let (chosen, _) = rest.split_once("Passes").unwrap();
    for word in [
        "water_cells",
        "split_levels",
        "predicted",
        "error ",
        "reason",
        "Method for this error",
        "expected",
        "not photon",
    ] {
        assert!(chosen.contains(word), "{word} in {chosen}");
    }
    // Without a request for accuracy, nothing about it is reported.
    let output = program("plan", &[], &folder.0);
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(text.starts_with("Passes"), "{text}");
}

#[test]
fn render_says_what_was_chosen_and_how_good_it_is() {
    let folder = Folder::new();
    let picture = folder.0.join("map.exr");
    let mut words = vec!["--target-error", "0.1", "--estimate-error", "true"];
    words.extend(["-o", picture.to_str().unwrap()]);
    let output = program("render", &words, &folder.0);
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let lines: Vec<&str> = text
        .lines()
        .filter_map(|line| line.strip_prefix("accuracy"))
        .map(str::trim)
        .collect();
    let [chosen, estimated] = lines.as_slice() else {
        panic!("two lines are expected: {text}");
    };
    assert!(
        chosen.contains("water cells chosen: predicted error "),
        "{chosen}"
    );
    assert!(chosen.ends_with(" ms"), "{chosen}");
    let error = estimated.strip_prefix("estimated error ").unwrap();
    let error: f64 = error.strip_suffix(" %").unwrap().parse().unwrap();
    assert!(0.0 < error && error < 20.0, "{estimated}");

    let picture = folder.0.join("plain.exr");
    let output = program("render", &["-o", picture.to_str().unwrap()], &folder.0);
    assert!(!said(&output).contains("accuracy"), "{}", said(&output));
}

#[test]
fn compare_puts_methods_beside_each_other() {
    let folder = Folder::new();
    let (cache, out) = (folder.0.join("truths"), folder.0.join("methods"));
    let mut words = vec!["--methods", "level_map,photon:photons=64,iterations=2"];
    words.extend(["--settings", "2", "--runs", "1", "--truth-error", "0.05"]);
    words.extend(["--points", "map", "-o", out.to_str().unwrap()]);
    let output = program("compare", &words, &cache);
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    for part in [
        "1 of 4: level_map, water_cells = 64",
        "photon, photons 64, iterations 2: photon_map_texels 128",
        "level_map: water_cells 128",
        "is nearest to the truth",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    for file in [
        "study.md",
        "study.csv",
        "error_time.svg",
        "error_time.png",
        "methods.png",
    ] {
        assert!(out.join(file).is_file(), "{file} of {text}");
    }
    let found = study(&out);
    assert!(found.is_comparison() && found.left_out.is_empty());
    let errors: Vec<f64> = (found.sweeps.iter())
        .flat_map(|sweep| sweep.points.iter().map(|point| point.error.relative_l1))
        .collect();
    println!("errors {errors:?}");
    assert!(errors[1] < errors[0], "more cells are nearer: {errors:?}");
    for sweep in &found.sweeps {
        for point in &sweep.points {
            assert!(
                point.error.flip > 0.0 && point.cost.peak_bytes > 0,
                "{point:?}"
            );
            assert!(point.cost.wall_ms.median > 0.0 && point.error.flux_bias.is_finite());
        }
    }
    // What nobody can do is refused before the truth is computed.
    for (methods, wanted) in [
        ("magic", "unknown method"),
        ("photon:search=clever", "`exact`"),
        ("", "1 … 32"),
    ] {
        let words = [
            "--methods",
            methods,
            "--truth-error",
            "0.000001",
            "-o",
            "nowhere",
        ];
        let output = program("compare", &words, &cache);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{methods}: {}",
            said(&output)
        );
        assert!(
            said(&output).contains(wanted),
            "{wanted} in {}",
            said(&output)
        );
    }
}
