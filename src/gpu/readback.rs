//! Copies results from the GPU to the host.

use bytemuck::Pod;

use super::{GpuContext, GpuError};

/// A recorded or submitted copy of a result to the host.
#[derive(Debug)]
pub struct Staged(wgpu::Buffer);

/// Records the copy of the first `bytes` bytes of `source` (usage COPY_SRC).
pub fn stage(
    gpu: &GpuContext,
    encoder: &mut wgpu::CommandEncoder,
    source: &wgpu::Buffer,
    bytes: u64,
) -> Staged {
    gpu.readback_peak
        .fetch_max(bytes, std::sync::atomic::Ordering::Relaxed);
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
    Staged(staging)
}

impl Staged {
    /// Reads the values; the copy must have been submitted. Waits for everything submitted.
    pub fn read<T: Pod>(self, gpu: &GpuContext) -> Result<Vec<T>, GpuError> {
        let (send, receive) = std::sync::mpsc::channel();
        self.0.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone only if the wait below failed; then the result is unused.
            let _ = send.send(result);
        });
        gpu.wait()?;
        match receive.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => {
                return Err(GpuError::Validation(format!(
                    "mapping a readback buffer: {error}"
                )));
            }
            Err(_) => {
                return Err(GpuError::Validation(
                    "a readback buffer was not mapped after the wait".to_owned(),
                ));
            }
        }
        let view = self
            .0
            .get_mapped_range(..)
            .map_err(|error| GpuError::Validation(format!("reading a readback buffer: {error}")))?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }
}

/// Reads the first `bytes` bytes of `source` (usage COPY_SRC) as values of `T`; waits for everything submitted.
pub fn read<T: Pod>(
    gpu: &GpuContext,
    source: &wgpu::Buffer,
    bytes: u64,
) -> Result<Vec<T>, GpuError> {
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let staged = stage(gpu, &mut encoder, source, bytes);
    gpu.queue.submit([encoder.finish()]);
    staged.read(gpu)
}
