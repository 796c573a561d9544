//! Comparisons of methods: which series there are, what is rendered, and what the results say.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;

use caustica::config::Limits;
use caustica::frame::{Frame, FrameKind, Layer};
use caustica::lab::study::comparison::{
    Contender, DEFAULT_RUNGS, METHOD_DIAL, RUNGS, contenders, split_list,
};
use caustica::lab::study::dial::{Dial, Setting, with_dials};
use caustica::lab::study::equal_time::{
    absent, best, is_twin, limit_ms, method_front, methods, standings,
};
use caustica::lab::study::error_images::method_images;
use caustica::lab::study::order::fit_order;
use caustica::lab::study::plot::error_against_time;
use caustica::lab::study::points::{Points, with_points};
use caustica::lab::study::report::{
    method_conclusions, method_table, to_csv, to_json, why_not_first, write_study,
};
use caustica::lab::study::study::{SeriesOf, Study, StudyImages};
use caustica::lab::study::sweep::{self, Refusal, StudyError, SweepSettings, run_study};
use caustica::lab::study::words::{label, named_setting};
use caustica::methods;
use caustica::reference::{Truth, TruthKind};
use caustica::scene::{DialValue, LayerName, Output, ResolvedScene};
use caustica::stats::{Stats, TimeStats};
use serde_json::json;

use crate::folder::Folder;
use crate::scene_files;
use crate::synthetic_study::{comparison, images, study as plain};

fn found(names: &[&str], scene: &ResolvedScene, rungs: u32) -> Vec<Contender> {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    contenders(&names, scene, rungs).unwrap()
}

fn refused(name: &str) -> (String, String) {
    let scene = scene_files::load("sine_pool", &[]);
    let error = contenders(&[name.to_owned()], &scene, 2).unwrap_err();
    (error.issues[0].pointer.clone(), error.to_string())
}

// Who takes part.

#[test]
fn all_is_every_method_with_every_word() {
    let scene = scene_files::load("teapot_floor", &[]);
    let all = found(&["all"], &scene, DEFAULT_RUNGS);
    let names: BTreeSet<&str> = all.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names.len(), all.len(), "names are distinct");
    let mut order: Vec<&str> = all.iter().map(|c| c.method).collect();
    order.dedup();
    assert_eq!(order, methods::ALL.map(|method| method.name));
    for method in methods::ALL {
        let own: Vec<&Contender> = all.iter().filter(|c| c.method == method.name).collect();
        assert_eq!(own[0].name, method.name, "first with its defaults");
        for dial in method.dials {
            for word in dial.words() {
                let name = format!("{}, {} {word}", method.name, dial.name);
                let is_default = dial.default_value() == DialValue::from(word);
                assert_eq!(names.contains(name.as_str()), !is_default, "{name}");
            }
        }
        let numbers = method.dials.iter().filter(|dial| dial.words().is_empty());
        let ladders = own
            .iter()
            .filter(|c| !c.name.contains(", ") || c.name.contains('×'));
        assert_eq!(
            ladders.count(),
            if numbers.count() > 1 { 2 } else { 1 },
            "{method:?}"
        );
    }
    // The same series again counts once.
    assert_eq!(found(&["all", "all"], &scene, DEFAULT_RUNGS), all);
}

#[test]
fn numbers_grow_together_and_stay_in_range() {
    let limits = Limits::default();
    for scene in ["sine_pool", "teapot_floor", "teapot_pool"] {
        let scene = scene_files::load(scene, &[]);
        for contender in found(&["all"], &scene, *RUNGS.end()) {
            let name = &contender.name;
            let mut before: Option<(f64, BTreeMap<&str, f64>)> = None;
            for (scale, dials) in &contender.settings {
                // Checked like any scene.
                let set =
                    with_dials(&scene, dials, &limits).unwrap_or_else(|e| panic!("{name}: {e}"));
                assert!(matches!(set, Setting::Scene(_)), "{name}: {set:?}");
                assert_eq!(
                    dials[0],
                    (METHOD_DIAL.to_owned(), contender.method.to_owned())
                );
                let numbers: BTreeMap<&str, f64> = dials
                    .iter()
                    .filter_map(|(name, value)| Some((name.as_str(), value.parse().ok()?)))
                    .collect();
                assert!(numbers.contains_key(contender.chief.as_str()), "{name}");
                if let Some((scale_before, numbers_before)) = &before {
                    assert_eq!(*scale, 2.0 * scale_before, "{name}");
                    for (dial, number) in &numbers {
                        assert!(*number >= numbers_before[dial], "{name}: {dial} shrinks");
                    }
                    let chief = contender.chief.as_str();
                    assert_eq!(numbers[chief], 2.0 * numbers_before[chief], "{name}");
                }
                before = Some((*scale, numbers));
            }
            assert_eq!(contender.settings[0].0, 0.25, "{name} begins with 64 cells");
            // Up to 2048 cells, or as far as the chief dial goes: 4096 photons are those of 1024 cells.
            let rungs = if name.starts_with("photon, ") { 5 } else { 6 };
            assert_eq!(contender.settings.len(), rungs, "{name}");
        }
    }
}

