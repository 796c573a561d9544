//! A kernel is compiled once, regardless of constants that its entry point does not use.

use caustica::config::RenderConfig;
use caustica::gpu::kernel::RasterTargets;
use caustica::gpu::shader::{Module, ShaderSources};
use caustica::gpu::{BindGroups, Binding, KernelCache, readback};
use serde_json::json;

use super::harness::{new_renderer, render_with, renderer};
use super::scene_files;

/// An entry point for each kind of use of `FIRST`, and one that uses none; nothing uses `SECOND`.
const SHADER: &str = "
    override FIRST: bool = true;
    override SECOND: bool = true;
    @group(0) @binding(0) var<storage, read_write> out: array<f32>;

    fn first() -> f32 { return select(1.0, 2.0, FIRST); }
    fn store(i: u32) { if i > 0 { loop { out[i] = first(); break; } } }

    @compute @workgroup_size(64) fn direct(@builtin(global_invocation_id) id: vec3u) {
        if FIRST { out[id.x] = 1.0; }
    }
    @compute @workgroup_size(64) fn nested(@builtin(global_invocation_id) id: vec3u) { store(id.x); }
    @compute @workgroup_size(64) fn plain(@builtin(global_invocation_id) id: vec3u) { out[id.x] = 3.0; }

    @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i), 0.0, 0.0, 1.0);
    }
    @fragment fn white() -> @location(0) f32 { return 1.0; }
";
const PATH: &str = "passes/some.wgsl";

#[test]
fn an_entry_point_depends_on_the_overrides_it_reaches() {
    let module = Module::parse(PATH, SHADER.to_owned()).unwrap();
    let of = |entry| module.overrides_of(PATH, entry).unwrap();
    assert_eq!(of("direct"), ["FIRST"]);
    assert_eq!(of("nested"), ["FIRST"]);
    assert!(of("plain").is_empty());
    assert!(module.overrides_of(PATH, "missing").is_err());
}

#[test]
fn one_kernel_for_all_values_of_what_is_not_used() {
    let renderer = renderer();
    let gpu = renderer.gpu();
    let sources = ShaderSources::new(&[(PATH, SHADER)]);
    let mut cache = KernelCache::default();
    // For each set of values the set that was compiled for it first, and how many were compiled anew.
    let mut compiled = |entry: &str, in_pieces: bool| {
        let before = cache.compiled();
        let ids = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(first, second)| {
            let constants = [("UNKNOWN", second), ("SECOND", second), ("FIRST", first)];
            cache
                .compute(gpu, &sources, (PATH, entry), &constants, in_pieces)
                .unwrap()
        });
        let same = ids.map(|id| ids.iter().position(|&known| known == id).unwrap());
        (same, cache.compiled() - before)
    };
    assert_eq!(compiled("plain", false), ([0, 0, 0, 0], 1));
    assert_eq!(compiled("direct", false), ([0, 1, 0, 1], 2));
    assert_eq!(compiled("nested", false), ([0, 1, 0, 1], 2));
    // In pieces it is another kernel.
    assert_eq!(compiled("plain", true), ([0, 0, 0, 0], 1));
    assert_eq!(compiled("direct", true), ([0, 1, 0, 1], 2));
    assert_eq!(compiled("direct", false), ([0, 1, 0, 1], 0));
    assert_eq!(cache.parsed(), 1);

    let targets = |depth_compare| RasterTargets {
        colors: vec![wgpu::TextureFormat::R32Float.into()],
        depth: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(depth_compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        primitive: wgpu::PrimitiveState::default(),
    };
    let before = cache.compiled();
    for compare in [
        wgpu::CompareFunction::Less,
        wgpu::CompareFunction::Greater,
        wgpu::CompareFunction::Less,
    ] {
        let entries = (PATH, ["corner", "white"]);
        cache
            .raster(gpu, &sources, entries, targets(compare))
            .unwrap();
    }
    assert_eq!(cache.compiled() - before, 2);
    assert_eq!(cache.parsed(), 1);
    gpu.check().unwrap();
}

