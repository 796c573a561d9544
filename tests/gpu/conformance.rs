//! The conformance suite: tests that every method has to pass, or to skip with a reason. It walks [`methods::ALL`] and names no
//! method.

use caustica::accuracy::{convergence_order, metrics};
use caustica::lab::hard_cases;
use caustica::lab::hard_cases::case::Family;
use caustica::methods::{self, Method};
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::render::RenderError;
use caustica::scene::{LayerName, Light, ResolvedScene};
use serde_json::{Value, json};

use super::harness::{self, Map};
use super::{scene_files, sine_pool};

/// Mean of flat water against its closed form.
const FLAT_MEAN: f64 = 1e-3;
/// Closure of the account of a method that conserves energy.
const CLOSURE: f64 = 1e-5;

/// A scene with this method.
fn with(method: &Method, mut scene: Value) -> ResolvedScene {
    scene["quality"]["method"] = method.name.into();
    scene_files::scene(scene)
}

/// Whether a method skips a case, and why.
fn skips(method: &Method, case: &str) -> bool {
    let found = method.conformance.skips.iter();
    let reason = found.into_iter().find(|(name, _)| *name == case);
    if let Some((_, reason)) = reason {
        println!("{method:?} skips {case}: {reason}");
    }
    reason.is_some()
}

/// Names of all cases of the suite.
fn cases() -> Vec<String> {
    ["flat", "account", "determinism", "sine_pool"]
        .map(str::to_owned)
        .into_iter()
        .chain(hard_scenes().map(|case| case.name.to_owned()))
        .collect()
}

/// Hard cases that are about a scene; those about the machine are the executor's, whatever the method.
fn hard_scenes() -> impl Iterator<Item = &'static hard_cases::Case> {
    hard_cases::all().filter(|case| case.family != Family::Machine)
}

#[test]
fn methods_have_unique_names_and_report_what_they_skip() {
    let known = cases();
    for (k, method) in methods::ALL.iter().enumerate() {
        let later = &methods::ALL[k + 1..];
        assert!(
            later.iter().all(|other| other.name != method.name),
            "{method:?}"
        );
        assert!(
            !method.summary.is_empty() && !method.paper.is_empty(),
            "{method:?}"
        );
        for (case, reason) in method.conformance.skips {
            assert!(
                known.iter().any(|name| name == case),
                "{method:?} skips {case}"
            );
            assert!(
                reason.len() > 20,
                "{method:?} skips {case} because {reason:?}"
            );
        }
    }
}

fn flat(elevation_deg: f64) -> Value {
    json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
        "floor": { "depth_m": 2, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 30,
                     "irradiance_w_m2": [1000, 800, 600] }],
        "quality": { "water_cells": 64 },
        "output": { "kind": "irradiance_map", "receiver": "floor",
                    "min_m": [-1, -1], "max_m": [1, 1], "width": 64, "height": 48 }
    })
}

#[test]
fn flat_water_has_the_closed_form_as_its_mean() {
    for method in methods::ALL {
        if skips(method, "flat") {
            continue;
        }
        for elevation_deg in [60.0, 20.0] {
            let resolved = with(method, flat(elevation_deg));
            let Light::Sun(sun) = &resolved.scene.lights[0] else {
                panic!("a sun");
            };
            let truth = flat_water_irradiance(&resolved.scene.water, 2.0, sun);
            let map = Map::from(&resolved);
            for channel in 0..3 {
                let error = (map.mean(channel) / truth[channel] - 1.0).abs();
                let uneven = map
                    .texels
                    .iter()
                    .map(|t| (t[channel] / truth[channel] - 1.0).abs());
                let uneven = uneven.fold(0.0, harness::nan_fails);
                println!(
                    "{method:?} at {elevation_deg}°, channel {channel}: mean off by {error:.1e}, worst texel by {uneven:.1e}"
                );
                assert!(
                    error <= FLAT_MEAN,
                    "{method:?} at {elevation_deg}°: {error:e}"
                );
            }
        }
    }
}

/// A pool with a box in it, for a map of the box or a view.
fn pool_with_a_box(output: Value) -> Value {
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20 }],
            "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 55, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1.2, 0], "scale": 0.5 }],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0] },
        "quality": { "water_cells": 96, "map_texels": 128, "level_map_texels": 64 },
        "output": output
    })
}

