//! The thesis's experiment without an adapter: accepted requests, and the files of results.

use caustica::cli::experiment::{meshes, planes};
use caustica::lab::experiment::level_map::{
    Experiment, HitPoint, MeshResult, PlanePoint, Technique, TechniqueFigures, plots, scene,
    to_csv, to_markdown,
};
use caustica::lab::shapes;
use caustica::lab::study::study::SpreadMs;
use caustica::scene::Quality;
use serde_json::json;

#[test]
fn numbers_of_planes_are_a_list_or_a_range() {
    assert_eq!(planes("3, 5,101").unwrap(), [3, 5, 101]);
    let all = planes("3..101").unwrap();
    assert_eq!((all.len(), all[0], all[98]), (99, 3, 101));
    for text in ["", "1", "3..1025", "101..3", "a..b", "3,,5", "-3"] {
        let error = planes(text).unwrap_err().to_string();
        assert!(error.contains("accepted: a,b,c or a..b"), "{error}");
    }
}

#[test]
fn shapes_are_named_or_all() {
    assert_eq!(meshes("all").unwrap().len(), shapes::ALL.len());
    assert_eq!(meshes("teapot, sphere").unwrap(), ["teapot", "sphere"]);
    let error = meshes("teapot,unicorn").unwrap_err().to_string();
    assert!(
        error.contains("`unicorn`") && error.contains("dolphin"),
        "{error}"
    );
}

#[test]
fn methods_of_placing_differ_in_nothing_else() {
    let base = scene("box", 32, 64).unwrap();
    let quality = |technique: Technique| technique.of(&base).scene.quality;
    let uniform = quality(Technique::Uniform(9));
    let method = |quality: &Quality| json!(quality.method);
    assert_eq!(method(&uniform), json!({ "kind": "planes", "planes": 9 }));
    assert_eq!(
        method(&quality(Technique::Smart(9))),
        json!({ "kind": "planes", "planes": 9, "slicing": "smart" })
    );
    let slices = quality(Technique::Volumetric(9));
    assert_eq!(
        method(&slices),
        json!({ "kind": "volumetric", "planes": 9 })
    );
    assert_eq!(quality(Technique::Hit), base.scene.quality);
    for technique in [slices, quality(Technique::Smart(9))] {
        let same = Quality {
            method: uniform.method.clone(),
            ..technique
        };
        assert_eq!(same, uniform);
    }
    assert!(scene("unicorn", 32, 64).is_err());
}

fn figures(ms: f64, error: f64) -> TechniqueFigures {
    TechniqueFigures {
        ms: SpreadMs {
            median: ms,
            min: 0.9 * ms,
            max: 1.2 * ms,
        },
        own_ms: Some(0.8 * ms),
        planned_bytes: 3 << 20,
        peak_bytes: 3 << 20,
        allocated_bytes: None,
        error: Some(error),
    }
}

/// Two shapes, one of them the thesis's.
fn found() -> Experiment {
    let mesh = |name: &str| MeshResult {
        name: name.to_owned(),
        triangles: 1984,
        truth_error: Some(0.001),
        planes: [3, 50, 101]
            .map(|planes| {
                let n = f64::from(planes);
                PlanePoint {
                    planes,
                    volumetric: figures(3.0 * n, 0.2 / n + 0.02),
                    uniform: figures(n, 0.2 / n + 0.02),
                    smart: figures(0.5 * n, 0.2 / n + 0.02),
                    used: planes / 2,
                    sub_boxes: 1,
                    texels: 1000,
                    ..PlanePoint::default()
                }
            })
            .to_vec(),
        hits: vec![HitPoint {
            water_cells: 64,
            split_levels: 2,
            figures: figures(20.0, 0.01),
        }],
    };
    Experiment {
        water_cells: 64,
        texels: 128,
        runs: 3,
        meshes: vec![mesh("sphere"), mesh("boulder")],
        ..Experiment::default()
    }
}

#[test]
fn the_page_sets_our_ratios_beside_the_thesis() {
    let text = to_markdown(&found(), "level-maps/");
    // 4.413 / 1.572 and 0.825 / 1.572 of tables 5-1 and 5-3, 50 planes of table 5-4.
    let row = text
        .lines()
        .find(|line| line.starts_with("| 101 | 303 |"))
        .unwrap();
    assert_eq!(
        row,
        "| 101 | 303 | 101 | 50.5 | 3 (2.81) | 0.5 (0.525) | 50 (50) | 1 |"
    );
    assert!(text.contains("](level-maps/sphere_time.svg)"));
    assert!(text.contains("](level-maps/sphere_error.svg)"));
    assert!(
        text.contains("\n| boulder | 1984 | 3 | 3 | 0.5 | 50 | 1 | 0 | 0 |"),
        "{text}"
    );
    assert!(
        !text.contains("## boulder"),
        "only the thesis's models are shown one by one"
    );
    assert!(text.contains("6 of 6 settings"));
    // Hits take 20 ms for 1 %: 3 planes take less time, and no error is below 2 %.
    assert!(text.contains("In 12 of 18 settings"), "{text}");
    assert!(text.contains("Exceptions: sphere with 3 planes, volumetric; sphere with 3 planes, uniform; sphere with 3 planes, smart; boulder"));
    assert!(
        text.contains("| sphere | 3 to 101 | 0 |  | 0 |  |"),
        "{text}"
    );
}

#[test]
fn the_table_has_a_row_for_each_method() {
    let text = to_csv(&found());
    let mut lines = text.lines();
    let columns = lines.next().unwrap().split(',').count();
    let rows: Vec<&str> = lines.collect();
    assert_eq!(rows.len(), 2 * (3 * 3 + 1));
    for row in &rows {
        assert_eq!(row.split(',').count(), columns, "{row}");
    }
    assert!(
        rows[0].starts_with("sphere,1984,volumetric,3,3,1,64,,9,"),
        "{}",
        rows[0]
    );
}

#[test]
fn a_shape_has_two_plots_with_a_truth_and_one_without() {
    let mut experiment = found();
    let both = plots(&experiment, &experiment.meshes[0]).unwrap();
    let names: Vec<&str> = both.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["sphere_time", "sphere_error"]);
    let svg = &both[0].1.svg;
    for text in [
        "Time against planes: sphere",
        "volumetric",
        "level map, smart",
        "planes",
    ] {
        assert!(svg.contains(text), "no `{text}`");
    }
    experiment.meshes[0].truth_error = None;
    assert_eq!(plots(&experiment, &experiment.meshes[0]).unwrap().len(), 1);
    experiment.meshes[0].planes[1].smart.ms.median = f64::NAN;
    assert!(plots(&experiment, &experiment.meshes[0]).is_err());
}
