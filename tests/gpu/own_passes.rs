//! A method that is only in this file: it finds the irradiance at points, once per beam set, from what a pass of its own has made once
//! for the frame. It shows that the executor runs every scope, whoever brings the passes, and that what is found at points makes
//! pictures and maps alike.

use caustica::config::RenderConfig;
use caustica::facts::Product;
use caustica::frame::Frame;
use caustica::gpu_struct;
use caustica::graph::{Layout, Texture};
use caustica::methods;
use caustica::render::{Prepared, Renderer};
use caustica::scene::LayerName;
use caustica::stages::beams::BEAMS;
use caustica::stages::points::{POINT_IRRADIANCE, POINTS, size};
use caustica::stages::surface::wanted_for_light;
use caustica::stages::{self, Groups, Pass, Slot, Step, Steps};
use serde_json::{Value, json};
use tokio_util::sync::CancellationToken;

use super::{harness, scene_files};

/// What every beam set's power is multiplied by: the last texel of a 3D texture that one pass stores to and another reads.
static FACTOR: Slot = Slot::texture(
    "factor",
    "a factor, 1",
    Texture {
        format: wgpu::TextureFormat::R32Float,
        dimension: wgpu::TextureViewDimension::D3,
        extent: |_| [2, 2, 3],
        usage: wgpu::TextureUsages::STORAGE_BINDING,
    },
);

/// Fills [`FACTOR`], once.
static FACTOR_PASS: Pass = Pass {
    name: "factor",
    shader: "methods/own/factor.wgsl",
    reads: &[],
    reads_if_present: &[],
    writes: &[&FACTOR],
    uniforms: &[],
    views: &[],
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
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

const POWER: Layout = Power::LAYOUT;

/// Gives every point the power of each beam set, times the factor.
static POWER_PASS: Pass = Pass {
    name: "power",
    shader: "methods/own/power.wgsl",
    reads: &[&POINTS, &FACTOR, &BEAMS],
    reads_if_present: &[],
    writes: &[&POINT_IRRADIANCE],
    uniforms: &[("power", POWER)],
    views: &[],
    wanted: wanted_for_light,
    steps: Steps::BandBeamSet(|facts, band, set| {
        let [width, _] = size(facts).unwrap();
        let points = width * band.rows;
        let power = facts.lights.beam_sets[set.index].power.map(|p| p as f32);
        let uniform = Power {
            power: [power[0], power[1], power[2], 0.0],
            points,
            pad_0: 0,
            pad_1: 0,
            pad_2: 0,
        };
        let uniforms = vec![("power", bytemuck::bytes_of(&uniform).to_vec())];
        let groups = Groups::Direct([points.div_ceil(64), 1, 1]);
        vec![Step::compute("power_main", groups, uniforms)]
    }),
    work: |_| 1.0,
};

const FACTOR_SHADER: &str = "
@group(0) @binding(0) var factor: texture_storage_3d<r32float, write>;
@compute @workgroup_size(2, 2, 3) fn factor_main(@builtin(local_invocation_id) id: vec3u) {
    textureStore(factor, id, vec4f(select(0.0, 0.5, all(id == vec3u(1u, 1u, 2u)))));
}
";

const POWER_SHADER: &str = "
#import \"shared/points.wgsl\"
struct Power { power: vec4f, points: u32, pad_0: u32, pad_1: u32, pad_2: u32 }
@group(0) @binding(0) var<uniform> power: Power;
@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var factor: texture_3d<f32>;
@group(0) @binding(3) var<storage, read> beams: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> point_irradiance: array<vec4f>;
@compute @workgroup_size(64) fn power_main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= power.points || points[id.x].receiver < 0.0 { return; }
    // The first vertex of the set's rays: they were traced, whoever reads them.
    if beams[0].w == 0.0 { return; }
    point_irradiance[id.x] += vec4f(power.power.xyz * textureLoad(factor, vec3u(1u, 1u, 2u), 0).x, 0.0);
}
";

