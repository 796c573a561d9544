//! Constants in Rust and in WGSL are equal, and dispatches cover their work.

use caustica::facts::{MOST_LIGHTS, SceneFacts, WaterMapFacts};
use caustica::frame::FAR_DEPTH_M;
use caustica::gpu::shader::Module;
use caustica::graph::{BandRun, BeamSetRun, Scope};
use caustica::methods::planes::depth_profile;
use caustica::methods::reference_planes::MOST_PLANES;
use caustica::methods::{self, Method};
use caustica::scene::{DialKind, MethodChoice};
use caustica::stages::camera_hits::{CUT_OFF, MARCH_UNFINISHED, OUTSIDE_MAP};
use caustica::stages::level_map::LevelMapRun;
use caustica::stages::maps::{self, MapLayout};
use caustica::stages::{
    self, Groups, Pass, Run, Work, estimate, landed, level_map, queues, reference_planes, split,
    sums, term,
};
use serde_json::json;
use wgpu::naga::{self, Expression, Literal, TypeInner};

use super::scene_files;
use super::shaders::{module, pass_modules};

fn constant(module: &Module, name: &str) -> Option<f64> {
    let (_, found) = module
        .ir
        .constants
        .iter()
        .find(|(_, constant)| constant.name.as_deref() == Some(name))?;
    match module.ir.global_expressions[found.init] {
        Expression::Literal(Literal::U32(v)) => Some(f64::from(v)),
        Expression::Literal(Literal::I32(v)) => Some(f64::from(v)),
        Expression::Literal(Literal::F32(v)) => Some(f64::from(v)),
        _ => None,
    }
}

/// Compares a constant in every module that has it; some must.
fn agrees(name: &str, expected: f64) {
    let mut seen = 0;
    for (path, module) in pass_modules() {
        if let Some(found) = constant(&module, name) {
            assert_eq!(found as f32, expected as f32, "{name} in {path}");
            seen += 1;
        }
    }
    assert!(seen > 0, "no shader has {name}");
}

#[test]
fn notes_of_pixels_agree_and_stay_apart() {
    agrees("MARCH_UNFINISHED", f64::from(MARCH_UNFINISHED));
    agrees("FAR_DEPTH_M", f64::from(FAR_DEPTH_M));
    agrees("OUTSIDE_MAP", f64::from(OUTSIDE_MAP));
    agrees("CUT_OFF", f64::from(CUT_OFF));
    assert_eq!(
        OUTSIDE_MAP | MARCH_UNFINISHED | CUT_OFF,
        7,
        "bits of their own"
    );
}

#[test]
fn terms_of_the_energy_account_agree() {
    agrees("TERM_EMITTED", term::EMITTED as f64);
    agrees("TERM_REFLECTED", term::REFLECTED as f64);
    agrees("TERM_MISSED", term::MISSED as f64);
    agrees("TERM_EXTINGUISHED", term::EXTINGUISHED as f64);
    agrees("TERM_LEFT", term::LEFT as f64);
    agrees("TERM_LANDED", term::LANDED as f64);
    agrees("TERM_UNRESOLVED", term::UNRESOLVED as f64);
    agrees("TERM_UNRESOLVED_COUNT", term::UNRESOLVED_COUNT as f64);
    agrees("TERM_CUT", term::CUT as f64);
    agrees("TERM_FACING_AWAY", term::FACING_AWAY as f64);
    agrees("TERM_LEAVING_AGAIN", term::LEAVING_AGAIN as f64);
    agrees("TERM_BARED_FLOOR", term::BARED_FLOOR as f64);
    assert!((term::BARED_FLOOR as u64) < sums::ENERGY_TERMS);
}

#[test]
fn terms_do_not_overlap() {
    let places = [
        (term::EMITTED, 1),
        (term::REFLECTED, 1),
        (term::MISSED, 1),
        (term::EXTINGUISHED, 3),
        (term::LEFT, 3),
        (term::LANDED, 3),
        (term::UNRESOLVED, 1),
        (term::UNRESOLVED_COUNT, 1),
        (term::CUT, 1),
    ];
    for pair in places.windows(2) {
        assert_eq!(pair[0].0 + pair[0].1, pair[1].0);
    }
}