#[test]
fn dials_without_effect_on_the_scene_are_not_set() {
    let dials = |scene: &str| -> BTreeSet<String> {
        let all = found(&["all"], &scene_files::load(scene, &[]), 2);
        let settings = all.iter().flat_map(|c| &c.settings);
        settings
            .flat_map(|(_, dials)| dials.iter().map(|(name, _)| name.clone()))
            .collect()
    };
    for (scene, of_objects, of_views) in [
        ("sine_pool", false, false),
        ("teapot_floor", true, false),
        ("pool", false, true),
    ] {
        let found = dials(scene);
        assert!(found.contains("water_cells"), "{scene}");
        for dial in ["split_levels", "level_map_texels"] {
            assert_eq!(found.contains(dial), of_objects, "{scene}: {dial}");
        }
        assert_eq!(found.contains("map_texels"), of_views, "{scene}");
    }
}

#[test]
fn a_method_with_several_numbers_has_a_ladder_on_which_the_first_is_ahead() {
    let scene = scene_files::load("sine_pool", &[]);
    let numbers = |name: &str, dial: &str| -> Vec<String> {
        let all = found(&["photon:all"], &scene, 3);
        let one = all.into_iter().find(|c| c.name == name).unwrap();
        let settings = one.settings.into_iter();
        settings
            .map(|(_, dials)| dials.into_iter().find(|(name, _)| name == dial).unwrap().1)
            .collect()
    };
    assert_eq!(numbers("photon", "photons"), ["64", "128", "256"]);
    assert_eq!(numbers("photon", "photon_map_texels"), ["64", "128", "256"]);
    // A number of steps does not fall below its default.
    assert_eq!(numbers("photon", "iterations"), ["3", "3", "3"]);
    let ahead = "photon, 4× photons";
    assert_eq!(numbers(ahead, "photons"), ["256", "512", "1024"]);
    assert_eq!(numbers(ahead, "photon_map_texels"), ["64", "128", "256"]);
    assert_eq!(
        numbers("photon, search exact", "photons"),
        ["256", "512", "1024"]
    );
}

#[test]
fn names_select_methods_words_and_numbers() {
    let scene = scene_files::load("sine_pool", &[]);
    let names =
        |of: &[&str]| -> Vec<String> { found(of, &scene, 2).into_iter().map(|c| c.name).collect() };
    assert_eq!(names(&["planes"]), ["planes"]);
    assert_eq!(names(&["planes:all"]), ["planes", "planes, slicing smart"]);
    assert_eq!(
        names(&["volumetric", "level_map"]),
        ["volumetric", "level_map"]
    );
    let fixed = found(&["planes:planes=9,slicing=smart"], &scene, 2);
    assert_eq!(fixed[0].name, "planes, planes 9, slicing smart");
    for (_, dials) in &fixed[0].settings {
        assert!(
            dials.contains(&("planes".to_owned(), "9".to_owned())),
            "{dials:?}"
        );
    }
    for (name, pointer, says) in [
        ("magic", "/quality/method", "unknown method"),
        ("plane", "/quality/method", "did you mean `planes`"),
        ("planes:planes=1", "/quality/method/planes", "2 … 1024"),
        (
            "planes:slicing=clever",
            "/quality/method/slicing",
            "`smart`",
        ),
        (
            "planes:iterations=2",
            "/quality/method/iterations",
            "it belongs to",
        ),
        ("planes:nine", "/quality/method", "`method:dial=value"),
        (
            "photon:photons=64,photon_map_texels=64,iterations=2",
            "/quality/method",
            "nothing",
        ),
    ] {
        let (found, text) = refused(name);
        assert_eq!(found, pointer, "{name}: {text}");
        assert!(text.contains(says), "{name}: {text}");
    }
}