/// A scene with a floor, a box under water and a box above it.
fn prepared(suns: usize, has_sky: bool, output: &Value) -> Prepared {
    let mut lights = vec![
        json!({ "kind": "sun", "elevation_deg": 55, "irradiance_w_m2": [100, 90, 80] }),
        json!({ "kind": "sun", "elevation_deg": 35, "irradiance_w_m2": [10, 20, 30] }),
    ];
    lights.truncate(suns);
    if has_sky {
        lights.push(json!({ "kind": "sky", "radiance_w_m2_sr": [3, 4, 5] }));
    }
    let mut output = output.clone();
    if output["kind"] == "irradiance_map" {
        output["include_sky"] = json!(has_sky);
    }
    let resolved = scene_files::scene(json!({
        "water": { "waves": [{ "kind": "sine", "amplitude_m": 0.02, "wavelength_m": 0.9 }] },
        "floor": { "depth_m": 2, "size_m": [6, 6] },
        "lights": lights,
        "objects": [
            { "mesh": "box.obj", "translation_m": [0.5, -1.4, 0], "scale": 0.4 },
            { "mesh": "box.obj", "translation_m": [-0.5, 0.5, 0], "scale": 0.4 }
        ],
        "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -0.5, 0] },
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

fn outputs() -> [Value; 2] {
    [
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 40, "height": 30 }),
        json!({ "kind": "view", "width": 64, "height": 48, "layers": ["irradiance", "radiance"], "format": "exr" }),
    ]
}

fn renderer() -> Renderer {
    let sources = methods::embedded()
        .with_file("methods/own/factor.wgsl", FACTOR_SHADER)
        .with_file("methods/own/power.wgsl", POWER_SHADER);
    Renderer::with_shaders(&RenderConfig::default(), sources).unwrap()
}

fn render(renderer: &mut Renderer, prepared: &Prepared) -> Frame {
    let frame = renderer.render_prepared(prepared, &CancellationToken::new());
    renderer.gpu().check().unwrap();
    frame.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn what_is_found_at_points_makes_pictures_and_maps() {
    for output in outputs() {
        for (count, half) in [(0, [0.0; 3]), (1, [50.0, 45.0, 40.0]), (2, [55.0; 3])] {
            // Without the caches of other frames, so that its peak is its own.
            let frame = render(&mut renderer(), &prepared(count, false, &output));
            let texels = harness::layer(&frame, LayerName::Irradiance);
            let due = texels.iter().filter(|texel| **texel == half).count();
            assert!(due > 900, "{count} suns, {output}: {due}");
            let runs = |name: &str| {
                let found = frame.stats.passes.iter().find(|pass| pass.name == name);
                found.map_or(0, |pass| pass.runs)
            };
            let once = u32::from(count > 0);
            let expected = [once, count as u32, count as u32];
            assert_eq!([runs("factor"), runs("beams"), runs("power")], expected);
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
}

/// The sky, and the suns on the dry box, are the same whatever the method: a method at points need not add them.
#[test]
fn sky_and_dry_surfaces_are_lit_as_with_a_method_of_maps() {
    let mut own = renderer();
    let mut default = harness::renderer();
    for output in outputs() {
        for count in [0, 1] {
            let prepared = prepared(count, true, &output);
            let found = render(&mut own, &prepared);
            let whole = render(
                &mut default,
                &Prepared::new(prepared.resolved().clone()).unwrap(),
            );
            let [found, whole] = [&found, &whole].map(|f| harness::layer(f, LayerName::Irradiance));
            let same = found.iter().zip(&whole).filter(|(a, b)| a == b).count();
            if count == 0 {
                assert_eq!(same, found.len(), "{output}: only the sky");
                assert!(found.iter().any(|texel| texel[2] > 1.0), "{output}");
            } else if output["kind"] == "view" {
                // Only the dry box is lit alike; by the sun of 100 W/m² it is brighter than by the sky.
                let bright = |(a, b): &(&[f64; 3], &[f64; 3])| a == b && a[0] > 30.0;
                let dry = found.iter().zip(&whole).filter(bright).count();
                assert!(dry > 20, "{dry}");
            }
        }
    }
}