#[test]
fn a_workgroups_account_holds_what_it_notes() {
    let module = module("stages/deposit.wgsl");
    let places = array_length(&module, "account");
    assert_eq!(places, term::LANDED + 3, "terms up to what lands");
}

#[test]
fn figures_of_queues_and_maps_agree() {
    agrees("MOST_GROUPS", f64::from(queues::MOST_GROUPS));
    agrees("QUEUE_HEAD", queues::QUEUE_HEAD_WORDS as f64);
    agrees("QUEUE_COUNT", queues::QUEUE_HEAD_WORDS as f64 - 1.0);
    agrees("SPLIT_HEAD", split::SPLIT_HEAD_WORDS as f64);
    agrees("SPLIT_WIDE_SHARE", f64::from(queues::WIDE_GROUPS));
    agrees("SPLIT_WIDE_COUNT", f64::from(split::SPLIT_WIDE_WORD - 1));
    agrees("SPLIT_WIDE_GROUPS", f64::from(split::SPLIT_WIDE_WORD));
    agrees("CULL_HEAD", reference_planes::CULL_HEAD_WORDS as f64);
    agrees("LIST_HEAD", reference_planes::PLANE_LIST_HEAD_WORDS as f64);
    agrees("TILE", f64::from(reference_planes::PLANE_TILE_TEXELS));
    agrees("WIDE_GROUPS", f64::from(queues::WIDE_GROUPS));
    agrees("MOST_CULL_GROUPS", f64::from(queues::MOST_GROUPS));
    agrees("MOST_PLANES", f64::from(MOST_PLANES));
    let profile = module("methods/planes/depth_profile.wgsl");
    let each = constant(&profile, "TEXELS_EACH").unwrap() as u32;
    let side = size(&profile, "profile_count")[0];
    assert_eq!(each * side, depth_profile::TEXELS_PER_GROUP);
    let estimate = module("stages/estimate.wgsl");
    let each = constant(&estimate, "PLACES_EACH").unwrap() as u32;
    let side = size(&estimate, "estimate_main")[0];
    assert_eq!(each * side, estimate::PLACES_PER_GROUP);
    agrees("NOWHERE", f64::from(maps::NOWHERE));
    agrees("EMPTY_DEPTH", level_map::EMPTY_DEPTH);
    let camera = module("stages/camera_irradiance.wgsl");
    assert_eq!(array_length(&camera, "air_lights"), MOST_LIGHTS);
    assert!(caustica::config::Limits::default().max_lights <= MOST_LIGHTS);
    let landed_module = module("stages/landed.wgsl");
    let each = constant(&landed_module, "TEXELS_EACH").unwrap() as u32;
    let side = array_length(&landed_module, "sums") as u32;
    assert_eq!(each * side, landed::TEXELS_PER_GROUP);
    assert_eq!(size(&landed_module, "landed_main"), [side, 1, 1]);
}

/// The sizes of slots whose elements are structs are whole numbers of them.
#[test]
fn slots_hold_whole_structs() {
    let facts = facts();
    let mut seen = 0;
    for pass in methods::all_passes() {
        for slot in pass.slots() {
            let Some((name, size, _)) = slot.element else {
                continue;
            };
            let bytes = slot.bytes(&facts);
            assert!(bytes > 0, "{slot:?} of {name}");
            assert_eq!(bytes % size as u64, 0, "{slot:?} of {name}");
            seen += 1;
        }
    }
    assert!(seen > 5, "{seen}");
    let receiver = size_of::<stages::receivers::Receiver>() as u64;
    let receivers = stages::receivers::RECEIVERS.bytes(&facts);
    assert_eq!(receivers, 2 * receiver, "the floor and one object");
}