#[test]
fn clear_water_after_murky_water_compiles_only_what_attenuates() {
    let scene = |absorption: [f64; 3]| {
        scene_files::scene(json!({
            "water": { "absorption_per_m": absorption },
            "floor": { "depth_m": 2, "size_m": [4, 4] },
            "lights": [{ "kind": "sun", "elevation_deg": 60, "irradiance_w_m2": [1, 1, 1] }],
            "objects": [{ "mesh": "box.obj", "translation_m": [0, -1, 0], "scale": 0.5 }],
            "camera": { "position_m": [0, 2.5, 3], "target_m": [0, -1, 0] },
            "quality": { "water_cells": 32, "map_texels": 32, "level_map_texels": 32 },
            "output": { "kind": "view", "width": 32, "height": 32 }
        }))
    };
    let mut renderer = new_renderer(&RenderConfig::default());
    let mut compiled = |absorption| {
        let before = renderer.kernels_compiled();
        render_with(&mut renderer, &scene(absorption));
        renderer.kernels_compiled() - before
    };
    let murky = compiled([0.3, 0.1, 0.05]);
    let clear = compiled([0.0; 3]);
    println!("{murky} kernels for murky water, {clear} more for clear water");
    assert!(clear > 0 && 2 * clear < murky, "{clear}, {murky}");
    assert_eq!(compiled([0.1; 3]), 0);
}

/// A texture of three dimensions that one kernel stores to and another reads, both bound by name.
#[test]
fn kernels_store_to_and_read_textures_of_three_dimensions() {
    const SIDE: u32 = 4;
    let sources = ShaderSources::new(&[(
        PATH,
        "@group(0) @binding(0) var stored: texture_storage_3d<r32float, write>;
         @group(0) @binding(1) var read: texture_3d<f32>;
         @group(0) @binding(2) var<storage, read_write> values: array<f32>;
         @compute @workgroup_size(4, 4, 4) fn store(@builtin(global_invocation_id) id: vec3u) {
             textureStore(stored, id, vec4f(f32(id.x + 10u * id.y + 100u * id.z)));
         }
         @compute @workgroup_size(4, 4, 4) fn load(@builtin(global_invocation_id) id: vec3u) {
             values[id.x + 4u * (id.y + 4u * id.z)] = textureLoad(read, id, 0).x;
         }",
    )]);
    let renderer = renderer();
    let gpu = renderer.gpu();
    let mut cache = KernelCache::default();
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("volume"),
        size: wgpu::Extent3d {
            width: SIDE,
            height: SIDE,
            depth_or_array_layers: SIDE,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let bytes = 4 * u64::from(SIDE.pow(3));
    let values = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("values"),
        size: bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut groups = BindGroups::default();
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    for entry in ["store", "load"] {
        let id = cache.compute(gpu, &sources, (PATH, entry), &[], false);
        let kernel = cache.kernel(id.unwrap());
        let bound = kernel.bind(gpu, &mut groups, |name| {
            Some(match name {
                "values" => Binding::Buffer {
                    buffer: &values,
                    bytes,
                },
                _ => Binding::Texture(&view),
            })
        });
        let bound = bound.unwrap();
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(kernel.pipeline());
        pass.set_bind_group(0, &bound.group, &bound.offsets);
        pass.dispatch_workgroups(1, 1, 1);
    }
    gpu.queue.submit([encoder.finish()]);
    let read: Vec<f32> = readback::read(gpu, &values, bytes).unwrap();
    for (index, value) in read.iter().enumerate() {
        let (x, y, z) = (index % 4, index / 4 % 4, index / 16);
        assert_eq!(*value, (x + 10 * y + 100 * z) as f32);
    }
    gpu.check().unwrap();
}
