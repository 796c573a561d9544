//! The conformance suite: tests that every method has to pass, or to skip with a reason. A scene that a method does not support is
//! skipped with the method's reason. The suite walks [`methods::ALL`], where that is cheap [`methods::variants`], and names no method.

use caustica::accuracy::{convergence_order, metrics};
use caustica::config::RenderConfig;
use caustica::facts::Product;
use caustica::lab::hard_cases;
use caustica::lab::hard_cases::case::Family;
use caustica::methods::{self, Method};
use caustica::reference::closed_form::flat_water_irradiance;
use caustica::render::RenderError;
use caustica::scene::{LayerName, Light, MethodChoice, Quality, ResolvedScene};
use serde_json::{Value, json};

use super::harness::{self, Map};
use super::{scene_files, sine_pool};

/// Mean of flat water against its closed form.
const FLAT_MEAN: f64 = 1e-3;
/// Closure of the account of a method that conserves energy.
const CLOSURE: f64 = 1e-5;
/// Irradiance of a box and of the floor around it against the closed form. Half a default plane distance absorbs 0.0014 of the light; the
/// surface reflects 0.02 of it, so that a method without Fresnel's factor fails.
const BOX: f64 = 1e-2;

/// A scene with this choice of method.
fn with(choice: &MethodChoice, mut scene: Value) -> ResolvedScene {
    scene["quality"]["method"] = json!(choice);
    scene_files::scene(scene)
}

/// All choices of [`methods::variants`], with their methods.
fn choices() -> impl Iterator<Item = (MethodChoice, &'static Method)> {
    methods::variants().into_iter().map(|choice| {
        let quality = Quality {
            method: choice.clone(),
            ..Quality::default()
        };
        (choice, methods::of(&quality))
    })
}

/// Whether the method of a scene does not support it; the reason is printed.
fn refuses(case: &str, resolved: &ResolvedScene) -> bool {
    // Faults of the scene itself are reported by the render.
    let Ok(Some(reason)) = methods::reason_against(resolved) else {
        return false;
    };
    let method = methods::of(&resolved.scene.quality);
    println!("{method:?} does not support {case}: {reason}");
    assert!(!reason.is_empty(), "{method:?}, {case}");
    true
}

