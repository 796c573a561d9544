//! Reports: complete, correctly encoded, and written atomically.

use std::fs;
use std::path::PathBuf;

use caustica::lab::study::error_images::{MOST_COLUMNS, error_images};
use caustica::lab::study::fit_orders;
use caustica::lab::study::plot::PlotError;
use caustica::lab::study::report::{
    ReportError, ReportLinks, SweepLinks, conclusions, to_csv, to_json, to_markdown, write_study,
};
use caustica::lab::study::study::{Study, StudyImages, Sweep};
use caustica::lab::study::words::{
    named_setting, percent, setting, signed_percent, significant, thousands,
};
use caustica::stats::Warning;
use serde_json::json;

use crate::synthetic_study::{images, point, study};

/// An empty folder of this test alone.
fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("caustica-report-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Fields of a CSV text, row by row, by the rules of RFC 4180.
fn parsed(csv: &str) -> Vec<Vec<String>> {
    let mut rows = vec![vec![String::new()]];
    let mut quoted = false;
    let mut characters = csv.chars().peekable();
    while let Some(c) = characters.next() {
        let row = rows.last_mut().unwrap();
        let field = row.last_mut().unwrap();
        match c {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => row.push(String::new()),
            '\r' if !quoted => {
                assert_eq!(characters.next(), Some('\n'), "lines end with CR LF");
                rows.push(vec![String::new()]);
            }
            _ => field.push(c),
        }
    }
    assert!(!quoted && rows.pop() == Some(vec![String::new()]));
    rows
}

#[test]
fn json_reads_back_as_the_same_study() {
    let mut odd = study();
    odd.sweeps[0].points[0].error.relative_l1 = 0.1 + 0.2;
    odd.sweeps[0].points[1].error.shadow_edge_share = None;
    odd.sweeps[0].points[1].error.estimated = None;
    odd.sweeps[0].points[2]
        .dials
        .insert("a".to_owned(), json!(null));
    odd.truth.shadow_edge_area = None;
    for study in [Study::default(), study(), odd] {
        let text = to_json(&study).unwrap();
        assert!(text.ends_with("}\n"));
        assert_eq!(serde_json::from_str::<Study>(&text).unwrap(), study);
    }
}

#[test]
fn json_refuses_what_it_cannot_say() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut study = study();
        study.sweeps[1].points[2].error.p99 = bad;
        let error = to_json(&study).unwrap_err();
        assert!(
            error.to_string().contains("/sweeps/1/points/2/error/p99"),
            "{error}"
        );
    }
}

#[test]
fn csv_has_a_row_per_setting_and_every_figure() {
    let mut study = study();
    study.sweeps[1].points[0].cost.passes.remove(0);
    study.sweeps[1].points[0].error.estimated = None;
    let rows = parsed(&to_csv(&study));
    let points: Vec<_> = study
        .sweeps
        .iter()
        .flat_map(|sweep| sweep.points.iter().map(move |point| (sweep, point)))
        .collect();
    assert_eq!(rows.len(), 1 + points.len());
    let column = |name: &str| {
        let index = rows[0].iter().position(|field| field == name);
        index.unwrap_or_else(|| panic!("no column {name}"))
    };
    for (row, (sweep, point)) in rows[1..].iter().zip(points) {
        assert_eq!(row.len(), rows[0].len());
        assert_eq!(row[column("scene")], study.scene);
        assert_eq!(row[column("sweep")], sweep.dial);
        assert_eq!(row[column("setting")], setting(sweep, point));
        let number = |name: &str| row[column(name)].parse::<f64>().ok();
        for (name, value) in [
            ("relative_l1", Some(point.error.relative_l1)),
            ("rmse_w_m2", Some(point.error.rmse_w_m2)),
            ("flux_bias", Some(point.error.flux_bias)),
            ("p99", Some(point.error.p99)),
            ("flip", Some(point.error.flip)),
            ("luv_distance", Some(point.error.luv_distance)),
            ("shadow_edge_share", point.error.shadow_edge_share),
            ("estimated_relative_l1", point.error.estimated),
            ("truth_relative_l1", Some(study.truth.relative_error)),
            ("runs", Some(f64::from(point.cost.runs))),
            ("wall_median_ms", Some(point.cost.wall_ms.median)),
            ("wall_min_ms", Some(point.cost.wall_ms.min)),
            ("gpu_max_ms", Some(point.cost.gpu_ms.max)),
            ("peak_bytes", Some(point.cost.peak_bytes as f64)),
            (
                "pass_surface_median_ms",
                point
                    .cost
                    .passes
                    .iter()
                    .find(|pass| pass.name == "surface")
                    .map(|pass| pass.ms.median),
            ),
        ] {
            assert_eq!(number(name), value, "{name}");
        }
        assert_eq!(
            row[column("on_pareto_front")],
            point.on_pareto_front.to_string()
        );
    }
}

