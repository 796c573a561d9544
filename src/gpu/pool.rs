//! Buffers that are lent to a frame and taken back, with an exact account of their bytes.

/// Number of frames for which an unused buffer is kept.
pub(super) const KEEP_FRAMES: u64 = 4;

#[derive(Debug)]
struct Free {
    /// The label it was lent under.
    label: &'static str,
    buffer: wgpu::Buffer,
    last_used: u64,
}

/// A pool of buffers, keyed by size and usage.
#[derive(Debug, Default)]
pub struct BufferPool {
    free: Vec<Free>,
    frame: u64,
    lent_bytes: u64,
    peak_bytes: u64,
}

impl BufferPool {
    /// Starts a frame, with nothing lent: resets the peak and drops buffers that were not used for some frames. Then drops the least
    /// recently used ones until at most `free_budget_bytes` are kept, and returns whether that dropped any.
    pub fn begin_frame(&mut self, free_budget_bytes: u64) -> bool {
        self.frame += 1;
        // A frame that failed half-way has dropped its buffers.
        self.lent_bytes = 0;
        self.peak_bytes = self.lent_bytes;
        let frame = self.frame;
        self.free.retain(|f| f.last_used + KEEP_FRAMES >= frame);
        let mut makes_room = false;
        while self.free_bytes() > free_budget_bytes {
            let oldest = (0..self.free.len()).min_by_key(|&index| self.free[index].last_used);
            let Some(index) = oldest else { break };
            self.free.swap_remove(index);
            makes_room = true;
        }
        makes_room
    }

    /// Lends a buffer of exactly `bytes` (rounded up to 4) with `usage`; its content is undefined. Prefers a buffer that was lent under the
    /// same label before, so that successive frames bind the same buffers.
    pub fn lend(
        &mut self,
        device: &wgpu::Device,
        label: &'static str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> wgpu::Buffer {
        let size = bytes.max(4).next_multiple_of(4);
        self.lent_bytes += size;
        self.peak_bytes = self.peak_bytes.max(self.lent_bytes);
        let fits = |f: &Free| f.buffer.size() == size && f.buffer.usage() == usage;
        let own = self.free.iter().position(|f| f.label == label && fits(f));
        let found = own.or_else(|| self.free.iter().position(fits));
        match found {
            Some(index) => self.free.swap_remove(index).buffer,
            None => device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            }),
        }
    }

    /// Takes a buffer back that was lent as `label`.
    pub fn give_back(&mut self, label: &'static str, buffer: wgpu::Buffer) {
        self.lent_bytes -= buffer.size();
        self.free.push(Free {
            label,
            buffer,
            last_used: self.frame,
        });
    }

    /// Drops all free buffers.
    pub fn clear(&mut self) {
        self.free.clear();
    }

    /// Bytes lent now.
    pub fn lent_bytes(&self) -> u64 {
        self.lent_bytes
    }

    /// Most bytes lent at once since the frame began.
    pub fn peak_bytes(&self) -> u64 {
        self.peak_bytes
    }

    /// Bytes kept for later frames.
    pub fn free_bytes(&self) -> u64 {
        self.free.iter().map(|f| f.buffer.size()).sum()
    }
}
