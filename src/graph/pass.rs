//! What a pass is.

use std::fmt;

use super::Layout;
use super::scope::{Program, Steps};
use super::slot::SlotDesc;

/// How many workgroups a dispatch runs.
pub enum Groups<P: Program> {
    /// As many as this.
    Direct([u32; 3]),
    /// As many as the three words of this queue from word number .1 on say.
    Queue(&'static SlotDesc<P>, u32),
}

impl<P: Program> Clone for Groups<P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Program> Copy for Groups<P> {}

/// A texture that is drawn into.
pub struct Color<P: Program> {
    /// The slot.
    pub slot: &'static SlotDesc<P>,
    /// Which of its layers.
    pub layer: u32,
    /// What it is cleared to; `None`: what is there stays.
    pub clear: Option<[f64; 4]>,
    /// How fragments join what is there; `None`: they replace it.
    pub blend: Option<wgpu::BlendState>,
}

/// The depth (and stencil) a draw tests against.
pub struct Depth<P: Program> {
    /// The slot.
    pub slot: &'static SlotDesc<P>,
    /// What the depth is cleared to; `None`: what is there stays.
    pub clear: Option<f32>,
    /// Which fragment stays.
    pub compare: wgpu::CompareFunction,
    /// Whether the depth of a fragment that stays is written.
    pub writes: bool,
    /// The stencil test; the reference value is 0.
    pub stencil: wgpu::StencilState,
    /// What the stencil is cleared to; `None`: what is there stays.
    pub stencil_clear: Option<u32>,
}

/// A draw without vertex buffers; the step's entry point is the vertex shader's.
pub struct Draw<P: Program> {
    /// Entry point of the fragment shader.
    pub fragment: &'static str,
    /// Vertices.
    pub vertices: u32,
    /// Instances.
    pub instances: u32,
    /// Triangles, lines or points.
    pub topology: wgpu::PrimitiveTopology,
    /// Which faces are left out; front faces are counter-clockwise.
    pub cull: Option<wgpu::Face>,
    /// Textures that are drawn into, in the order of the fragment's outputs.
    pub colors: Vec<Color<P>>,
    /// Depth and stencil.
    pub depth: Option<Depth<P>>,
    /// Texels from the upper left corner that are drawn into; `None`: all.
    pub viewport: Option<[u32; 2]>,
}

/// What a step does.
pub enum Work<P: Program> {
    /// A compute dispatch.
    Compute(Groups<P>),
    /// A draw.
    Draw(Draw<P>),
}

/// A texture variable of the shader that is bound to one layer of a slot, under a name of its own.
pub struct View<P: Program> {
    /// Name of the variable.
    pub variable: &'static str,
    /// The slot.
    pub slot: &'static SlotDesc<P>,
    /// Which of its layers.
    pub layer: u32,
}

/// One dispatch or draw.
pub struct Step<P: Program> {
    /// Entry point (of a draw: the vertex entry point).
    pub entry: &'static str,
    /// What it does.
    pub work: Work<P>,
    /// Bytes of the uniform variables, by name.
    pub uniforms: Vec<(&'static str, Vec<u8>)>,
    /// Texture variables that are not called like their slots, or are one layer of them.
    pub views: Vec<View<P>>,
}

impl<P: Program> Step<P> {
    /// A compute dispatch.
    pub fn compute(
        entry: &'static str,
        groups: Groups<P>,
        uniforms: Vec<(&'static str, Vec<u8>)>,
    ) -> Self {
        Self {
            entry,
            work: Work::Compute(groups),
            uniforms,
            views: Vec::new(),
        }
    }
}

/// A pass: everything that planner and executor need to know of it.
pub struct PassDesc<P: Program> {
    /// Its name.
    pub name: &'static str,
    /// Its shader, a path below `shaders/`.
    pub shader: &'static str,
    /// Slots it cannot do without.
    pub reads: &'static [&'static SlotDesc<P>],
    /// Slots it takes where they are there.
    pub reads_if_present: &'static [&'static SlotDesc<P>],
    /// Slots it fills.
    pub writes: &'static [&'static SlotDesc<P>],
    /// Uniform variables that its steps bring along: name, and layout of the struct.
    pub uniforms: &'static [(&'static str, Layout)],
    /// Why it is in (`Ok`) or out (`Err`), as a sentence.
    pub wanted: fn(&P::Facts) -> Result<String, String>,
    /// Its scope, and its dispatches and draws for one run.
    pub steps: Steps<P>,
    /// Units of work of one run: rays through waves, texels, pixels, whatever its time grows with.
    pub work: fn(&P::Facts) -> f64,
}

impl<P: Program> PassDesc<P> {
    /// All slots it touches.
    pub fn slots(&self) -> impl Iterator<Item = &'static SlotDesc<P>> + use<P> {
        let reads = self.reads.iter().chain(self.reads_if_present);
        reads.chain(self.writes).copied()
    }

    /// Whether it touches a slot.
    pub fn touches(&self, slot: &SlotDesc<P>) -> bool {
        self.slots().any(|own| own == slot)
    }
}

impl<P: Program> fmt::Debug for PassDesc<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