fn links() -> ReportLinks {
    let sweep = |name: &str| SweepLinks {
        convergence: Some(format!("convergence_{name}.svg")),
        errors: Some(format!("errors_{name}.png")),
    };
    ReportLinks {
        methods: None,
        error_time: Some("error_time.svg".to_owned()),
        sweeps: ["beams", "steps", "hits"].map(sweep).to_vec(),
        json: Some("study.json".to_owned()),
        csv: None,
    }
}

#[test]
fn markdown_holds_every_setting_and_picture() {
    let mut study = study();
    study.sweeps[0].points[0].warnings = vec![Warning::new("w", "an | odd <warning>"); 1];
    let text = to_markdown(&study, &links());
    for sweep in &study.sweeps {
        for point in &sweep.points {
            let start = format!(
                "| {} | {} |",
                setting(sweep, point),
                percent(point.error.relative_l1)
            );
            assert!(text.contains(&start), "{start}");
            assert!(text.contains(&named_setting(sweep, point)));
        }
    }
    for part in [
        "Synthetic Adapter 9000",
        "its own error is **0.06 %**",
        "](error_time.svg)",
        "](convergence_beams.svg)",
        "](errors_hits.png)",
        "](study.json)",
        "beams 4096 was left out",
        "an \\| odd &lt;warning> (1×)",
        "pool &lt;deep> &amp;",
        "Order of convergence: 1.99",
    ] {
        assert!(text.contains(part), "no `{part}`");
    }
    assert!(!text.contains("study.csv"), "an absent file is not linked");
    // All rows of a table have as many cells.
    let mut cells = None;
    for line in text.lines() {
        let bars = line.replace("\\|", "").matches('|').count();
        if bars == 0 {
            cells = None;
        } else {
            assert_eq!(*cells.get_or_insert(bars), bars, "{line}");
        }
    }
    let stars = study.sweeps.iter().flat_map(|sweep| &sweep.points);
    let stars = stars.filter(|point| point.on_pareto_front).count();
    assert_eq!(text.matches("| ★ |").count(), stars);
}

#[test]
fn markdown_of_nothing_says_so() {
    let text = to_markdown(&Study::default(), &ReportLinks::default());
    assert!(text.contains("Nothing was measured."));
    let empty = Study {
        sweeps: vec![Sweep {
            dial: "beams".to_owned(),
            ..Sweep::default()
        }],
        ..Study::default()
    };
    assert!(to_markdown(&empty, &ReportLinks::default()).contains("No setting was measured."));
}

fn said(points: &[(serde_json::Value, f64, f64)], truth_error: f64) -> String {
    let mut study = study();
    study.truth.relative_error = truth_error;
    let points = points.iter().map(|(value, error, ms)| {
        let mut point = point("dial", value.clone(), 0.0, *ms);
        point.error.relative_l1 = *error;
        point
    });
    study.sweeps = vec![Sweep {
        dial: "dial".to_owned(),
        points: points.collect(),
        ..Sweep::default()
    }];
    fit_orders(&mut study);
    conclusions(&study, &study.sweeps[0]).join(" ")
}