#[test]
fn lists_of_methods_split_between_methods_only() {
    let split = |text: &str| split_list(text);
    assert_eq!(split("a, b:x=1,y=2 ,c"), ["a", "b:x=1,y=2", "c"]);
    assert_eq!(split("b:x=1,c:y=2"), ["b:x=1", "c:y=2"]);
    assert_eq!(split(" ,"), [""; 0]);
    let dial = Dial::parse("method=planes:planes=9,slicing=smart,volumetric").unwrap();
    assert_eq!(dial.values, ["planes:planes=9,slicing=smart", "volumetric"]);
    // A sweep of methods at the scene's own settings reads them too.
    let scene = scene_files::load("sine_pool", &[]);
    let setting = [("method".to_owned(), dial.values[0].clone())];
    let Setting::Scene(set) = with_dials(&scene, &setting, &Limits::default()).unwrap() else {
        panic!("planes can do it");
    };
    assert_eq!(
        json!(set.scene.quality.method),
        json!({ "kind": "planes", "planes": 9, "slicing": "smart" })
    );
}

#[test]
fn points_are_those_that_are_asked_for() {
    let limits = Limits::default();
    let pool = scene_files::load("teapot_pool", &[]);
    let map = with_points(&pool, Points::Map, &limits).unwrap();
    let Output::IrradianceMap(output) = &map.scene.output else {
        panic!("{:?}", map.scene.output);
    };
    // 1.25 × 1.6 m, around (0.05, 0.1), where the camera looks.
    assert_eq!(output.min_m, Some([-0.95, -0.9]));
    assert_eq!(output.max_m, Some([1.05, 1.1]));
    assert_eq!((output.width, output.height), (Some(256), Some(256)));
    let view = with_points(&pool, Points::View, &limits).unwrap();
    let Output::View(output) = &view.scene.output else {
        panic!("{:?}", view.scene.output);
    };
    assert_eq!(output.layers, [LayerName::Irradiance]);
    assert_eq!((output.width, output.height), (960, 540), "the scene's own");
    let plain = scene_files::load("sine_pool", &[]);
    let same = with_points(&plain, Points::Map, &limits).unwrap();
    assert_eq!(same.scene.output, plain.scene.output);
    let error = with_points(&plain, Points::View, &limits).unwrap_err();
    assert_eq!(error.issues[0].pointer, "/camera", "{error}");
}

// What is rendered.

/// A scene of 4 × 4 texels.
fn small(name: &str) -> ResolvedScene {
    let scene = scene_files::load(name, &[]);
    let mut map = with_points(&scene, Points::Map, &Limits::default()).unwrap();
    if let Output::IrradianceMap(output) = &mut map.scene.output {
        (output.width, output.height) = (Some(4), Some(4));
    }
    map
}

fn truth() -> Truth {
    Truth {
        kind: TruthKind::FloorMap,
        width: 4,
        height: 4,
        first_pixel: [0, 0],
        pixel_step: 1,
        irradiance: vec![[1.0; 3]; 16],
        compared: vec![true; 16],
        relative_error: 1e-4,
        rays: 1000,
        shadow: None,
        seconds: 0.0,
        from_disk: false,
    }
}

fn settings(methods: &[&str], rungs: u32) -> SweepSettings {
    let values = methods.iter().map(|name| (*name).to_owned()).collect();
    SweepSettings {
        dials: vec![Dial::new(METHOD_DIAL, values).unwrap()],
        grid: false,
        rungs,
        runs: 3,
    }
}

/// A study by a renderer whose error is one over the square of the cells, and whose time is `ms_of` of them.
fn pretended(
    scene: &ResolvedScene,
    settings: &SweepSettings,
    ms_of: impl Fn(&ResolvedScene) -> f64,
) -> Result<(Study, StudyImages), StudyError<Infallible>> {
    run_study(
        scene,
        "pretended",
        &truth(),
        settings,
        &Limits::default(),
        &mut |scene: ResolvedScene| -> Result<Frame, Refusal<Infallible>> {
            let cells = f64::from(scene.scene.quality.water_cells);
            let value = (1.0 + 100.0 / (cells * cells)) as f32;
            let layer = Layer {
                channels: 3,
                data: vec![value; 48],
            };
            Ok(Frame {
                kind: FrameKind::IrradianceMap,
                width: 4,
                height: 4,
                layers: BTreeMap::from([(LayerName::Irradiance, layer)]),
                projection: None,
                stats: Stats {
                    time_ms: TimeStats {
                        total: ms_of(&scene),
                        ..TimeStats::default()
                    },
                    ..Stats::default()
                },
                scene: None,
            })
        },
        &mut |_, _, _| true,
    )
}

