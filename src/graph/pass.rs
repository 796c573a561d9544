//! Description of a pass: its slots, its condition, and its dispatches and draws.

use std::fmt;

use super::Layout;
use super::scope::{Program, Steps};
use super::slot::SlotDesc;

/// The number of workgroups of a dispatch.
pub enum Groups<P: Program> {
    /// A fixed number along each axis.
    Direct([u32; 3]),
    /// Read on the GPU: three words of this queue, starting at word number .1.
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
    /// Clear value; `None`: the old content stays.
    pub clear: Option<[f64; 4]>,
    /// How fragments are blended with the old content; `None`: they replace it.
    pub blend: Option<wgpu::BlendState>,
}

/// The depth (and stencil) a draw tests against.
pub struct Depth<P: Program> {
    /// The slot.
    pub slot: &'static SlotDesc<P>,
    /// Clear value of the depth; `None`: the old content stays.
    pub clear: Option<f32>,
    /// Depth test: which fragments pass.
    pub compare: wgpu::CompareFunction,
    /// Whether the depth of a fragment that passes is written.
    pub writes: bool,
    /// The stencil test; the reference value is 0.
    pub stencil: wgpu::StencilState,
    /// Clear value of the stencil; `None`: the old content stays.
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
    /// Which faces are culled; front faces are counter-clockwise.
    pub cull: Option<wgpu::Face>,
    /// Render targets, in the order of the fragment's outputs.
    pub colors: Vec<Color<P>>,
    /// Depth and stencil.
    pub depth: Option<Depth<P>>,
    /// Width and height of the viewport, from the upper left corner; `None`: the whole target.
    pub viewport: Option<[u32; 2]>,
}

/// What a step does.
pub enum Work<P: Program> {
    /// A compute dispatch.
    Compute(Groups<P>),
    /// A draw.
    Draw(Draw<P>),
}

/// A texture variable of the shader that is bound to one layer of a slot and need not have the slot's name.
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
    /// Texture variables whose names differ from their slots', or that are one layer of a slot.
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

/// A pass: everything that the planner and the executor need.
pub struct PassDesc<P: Program> {
    /// Its name.
    pub name: &'static str,
    /// Its shader, a path below `shaders/`.
    pub shader: &'static str,
    /// Slots it needs.
    pub reads: &'static [&'static SlotDesc<P>],
    /// Slots it reads if they exist.
    pub reads_if_present: &'static [&'static SlotDesc<P>],
    /// Slots it fills.
    pub writes: &'static [&'static SlotDesc<P>],
    /// Uniform variables that its steps supply: name, and layout of the struct.
    pub uniforms: &'static [(&'static str, Layout)],
    /// Texture variables that its steps bind to one layer of a slot, under another name than the slot's.
    pub views: &'static [&'static str],
    /// The reason why it runs (`Ok`) or not (`Err`), as a sentence.
    pub wanted: fn(&P::Facts) -> Result<String, String>,
    /// Its scope, and its dispatches and draws for one run.
    pub steps: Steps<P>,
    /// Units of work of one run, in proportion to its time: rays through waves, texels, pixels.
    pub work: fn(&P::Facts) -> f64,
}

impl<P: Program> PassDesc<P> {
    /// All slots it reads or writes.
    pub fn slots(&self) -> impl Iterator<Item = &'static SlotDesc<P>> + use<P> {
        let reads = self.reads.iter().chain(self.reads_if_present);
        reads.chain(self.writes).copied()
    }

    /// Whether it reads or writes a slot.
    pub fn touches(&self, slot: &SlotDesc<P>) -> bool {
        self.slots().any(|own| own == slot)
    }
}

impl<P: Program> fmt::Debug for PassDesc<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