/// The account of a method that conserves energy closes; of one that does not, the frame says so, and there is such a frame.
#[test]
fn accounts_close_or_the_frame_says_that_they_do_not() {
    for method in methods::ALL {
        if skips(method, "account") {
            continue;
        }
        let view = json!({ "kind": "view", "width": 64, "height": 48 });
        let frame = harness::render(&with(method, pool_with_a_box(view)));
        assert!(!frame.stats.energy.is_empty(), "{method:?}");
        let closures = frame.stats.energy.iter().map(|account| account.closure);
        let closure = closures.fold(0.0, harness::nan_fails);
        let warned = frame.stats.warnings.iter();
        let warning = warned
            .into_iter()
            .find(|w| w.code == "method_does_not_conserve");
        println!("{method:?}: closure {closure:.1e}");
        if method.facts_of_default().conserves_energy {
            assert!(closure <= CLOSURE, "{method:?}: {closure:e}");
            assert!(warning.is_none(), "{method:?}");
        } else {
            assert!(
                closure > CLOSURE,
                "{method:?} conserves energy: {closure:e}"
            );
            let flux_w = warning.and_then(|w| w.flux_w);
            assert!(
                flux_w.is_some_and(|w| w != [0.0; 3]),
                "{method:?} does not say so"
            );
        }
    }
}

#[test]
fn the_same_request_gives_the_same_bytes() {
    let outputs = [
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 96, "height": 96 }),
        json!({ "kind": "irradiance_map", "receiver": 0 }),
        json!({ "kind": "view", "width": 64, "height": 48, "layers": ["radiance", "irradiance"], "format": "exr" }),
    ];
    for method in methods::ALL {
        if skips(method, "determinism") {
            continue;
        }
        for output in &outputs {
            let resolved = with(method, pool_with_a_box(output.clone()));
            let [first, second] = [0, 1].map(|_| harness::render(&resolved));
            assert_eq!(first.layers, second.layers, "{method:?}, {output}");
            assert_eq!(first.stats.energy, second.stats.energy, "{method:?}");
            let lit = &first.layers[&LayerName::Irradiance];
            assert!(lit.data.iter().any(|&v| v > 0.0), "{method:?}, {output}");
        }
    }
}

#[test]
fn the_error_on_the_sine_pool_is_as_expected_and_falls_as_expected() {
    let truth = sine_pool::truth();
    for method in methods::ALL {
        if skips(method, "sine_pool") {
            continue;
        }
        let error_at = |cells: u32| {
            let cells = cells.to_string();
            let changes = [
                ("/quality/method", method.name),
                ("/quality/water_cells", cells.as_str()),
            ];
            let map = Map::from(&scene_files::load("sine_pool", &changes));
            metrics::relative_l1(map.values(), truth.irradiance.as_flattened()).unwrap()
        };
        let points = [64, 128, 256].map(|cells| (f64::from(cells), error_at(cells)));
        let order = convergence_order(&points);
        println!("{method:?}: {points:?}, order {order:.2}");
        let most = method.conformance.sine_pool_error_at_256;
        assert!(points[2].1 <= most, "{method:?}: {points:?}");
        assert!(
            order >= 0.9 * method.expected_order,
            "{method:?}: {order} of {}",
            method.expected_order
        );
    }
}

/// Every scene of the hard cases renders: finite, with closed accounts where the method conserves energy, the same twice; or it is
/// refused with an error of the scene or of the budget. The default method is left out: the hard cases themselves are run with it.
#[test]
fn hard_cases_are_finite_and_accounted_for() {
    for method in &methods::ALL[1..] {
        let conserves = method.facts_of_default().conserves_energy;
        let (mut rendered, mut refused) = (0, 0);
        for case in hard_scenes() {
            if skips(method, case.name) {
                continue;
            }
            let Some(mut scene) = hard_cases::scene(case) else {
                continue;
            };
            scene["quality"]["method"] = method.name.into();
            let Some(resolved) = hard_cases::resolved(scene) else {
                refused += 1;
                continue;
            };
            let tries = [0, 1].map(|_| harness::try_render(&mut harness::renderer(), &resolved));
            match tries {
                [Ok(first), Ok(second)] => {
                    assert_eq!(first.layers, second.layers, "{method:?}, {}", case.name);
                    for account in &first.stats.energy {
                        let closure = account.closure;
                        assert!(closure.is_finite(), "{method:?}, {}", case.name);
                        assert!(
                            !conserves || closure <= CLOSURE,
                            "{method:?}, {}: {closure:e}",
                            case.name
                        );
                    }
                    rendered += 1;
                }
                [
                    Err(RenderError::Scene(_) | RenderError::OverBudget { .. }),
                    Err(_),
                ] => refused += 1,
                [Err(error), _] | [_, Err(error)] => panic!("{method:?}, {}: {error}", case.name),
            }
        }
        println!("{method:?}: {rendered} scenes rendered, {refused} refused");
        assert!(rendered > 40, "{method:?}: {rendered}");
    }
}