#[test]
fn every_method_runs_along_its_ladder() {
    let settings = settings(&["level_map", "planes:all"], 3);
    let (study, images) = pretended(&small("sine_pool"), &settings, |_| 5.0).unwrap();
    assert!(study.is_comparison());
    let names: Vec<&str> = study.sweeps.iter().map(|s| s.dial.as_str()).collect();
    assert_eq!(names, ["level_map", "planes", "planes, slicing smart"]);
    assert_eq!(methods(&study), ["level_map", "planes"]);
    for (sweep, images) in study.sweeps.iter().zip(&images.points) {
        assert_eq!((sweep.points.len(), images.len()), (3, 3));
        let scales: Vec<f64> = sweep.points.iter().map(|p| p.scale.unwrap()).collect();
        assert_eq!(scales, [0.25, 0.5, 1.0]);
        let order = sweep.order.unwrap();
        assert!((order - 2.0).abs() < 1e-2, "{order}");
    }
    let planes = &study.sweeps[2];
    assert_eq!(label(planes, &planes.points[2]), "256");
    assert_eq!(
        named_setting(planes, &planes.points[2]),
        "planes, slicing smart: water_cells 256, planes 51"
    );
    assert_eq!(
        serde_json::from_str::<Study>(&to_json(&study).unwrap()).unwrap(),
        study
    );
    assert!(to_csv(&study).contains("\"planes, slicing smart\""));
}

#[test]
fn methods_that_do_not_apply_appear_with_their_reason() {
    let lamps = small("lamp_pool");
    let (study, _) = pretended(&lamps, &settings(&["all"], 2), |_| 5.0).unwrap();
    let left: BTreeSet<&str> = study.left_out.iter().map(|l| l.method.as_str()).collect();
    assert!(
        left.contains("photon") && left.contains("caustic_volume"),
        "{left:?}"
    );
    let said = method_conclusions(&study).join("\n");
    for left in &study.left_out {
        assert!(!methods(&study).contains(&left.method.as_str()), "{left:?}");
        assert!(left.reason.contains("light"), "{left:?}");
    }
    let named = absent(&study);
    for method in ["photon", "caustic_volume"] {
        assert!(named.iter().any(|(name, _)| *name == method), "{named:?}");
    }
    for (name, reason) in named {
        let sentence = format!("{name} cannot render this scene: {reason}.");
        assert_eq!(said.matches(&sentence).count(), 1, "{sentence} in {said}");
    }
    let mut partly = study.clone();
    partly.left_out[0].reason = "another reason".to_owned();
    let names: Vec<&str> = absent(&partly).into_iter().map(|(name, _)| name).collect();
    assert!(
        names.contains(&"photon, search exact"),
        "reasons differ: {names:?}"
    );
    // Alone they are a study of nothing, which is found before any time is spent.
    let alone = settings(&["photon"], 2);
    let error = sweep::check::<Infallible>(&lamps, &alone, &Limits::default()).unwrap_err();
    assert!(matches!(error, StudyError::NothingLeft(_)), "{error}");
    assert!(error.to_string().contains("point light"), "{error}");
}

#[test]
fn every_timed_frame_shows_a_new_moment() {
    let moments = |settings: &SweepSettings| {
        let seen = RefCell::new(Vec::new());
        pretended(&small("sine_pool"), settings, |scene| {
            seen.borrow_mut().push(scene.scene.time_s);
            1.0
        })
        .unwrap();
        seen.into_inner()
    };
    // The first frame of each setting is compared with the truth, and shows the scene's own moment.
    let of_methods = moments(&settings(&["level_map"], 2));
    assert_eq!(of_methods, [0.0, 1e-3, 2e-3, 3e-3, 0.0, 1e-3, 2e-3, 3e-3]);
    let mut grid = settings(&["level_map"], 2);
    grid.grid = true;
    assert_eq!(
        moments(&grid),
        [0.0; 4],
        "a study of dials stays where it is"
    );
}

