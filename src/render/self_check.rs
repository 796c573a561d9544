//! Self-check of this machine: every formula and two small scenes, GPU against float64.

use tokio_util::sync::CancellationToken;

use super::{RenderError, Renderer};
use crate::gpu::shader::ShaderSources;
use crate::gpu::{BindGroups, Binding, GpuContext, GpuError, Kernel, readback};
use crate::physics::{attenuation, fresnel, refraction, registry};
use crate::scene::{ResolvedScene, Scene};

/// Result of comparing this machine's GPU with float64 physics.
#[derive(
    Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
pub struct SelfCheck {
    /// Whether every check passed.
    pub passed: bool,
    /// One line per check.
    pub checks: Vec<SelfCheckItem>,
}

/// One check.
#[derive(
    Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema,
)]
pub struct SelfCheckItem {
    /// What was compared.
    pub name: String,
    /// Largest error found; of formulas as a share of the one allowed.
    pub error: f64,
    /// Largest error allowed.
    pub tolerance: f64,
    /// Whether it passed.
    pub passed: bool,
}

/// Samples per formula.
const SAMPLES: usize = 512;
/// Side of the scene's map.
const MAP_SIDE: u32 = 32;
/// Relative error that the flat scene may have.
const FLAT_TOLERANCE: f64 = 1e-4;
/// Closure that the wavy scene's energy account may have.
const CLOSURE_TOLERANCE: f64 = 1e-5;

impl Renderer {
    /// Compares this machine with float64 physics.
    ///
    /// # Errors
    /// When the GPU fails; a wrong result is not an error but a check that did not pass.
    pub fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        let mut checks = Vec::new();
        for twin in registry::all() {
            let error = twin_error(&self.gpu, &self.sources, twin, SAMPLES)?;
            checks.push(item(format!("formula {}", twin.name), error.share, 1.0));
        }
        checks.push(item(
            "scene: flat water, irradiance".to_owned(),
            self.flat_error()?,
            FLAT_TOLERANCE,
        ));
        checks.push(item(
            "scene: waves, energy account".to_owned(),
            self.wavy_closure()?,
            CLOSURE_TOLERANCE,
        ));
        Ok(SelfCheck {
            passed: checks.iter().all(|c| c.passed),
            checks,
        })
    }

    /// Largest relative error of flat water against its closed form.
    fn flat_error(&mut self) -> Result<f64, GpuError> {
        let resolved = small_scene("[]");
        let map = self.small_map(&resolved)?.0;
        let to_light = refraction::direction_to_light(50_f64.to_radians(), 20_f64.to_radians());
        let Some(down) = refraction::refract_direction(-to_light, glam::DVec3::Y, 1.333) else {
            return Ok(f64::INFINITY);
        };
        let truth = [0.3, 0.05, 0.02].map(|c| {
            1000.0
                * to_light.y
                * fresnel::fresnel_transmittance(to_light.y, 1.333)
                * attenuation::transmission(c, 2.0 / -down.y)
        });
        let errors = map.chunks_exact(3).flat_map(|texel| {
            texel
                .iter()
                .zip(truth)
                .map(|(&value, truth)| ((f64::from(value) - truth) / truth).abs())
        });
        Ok(errors.fold(0.0, f64::max))
    }

    /// Closure of the energy account under waves.
    fn wavy_closure(&mut self) -> Result<f64, GpuError> {
        let wave =
            r#"{"kind": "sine", "amplitude_m": 0.03, "wavelength_m": 0.9, "direction_deg": 20}"#;
        let resolved = small_scene(&format!("[{wave}]"));
        Ok(self.small_map(&resolved)?.1)
    }

    fn small_map(&mut self, resolved: &ResolvedScene) -> Result<(Vec<f32>, f64), GpuError> {
        let mut frame = match self.render(resolved, &CancellationToken::new()) {
            Ok(frame) => frame,
            Err(RenderError::Gpu(error)) => return Err(error),
            Err(other) => {
                return Err(GpuError::Validation(format!(
                    "the self-check's scene: {other}"
                )));
            }
        };
        let map = frame
            .layers
            .remove(&crate::scene::LayerName::Irradiance)
            .map_or(Vec::new(), |layer| layer.data);
        let closure = frame
            .stats
            .energy
            .first()
            .map_or(f64::INFINITY, |account| account.closure);
        Ok((map, closure))
    }
}

