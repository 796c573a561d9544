//! Slots: the buffers and textures that flow between passes.

use std::cmp::Ordering;
use std::fmt;

use super::Layout;
use super::scope::Program;

/// Who fills a slot, and how long it lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Passes. It lives from the first pass that uses it to the last.
    Passes,
    /// The host, before the frame.
    Host,
    /// Passes; a cache keeps it from frame to frame.
    Cached,
    /// The host; a cache keeps it from frame to frame.
    HostCached,
}

/// How a slot is cleared before each beam set.
pub enum Clear<P: Program> {
    /// Not at all.
    Nothing,
    /// The first bytes become zero. The function gives their number for narrow (false) or wide (true) flux sums.
    Zero(fn(&P::Facts, bool) -> u64),
    /// The first words become these, such as the head of an empty queue.
    Head(&'static [u32]),
}

/// Textures of a slot.
pub struct Texture<P: Program> {
    /// Format of a texel.
    pub format: wgpu::TextureFormat,
    /// How shaders see it: 2D, an array of 2D layers, or 3D.
    pub dimension: wgpu::TextureViewDimension,
    /// Width, height, and depth or layers, for a scene.
    pub extent: fn(&P::Facts) -> [u32; 3],
    /// Usage besides being read by shaders: rendered to, or stored to.
    pub usage: wgpu::TextureUsages,
}

impl<P: Program> Texture<P> {
    /// Size for a scene, bytes.
    pub fn bytes(&self, facts: &P::Facts) -> u64 {
        let [x, y, z] = (self.extent)(facts).map(u64::from);
        let texel = self.format.block_copy_size(None).unwrap_or(4);
        u64::from(texel) * x * y * z
    }
}

/// What a slot is.
pub enum Kind<P: Program> {
    /// A buffer; the function gives its size in bytes.
    Buffer(fn(&P::Facts) -> u64),
    /// Textures.
    Texture(Texture<P>),
}

/// A buffer or texture that passes share. The WGSL variable that binds it has the same name. The name identifies a slot; a test checks
/// that names are unique.
pub struct SlotDesc<P: Program> {
    /// Name in WGSL and in plans.
    pub name: &'static str,
    /// What one element holds, with its unit.
    pub holds: &'static str,
    /// Who fills it.
    pub origin: Origin,
    /// Buffer or textures, and their size.
    pub kind: Kind<P>,
    /// How it is cleared before each beam set.
    pub clear: Clear<P>,
    /// Layout of an element that is a struct.
    pub element: Option<Layout>,
}

impl<P: Program> SlotDesc<P> {
    /// A buffer of `bytes` bytes that passes fill.
    pub const fn buffer(
        name: &'static str,
        holds: &'static str,
        bytes: fn(&P::Facts) -> u64,
    ) -> Self {
        Self {
            name,
            holds,
            origin: Origin::Passes,
            kind: Kind::Buffer(bytes),
            clear: Clear::Nothing,
            element: None,
        }
    }

    /// A texture that passes draw into.
    pub const fn texture(name: &'static str, holds: &'static str, texture: Texture<P>) -> Self {
        Self {
            name,
            holds,
            origin: Origin::Passes,
            kind: Kind::Texture(texture),
            clear: Clear::Nothing,
            element: None,
        }
    }

    /// Size for a scene, bytes. A cached slot is sized by its cache instead.
    pub fn bytes(&self, facts: &P::Facts) -> u64 {
        match &self.kind {
            Kind::Buffer(bytes) => bytes(facts),
            Kind::Texture(texture) => texture.bytes(facts),
        }
    }

    /// Whether it is a buffer.
    pub fn is_buffer(&self) -> bool {
        matches!(self.kind, Kind::Buffer(_))
    }
}

impl<P: Program> PartialEq for SlotDesc<P> {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl<P: Program> Eq for SlotDesc<P> {}

impl<P: Program> PartialOrd for SlotDesc<P> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<P: Program> Ord for SlotDesc<P> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name.cmp(other.name)
    }
}

impl<P: Program> fmt::Debug for SlotDesc<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
