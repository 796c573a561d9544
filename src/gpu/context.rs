//! Opens an adapter by policy and records the errors of its device.

use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::GpuError;
use crate::config::AdapterPolicy;
use crate::stats::AdapterStats;

/// Longest wait for submitted work, s; work that takes longer counts as hung.
pub const WAIT_S: u64 = 300;

/// Errors that wgpu reported outside any call's result. The first one is kept; a loss of the device takes precedence.
#[derive(Debug, Default)]
struct ErrorLog {
    first: Option<GpuError>,
    lost: Option<String>,
}

/// One device and its queue.
#[derive(Debug)]
pub struct GpuContext {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The limits that the device was opened with.
    pub limits: wgpu::Limits,
    /// Whether pass timestamps can be taken.
    pub timestamps: bool,
    /// Whether draws can blend into textures of 32-bit floats.
    pub blends_float32: bool,
    /// Largest staging buffer since [`Self::take_readback_peak`], bytes.
    pub(super) readback_peak: AtomicU64,
    adapter: AdapterStats,
    errors: Arc<Mutex<ErrorLog>>,
}

impl GpuContext {
    /// Opens the best adapter that `policy` admits.
    pub fn open(policy: AdapterPolicy) -> Result<Self, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::PRIMARY;
        let instance = wgpu::Instance::new(descriptor);
        let adapters = block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let adapter = choose(adapters, policy)?;
        let info = adapter.get_info();
        // Whatever of these it has.
        let features = adapter.features()
            & (wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::FLOAT32_BLENDABLE);
        let software = info.device_type == wgpu::DeviceType::Cpu;
        let limits = wanted_limits(&adapter.limits(), software);
        let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("caustica"),
            required_features: features,
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        }))
        .map_err(|error| GpuError::NoAdapter(format!("{}: {error}", info.name)))?;
        let errors = Arc::new(Mutex::new(ErrorLog::default()));
        listen(&device, &errors);
        let adapter = AdapterStats {
            name: info.name,
            backend: format!("{:?}", info.backend).to_lowercase(),
            driver: format!("{} {}", info.driver, info.driver_info)
                .trim()
                .to_owned(),
            software: info.device_type == wgpu::DeviceType::Cpu,
        };
        tracing::info!(adapter = %adapter.name, driver = %adapter.driver, software = adapter.software, "GPU context open");
        Ok(Self {
            device,
            queue,
            limits,
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            blends_float32: features.contains(wgpu::Features::FLOAT32_BLENDABLE),
            readback_peak: AtomicU64::new(0),
            adapter,
            errors,
        })
    }

    /// Bytes of the largest readback since the last call.
    pub fn take_readback_peak(&self) -> u64 {
        self.readback_peak.swap(0, Ordering::Relaxed)
    }

    /// WGSL adapted to this adapter. A CPU driver gets uniforms as read-only storage: lavapipe 22.3 compiles and keeps a separate shader
    /// for every dispatch with a uniform that decides a branch or a loop (seen: 0.8 MiB and 5 ms per frame of six passes). GPUs keep
    /// uniforms, and with them WebGPU's limit of eight storage buffers.
    pub fn adapt<'a>(&self, text: &'a str) -> Cow<'a, str> {
        match self.uniforms_as() {
            wgpu::BufferBindingType::Uniform => text.into(),
            wgpu::BufferBindingType::Storage { .. } => {
                text.replace("var<uniform>", "var<storage, read>").into()
            }
        }
    }

    /// The buffer binding type of uniforms, see [`Self::adapt`].
    pub(super) fn uniforms_as(&self) -> wgpu::BufferBindingType {
        if self.adapter.software {
            wgpu::BufferBindingType::Storage { read_only: true }
        } else {
            wgpu::BufferBindingType::Uniform
        }
    }

    /// The adapter.
    pub fn adapter(&self) -> &AdapterStats {
        &self.adapter
    }

    /// The first error since the last call, if any; a lost device stays lost.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut log = lock(&self.errors);
        if let Some(reason) = &log.lost {
            return Err(GpuError::DeviceLost(reason.clone()));
        }
        match log.first.take() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }

    /// Blocks until everything submitted is done.
    pub fn wait(&self) -> Result<(), GpuError> {
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(Duration::from_secs(WAIT_S)),
        });
        self.check()?;
        match polled {
            Ok(_) => Ok(()),
            Err(wgpu::PollError::Timeout) => Err(GpuError::Timeout(WAIT_S)),
            Err(error) => Err(GpuError::Validation(error.to_string())),
        }
    }

    /// Frees what a failed frame has left, and discards its further errors, which follow from the first and must not fail the next frame.
    /// A lost device stays lost.
    pub fn forget_errors(&self) {
        self.tidy();
        lock(&self.errors).first = None;
    }

    /// Lets wgpu free unused memory; to be called also when idle.
    pub fn tidy(&self) {
        // The result only says whether the queue is empty.
        let _ = self.device.poll(wgpu::PollType::Poll);
    }
}