fn array_length(module: &Module, variable: &str) -> usize {
    let (_, found) = module
        .ir
        .global_variables
        .iter()
        .find(|(_, v)| v.name.as_deref() == Some(variable))
        .unwrap_or_else(|| panic!("no `{variable}`"));
    match module.ir.types[found.ty].inner {
        TypeInner::Array {
            size: naga::ArraySize::Constant(n),
            ..
        } => n.get() as usize,
        _ => panic!("`{variable}` is no array of fixed length"),
    }
}

fn size(module: &Module, entry: &str) -> [u32; 3] {
    let found = module.ir.entry_points.iter().find(|e| e.name == entry);
    found
        .unwrap_or_else(|| panic!("no `{entry}`"))
        .workgroup_size
}

/// Odd sizes everywhere: whoever divides by the wrong number is found out.
fn facts() -> SceneFacts {
    facts_with(methods::ALL[0])
}

/// The same scene with any method, its dials off their defaults.
fn facts_with(method: &Method) -> SceneFacts {
    facts_with_words(method, usize::MAX)
}

/// The same, with the word of this number, or the last, for each dial that has words.
fn facts_with_words(method: &Method, number: usize) -> SceneFacts {
    let mut choice = MethodChoice::named(method.name);
    for dial in method.dials {
        choice = match dial.kind {
            DialKind::Integer { least, most, .. } => choice.with(dial, 7_u32.clamp(least, most)),
            DialKind::Number { least, most, .. } => choice.with(dial, 0.7 * least + 0.3 * most),
            DialKind::Word { words, .. } => {
                choice.with(dial, words[number.min(words.len() - 1)].name)
            }
        };
    }
    let resolved = scene_files::scene(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.1 }] },
        "floor": { "depth_m": 2, "size_m": [9, 7] },
        "lights": [{ "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0] }],
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 131, "map_texels": 333, "level_map_texels": 64, "method": choice },
        "output": { "kind": "view", "width": 101, "height": 67 }
    }));
    let facts = (method.facts)(&resolved.scene.quality);
    let mut facts = SceneFacts::of(&resolved, facts).unwrap();
    // No scene has two outputs; here every pass has work.
    facts.output.water_map = Some(WaterMapFacts {
        rect: facts.receivers.floor.as_ref().unwrap().rect,
        width: 101,
        height: 67,
    });
    facts
}

/// A beam set with narrow sums.
const SET: BeamSetRun = BeamSetRun {
    index: 0,
    wide_sums: false,
};

/// The band of the whole picture of [`facts`].
const BAND: BandRun = BandRun {
    first_row: 0,
    rows: 67,
    offset: [0.0; 2],
    sample_index: 0,
    leg: 0,
};

/// (workgroups × size of one, invocations needed) of the first step of a pass, as plain products.
fn check_cover(pass: &Pass, facts: &SceneFacts, run: Run<'_>, tile: [u32; 2], needs: [u32; 2]) {
    let module = module(pass.shader);
    let steps = pass.steps.of(facts, run).unwrap();
    assert!(!steps.is_empty(), "{}", pass.name);
    let Work::Compute(Groups::Direct(groups)) = steps[0].work else {
        panic!("{} does not dispatch", pass.name);
    };
    let size = size(&module, steps[0].entry);
    assert_eq!(
        size.iter().product::<u32>(),
        tile[0] * tile[1],
        "{}",
        pass.name
    );
    for axis in 0..2 {
        let covered = groups[axis] * tile[axis];
        assert!(
            covered >= needs[axis],
            "{}: {covered} on axis {axis}",
            pass.name
        );
        assert!(
            covered < needs[axis] + tile[axis],
            "{}: {covered}",
            pass.name
        );
    }
    assert_eq!(groups[2], 1);
}

