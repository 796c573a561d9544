//! Uniform data: equal bytes share a place in a buffer, within a frame and with earlier frames. They are bound at a dynamic offset, so
//! bind groups do not change with their content.

use std::collections::BTreeMap;

use super::GpuContext;
use super::pool::KEEP_FRAMES;

/// Alignment of places, bytes: no device requires more.
const ALIGNMENT: u64 = 256;
/// Bytes of a buffer of places.
const BUFFER_BYTES: u64 = 1 << 16;

/// Where constants lie.
#[derive(Clone, Debug)]
pub struct Placed {
    /// The buffer that holds them, and others.
    pub buffer: wgpu::Buffer,
    /// Where they begin in it.
    pub offset: u32,
}

/// Uniform data by content, kept for some frames. The number of buffers is the largest that frames have needed at once since the start (or
/// since the last idle time).
#[derive(Debug, Default)]
pub struct Uniforms {
    kept: BTreeMap<Vec<u8>, KeptPlace>,
    /// Unused places, by size.
    free: BTreeMap<u64, Vec<(wgpu::Buffer, u32)>>,
    /// The newest buffer, and the offset from which it is empty.
    newest: Option<(wgpu::Buffer, u64)>,
    frame: u64,
}

#[derive(Debug)]
struct KeptPlace {
    placed: Placed,
    last_used: u64,
}

impl Uniforms {
    /// Starts a frame: places that were not used for some frames become free.
    pub fn begin_frame(&mut self) {
        self.frame += 1;
        let (frame, free) = (self.frame, &mut self.free);
        self.kept.retain(|bytes, KeptPlace { placed, last_used }| {
            let stays = *last_used + KEEP_FRAMES >= frame;
            if !stays {
                let places = free.entry(room(bytes)).or_default();
                places.push((placed.buffer.clone(), placed.offset));
            }
            stays
        });
    }

    /// The place that holds `bytes` for everything submitted from now on; only this function writes to it.
    pub fn get(&mut self, gpu: &GpuContext, bytes: &[u8]) -> Placed {
        if let Some(kept) = self.kept.get_mut(bytes) {
            kept.last_used = self.frame;
            return kept.placed.clone();
        }
        let (buffer, offset) = self.place(gpu, room(bytes));
        gpu.queue.write_buffer(&buffer, u64::from(offset), bytes);
        let placed = Placed { buffer, offset };
        let kept = KeptPlace {
            placed: placed.clone(),
            last_used: self.frame,
        };
        self.kept.insert(bytes.to_vec(), kept);
        placed
    }

    /// An unused place.
    fn place(&mut self, gpu: &GpuContext, room: u64) -> (wgpu::Buffer, u32) {
        if let Some(place) = self.free.get_mut(&room).and_then(Vec::pop) {
            return place;
        }
        let has_room = |(buffer, from): &(wgpu::Buffer, u64)| from + room <= buffer.size();
        let (buffer, from) = self.newest.take().filter(has_room).unwrap_or_else(|| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms"),
                size: BUFFER_BYTES.max(room),
                usage: wgpu::BufferUsages::UNIFORM
                    | wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            (buffer, 0)
        });
        self.newest = Some((buffer.clone(), from + room));
        (buffer, u32::try_from(from).unwrap_or(u32::MAX))
    }
}

fn room(bytes: &[u8]) -> u64 {
    (bytes.len() as u64).next_multiple_of(ALIGNMENT)
}
