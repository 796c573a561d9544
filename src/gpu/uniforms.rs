//! Small constant buffers: equal bytes share one, within a frame and with the frame before.

use std::collections::BTreeMap;

use super::GpuContext;

/// The uniform buffers of the frame at work and of the one before, by what they hold.
#[derive(Debug, Default)]
pub struct Uniforms {
    used: BTreeMap<Vec<u8>, wgpu::Buffer>,
    before: BTreeMap<Vec<u8>, wgpu::Buffer>,
}

impl Uniforms {
    /// Starts a frame: what the last one did not use is dropped.
    pub fn begin_frame(&mut self) {
        self.before = std::mem::take(&mut self.used);
    }

    /// The buffer that holds `bytes`; nobody else may write to it.
    pub fn get(&mut self, gpu: &GpuContext, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        if let Some(buffer) = self.used.get(bytes) {
            return buffer.clone();
        }
        let buffer = self.before.remove(bytes).unwrap_or_else(|| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes.len() as u64,
                usage: wgpu::BufferUsages::UNIFORM
                    | wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            gpu.queue.write_buffer(&buffer, 0, bytes);
            buffer
        });
        self.used.insert(bytes.to_vec(), buffer.clone());
        buffer
    }
}