#[test]
fn long_rows_of_workgroups_are_folded_evenly() {
    for groups in [
        0, 1, 65_534, 65_535, 65_536, 65_601, 131_070, 131_071, 4_000_000,
    ] {
        let Groups::Direct([x, y, z]) = queues::in_columns(groups) else {
            panic!("no fixed number");
        };
        assert!(x <= 65_535 && y <= 65_535 && z == 1, "{groups}");
        assert!(
            x * y >= groups && x * y < groups.max(1) + y,
            "{groups}: {x} × {y}"
        );
    }
}

#[test]
fn dispatches_cover_their_work() {
    let facts = facts();
    let set = Run::BeamSet(SET);
    for pass in [
        &stages::surface::PASS,
        &stages::beams::PASS,
        &stages::hits::PASS,
    ] {
        // Vertices row by row, without a gap.
        check_cover(pass, &facts, set, [64, 1], [132 * 132, 1]);
    }
    check_cover(&stages::deposit::PASS, &facts, set, [8, 8], [131, 131]);
    let maps = MapLayout::of(&facts);
    assert_eq!(maps.flux_texels(), floor_texels(&facts) + 64 * 64);
    let mut seen = 0;
    for pass in methods::all_passes() {
        if pass.steps.scope() == Scope::Band {
            check_cover(pass, &facts, Run::Band(BAND), [8, 8], [101, 67]);
            seen += 1;
        }
    }
    assert!(seen >= 5, "{seen}");
}

fn floor_texels(facts: &SceneFacts) -> u64 {
    let map = facts.receivers.floor_map.unwrap();
    u64::from(map.width) * u64::from(map.height)
}

#[test]
fn sums_over_texels_cover_all_of_them() {
    let facts = facts();
    let groups = |work: &Work| match work {
        Work::Compute(Groups::Direct(groups)) => groups.iter().product::<u32>(),
        _ => panic!("no dispatch"),
    };
    let landed = landed::PASS.steps.of(&facts, Run::BeamSet(SET)).unwrap();
    let maps = MapLayout::of(&facts);
    let needed = maps
        .flux_texels()
        .div_ceil(u64::from(landed::TEXELS_PER_GROUP));
    assert_eq!(u64::from(groups(&landed[0].work)), needed);
    let side = size(&module("stages/irradiance.wgsl"), "irradiance_main")[0];
    let irradiance = &stages::irradiance::PASS.steps;
    let irradiance = irradiance.of(&facts, Run::BeamSet(SET)).unwrap();
    assert_eq!(irradiance.len(), 2, "the floor and one object");
    let texels = [floor_texels(&facts), 64 * 64];
    for (step, texels) in irradiance.iter().zip(texels) {
        assert!(u64::from(groups(&step.work) * side) >= texels);
    }
}

/// The run of a pass's own scope.
fn own_run<'a>(pass: &Pass, level_map: &'a LevelMapRun, facts: &'a SceneFacts) -> Run<'a> {
    match pass.steps.scope() {
        Scope::Frame => Run::Frame,
        Scope::LevelMap => Run::LevelMap(level_map),
        Scope::BeamSet | Scope::FineBeamSet | Scope::BeamSetMaps => Run::BeamSet(SET),
        Scope::CoarseBeamSet => Run::CoarseBeamSet(SET, facts),
        Scope::Estimate => Run::Estimate,
        Scope::Band => Run::Band(BAND),
        Scope::BandBeamSet => Run::BandBeamSet(BAND, SET),
    }
}

fn a_level_map(facts: &SceneFacts) -> LevelMapRun {
    let mut level_box = facts.lights.lit[0].boxes[0].clone().unwrap();
    level_box.key.layers = 2;
    LevelMapRun {
        level_box,
        arena_offset: 0,
        first_triangle: 0,
        triangles: 12,
    }
}