#[test]
fn conclusions_follow_from_the_figures() {
    let text = said(
        &[
            (json!(512), 0.01, 29.0),
            (json!(256), 0.043, 10.0),
            (json!(1024), 0.0098, 30.0),
            (json!(2048), 0.001, 20.0),
            (json!(4096), 0.0009, 90.0),
        ],
        0.0005,
    );
    for part in [
        "From 256 to 512 the error falls 4.3× (4.3 % → 1 %) and the time grows 2.9×.",
        "From 512 to 1024 the error hardly changes (1 % → 0.98 %) and the time hardly changes (their runs overlap).",
        "From 1024 to 2048 the error falls 9.8× (0.98 % → 0.1 %) and the time falls 1.5×.",
        "At 2048 the error is less than 3 times the truth's own (0.05 %)",
        "Order ",
    ] {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
    assert!(!text.contains("From 2048"), "the truth hides it: {text}");

    let worse = said(&[(json!(1), 0.01, 1.0), (json!(2), 0.02, 2.0)], 0.0);
    assert!(worse.contains("the error grows 2×"), "{worse}");
    assert!(
        worse.contains("twice the dial multiplies the error by 2"),
        "{worse}"
    );
    let exact = said(&[(json!(1), 0.01, 1.0), (json!(2), 0.0, 2.0)], 0.0);
    assert!(exact.contains("falls to 0"), "{exact}");
    let words = said(&[(json!("a"), 0.01, 1.0), (json!("b"), 0.005, 4.0)], 0.0);
    assert!(
        words.contains("The fastest is a (1 %, 1 ms), the nearest to the truth b (0.5 %, 4 ms): from the first to the second the error falls 2× and the time grows 4×."),
        "{words}"
    );
    let best = said(&[(json!("a"), 0.01, 4.0), (json!("b"), 0.005, 1.0)], 0.0);
    assert!(best.contains("b (0.5 %, 1 ms) is both"), "{best}");
    let mut study = study();
    let levels = [(0, 0.09), (1, 0.03), (2, 0.01)];
    let levels = levels.map(|(level, error)| {
        let mut point = point("split_levels", json!(level), 0.0, 1.0);
        point.error.relative_l1 = error;
        point
    });
    study.sweeps = vec![Sweep {
        dial: "split_levels".to_owned(),
        points: levels.to_vec(),
        ..Sweep::default()
    }];
    fit_orders(&mut study);
    let halved = conclusions(&study, &study.sweeps[0]).join(" ");
    assert!(
        halved.contains("Each further level divides the error by 3.") && !halved.contains("Order"),
        "{halved}"
    );
    let report = to_markdown(&study, &ReportLinks::default());
    assert!(report.contains("The error falls by a factor of 3 per level."));
    let one = said(&[(json!(3), 0.01, 4.0)], 0.0);
    assert!(one.contains("Only 3 (1 %, 4 ms) was measured."), "{one}");
}

#[test]
fn a_folder_holds_everything_and_the_same_bytes() {
    let (folder, study) = (folder("all"), study());
    let images = images(&study, 24, 16);
    let read = || -> Vec<(PathBuf, Vec<u8>)> {
        let paths = write_study(&folder.join("new"), &study, &images).unwrap();
        let bytes = paths.iter().map(|path| fs::read(path).unwrap());
        paths.iter().cloned().zip(bytes).collect()
    };
    let first = read();
    assert!(first == read(), "the same study gives the same bytes");
    let mut names: Vec<String> = fs::read_dir(folder.join("new"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let mut expected: Vec<String> = ["study.md", "study.json", "study.csv"]
        .map(str::to_owned)
        .to_vec();
    expected.extend(["error_time.svg", "error_time.png"].map(str::to_owned));
    for dial in ["beams", "steps", "hits"] {
        expected.extend([
            format!("convergence_{dial}.svg"),
            format!("convergence_{dial}.png"),
            format!("errors_{dial}.png"),
        ]);
    }
    expected.sort();
    assert_eq!(names, expected, "and nothing else is left behind");
    // Every link of the report leads somewhere.
    let report = fs::read_to_string(folder.join("new/study.md")).unwrap();
    let targets: Vec<&str> = report
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .collect();
    assert_eq!(targets.len(), 1 + 2 * 3 + 2);
    for target in targets {
        assert!(folder.join("new").join(target).is_file(), "{target}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn odd_dials_get_plain_and_different_names() {
    let (folder, mut study) = (folder("names"), study());
    for (sweep, dial) in
        study
            .sweeps
            .iter_mut()
            .zip(["water/Grid × steps", "water grid x steps", "../.."])
    {
        dial.clone_into(&mut sweep.dial);
    }
    let images = images(&study, 8, 8);
    let paths = write_study(&folder, &study, &images).unwrap();
    let has = |name: &str| paths.iter().any(|path| path == &folder.join(name));
    assert!(has("errors_water_grid_x_steps.png"));
    assert!(has("errors_water_grid_x_steps_2.png"));
    assert!(has("errors_sweep.png"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_failure_leaves_no_files() {
    let (folder, study) = (folder("fails"), study());
    let good = images(&study, 8, 8);
    let names = || fs::read_dir(&folder).unwrap().count();
    // An image is missing.
    let mut bad = good.clone();
    bad.points[2].pop();
    let error = write_study(&folder, &study, &bad).unwrap_err();
    assert!(
        matches!(error, ReportError::Plot(PlotError::Images(_))),
        "{error}"
    );
    assert_eq!(names(), 0);
    // The last file's place is taken by a folder.
    fs::create_dir(folder.join("errors_hits.png")).unwrap();
    let error = write_study(&folder, &study, &good).unwrap_err();
    assert!(error.to_string().contains("errors_hits.png"), "{error}");
    assert_eq!(names(), 1, "only the folder in the way");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn contact_sheets_refuse_what_does_not_fit() {
    let study = study();
    let good = images(&study, 8, 8);
    let fails = |images: &StudyImages| error_images(&study, images, 0).unwrap_err();
    let mut small = good.clone();
    small.points[0][1] = images(&study, 7, 8).truth;
    assert!(matches!(fails(&small), PlotError::Images(_)));
    let mut none = good.clone();
    none.points.clear();
    assert!(matches!(fails(&none), PlotError::Images(_)));
    let mut black = good.clone();
    black.truth.rgb.fill([0.0; 3]);
    assert!(matches!(fails(&black), PlotError::Metric(_)));
    for bad in [f64::NAN, f64::INFINITY] {
        for (image, truth) in [(bad, 1.0), (1.0, bad)] {
            let mut broken = good.clone();
            broken.points[0][1].rgb[3] = [image; 3];
            broken.truth.rgb[3] = [truth; 3];
            assert!(matches!(fails(&broken), PlotError::Metric(_)));
        }
    }
    assert!(matches!(
        error_images(&study, &good, 3),
        Err(PlotError::NoSweep { index: 3, .. })
    ));
}

/// Width, height and pixels of an RGB file.
fn decoded(bytes: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width as usize, info.height as usize, pixels)
}

#[test]
fn contact_sheets_show_the_sign_of_an_error() {
    let mut study = study();
    study.sweeps.truncate(1);
    study.sweeps[0].points.truncate(3);
    let mut images = images(&study, 256, 256);
    let truth = images.truth.clone();
    images.points[0] = [0.8, 1.0, 1.25]
        .map(|scale| {
            let mut image = truth.clone();
            for value in image.rgb.as_flattened_mut() {
                *value *= scale;
            }
            image
        })
        .to_vec();
    let (width, _, pixels) = decoded(&error_images(&study, &images, 0).unwrap());
    // The middle of each tile of the second row: columns are 270 wide, rows 270 high.
    let at = |column: usize| {
        let (x, y) = (20 + column * 270 + 128, 58 + 44 + 270 + 128);
        let start = (y * width + x) * 3;
        [pixels[start], pixels[start + 1], pixels[start + 2]]
    };
    let [dark, right, bright] = [at(1), at(2), at(3)];
    assert!(dark[2] > dark[0], "too dark is blue: {dark:?}");
    assert_eq!(right, [255; 3], "right is white");
    assert!(bright[0] > bright[2], "too bright is red: {bright:?}");
}

#[test]
fn contact_sheets_have_room_for_eight() {
    let mut study = study();
    study.sweeps.truncate(1);
    let one = study.sweeps[0].points[0].clone();
    let wide = |study: &Study| {
        let images = images(study, 16, 16);
        decoded(&error_images(study, &images, 0).unwrap()).0
    };
    study.sweeps[0].points = vec![one.clone(); MOST_COLUMNS];
    let full = wide(&study);
    study.sweeps[0].points = vec![one.clone(); MOST_COLUMNS + 3];
    assert_eq!(wide(&study), full);
    study.sweeps[0].points = vec![one];
    assert!(wide(&study) < full / 3);
    // Large maps shrink, odd sizes included.
    let large = images(&study, 1025, 300);
    let (width, height, _) = decoded(&error_images(&study, &large, 0).unwrap());
    assert!(width < 600 && height < 500, "{width} × {height}");
}

#[test]
fn numbers_as_people_write_them() {
    for (value, digits, text) in [
        (0.0, 3, "0"),
        (1.0, 3, "1"),
        (0.012345, 3, "0.0123"),
        (99.96, 3, "100"),
        (1234.5, 3, "1230"),
        (1234.5, 6, "1234.5"),
        (-0.5, 2, "−0.5"),
        (1e-7, 3, "0.0000001"),
        (0.1, 3, "0.1"),
    ] {
        assert_eq!(significant(value, digits), text);
    }
    assert_eq!(percent(0.0123), "1.23 %");
    assert_eq!(signed_percent(0.01), "+1 %");
    assert_eq!(signed_percent(-0.01), "−1 %");
    assert_eq!(signed_percent(1e-12), "0 %");
    assert_eq!(thousands(1_234_567), "1\u{202f}234\u{202f}567");
    assert_eq!(thousands(12), "12");
}
