//! Photon mapping in image space: against a plain float64 program, against the truth, and its parts against each other.

use caustica::accuracy::{convergence_order, metrics};
use caustica::config::RenderConfig;
use caustica::graph::BandRun;
use caustica::methods;
use caustica::methods::photon::photons::PHOTONS;
use caustica::methods::photon::view::photon_count;
use caustica::methods::photon::{
    DEPOSIT, DRAWN, EXACT, ITERATIONS, LOOKUP, MAP_TEXELS, METHOD, PHOTONS_PER_SIDE, SEARCH,
    photon_lookup,
};
use caustica::render::{Prepared, Renderer};
use caustica::scene::{LayerName, MethodChoice, ResolvedScene};
use caustica::stages::points::{POINT_IRRADIANCE, POINTS};
use caustica::stages::surface::wanted_for_light;
use caustica::stages::{Pass, Step, Steps, queues};
use glam::{DVec2, DVec3};
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::harness::{self, Map};
use super::photon_plain::Plain;
use super::{scene_files, sine_pool};

/// Puts the photons where the irradiance of a map's texels belongs, one to a texel: place on the map, and path.
static SPY: Pass = Pass {
    name: "photon_spy",
    shader: "methods/own/photon_spy.wgsl",
    reads: &[&POINTS, &PHOTONS],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::Band(|facts, _: BandRun| {
        let groups = queues::in_columns(photon_count(facts).div_ceil(64));
        vec![Step::compute("photon_spy_main", groups, Vec::new())]
    }),
    work: |_| 1.0,
};

const SPY_SHADER: &str = "
#import \"shared/points.wgsl\"
@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> photons: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> point_irradiance: array<vec4f>;
@compute @workgroup_size(64) fn photon_spy_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&photons) || points[id.x].receiver < 0.0 { return; }
    point_irradiance[id.x] = photons[id.x].xyww;
}
";

fn choice() -> MethodChoice {
    MethodChoice::named(METHOD.name)
}

fn with(mut scene: Value, choice: &MethodChoice) -> ResolvedScene {
    scene["quality"]["method"] = json!(choice);
    scene_files::scene(scene)
}

