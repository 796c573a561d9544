//! Breaks a device in the middle of a frame, and checks that the frame is not affected.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use tokio_util::sync::CancellationToken;

use crate::cache::{WarmUp, WarmedMap};
use crate::frame::Frame;
use crate::gpu::GpuError;
use crate::gpu_queue::RenderBackend;
use crate::mesh::Mesh;
use crate::plan::Plan;
use crate::render::{Prepared, RenderError, Renderer, SelfCheck};
use crate::stats::{AdapterStats, CacheStats};

/// Calls `harm` when the GPU has done that many of the coming submissions.
pub(super) fn after_submissions(
    queue: &wgpu::Queue,
    submissions: u32,
    harm: impl FnOnce() + Send + 'static,
) {
    count_down(queue, submissions, Box::new(harm));
}

fn count_down(queue: &wgpu::Queue, submissions: u32, harm: Box<dyn FnOnce() + Send>) {
    let next = queue.clone();
    queue.on_submitted_work_done(move || {
        if submissions == 0 {
            harm();
        } else {
            count_down(&next, submissions - 1, harm);
        }
    });
}

/// Requests more memory than exists, so that the device reports that it is out of memory.
pub(super) fn exhaust(device: &wgpu::Device) {
    let limits = device.limits();
    let side = limits.max_texture_dimension_2d;
    // 4 GiB where the side is 16 384, which a CPU driver refuses; on a GPU as many layers of that as it takes.
    let layers = match device.adapter_info().device_type {
        wgpu::DeviceType::Cpu => 1,
        _ => limits.max_texture_array_layers,
    };
    // Dropped at once: the texture was never created.
    let _ = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("more than there is"),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
}

/// The number of values of two frames that are not bit-equal; all values where their layers or sizes differ.
pub(super) fn differing_values(a: &Frame, b: &Frame) -> f64 {
    let values = |frame: &Frame| -> usize { frame.layers.values().map(|l| l.data.len()).sum() };
    if !a.layers.keys().eq(b.layers.keys()) || values(a) != values(b) || values(a) == 0 {
        return values(a).max(values(b)).max(1) as f64;
    }
    let pairs = a.layers.values().zip(b.layers.values());
    let differing = pairs.flat_map(|(a, b)| a.data.iter().zip(&b.data));
    differing
        .filter(|(a, b)| a.to_bits() != b.to_bits())
        .count() as f64
}

/// A renderer whose device is lost in the middle of the next frame after `armed` is set.
pub(super) struct Saboteur {
    renderer: Renderer,
    armed: Arc<AtomicBool>,
}

impl Saboteur {
    pub(super) fn new(renderer: Renderer, armed: Arc<AtomicBool>) -> Self {
        Self { renderer, armed }
    }
}

impl RenderBackend for Saboteur {
    fn adapter(&self) -> AdapterStats {
        self.renderer.adapter()
    }

    fn dial_basis(&self) -> String {
        self.renderer.dial_basis()
    }

    fn plan(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Plan, RenderError> {
        self.renderer.plan_prepared(prepared, cancel)
    }

    fn render(
        &mut self,
        prepared: &Prepared,
        cancel: &CancellationToken,
    ) -> Result<Frame, RenderError> {
        if self.armed.swap(false, Ordering::Relaxed) {
            let gpu = self.renderer.gpu();
            let device = gpu.device.clone();
            after_submissions(&gpu.queue, 3, move || device.destroy());
        }
        self.renderer.render_prepared(prepared, cancel)
    }

    fn warm(
        &mut self,
        mesh: &Arc<Mesh>,
        wanted: &WarmUp,
        cancel: &CancellationToken,
    ) -> Result<Vec<WarmedMap>, RenderError> {
        self.renderer.warm(mesh, wanted, cancel)
    }

    fn self_check(&mut self) -> Result<SelfCheck, GpuError> {
        self.renderer.self_check()
    }

    fn forget_mesh(&mut self, id: &str) {
        self.renderer.forget_mesh(id);
    }

    fn level_map_cache(&self) -> CacheStats {
        self.renderer.level_map_cache()
    }

    fn field_cache(&self) -> CacheStats {
        self.renderer.field_cache()
    }

    fn idle(&mut self) -> Result<(), GpuError> {
        self.renderer.idle()
    }
}
