//! A method that is only in this file: it finds the irradiance at points, once per beam set, from what a pass of its own has made once
//! for the frame. It shows that the executor runs every scope, whoever brings the passes, and that what is found at points makes
//! pictures and maps alike.

use caustica::config::RenderConfig;
use caustica::facts::Product;
use caustica::gpu_struct;
use caustica::graph::Layout;
use caustica::methods;
use caustica::render::{Prepared, Renderer};
use caustica::scene::LayerName;
use caustica::stages::points::{POINT_IRRADIANCE, POINTS, size};
use caustica::stages::surface::wanted_for_light;
use caustica::stages::{self, Groups, Pass, Slot, Step, Steps};
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::{harness, scene_files};

/// What every beam set's power is multiplied by.
static FACTOR: Slot = Slot::buffer("factor", "a factor, 1", |_| 16);

/// Fills [`FACTOR`], once.
static FACTOR_PASS: Pass = Pass {
    name: "factor",
    shader: "methods/own/factor.wgsl",
    reads: &[],
    reads_if_present: &[],
    writes: &[&FACTOR],
    uniforms: &[],
    wanted: wanted_for_light,
    steps: Steps::Frame(|_| {
        vec![Step::compute(
            "factor_main",
            Groups::Direct([1, 1, 1]),
            Vec::new(),
        )]
    }),
    work: |_| 1.0,
};

gpu_struct! {
    /// The uniform of the pass below.
    pub Power = "Power" {
        power: [f32; 4],
        points: u32,
        adds: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

const POWER: Layout = Power::LAYOUT;

/// Gives every point the power of each beam set, times the factor.
static POWER_PASS: Pass = Pass {
    name: "power",
    shader: "methods/own/power.wgsl",
    reads: &[&POINTS, &FACTOR],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[("power", POWER)],
    wanted: wanted_for_light,
    steps: Steps::BandBeamSet(|facts, band, set| {
        let [width, _] = size(facts).unwrap();
        let points = width * band.rows;
        let power = facts.lights.beam_sets[set.index].power.map(|p| p as f32);
        let uniform = Power {
            power: [power[0], power[1], power[2], 0.0],
            points,
            adds: u32::from(set.index > 0),
            pad_0: 0,
            pad_1: 0,
        };
        let uniforms = vec![("power", bytemuck::bytes_of(&uniform).to_vec())];
        let groups = Groups::Direct([points.div_ceil(64), 1, 1]);
        vec![Step::compute("power_main", groups, uniforms)]
    }),
    work: |_| 1.0,
};

const FACTOR_SHADER: &str = "
@group(0) @binding(0) var<storage, read_write> factor: array<f32>;
@compute @workgroup_size(1) fn factor_main() { factor[0] = 0.5; }
";

const POWER_SHADER: &str = "
#import \"shared/points.wgsl\"
struct Power { power: vec4f, points: u32, adds: u32, pad_0: u32, pad_1: u32 }
@group(0) @binding(0) var<uniform> power: Power;
@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> factor: array<f32>;
@group(0) @binding(3) var<storage, read_write> point_irradiance: array<vec4f>;
@compute @workgroup_size(64) fn power_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= power.points { return; }
    var light = vec4f(0.0);
    if points[id.x].receiver >= 0.0 { light = vec4f(power.power.xyz * factor[0], 0.0); }
    if power.adds == 1u { light += point_irradiance[id.x]; }
    point_irradiance[id.x] = light;
}
";

fn prepared(output: Value) -> Prepared {
    let resolved = scene_files::scene(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9 }] },
        "floor": { "depth_m": 2, "size_m": [6, 6] },
        "lights": [
            { "kind": "sun", "elevation_deg": 55, "irradiance_w_m2": [100, 90, 80] },
            { "kind": "sun", "elevation_deg": 35, "irradiance_w_m2": [10, 20, 30] }
        ],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1.2, 0] },
        "quality": { "water_cells": 32 },
        "output": output
    }));
    let mut passes: Vec<&'static Pass> = stages::BEFORE_METHOD.to_vec();
    passes.push(&FACTOR_PASS);
    passes.extend(stages::AFTER_MAPS);
    passes.push(&POWER_PASS);
    passes.extend(stages::PICTURE);
    let prepared = Prepared::new(resolved).unwrap();
    prepared
        .with_passes(passes)
        .with_facts(|facts| facts.method.product = Product::PointIrradiance)
}

#[test]
fn what_is_found_at_points_makes_pictures_and_maps() {
    let sources = methods::embedded()
        .with_file("methods/own/factor.wgsl", FACTOR_SHADER)
        .with_file("methods/own/power.wgsl", POWER_SHADER);
    let mut renderer = Renderer::with_shaders(&RenderConfig::default(), sources).unwrap();
    // Half of both suns.
    let due = [55.0, 55.0, 55.0];
    let map = json!({ "kind": "irradiance_map", "receiver": "floor", "width": 40, "height": 30 });
    let view = json!({ "kind": "view", "width": 64, "height": 48, "layers": ["irradiance", "radiance"], "format": "exr" });
    for output in [map, view] {
        let prepared = prepared(output.clone());
        let frame = renderer
            .render_prepared(&prepared, &CancellationToken::new())
            .unwrap_or_else(|error| panic!("{error}"));
        renderer.gpu().check().unwrap();
        let texels = harness::layer(&frame, LayerName::Irradiance);
        let lit = texels.iter().filter(|texel| **texel == due).count();
        let dark = texels.iter().filter(|texel| **texel == [0.0; 3]).count();
        assert_eq!(lit + dark, texels.len(), "{output}");
        assert!(lit > 1000, "{output}: {lit} of {}", texels.len());
        let runs = |name: &str| {
            let found = frame.stats.passes.iter().find(|pass| pass.name == name);
            found.map_or(0, |pass| pass.runs)
        };
        assert_eq!([runs("factor"), runs("power")], [1, 2]);
        // Nothing of the receivers' maps is planned for a method that has none.
        for absent in ["deposit", "irradiance", "camera_irradiance"] {
            assert_eq!(runs(absent), 0, "{absent}");
        }
        assert_eq!(
            frame.stats.memory.peak_bytes,
            frame.stats.memory.planned_peak_bytes
        );
    }
}
