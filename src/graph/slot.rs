//! What flows between passes.

use std::cmp::Ordering;
use std::fmt;

use super::Layout;
use super::scope::Program;

/// Who fills a slot, and how long it lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Passes. It lives from the first that touches it to the last.
    Passes,
    /// The host, before the frame.
    Host,
    /// Passes; a cache keeps it from frame to frame.
    Cached,
    /// The host; a cache keeps it from frame to frame.
    HostCached,
}

/// What a slot's content is before each beam set.
pub enum Clear<P: Program> {
    /// Whatever was there.
    Nothing,
    /// Zeros in the first bytes: so many, with narrow (false) or wide (true) flux sums.
    Zero(fn(&P::Facts, bool) -> u64),
    /// These words at the beginning, such as the head of an empty queue.
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
    /// Besides being read by shaders: rendered to, or stored to.
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
    /// A buffer of so many bytes.
    Buffer(fn(&P::Facts) -> u64),
    /// Textures.
    Texture(Texture<P>),
}

/// What passes share. A WGSL variable that binds it has its name. Slots are told apart by their names, which a test keeps apart.
pub struct SlotDesc<P: Program> {
    /// Name in WGSL and in plans.
    pub name: &'static str,
    /// What one element holds, with its unit.
    pub holds: &'static str,
    /// Who fills it.
    pub origin: Origin,
    /// Buffer or textures, and their size.
    pub kind: Kind<P>,
    /// What it holds before each beam set.
    pub clear: Clear<P>,
    /// Layout of an element that is a struct.
    pub element: Option<Layout>,
}

impl<P: Program> SlotDesc<P> {
    /// A buffer that passes fill, of so many bytes.
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

    /// Size for a scene, bytes. What is kept is sized by its cache.
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
