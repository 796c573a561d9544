//! Results back to the host.

use bytemuck::Pod;

use super::{GpuContext, GpuError};

/// Reads the first `bytes` bytes of `source` (usage COPY_SRC) as values of `T`; waits for everything submitted.
pub fn read<T: Pod>(
    gpu: &GpuContext,
    source: &wgpu::Buffer,
    bytes: u64,
) -> Result<Vec<T>, GpuError> {
    gpu.readback_peak
        .fetch_max(bytes, std::sync::atomic::Ordering::Relaxed);
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, bytes);
    gpu.queue.submit([encoder.finish()]);
    let (send, receive) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver is gone only when the wait below failed, and then nobody cares.
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
    let view = staging
        .get_mapped_range(..)
        .map_err(|error| GpuError::Validation(format!("reading a readback buffer: {error}")))?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}