/// A pool with a box whose top lies 0.6 m deep, and a map of the floor of `side`² texels.
fn pool(elevation_deg: f64, scale: Option<[f64; 3]>, side: u32) -> Value {
    let mut objects = Vec::new();
    if let Some(scale) = scale {
        let middle = middle_of(scale).to_array();
        objects.push(json!({ "mesh": "box.obj", "translation_m": middle, "scale": scale }));
    }
    json!({
        "water": {
            "waves": [{ "kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20 },
                      { "kind": "sine", "amplitude_m": 0.01, "wavelength_m": 0.4, "direction_deg": 110 }],
            "absorption_per_m": [0.3, 0.1, 0.05]
        },
        "floor": { "depth_m": 1.5, "size_m": [8, 8] },
        "lights": [{ "kind": "sun", "elevation_deg": elevation_deg, "azimuth_deg": 30, "irradiance_w_m2": [1000, 900, 800] }],
        "objects": objects,
        "output": { "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1],
                    "width": side, "height": side }
    })
}

/// A box that stands on the floor of [`pool`].
const BOX: [f64; 3] = [0.6, 0.9, 0.5];
/// A box that is one half of the floor, with a step in the middle of the map.
const STEP: [f64; 3] = [6.0, 0.9, 12.0];

fn middle_of(scale: [f64; 3]) -> DVec3 {
    let x = if scale == STEP { 3.0 } else { 0.0 };
    DVec3::new(x, -1.5 + 0.5 * scale[1], 0.0)
}

fn box_of(scale: Option<[f64; 3]>) -> Vec<[DVec3; 2]> {
    let boxes = scale.map(|scale| {
        let half = DVec3::from(scale) * 0.5;
        [middle_of(scale) - half, middle_of(scale) + half]
    });
    boxes.into_iter().collect()
}

fn spying() -> Renderer {
    let sources = methods::embedded().with_file("methods/own/photon_spy.wgsl", SPY_SHADER);
    Renderer::with_shaders(&RenderConfig::default(), sources).unwrap()
}

/// Place on the map and path of every photon; zeros for those on no texel.
fn spied(renderer: &mut Renderer, prepared: &Prepared) -> Vec<[f64; 3]> {
    let passes = prepared.passes().iter().map(|pass| match pass.name {
        name if name == photon_lookup::PASS.name => &SPY,
        _ => *pass,
    });
    let prepared = prepared.clone().with_passes(passes.collect());
    let frame = renderer.render_prepared(&prepared, &CancellationToken::new());
    let frame = frame.unwrap_or_else(|error| panic!("{error}"));
    renderer.gpu().check().unwrap();
    harness::layer(&frame, LayerName::Irradiance)
}

#[test]
fn photons_end_where_a_plain_program_says() {
    const SIDE: u32 = 96;
    let mut renderer = spying();
    for elevation_deg in [60.0, 25.0] {
        for scale in [None, Some(BOX), Some(STEP)] {
            for iterations in [1, 2, 3, 6] {
                let choice = choice()
                    .with(&PHOTONS_PER_SIDE, SIDE)
                    .with(&ITERATIONS, iterations);
                let prepared =
                    Prepared::new(with(pool(elevation_deg, scale, SIDE), &choice)).unwrap();
                let found = spied(&mut renderer, &prepared);
                let plain = Plain::new(prepared.facts(), &box_of(scale), SIDE, 256);
                let mut off = 0;
                let mut ended = 0;
                for (index, found) in found.iter().enumerate() {
                    let due = plain.photon(index as u32, iterations);
                    let uv = plain.map_place(due.at);
                    let is_on_map =
                        uv.cmpge(DVec2::ZERO).all() && uv.cmplt(DVec2::splat(256.0)).all();
                    let due = if is_on_map {
                        [uv.x, uv.y, due.path_m]
                    } else {
                        [0.0; 3]
                    };
                    ended += u32::from(is_on_map);
                    // Texels, and m: f32 over some metres.
                    let differs = (0..3).any(|k| (found[k] - due[k]).abs() > 5e-3);
                    off += u32::from(differs);
                }
                let share = f64::from(off) / f64::from(SIDE * SIDE);
                println!(
                    "{elevation_deg}°, box {scale:?}, {iterations} steps: {ended} photons end on the map, {off} differ"
                );
                assert!(ended > SIDE * SIDE / 5, "{ended}");
                // Rounding decides between two texels of the view at a silhouette.
                let most = if scale.is_none() { 1e-3 } else { 1e-2 };
                assert!(share <= most, "{share}");
            }
        }
    }
}

#[test]
fn flat_water_is_even() {
    for elevation_deg in [60.0, 20.0] {
        let mut scene = pool(elevation_deg, None, 128);
        scene["water"]["waves"] = json!([]);
        let resolved = with(scene, &choice());
        let map = Map::from(&resolved);
        let worst = map
            .texels
            .iter()
            .map(|t| (t[0] / map.mean(0) - 1.0).abs())
            .fold(0.0, harness::nan_fails);
        println!("{elevation_deg}°: texels within {worst:.1e} of their mean");
        assert!(worst <= 1e-4, "{worst:e}");
        assert!(map.closure() <= 1e-6, "{:e}", map.closure());
    }
}

fn sine_pool_with(choice: &MethodChoice) -> ResolvedScene {
    let mut resolved = scene_files::load("sine_pool", &[]);
    resolved.scene.quality.method = methods::shortest(choice);
    resolved
}

fn error_on_sine_pool(values: &[[f64; 3]]) -> f64 {
    metrics::relative_l1(
        values.as_flattened(),
        sine_pool::truth().irradiance.as_flattened(),
    )
    .unwrap()
}

/// The error is the paper's own, not this program's.
#[test]
fn the_error_is_that_of_the_plain_program() {
    for photons in [128, 256, 512] {
        let resolved = sine_pool_with(&choice().with(&PHOTONS_PER_SIDE, photons));
        let prepared = Prepared::new(resolved.clone()).unwrap();
        let plain = Plain::new(prepared.facts(), &[], photons, 256);
        let due = plain.floor(&plain.caustics(3));
        let map = Map::from(&resolved);
        let [found, due_error] = [&map.texels, &due].map(|texels| error_on_sine_pool(texels));
        let apart = metrics::relative_l1(map.values(), due.as_flattened()).unwrap();
        println!(
            "{photons}² photons: error {found:.4}, of the plain program {due_error:.4}; {apart:.1e} apart"
        );
        assert!(
            (found - due_error).abs() <= 0.2 * due_error,
            "{found} {due_error}"
        );
        assert!(apart <= 0.02, "{apart}");
    }
}

/// Light's map and output have the same texels, so that what is left is the noise of photons per texel.
#[test]
fn noise_falls_with_the_photons() {
    let error_at = |photons: u32| {
        let map = Map::from(&sine_pool_with(&choice().with(&PHOTONS_PER_SIDE, photons)));
        error_on_sine_pool(&map.texels)
    };
    let points = [512, 1024, 2048].map(|n| (f64::from(n), error_at(n)));
    let order = convergence_order(&points);
    println!("{points:?}, order {order:.2} by photons per side");
    // Between 1, for texels whose count of rows and columns is off by one, and 2, for counts that are off at random.
    assert!((1.2..1.8).contains(&order), "{order} from {points:?}");
    assert!(points[2].1 <= 0.03, "{points:?}");
}

/// One photon per texel: the grids of photons and of texels beat. That is the paper's own setting.
#[test]
fn one_photon_per_texel_beats_with_the_texels() {
    let map = Map::from(&sine_pool_with(&choice().with(&LOOKUP, "nearest")));
    let empty = map.texels.iter().filter(|t| t[0] == 0.0).count();
    let share = empty as f64 / map.texels.len() as f64;
    let error = error_on_sine_pool(&map.texels);
    println!("256² photons on 256² texels: {share:.3} of the texels are empty, error {error:.3}");
    assert!(share > 0.05, "{share}: no longer what the documents say");
    let more = Map::from(&sine_pool_with(
        &choice()
            .with(&LOOKUP, "nearest")
            .with(&PHOTONS_PER_SIDE, 1024_u32),
    ));
    let empty = more.texels.iter().filter(|t| t[0] == 0.0).count();
    assert_eq!(empty, 0);
}

/// Where the search in image space ends otherwise than a true intersection, by the number of its steps.
#[test]
fn the_search_errs_at_steps_and_boxes() {
    const SIDE: u32 = 128;
    let mut renderer = spying();
    for scale in [None, Some(STEP), Some(BOX)] {
        let mut at = |search: &str, iterations: u32| {
            let choice = choice()
                .with(&PHOTONS_PER_SIDE, SIDE)
                .with(&SEARCH, search)
                .with(&ITERATIONS, iterations);
            let prepared = Prepared::new(with(pool(45.0, scale, SIDE), &choice)).unwrap();
            spied(&mut renderer, &prepared)
        };
        let exact = at(EXACT, 1);
        let mut shares = Vec::new();
        for iterations in [1, 2, 3, 5, 8, 16] {
            let found = at("image_space", iterations);
            let off = found
                .iter()
                .zip(&exact)
                .filter(|(a, b)| (a[0] - b[0]).abs() > 1.0 || (a[1] - b[1]).abs() > 1.0);
            shares.push(off.count() as f64 / f64::from(SIDE * SIDE));
        }
        println!("{scale:?}: off by more than a texel after 1, 2, 3, 5, 8, 16 steps: {shares:.4?}");
        assert!(shares[0] > 0.5, "one step cannot be right: {shares:?}");
        if scale.is_none() {
            assert!(shares[1..].iter().all(|share| *share == 0.0), "{shares:?}");
        } else {
            // Most of these ends are hidden from the view, and no search in it finds them.
            assert!(shares[2] > 0.0 && shares[2] < 0.3, "{shares:?}");
            assert!(shares[4] <= shares[1], "{shares:?}");
        }
    }
}

fn relative_difference(a: &Map, b: &Map) -> f64 {
    metrics::relative_l1(a.values(), b.values()).unwrap()
}

/// Integers, drawn points, and integers where points cannot be blended.
#[test]
fn sums_are_the_same_however_they_are_made() {
    let scene = pool(50.0, Some(BOX), 128);
    let render = |deposit: &str, blends: bool| {
        let resolved = with(scene.clone(), &choice().with(&DEPOSIT, deposit));
        let prepared = Prepared::new(resolved).unwrap();
        let prepared = prepared.with_facts(|facts| facts.blends_float32 = blends);
        let mut renderer = harness::renderer();
        let frame = renderer.render_prepared(&prepared, &CancellationToken::new());
        renderer.gpu().check().unwrap();
        let frame = frame.unwrap_or_else(|error| panic!("{error}"));
        let texels = harness::layer(&frame, LayerName::Irradiance);
        Map { frame, texels }
    };
    let integers = render("atomic", true);
    let drawn = render(DRAWN, true);
    let fallback = render(DRAWN, false);
    let runs = |map: &Map, name: &str| map.stats.passes.iter().any(|pass| pass.name == name);
    if harness::renderer().gpu().blends_float32 {
        assert!(runs(&drawn, "photon_draw") && !runs(&drawn, "photon_sums"));
    }
    let apart = relative_difference(&drawn, &integers);
    println!("drawn points and integers are {apart:.1e} apart");
    assert!(apart <= 1e-6, "{apart:e}");
    assert_eq!(fallback.frame.layers, integers.frame.layers);
    let passes = &fallback.stats.passes;
    let sums = passes
        .iter()
        .find(|pass| pass.name == "photon_sums")
        .unwrap();
    assert!(sums.reason.contains("cannot blend"), "{}", sums.reason);
    assert_eq!(
        fallback.stats.memory.peak_bytes,
        fallback.stats.memory.planned_peak_bytes
    );
}

/// Each sun has a map of its own: together they give what they give alone.
#[test]
fn several_suns_add_up() {
    let suns = [
        json!({ "kind": "sun", "elevation_deg": 55, "azimuth_deg": 20, "irradiance_w_m2": [100, 90, 80] }),
        json!({ "kind": "sun", "elevation_deg": 40, "azimuth_deg": 200, "irradiance_w_m2": [10, 20, 30] }),
        json!({ "kind": "sun", "elevation_deg": 80, "azimuth_deg": 100, "irradiance_w_m2": [5, 5, 50] }),
    ];
    for output in [
        pool(1.0, None, 96)["output"].clone(),
        json!({ "kind": "view", "width": 64, "height": 48, "layers": ["irradiance"], "format": "exr" }),
    ] {
        let render = |lights: &[Value]| {
            let mut scene = pool(1.0, Some(BOX), 96);
            scene["lights"] = json!(lights);
            scene["output"] = output.clone();
            scene["camera"] = json!({ "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0] });
            Map::from(&with(scene, &choice().with(&PHOTONS_PER_SIDE, 512_u32)))
        };
        let together = render(&suns);
        let each = [0, 1, 2].map(|k| render(&suns[k..=k]));
        for (at, texel) in together.texels.iter().enumerate() {
            for c in 0..3 {
                let sum: f64 = each.iter().map(|map| map.texels[at][c]).sum();
                assert!(
                    (texel[c] - sum).abs() <= 1e-5 * sum.max(1.0),
                    "{at}: {texel:?} {sum}"
                );
            }
        }
        assert!(together.mean(2) > 10.0, "{}", together.mean(2));
    }
}

/// What the box hides is dark, and what is lost is reported with its flux.
#[test]
fn what_is_hidden_or_lost_is_reported() {
    let map = Map::from(&with(pool(45.0, Some(BOX), 128), &choice()));
    let codes = |map: &Map| -> Vec<String> {
        let warnings = map.stats.warnings.iter();
        warnings.map(|warning| warning.code.clone()).collect()
    };
    let of = |map: &Map, code: &str| -> [f64; 3] {
        let mut warnings = map.stats.warnings.iter();
        let found = warnings.find(|warning| warning.code == code);
        found
            .and_then(|w| w.flux_w)
            .unwrap_or_else(|| panic!("{code} is not in {:?}", codes(map)))
    };
    let emitted_w = map.stats.energy[0].emitted_w;
    for code in ["rays_end_out_of_view", "method_does_not_conserve"] {
        let flux_w = of(&map, code);
        for c in 0..3 {
            let share = flux_w[c].abs() / emitted_w[c];
            assert!(share > 1e-3 && share < 0.2, "{code}: {share}");
        }
    }
    // A true intersection is out of the view only where it is hidden from the light's rays in the air.
    let exact = Map::from(&with(
        pool(45.0, Some(BOX), 128),
        &choice().with(&SEARCH, EXACT),
    ));
    let more = Map::from(&with(
        pool(45.0, Some(BOX), 128),
        &choice().with(&ITERATIONS, 8_u32),
    ));
    let shares = [&exact, &map, &more].map(|map| of(map, "rays_end_out_of_view")[0] / emitted_w[0]);
    println!(
        "out of the view: {:.4} of the flux with true intersections, {:.4} after 3 steps, {:.4} after 8",
        shares[0], shares[1], shares[2]
    );
    assert!(
        shares[0] > 1e-3 && shares[1] < 3.0 * shares[0],
        "{shares:?}"
    );
    // The floor under the middle of the box.
    let middle = map.texels[64 * 128 + 64];
    assert_eq!(middle, [0.0; 3]);
    // A single step ends off the floor nearly everywhere; nothing is traced again because of that.
    let coarse = Map::from(&with(
        pool(45.0, None, 128),
        &choice().with(&ITERATIONS, 1_u32),
    ));
    assert!(of(&coarse, "rays_end_out_of_view")[0] > 0.5 * coarse.stats.energy[0].landed_w[0]);
    assert!(!codes(&coarse).contains(&"sums_done_again".to_owned()));
    // Two steps find any floor.
    let fine = Map::from(&with(
        pool(45.0, None, 128),
        &choice().with(&ITERATIONS, 2_u32),
    ));
    assert!(
        !codes(&fine).contains(&"rays_end_out_of_view".to_owned()),
        "{:?}",
        codes(&fine)
    );
    assert!(fine.closure() <= 1e-6, "{:e}", fine.closure());
}

#[test]
fn lamps_are_refused_with_a_reason() {
    let mut scene = pool(45.0, None, 64);
    let lamp = json!({ "kind": "point", "position_m": [0, 2, 0], "intensity_w_sr": [10, 10, 10] });
    scene["lights"].as_array_mut().unwrap().push(lamp);
    let resolved = with(scene, &choice());
    let reason = methods::reason_against(&resolved).unwrap().unwrap();
    assert!(
        reason.contains("orthographic") && reason.contains("light 1"),
        "{reason}"
    );
}

/// Photons that are too few for the waves are warned of at the dial that helps.
#[test]
fn too_few_photons_for_the_waves_are_warned_of() {
    let choice = choice()
        .with(&PHOTONS_PER_SIDE, 16_u32)
        .with(&MAP_TEXELS, 64_u32);
    let prepared = Prepared::new(with(pool(45.0, None, 64), &choice)).unwrap();
    let mut warnings = prepared.facts().warnings.iter();
    let found = warnings.find(|w| w.code == "waves_undersampled").unwrap();
    assert_eq!(found.pointer.as_deref(), Some("/quality/method/photons"));
}
