//! Bindings of entry points, and bind groups that are kept from frame to frame.

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
        /// Number of bytes that are bound.
        bytes: u64,
    },
    /// Constants, for a `var<uniform>`.
    Uniform(&'a Placed),
    /// A texture.
    Texture(&'a wgpu::TextureView),
}

/// Bind group 0 of an entry point, with its dynamic offsets.
#[derive(Clone, Debug)]
pub struct Bound {
    /// The group.
    pub group: wgpu::BindGroup,
    /// Where its uniforms begin, in the order of their bindings.
    pub offsets: Vec<u32>,
}

/// Cache of bind groups, keyed by layout and buffers. Groups are kept as long as the [pool](super::BufferPool) keeps buffers, because
/// making one takes the host as long as the rest of a dispatch. They keep their buffers alive, so code that drops buffers earlier must
/// [clear](Self::clear) them.
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
    /// Starts a frame: drops groups that were not used for some frames, no later than the buffers they bind.
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

    /// Number of groups made since the start.
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