fn lock(errors: &Mutex<ErrorLog>) -> MutexGuard<'_, ErrorLog> {
    errors.lock().unwrap_or_else(PoisonError::into_inner)
}

fn listen(device: &wgpu::Device, errors: &Arc<Mutex<ErrorLog>>) {
    let log = Arc::clone(errors);
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let found = match &error {
            wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory(error.to_string()),
            wgpu::Error::Validation { description, .. }
            | wgpu::Error::Internal { description, .. } => {
                GpuError::Validation(description.clone())
            }
        };
        let mut log = lock(&log);
        if log.first.is_none() && log.lost.is_none() {
            tracing::error!(%error, "uncaptured GPU error");
            log.first = Some(found);
        }
    }));
    let log = Arc::clone(errors);
    device.set_device_lost_callback(move |reason, message| {
        let mut log = lock(&log);
        if log.lost.is_none() {
            log.lost = Some(format!("{reason:?}: {message}"));
        }
    });
}

/// Baseline limits; those that restrict the size of scenes are raised to the adapter's.
fn wanted_limits(adapter: &wgpu::Limits, software: bool) -> wgpu::Limits {
    let baseline = wgpu::Limits::default();
    let storage_buffers = baseline.max_storage_buffers_per_shader_stage;
    wgpu::Limits {
        // Eight. On a CPU driver also the uniforms, including that of pieces: see `GpuContext::adapt`. They are bound at dynamic offsets,
        // of which WebGPU guarantees four.
        max_storage_buffers_per_shader_stage: if software {
            storage_buffers + 4
        } else {
            storage_buffers
        },
        max_buffer_size: adapter.max_buffer_size,
        max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
        max_texture_dimension_2d: adapter.max_texture_dimension_2d,
        ..baseline
    }
}

fn choose(adapters: Vec<wgpu::Adapter>, policy: AdapterPolicy) -> Result<wgpu::Adapter, GpuError> {
    let software = |a: &wgpu::Adapter| a.get_info().device_type == wgpu::DeviceType::Cpu;
    let found: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
    let rank = |a: &wgpu::Adapter| match a.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    let mut fitting: Vec<wgpu::Adapter> = adapters
        .into_iter()
        .filter(|a| match policy {
            AdapterPolicy::Gpu => !software(a),
            AdapterPolicy::Software => software(a),
            AdapterPolicy::Any => true,
        })
        .collect();
    fitting.sort_by_key(rank);
    fitting.into_iter().next().ok_or_else(|| {
        GpuError::NoAdapter(format!(
            "policy `{}` admits none of {found:?}; usual causes: no Vulkan driver is installed (Debian: \
             mesa-vulkan-drivers), a container without NVIDIA_DRIVER_CAPABILITIES=graphics, or a driver library that \
             misses libXext or libEGL",
            format!("{policy:?}").to_lowercase()
        ))
    })
}

/// Runs a future that wgpu completes without an executor.
fn block_on<F: Future>(future: F) -> F::Output {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    loop {
        if let std::task::Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
        std::thread::yield_now();
    }
}