#[test]
fn every_entry_point_is_run_by_a_step() {
    for method in methods::ALL {
        let words = method.dials.iter().map(|dial| dial.words().len());
        let numbers = 0..words.max().unwrap_or(0).max(1);
        let all: Vec<SceneFacts> = numbers
            .map(|number| facts_with_words(method, number))
            .collect();
        for pass in method.pipeline() {
            let module = module(pass.shader);
            let steps_of = |facts| {
                let level_map = a_level_map(facts);
                let run = own_run(pass, &level_map, facts);
                pass.steps.of(facts, run).unwrap()
            };
            let steps: Vec<stages::Step> = all.iter().flat_map(steps_of).collect();
            check_entries(pass, &module, &steps);
        }
    }
}

/// Steps for another scope are an error and not an empty list.
#[test]
fn steps_of_another_scope_are_an_error() {
    let facts = facts();
    let level_map = a_level_map(&facts);
    let runs = [
        Run::Frame,
        Run::LevelMap(&level_map),
        Run::BeamSet(SET),
        Run::CoarseBeamSet(SET, &facts),
        Run::Estimate,
        Run::Band(BAND),
        Run::BandBeamSet(BAND, SET),
    ];
    for pass in methods::all_passes() {
        let accepted = runs
            .iter()
            .filter(|&&run| pass.steps.of(&facts, run).is_ok());
        assert_eq!(accepted.count(), 1, "{}", pass.name);
    }
    let wrong = stages::surface::PASS.steps.of(&facts, Run::Estimate);
    let wrong = wrong.err().unwrap();
    assert_eq!(
        wrong.to_string(),
        "its scope is BeamSet, but it was run for the estimate"
    );
}

/// Steps run all entry points of the shader, and bring along the uniforms that those bind, as they are declared.
fn check_entries(pass: &Pass, module: &Module, steps: &[stages::Step]) {
    for entry in &module.ir.entry_points {
        let runs = |step: &stages::Step| {
            let draws = match &step.work {
                Work::Draw(draw) => draw.fragment == entry.name,
                Work::Compute(_) => false,
            };
            draws || step.entry == entry.name
        };
        assert!(steps.iter().any(runs), "{} of {}", entry.name, pass.name);
    }
    for step in steps {
        let found = module.bindings(pass.name, step.entry).unwrap();
        for (name, bytes) in &step.uniforms {
            let declared = pass.uniforms.iter().find(|(own, _)| own == name);
            let (_, (_, size, _)) = declared.unwrap_or_else(|| panic!("{name} of {}", pass.name));
            assert_eq!(bytes.len() % size, 0, "{name} of {}", step.entry);
            if let Some(bound) = found.iter().find(|b| b.name == *name) {
                let caustica::gpu::shader::Access::Uniform(size) = bound.access else {
                    panic!("{name} of {} is no uniform", step.entry);
                };
                assert_eq!(bytes.len() as u32, size, "{name} of {}", step.entry);
            }
        }
        for bound in &found {
            if matches!(bound.access, caustica::gpu::shader::Access::Uniform(_)) {
                let brought = step.uniforms.iter().any(|(name, _)| *name == bound.name);
                assert!(brought, "{} of {}", bound.name, step.entry);
            }
        }
    }
}

#[test]
fn buffers_hold_at_least_one_element() {
    // Lists may be empty; what is bound must not be.
    let resolved = scene_files::scene(json!({
        "floor": { "depth_m": 2, "size_m": [9, 7] },
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] }
    }));
    let facts = methods::facts(&resolved).unwrap();
    for pass in methods::all_passes() {
        let (path, module) = (pass.shader, module(pass.shader));
        for (_, variable) in module.ir.global_variables.iter() {
            let slots = pass.slots().collect::<Vec<_>>();
            let named = |slot: &&&stages::Slot| Some(slot.name) == variable.name.as_deref();
            let Some(slot) = slots.iter().find(named) else {
                continue;
            };
            if let TypeInner::Array { stride, .. } = module.ir.types[variable.ty].inner {
                // The planner gives no buffer less than 16 bytes.
                let bytes = slot.bytes(&facts).max(16);
                assert!(
                    bytes >= u64::from(stride),
                    "{slot:?} in {path}: {bytes} bytes"
                );
            }
        }
    }
}
