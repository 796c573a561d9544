//! Figures that stand in Rust and in WGSL are the same, and dispatches cover their work.

use caustica::facts::{MOST_LIGHTS, SceneFacts};
use caustica::gpu::shader::Module;
use caustica::passes::camera_hits::MARCH_UNFINISHED;
use caustica::passes::desc::{Run, Step};
use caustica::passes::maps::{self, MapLayout};
use caustica::passes::{
    self, Groups, PassDesc, Repeat, Work, depth_profile, estimate, landed, level_map, slot, term,
};
use caustica::scene::ranges::{self, Integer as _};
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
    let most_samples = ranges::PixelSamples::MAX.pow(2) as f32;
    assert!(most_samples < MARCH_UNFINISHED);
    let most = most_samples * (MARCH_UNFINISHED + 1.0);
    assert!(most < (1_u32 << f32::MANTISSA_DIGITS) as f32);
}

#[test]
fn terms_of_the_energy_account_agree() {
    agrees("TERM_EMITTED", term::EMITTED as f64);
    agrees("TERM_REFLECTED", term::REFLECTED as f64);
    agrees("TERM_MISSED", term::MISSED as f64);
    agrees("TERM_EXTINGUISHED", term::EXTINGUISHED as f64);
    agrees("TERM_LEFT", term::LEFT as f64);
    agrees("TERM_LANDED", term::LANDED as f64);
    agrees("TERM_TORN", term::TORN as f64);
    agrees("TERM_TORN_COUNT", term::TORN_COUNT as f64);
    agrees("TERM_CUT", term::CUT as f64);
    agrees("TERM_TURNED", term::TURNED as f64);
    agrees("TERM_AGAIN", term::AGAIN as f64);
    agrees("TERM_BARED", term::BARED as f64);
    assert!((term::BARED as u64) < slot::ENERGY_TERMS);
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
        (term::TORN, 1),
        (term::TORN_COUNT, 1),
        (term::CUT, 1),
    ];
    for pair in places.windows(2) {
        assert_eq!(pair[0].0 + pair[0].1, pair[1].0);
    }
}

#[test]
fn a_workgroups_account_holds_what_it_notes() {
    let module = module("passes/deposit.wgsl");
    let places = array_length(&module, "account");
    assert_eq!(places, term::LANDED + 3, "terms up to what lands");
}

#[test]
fn figures_of_queues_and_maps_agree() {
    agrees("MOST_GROUPS", f64::from(slot::MOST_GROUPS));
    agrees("QUEUE_HEAD", slot::QUEUE_HEAD_WORDS as f64);
    agrees("QUEUE_COUNT", slot::QUEUE_HEAD_WORDS as f64 - 1.0);
    agrees("SPLIT_HEAD", slot::SPLIT_HEAD_WORDS as f64);
    agrees("SPLIT_WIDE_SHARE", f64::from(slot::WIDE_GROUPS));
    agrees("SPLIT_WIDE_COUNT", f64::from(slot::SPLIT_WIDE_WORD - 1));
    agrees("SPLIT_WIDE_GROUPS", f64::from(slot::SPLIT_WIDE_WORD));
    agrees("CULL_HEAD", slot::CULL_HEAD_WORDS as f64);
    agrees("LIST_HEAD", slot::PLANE_LIST_HEAD_WORDS as f64);
    agrees("TILE", f64::from(slot::PLANE_TILE_TEXELS));
    agrees("WIDE_GROUPS", f64::from(slot::WIDE_GROUPS));
    agrees("MOST_CULL_GROUPS", f64::from(slot::MOST_GROUPS));
    agrees("MOST_PLANES", f64::from(ranges::Planes::MAX));
    let profile = module("passes/depth_profile.wgsl");
    let each = constant(&profile, "TEXELS_EACH").unwrap() as u32;
    let side = size(&profile, "profile_count")[0];
    assert_eq!(each * side, depth_profile::TEXELS_PER_GROUP);
    let estimate = module("passes/estimate.wgsl");
    let each = constant(&estimate, "PLACES_EACH").unwrap() as u32;
    let side = size(&estimate, "estimate_main")[0];
    assert_eq!(each * side, estimate::PLACES_PER_GROUP);
    agrees("NOWHERE", f64::from(maps::NOWHERE));
    agrees("EMPTY_DEPTH", level_map::EMPTY_DEPTH);
    let camera = module("passes/camera_irradiance.wgsl");
    assert_eq!(array_length(&camera, "air_lights"), MOST_LIGHTS);
    assert!(caustica::config::Limits::default().max_lights <= MOST_LIGHTS);
    let landed_module = module("passes/landed.wgsl");
    let each = constant(&landed_module, "TEXELS_EACH").unwrap() as u32;
    let side = array_length(&landed_module, "sums") as u32;
    assert_eq!(each * side, landed::TEXELS_PER_GROUP);
    assert_eq!(size(&landed_module, "landed_main"), [side, 1, 1]);
}