#[test]
fn a_slow_method_stops_early_and_says_so() {
    let settings = settings(&["level_map", "planes"], 4);
    let (study, _) = pretended(&small("sine_pool"), &settings, |scene| {
        let is_planes = scene.scene.quality.method.kind.as_deref() == Some("planes");
        let cells = f64::from(scene.scene.quality.water_cells);
        if is_planes { 20.0 * cells } else { 1.0 }
    })
    .unwrap();
    let counts: Vec<usize> = study.sweeps.iter().map(|s| s.points.len()).collect();
    // 64 cells take 1.3 s and 128 take 2.6 s.
    assert_eq!(counts, [4, 2]);
    let said: Vec<&str> = study.warnings.iter().map(|w| w.message.as_str()).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(
        said[0].contains("planes, water_cells = 256") && said[0].contains("2560 ms"),
        "{said:?}"
    );
}

#[test]
fn a_comparison_sets_all_dials_itself() {
    for field in ["target_error", "time_budget_ms"] {
        let pointer = format!("/quality/{field}");
        let scene = scene_files::load("sine_pool", &[(pointer.as_str(), "0.1")]);
        let refused =
            sweep::check::<Infallible>(&scene, &settings(&["all"], 2), &Limits::default());
        let Err(StudyError::Scene(error)) = refused else {
            panic!("{refused:?}");
        };
        assert_eq!(error.issues[0].pointer, pointer);
    }
    // The scene's own method and its dials do not matter.
    let own = scene_files::load(
        "sine_pool",
        &[
            ("/quality/method", "planes"),
            ("/quality/method/planes", "9"),
        ],
    );
    sweep::check::<Infallible>(&own, &settings(&["all"], 2), &Limits::default()).unwrap();
}

#[test]
fn method_in_a_grid_is_an_ordinary_dial() {
    let mut grid = settings(&["level_map", "planes"], 2);
    grid.grid = true;
    assert!(!grid.is_comparison());
    let (study, _) = pretended(&small("sine_pool"), &grid, |_| 1.0).unwrap();
    assert!(!study.is_comparison());
    assert_eq!(study.sweeps.len(), 1);
    assert_eq!(study.sweeps[0].points.len(), 2, "one setting each");
}

// What the results say.

#[test]
fn fronts_hold_what_no_setting_of_the_method_beats() {
    let study = comparison();
    let front: Vec<(&str, f64)> = method_front(&study, "point")
        .iter()
        .map(|s| (s.sweep.dial.as_str(), s.ms()))
        .collect();
    let smooth = "point, density smooth";
    assert_eq!(
        front,
        [
            ("point", 3.0),
            (smooth, 4.0),
            ("point", 6.0),
            (smooth, 8.0),
            (smooth, 16.0)
        ]
    );
    // Of all methods together.
    let on_front: Vec<Vec<bool>> = study
        .sweeps
        .iter()
        .map(|sweep| sweep.points.iter().map(|p| p.on_pareto_front).collect())
        .collect();
    assert_eq!(on_front[0], [false, false, true, true]);
    assert_eq!(on_front[1], [true, true, false]);
    assert_eq!(on_front[2], [true, true, true]);
    assert_eq!(on_front[3], [false, false]);
}

#[test]
fn methods_are_ranked_in_the_same_time() {
    let study = comparison();
    assert_eq!(limit_ms(&study), Some(20.0), "the third of four settings");
    let at = |ms: f64| -> Vec<(String, Option<f64>)> {
        let all = standings(&study, ms);
        all.iter()
            .map(|s| (s.method().to_owned(), s.error_in_time))
            .collect()
    };
    let found = at(20.0);
    assert_eq!(found[0], ("beam".to_owned(), Some(0.005)));
    // Beyond its last setting a method stays as good as that.
    assert_eq!(found[1], ("point".to_owned(), Some(0.019)));
    assert_eq!(found[2], ("slow".to_owned(), None));
    // Between two settings, by a power law: half way from 10 to 20 ms in logarithms.
    let between = at(10.0 * 2f64.sqrt())[0].1.unwrap();
    assert!((between - 0.01).abs() < 1e-12, "{between}");
    let all = standings(&study, 20.0);
    assert_eq!(best(&all).unwrap().method(), "beam");
    let all = standings(&study, 7.0);
    assert_eq!(best(&all).unwrap().method(), "point");
    assert!(best(&standings(&study, 1.0)).is_none());
}

