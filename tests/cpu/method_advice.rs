//! Which method is advised for an error: by what methods cannot do and leave out, and by measurements of scenes of the same kind.

use std::collections::BTreeSet;

use caustica::calibration::frontiers::{
    Frontiers, Kind, MeasuredMethod, MeasuredScene, MeasuredSetting,
};
use caustica::methods;
use caustica::scene::ResolvedScene;
use caustica::stats::{ChosenDials, MethodAdvice};
use caustica::tuning::method::{Question, advise, kind_of};
use serde_json::json;

use super::scene_files;

const MAP: Kind = Kind {
    view: false,
    objects: false,
    lamps: false,
};

/// A front: errors and times.
fn front(method: &str, settings: &[(f64, f64)]) -> MeasuredMethod {
    MeasuredMethod {
        method: method.to_owned(),
        settings: settings
            .iter()
            .map(|&(error, ms)| MeasuredSetting {
                dials: [("cells".to_owned(), json!((1e3 * ms) as u64))].into(),
                error,
                ms,
            })
            .collect(),
    }
}

fn scene(name: &str, kind: Kind, methods: Vec<MeasuredMethod>) -> MeasuredScene {
    MeasuredScene {
        scene: name.to_owned(),
        kind,
        methods,
    }
}

fn default_name() -> &'static str {
    methods::ALL[0].name
}

/// The default method halves its error for each doubling of the time, from 16 % in 1 ms.
fn default_front() -> MeasuredMethod {
    front(default_name(), &[(0.16, 1.0), (0.04, 4.0), (0.01, 16.0)])
}

fn advice(resolved: &ResolvedScene, target: f64, scenes: Vec<MeasuredScene>) -> MethodAdvice {
    let facts = methods::facts(resolved).unwrap();
    let chosen = ChosenDials {
        water_cells: 150,
        predicted_error: 0.9 * target,
        predicted_ms: 100.0,
        meets: true,
        ..ChosenDials::default()
    };
    let question = Question {
        resolved,
        facts: &facts,
        target,
        chosen: &chosen,
    };
    let advice = advise(&question, &Frontiers::new("a machine".to_owned(), scenes));
    // Every method is named once.
    let mut named: Vec<&str> = advice.others.iter().map(|o| o.method.as_str()).collect();
    named.push(&advice.method);
    assert_eq!(named.len(), methods::ALL.len(), "{advice:#?}");
    let named: BTreeSet<&str> = named.into_iter().collect();
    assert_eq!(named, methods::ALL.map(|m| m.name).into());
    assert!(
        advice.others.iter().all(|o| !o.reason.is_empty()),
        "{advice:#?}"
    );
    advice
}

fn reason<'a>(advice: &'a MethodAdvice, method: &str) -> &'a str {
    let found = advice.others.iter().find(|other| other.method == method);
    &found
        .unwrap_or_else(|| panic!("{method} in {advice:#?}"))
        .reason
}

#[test]
fn without_measurements_the_default_method_is_advised() {
    let found = advice(&scene_files::load("sine_pool", &[]), 0.02, Vec::new());
    assert_eq!(found.method, default_name());
    assert_eq!(
        (found.expected_error, found.expected_ms),
        (0.9 * 0.02, 100.0)
    );
    assert!(found.reason.contains("150 water cells"), "{found:#?}");
    assert!(
        found.reason.contains("no other method was measured"),
        "{found:#?}"
    );
    assert!(found.source.contains("trial renders"));
    for other in methods::ALL.into_iter().skip(1) {
        let reason = reason(&found, other.name);
        assert!(
            reason.contains("no scene of this kind was measured"),
            "{reason}"
        );
        assert_eq!(
            reason.contains("does not go to 0"),
            other.expected_order == 0.0
        );
    }
}

#[test]
fn methods_that_cannot_do_a_scene_or_leave_something_out_say_so() {
    let lamps = advice(&scene_files::load("lamp_pool", &[]), 0.02, Vec::new());
    let said = reason(&lamps, "photon");
    assert!(said.starts_with("it cannot render this scene: "), "{said}");
    let reef = advice(&scene_files::load("reef", &[]), 0.02, Vec::new());
    for method in methods::ALL {
        let leaves_out = method.facts_of_default().leaves_out;
        if method.name != default_name() && leaves_out.shadows_on_objects {
            let said = reason(&reef, method.name);
            assert_eq!(said, "it leaves out the shadows of objects on each other");
        }
    }
}