#[test]
fn receivers_have_the_size_that_slots_reckon_with() {
    let size_of = |name: &str| {
        passes::gpu_data::LAYOUTS
            .iter()
            .find(|(wgsl, _, _)| *wgsl == name)
            .map(|(_, size, _)| *size as u64)
    };
    let facts = facts();
    assert_eq!(
        size_of("Receiver").map(|bytes| 2 * bytes),
        Some(slot::Slot::Receivers.bytes(&facts)),
        "the floor and one object"
    );
    let waves = facts.surface.components.len() as u64;
    assert_eq!(
        Some(slot::Slot::Waves.bytes(&facts) / waves),
        size_of("Wave")
    );
    let objects = facts.objects.len() as u64;
    assert_eq!(
        Some(slot::Slot::Instances.bytes(&facts) / objects),
        size_of("Instance")
    );
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
    let resolved = scene_files::scene(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 1.1 }] },
        "floor": { "depth_m": 2, "size_m": [9, 7] },
        "lights": [{ "kind": "sun", "elevation_deg": 50, "irradiance_w_m2": [1, 1, 1] }],
        "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0] }],
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] },
        "quality": { "water_cells": 131, "map_texels": 333, "level_map_texels": 64, "slicing": "smart", "planes": 7 },
        "output": { "kind": "view", "width": 101, "height": 67 }
    }));
    SceneFacts::of(&resolved).unwrap()
}

/// (workgroups × size of one, invocations needed) of the first step of a pass, as plain products.
fn check_cover(pass: &PassDesc, facts: &SceneFacts, run: Run<'_>, tile: [u32; 2], needs: [u32; 2]) {
    let module = module(&format!("passes/{}.wgsl", pass.name));
    let steps = (pass.steps)(facts, run);
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
        let Groups::Direct([x, y, z]) = slot::in_columns(groups) else {
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
    let light = Run::Light {
        index: 0,
        wide_sums: false,
    };
    for pass in [
        &passes::surface::PASS,
        &passes::beams::PASS,
        &passes::hits::PASS,
    ] {
        // Vertices row by row, without a gap.
        check_cover(pass, &facts, light, [64, 1], [132 * 132, 1]);
    }
    check_cover(&passes::deposit::PASS, &facts, light, [8, 8], [131, 131]);
    let maps = MapLayout::of(&facts);
    assert_eq!(maps.flux_texels(), floor_texels(&facts) + 64 * 64);
    let band = Run::Band {
        first_row: 0,
        rows: 67,
        offset: [0.0; 2],
        sample_index: 0,
    };
    for pass in passes::ALL.iter().filter(|p| p.repeat == Repeat::Band) {
        check_cover(pass, &facts, band, [8, 8], [101, 67]);
    }
}

fn floor_texels(facts: &SceneFacts) -> u64 {
    let map = facts.floor_map.unwrap();
    u64::from(map.width) * u64::from(map.height)
}

#[test]
fn sums_over_texels_cover_all_of_them() {
    let facts = facts();
    let light = Run::Light {
        index: 0,
        wide_sums: false,
    };
    let groups = |work: Work| match work {
        Work::Compute(Groups::Direct(groups)) => groups.iter().product::<u32>(),
        _ => panic!("no dispatch"),
    };
    let landed = (landed::PASS.steps)(&facts, light);
    let maps = MapLayout::of(&facts);
    let needed = maps
        .flux_texels()
        .div_ceil(u64::from(landed::TEXELS_PER_GROUP));
    assert_eq!(u64::from(groups(landed[0].work)), needed);
    let side = size(&module("passes/irradiance.wgsl"), "irradiance_main")[0];
    let irradiance = (passes::irradiance::PASS.steps)(&facts, light);
    assert_eq!(irradiance.len(), 2, "the floor and one object");
    let texels = [floor_texels(&facts), 64 * 64];
    for (step, texels) in irradiance.iter().zip(texels) {
        assert!(u64::from(groups(step.work) * side) >= texels);
    }
}

/// What a pass runs in a scene with everything in it.
pub(crate) fn steps_of(pass: &PassDesc) -> Vec<Step> {
    let facts = facts();
    let mut level_box = facts.lights[0].boxes[0].clone().unwrap();
    level_box.key.layers = 2;
    let run = match pass.repeat {
        Repeat::LevelMap => Run::LevelMap {
            level_box: &level_box,
            arena_offset: 0,
            first_triangle: 0,
            triangles: 12,
        },
        Repeat::Light | Repeat::FineLight => Run::Light {
            index: 0,
            wide_sums: false,
        },
        Repeat::CoarseLight => Run::CoarseLight {
            index: 0,
            wide_sums: false,
            fine: &facts,
        },
        Repeat::Frame => Run::Frame,
        Repeat::Band => Run::Band {
            first_row: 0,
            rows: 67,
            offset: [0.0; 2],
            sample_index: 0,
        },
    };
    (pass.steps)(&facts, run)
}

#[test]
fn every_entry_point_is_run_by_a_step() {
    for pass in passes::ALL {
        let module = module(&format!("passes/{}.wgsl", pass.name));
        let steps = steps_of(pass);
        for entry in &module.ir.entry_points {
            let run = steps.iter().any(|step| step.entry == entry.name);
            let drawn = entry.stage == naga::ShaderStage::Fragment;
            assert!(run || drawn, "{} of {}", entry.name, pass.name);
        }
        for step in &steps {
            let found = module.bindings(pass.name, step.entry).unwrap();
            for (name, bytes) in &step.uniforms {
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
}

#[test]
fn buffers_hold_at_least_one_element() {
    // Lists may be empty; what is bound must not be.
    let resolved = scene_files::scene(json!({
        "floor": { "depth_m": 2, "size_m": [9, 7] },
        "camera": { "position_m": [0, 3, 2], "target_m": [0, -1, 0] }
    }));
    let facts = SceneFacts::of(&resolved).unwrap();
    for (path, module) in pass_modules() {
        for (_, variable) in module.ir.global_variables.iter() {
            let Some(slot) = variable.name.as_deref().and_then(slot::Slot::by_name) else {
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