#[test]
fn a_method_that_does_the_same_is_no_rival_whatever_its_times() {
    let mut study = comparison();
    let mut twin = study.sweeps[0].clone();
    twin.dial = "twin".to_owned();
    twin.series = Some(SeriesOf {
        method: "twin".to_owned(),
        chief: "cells".to_owned(),
    });
    for point in &mut twin.points {
        point.cost.wall_ms.median *= 0.5;
    }
    study.sweeps.push(twin);
    assert!(is_twin(&study, "twin"));
    assert!(!is_twin(&study, "beam") && !is_twin(&study, "point") && !is_twin(&study, "slow"));
    let all = standings(&study, 20.0);
    assert_eq!(all[3].error_in_time, all[0].error_in_time);
    assert_eq!(best(&all).unwrap().method(), "beam");
    assert_eq!(why_not_first(&study), None);
    let said = method_conclusions(&study).join("\n");
    assert!(said.contains("twin does the same here as beam"), "{said}");
    // One pass or one bit of difference makes another method of it.
    let mut other = study.clone();
    other.sweeps[4].points[1].error.relative_l1 *= 1.0 + 1e-15;
    assert!(!is_twin(&other, "twin"));
    let mut other = study;
    other.sweeps[4].points[1].cost.passes.pop();
    assert!(!is_twin(&other, "twin"));
    assert_eq!(best(&standings(&other, 20.0)).unwrap().method(), "twin");
}

#[test]
fn it_is_said_where_the_first_method_is_not_the_best() {
    let mut study = comparison();
    assert_eq!(why_not_first(&study), None);
    let said = method_conclusions(&study).join("\n");
    for part in [
        "In 20 ms (the time of beam with cells 256, aside 7), beam is nearest to the truth: 0.5 %.",
        "point: 1.9 %, 3.8 times as much",
        "slow takes longer at every setting: 100 ms",
        "picky cannot render this scene: it wants a sun.",
    ] {
        assert!(said.contains(part), "{part} in {said}");
    }
    // Now it takes four times as long, and is worse.
    for point in &mut study.sweeps[0].points {
        point.cost.wall_ms.median *= 4.0;
        point.error.relative_l1 *= 6.0;
    }
    let why = why_not_first(&study).unwrap();
    for part in [
        "beam is not the best here: in 80 ms its error is 3 %, that of point 1.9 %.",
        "point is as near after 6 ms (point: grains 128, aside 7).",
        "of the time of beam is its pass deposit",
    ] {
        assert!(why.contains(part), "{part} in {why}");
    }
    assert!(method_conclusions(&study).contains(&why));
}

#[test]
fn orders_are_fitted_to_the_scale() {
    let study = comparison();
    let fit = fit_order(&study.sweeps[0], 1e-5).unwrap();
    assert!((fit.order - 2.0).abs() < 1e-9, "{}", fit.order);
    assert!((fit.error_at(1.0) - 0.005).abs() < 1e-9);
}

#[test]
fn the_plot_has_a_front_per_method_and_the_report_every_setting() {
    let study = comparison();
    let plot = error_against_time(&study).unwrap();
    for text in ["beam", "point", "slow", "picky"] {
        assert!(plot.svg.contains(text), "{text}");
    }
    // The whole legend: four series, the front, the truth's error.
    assert!(plot.svg.contains("point, density smooth"));
    let table = method_table(&study);
    assert_eq!(table.lines().count(), 2 + 12);
    assert!(
        table.contains("| beam | cells 256, aside 7 | 0.5 % |"),
        "{table}"
    );
    assert!(table.contains("energy balance"));
    let images = images(&study, 32, 32);
    let folder = Folder::new();
    let files = write_study(&folder.0, &study, &images).unwrap();
    let names: Vec<String> = files
        .iter()
        .map(|file| file.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(
        names,
        [
            "study.md",
            "study.json",
            "study.csv",
            "error_time.svg",
            "error_time.png",
            "methods.png"
        ]
    );
    let report = std::fs::read_to_string(&files[0]).unwrap();
    for part in [
        "methods.png",
        "error_time.svg",
        "beam is nearest",
        "Orders of convergence",
    ] {
        assert!(report.contains(part), "{part} in {report}");
    }
    // A plain study has no such sheet.
    let error = method_images(&plain(), &images, 20.0).unwrap_err();
    assert!(error.to_string().contains("nothing to draw"), "{error}");
}