#[test]
fn a_method_that_was_faster_everywhere_is_advised() {
    let pool = scene_files::load("sine_pool", &[]);
    let fast = |factor: f64| {
        let settings = [(0.16, factor), (0.04, 4.0 * factor), (0.01, 16.0 * factor)];
        front("photon", &settings)
    };
    let scenes = vec![
        scene("one", MAP, vec![default_front(), fast(0.5)]),
        scene("two", MAP, vec![default_front(), fast(0.25)]),
        // Another kind of scene does not count.
        scene("other", Kind { view: true, ..MAP }, vec![default_front()]),
    ];
    let found = advice(&pool, 0.02, scenes.clone());
    assert_eq!(found.method, "photon", "{found:#?}");
    assert!(
        (found.expected_ms - 50.0).abs() < 1e-9,
        "the worst ratio: {found:#?}"
    );
    assert_eq!(found.expected_error, 0.02);
    assert!(found.reason.contains("at most 50 %") && found.reason.contains("each of 2"));
    assert!(found.source.contains("a machine"), "{found:#?}");
    // The setting that meets the error on every scene.
    assert_eq!(found.dials, [("cells".to_owned(), json!(8000))].into());
    assert!(reason(&found, default_name()).contains("100 ms predicted"));
    assert!(
        reason(&found, "planes").contains("not measured on one"),
        "{found:#?}"
    );

    // Faster on one scene only.
    let mut mixed = scenes.clone();
    mixed[1].methods[1] = fast(2.0);
    let found = advice(&pool, 0.02, mixed);
    assert_eq!(found.method, default_name());
    let said = reason(&found, "photon");
    assert!(
        said.contains("0.50 … 2.0 times as long") && said.contains("one, two"),
        "{said}"
    );
    assert!(
        found.reason.contains("no other method was faster on every"),
        "{found:#?}"
    );

    // Not by much.
    let close = vec![scene("one", MAP, vec![default_front(), fast(0.95)])];
    assert_eq!(advice(&pool, 0.02, close).method, default_name());

    // Never that near to the truth.
    let mut coarse = scenes;
    coarse[1].methods[1] = front("photon", &[(0.16, 0.1), (0.07, 0.2)]);
    let said = advice(&pool, 0.02, coarse.clone());
    let said = reason(&said, "photon");
    assert_eq!(said, "the smallest error measured with it on two is 7.0 %");
    // For a larger error it is the fastest.
    assert_eq!(advice(&pool, 0.08, coarse).method, "photon");

    // Of two that are faster, the one whose worst case is better.
    let both = vec![scene(
        "one",
        MAP,
        vec![default_front(), fast(0.5), front("planes", &[(0.01, 1.0)])],
    )];
    let found = advice(&pool, 0.02, both);
    assert_eq!(found.method, "planes");
    assert_eq!(reason(&found, "photon"), "planes was faster still");

    // Below all that was measured nothing is claimed.
    let found = advice(
        &pool,
        0.001,
        vec![scene(
            "one",
            MAP,
            vec![default_front(), front("planes", &[(0.0005, 1.0)])],
        )],
    );
    assert_eq!(found.method, default_name());
    assert!(
        reason(&found, "planes").contains("cannot be compared"),
        "{found:#?}"
    );
}

#[test]
fn scenes_have_kinds() {
    let kind = |name: &str| {
        let resolved = scene_files::load(name, &[]);
        kind_of(&resolved, &methods::facts(&resolved).unwrap())
    };
    let some = |view, objects, lamps| {
        Some(Kind {
            view,
            objects,
            lamps,
        })
    };
    assert_eq!(kind("sine_pool"), some(false, false, false));
    assert_eq!(kind("teapot_floor"), some(false, true, false));
    assert_eq!(kind("pool"), some(true, false, false));
    assert_eq!(kind("lamp_pool"), some(true, true, true));
    let on_mesh = scene_files::scene(json!({
        "lights": [{ "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }],
        "output": { "kind": "irradiance_map", "receiver": 0 }
    }));
    assert_eq!(kind_of(&on_mesh, &methods::facts(&on_mesh).unwrap()), None);
}

#[test]
fn times_are_interpolated_and_never_extrapolated() {
    let front = default_front();
    assert_eq!(front.ms_at(0.5), Some(1.0), "the fastest setting is enough");
    assert!((front.ms_at(0.08).unwrap() - 2.0).abs() < 1e-12);
    assert!((front.ms_at(0.02).unwrap() - 8.0).abs() < 1e-12);
    assert_eq!(front.ms_at(0.01), Some(16.0));
    assert_eq!(front.ms_at(0.0099), None);
    assert_eq!(front.setting_at(0.05).unwrap().ms, 4.0);
    assert_eq!(front.least_error(), 0.01);
}

#[test]
fn only_fronts_are_read() {
    let written = |settings: &[(f64, f64)]| {
        let methods = vec![front("photon", settings)];
        let frontiers = Frontiers::new(String::new(), vec![scene("one", MAP, methods)]);
        serde_json::to_string(&frontiers).unwrap()
    };
    Frontiers::read(&written(&[(0.1, 1.0), (0.05, 2.0)]), "a").unwrap();
    for (settings, says) in [
        (&[(0.1, 1.0), (0.2, 2.0)][..], "no front"),
        (&[(0.1, 2.0), (0.05, 1.0)], "no front"),
        (&[], "no front"),
        (&[(0.0, 1.0)], "above 0"),
        (&[(0.1, -1.0)], "above 0"),
    ] {
        let error = Frontiers::read(&written(settings), "a")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(says) && error.contains("photon on one"),
            "{error}"
        );
    }
    let old = written(&[(0.1, 1.0)]).replace("\"form\":1", "\"form\":2");
    assert!(
        Frontiers::read(&old, "a")
            .unwrap_err()
            .to_string()
            .contains("form is 2")
    );
}

#[test]
fn the_built_in_measurements_are_of_methods_that_exist() {
    for scene in &Frontiers::built_in().scenes {
        for measured in &scene.methods {
            let known = methods::ALL.iter().any(|m| m.name == measured.method);
            assert!(known, "{} on {}", measured.method, scene.scene);
        }
    }
}
