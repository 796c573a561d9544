//! What an entry point binds, and bind groups that are kept from frame to frame.

use std::collections::BTreeMap;

use super::pool::KEEP_FRAMES;
use super::uniforms::Placed;

/// Something to bind.
#[derive(Clone, Copy, Debug)]
pub enum Binding<'a> {
    /// The first bytes of a buffer.
    Buffer {
        /// The buffer.
        buffer: &'a wgpu::Buffer,
        /// How many of its bytes.
        bytes: u64,
    },
    /// Constants, for a `var<uniform>`.
    Uniform(&'a Placed),
    /// A texture.
    Texture(&'a wgpu::TextureView),
}

/// What an entry point reads and writes, ready to be set at group 0.
#[derive(Clone, Debug)]
pub struct Bound {
    /// The group.
    pub group: wgpu::BindGroup,
    /// Where its uniforms begin, in the order of their bindings.
    pub offsets: Vec<u32>,
}

/// Bind groups by what they bind, kept from frame to frame as long as the [pool](super::BufferPool) keeps buffers: making one takes a
/// frame's host as long as all the rest of a dispatch. They keep their buffers alive, so whoever drops buffers earlier
/// [clears](Self::clear) them.
#[derive(Debug, Default)]
pub struct BindGroups {
    kept: BTreeMap<(wgpu::BindGroupLayout, Vec<(wgpu::Buffer, u64)>), KeptGroup>,
    frame: u64,
    made: u64,
}

#[derive(Debug)]
struct KeptGroup {
    group: wgpu::BindGroup,
    last_used: u64,
}

impl BindGroups {
    /// Starts a frame: what was not used for some frames is dropped, no later than the buffers it binds.
    pub fn begin_frame(&mut self) {
        self.frame += 1;
        let frame = self.frame;
        self.kept
            .retain(|_, kept| kept.last_used + KEEP_FRAMES >= frame);
    }

    /// Drops all of them.
    pub fn clear(&mut self) {
        self.kept.clear();
    }

    /// How many were made since the start.
    pub fn made(&self) -> u64 {
        self.made
    }

    /// The group of this layout that binds the first bytes of these buffers; made by `make` if there is none.
    pub(super) fn get(
        &mut self,
        layout: &wgpu::BindGroupLayout,
        buffers: Vec<(wgpu::Buffer, u64)>,
        make: impl FnOnce() -> wgpu::BindGroup,
    ) -> wgpu::BindGroup {
        let made = &mut self.made;
        let kept = self
            .kept
            .entry((layout.clone(), buffers))
            .or_insert_with(|| {
                *made += 1;
                KeptGroup {
                    group: make(),
                    last_used: 0,
                }
            });
        kept.last_used = self.frame;
        kept.group.clone()
    }
}