/// Whether a frame has to have accounts that close.
fn closes_accounts(method: &Method) -> bool {
    let facts = method.facts_of_default();
    facts.conserves_energy && facts.product != Product::PointIrradiance
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
    ["flat", "box", "account", "determinism", "sine_pool"]
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

/// Irradiance at a depth under flat water.
fn flat_truth(resolved: &ResolvedScene, depth_m: f64) -> [f64; 3] {
    let Light::Sun(sun) = &resolved.scene.lights[0] else {
        panic!("a sun");
    };
    flat_water_irradiance(&resolved.scene.water, depth_m, sun)
}

#[test]
fn flat_water_has_the_closed_form_as_its_mean() {
    for (choice, method) in choices() {
        if skips(method, "flat") {
            continue;
        }
        for elevation_deg in [60.0, 20.0] {
            let resolved = with(&choice, flat(elevation_deg));
            if refuses("flat", &resolved) {
                continue;
            }
            let truth = flat_truth(&resolved, 2.0);
            let map = Map::from(&resolved);
            for channel in 0..3 {
                let error = (map.mean(channel) / truth[channel] - 1.0).abs();
                let uneven = map
                    .texels
                    .iter()
                    .map(|t| (t[channel] / truth[channel] - 1.0).abs());
                let uneven = uneven.fold(0.0, harness::nan_fails);
                println!(
                    "{choice:?} at {elevation_deg}°, channel {channel}: mean off by {error:.1e}, worst texel by {uneven:.1e}"
                );
                assert!(
                    error <= FLAT_MEAN,
                    "{choice:?} at {elevation_deg}°: {error:e}"
                );
            }
        }
    }
}

/// A box of 0.4 m under flat water and a vertical sun. Its top lies 0.8 m deep, over a floor at 2 m.
fn box_under_flat_water(output: Value) -> Value {
    json!({
        "water": { "absorption_per_m": [0.35, 0.07, 0.03] },
        "floor": { "depth_m": 2, "size_m": [4, 4] },
        "lights": [{ "kind": "sun", "elevation_deg": 90, "irradiance_w_m2": [1000, 800, 600] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.4 }],
        "quality": { "water_cells": 128, "level_map_texels": 64 },
        "output": output
    })
}

/// Mean of the texels at those columns and rows that `is_inside` accepts, per channel.
fn mean_of(map: &Map, is_inside: impl Fn(usize, usize) -> bool) -> [f64; 3] {
    let width = map.width as usize;
    let texels = map.texels.iter().enumerate();
    let inside: Vec<[f64; 3]> = texels
        .filter(|(at, _)| is_inside(at % width, at / width))
        .map(|(_, texel)| *texel)
        .collect();
    assert!(inside.len() > 100, "only {} texels", inside.len());
    std::array::from_fn(|c| inside.iter().map(|t| t[c]).sum::<f64>() / inside.len() as f64)
}

/// Largest relative error of a channel.
fn worst_channel(found: [f64; 3], truth: [f64; 3]) -> f64 {
    harness::largest_relative(&found, &truth)
}

#[test]
fn a_box_has_the_closed_form_on_its_top_and_a_dark_floor_below() {
    /// Texels of the floor's map along a side of 1 m.
    const SIDE: usize = 50;
    let on_top = json!({ "kind": "irradiance_map", "receiver": 0 });
    let on_floor = json!({ "kind": "irradiance_map", "receiver": "floor",
                           "min_m": [-0.5, -0.5], "max_m": [0.5, 0.5], "width": SIDE, "height": SIDE });
    // Distance of a texel's middle from the middle of the box, along the axis where it is larger.
    let distance_m = |x: usize, y: usize| {
        let along = |i: usize| ((i as f64 + 0.5) / SIDE as f64 - 0.5).abs();
        along(x).max(along(y))
    };
    for (choice, method) in choices() {
        if skips(method, "box") {
            continue;
        }
        let resolved = with(&choice, box_under_flat_water(on_top.clone()));
        if !refuses("box", &resolved) {
            let map = Map::from(&resolved);
            // The top nearly fills the map; a margin of an eighth excludes what its edges light in part.
            let [width, height] = [map.width, map.height].map(|side| side as usize);
            let is_inside = |i: usize, side: usize| i >= side / 8 && i < side - side / 8;
            let found = mean_of(&map, |x, y| is_inside(x, width) && is_inside(y, height));
            let error = worst_channel(found, flat_truth(&resolved, 0.8));
            println!("{choice:?}: top of the box off by {error:.1e}");
            assert!(error <= BOX, "{choice:?}: {found:?}");
        }
        let resolved = with(&choice, box_under_flat_water(on_floor.clone()));
        if !refuses("box", &resolved) {
            let map = Map::from(&resolved);
            // The box ends at 0.2 m.
            let dark = mean_of(&map, |x, y| distance_m(x, y) < 0.15);
            let lit = mean_of(&map, |x, y| distance_m(x, y) > 0.25);
            let truth = flat_truth(&resolved, 2.0);
            let error = worst_channel(lit, truth);
            println!("{choice:?}: floor beside the box off by {error:.1e}, below it {dark:?}");
            assert!(error <= BOX, "{choice:?}: {lit:?}");
            if methods::facts(&resolved).unwrap().method.leaves_out.shadows {
                let mut warnings = map.stats.warnings.iter();
                let warning = warnings.find(|w| w.code == "objects_cast_no_shadows");
                assert!(warning.is_some_and(|w| w.flux_w.is_some()), "{choice:?}");
                continue;
            }
            for channel in 0..3 {
                assert!(
                    dark[channel] <= BOX * truth[channel],
                    "{choice:?}: {dark:?} below the box"
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

/// The account of a method that conserves energy closes; of one that does not, the frame says so.
#[test]
fn accounts_close_or_the_frame_says_that_they_do_not() {
    for method in methods::ALL {
        if skips(method, "account") {
            continue;
        }
        let view = json!({ "kind": "view", "width": 64, "height": 48 });
        let choice = MethodChoice::named(method.name);
        let resolved = with(&choice, pool_with_a_box(view));
        if refuses("account", &resolved) {
            continue;
        }
        let frame = harness::render(&resolved);
        let closures = frame.stats.energy.iter().map(|account| account.closure);
        let closure = closures.fold(0.0, harness::nan_fails);
        let mut warnings = frame.stats.warnings.iter();
        let warning = warnings.find(|w| w.code == "method_does_not_conserve");
        println!("{method:?}: closure {closure:.1e}");
        if closes_accounts(method) {
            assert!(!frame.stats.energy.is_empty(), "{method:?}");
            assert!(closure <= CLOSURE, "{method:?}: {closure:e}");
            assert!(warning.is_none(), "{method:?}");
        } else {
            let warning = warning.unwrap_or_else(|| panic!("{method:?} does not say so"));
            // Without an account there is no flux to report.
            let reports = warning.flux_w.is_some_and(|w| w != [0.0; 3]);
            assert!(reports || frame.stats.energy.is_empty(), "{method:?}");
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
    for (choice, method) in choices() {
        if skips(method, "determinism") {
            continue;
        }
        for output in &outputs {
            let resolved = with(&choice, pool_with_a_box(output.clone()));
            if refuses("determinism", &resolved) {
                continue;
            }
            let [first, second] = [0, 1].map(|_| harness::render(&resolved));
            assert_eq!(first.layers, second.layers, "{choice:?}, {output}");
            assert_eq!(first.stats.energy, second.stats.energy, "{choice:?}");
            let lit = &first.layers[&LayerName::Irradiance];
            assert!(lit.data.iter().any(|&v| v > 0.0), "{choice:?}, {output}");
        }
    }
}

#[test]
fn the_error_on_the_sine_pool_is_as_expected_and_falls_as_expected() {
    let truth = sine_pool::truth();
    for (choice, method) in choices() {
        if skips(method, "sine_pool") {
            continue;
        }
        let scene_at = |cells: u32| {
            let cells = cells.to_string();
            let mut resolved =
                scene_files::load("sine_pool", &[("/quality/water_cells", cells.as_str())]);
            resolved.scene.quality.method = methods::shortest(&choice);
            resolved
        };
        if refuses("sine_pool", &scene_at(64)) {
            continue;
        }
        let error_at = |cells: u32| {
            let map = Map::from(&scene_at(cells));
            metrics::relative_l1(map.values(), truth.irradiance.as_flattened()).unwrap()
        };
        let points = [64, 128, 256].map(|cells| (f64::from(cells), error_at(cells)));
        let order = convergence_order(&points);
        println!("{choice:?}: {points:?}, order {order:.2}");
        let most = method.conformance.sine_pool_error_at_256;
        assert!(points[2].1 <= most, "{choice:?}: {points:?}");
        assert!(
            order >= 0.9 * method.expected_order,
            "{choice:?}: {order} of {}",
            method.expected_order
        );
    }
}

/// Every scene of the hard cases renders: finite, with closed accounts where the method conserves energy; or it is
/// refused with an error of the scene or of the budget. The default method is left out: the hard cases themselves are run with it.
#[test]
fn hard_cases_are_finite_and_accounted_for() {
    // Its own, so that other tests do not wait.
    let mut renderer = harness::new_renderer(&RenderConfig::default());
    for method in &methods::ALL[1..] {
        let closes = closes_accounts(method);
        let (mut rendered, mut refused, mut unsupported) = (0, 0, 0);
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
            if refuses(case.name, &resolved) {
                unsupported += 1;
                continue;
            }
            match harness::try_render(&mut renderer, &resolved) {
                Ok(frame) => {
                    for account in &frame.stats.energy {
                        let closure = account.closure;
                        assert!(closure.is_finite(), "{method:?}, {}", case.name);
                        assert!(
                            !closes || closure <= CLOSURE,
                            "{method:?}, {}: {closure:e}",
                            case.name
                        );
                    }
                    rendered += 1;
                }
                Err(RenderError::Scene(_) | RenderError::OverBudget { .. }) => refused += 1,
                Err(error) => panic!("{method:?}, {}: {error}", case.name),
            }
        }
        println!(
            "{method:?}: {rendered} scenes rendered, {refused} refused, {unsupported} not supported"
        );
        assert!(rendered + unsupported > 40, "{method:?}: {rendered}");
    }
}