fn item(name: String, error: f64, tolerance: f64) -> SelfCheckItem {
    SelfCheckItem {
        name,
        error,
        tolerance,
        passed: error <= tolerance,
    }
}

fn small_scene(waves: &str) -> ResolvedScene {
    let json = format!(
        r#"{{
            "water": {{ "waves": {waves}, "absorption_per_m": [0.3, 0.05, 0.02] }},
            "floor": {{ "depth_m": 2, "size_m": [8, 8] }},
            "lights": [ {{ "kind": "sun", "elevation_deg": 50, "azimuth_deg": 20, "irradiance_w_m2": [1000, 1000, 1000] }} ],
            "quality": {{ "water_cells": 32 }},
            "output": {{ "kind": "irradiance_map", "receiver": "floor", "min_m": [-1, -1], "max_m": [1, 1],
                         "width": {MAP_SIDE}, "height": {MAP_SIDE} }}
        }}"#
    );
    let scene: Scene = Scene::from_json(json.as_bytes()).expect("the self-check's scene is valid");
    ResolvedScene::bare(scene)
}

/// Largest error of a formula's f32 twin over its domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwinError {
    /// Error as a share of the tolerance; infinite if the result is not a number.
    pub share: f64,
    /// Arguments with this error.
    pub arguments: [f64; 8],
}

/// Largest error of a formula's f32 twin over its domain, with its arguments.
///
/// # Errors
/// When the GPU fails or the shader does not compile.
pub fn twin_error(
    gpu: &GpuContext,
    sources: &ShaderSources,
    twin: &registry::Twin,
    samples: usize,
) -> Result<TwinError, GpuError> {
    let inputs = registry::samples(twin, samples);
    let outputs = run_twin(gpu, sources, twin, &inputs)?;
    let mut worst = TwinError {
        share: 0.0,
        arguments: [0.0; 8],
    };
    for (&arguments, &found) in inputs.iter().zip(&outputs) {
        let share = twin.error(&arguments[..twin.domain.len()], found);
        if share > worst.share {
            worst = TwinError { share, arguments };
        }
    }
    Ok(worst)
}

fn run_twin(
    gpu: &GpuContext,
    sources: &ShaderSources,
    twin: &registry::Twin,
    inputs: &[[f64; 8]],
) -> Result<Vec<[f32; 4]>, GpuError> {
    let mut text = sources.assemble_all(&["lib/turns.wgsl", "lib/refraction.wgsl", twin.file])?;
    text.push_str(registry::CALL_PRELUDE);
    text.push_str(&format!(
        "@group(0) @binding(0) var<storage, read> arguments: array<array<f32, 8>>;
         @group(0) @binding(1) var<storage, read_write> results: array<vec4f>;
         @compute @workgroup_size(64) fn twin_main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= arrayLength(&arguments) {{ return; }}
             let a = arguments[id.x];
             results[id.x] = {};
         }}",
        twin.call
    ));
    let kernel = Kernel::from_text(gpu, twin.file, text, "twin_main", &[])?;
    let arguments: Vec<[f32; 8]> = inputs.iter().map(|args| args.map(|a| a as f32)).collect();
    let buffer = |label, bytes: u64| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    };
    let source = buffer("arguments", 32 * inputs.len() as u64);
    let target = buffer("results", 16 * inputs.len() as u64);
    gpu.queue
        .write_buffer(&source, 0, bytemuck::cast_slice(&arguments));
    let bound = kernel.bind(gpu, &mut BindGroups::default(), |name| match name {
        "arguments" => Some(Binding::Buffer {
            buffer: &source,
            bytes: source.size(),
        }),
        "results" => Some(Binding::Buffer {
            buffer: &target,
            bytes: target.size(),
        }),
        _ => None,
    })?;
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(kernel.pipeline());
        pass.set_bind_group(0, &bound.group, &bound.offsets);
        pass.dispatch_workgroups(
            u32::try_from(inputs.len().div_ceil(64)).unwrap_or(u32::MAX),
            1,
            1,
        );
    }
    gpu.queue.submit([encoder.finish()]);
    readback::read(gpu, &target, 16 * inputs.len() as u64)
}
