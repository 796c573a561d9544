//! What a pass is.

use super::slot::Slot;
use crate::facts::SceneFacts;
use crate::facts::placement::LevelBox;

/// How often a pass runs in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// Once per level map that is not cached.
    LevelMap,
    /// Once per light, and again when its light is done coarsely to estimate the error.
    Light,
    /// Once per light and not again: what makes its maps, or only counts.
    FineLight,
    /// Once per light and only when its light is done again coarsely, to estimate the error.
    CoarseLight,
    /// Once, when all lights are done.
    Frame,
    /// Once per band of the picture.
    Band,
}

/// A run of a pass: which of its repetitions it is.
#[derive(Clone, Copy, Debug)]
pub enum Run<'a> {
    /// Build this level map at word `arena_offset` of the arena, from the mesh whose triangles begin at `first_triangle`
    /// (in 16-byte units of the geometry).
    LevelMap {
        /// The map's box.
        level_box: &'a LevelBox,
        /// Word offset in the arena.
        arena_offset: u32,
        /// Where the mesh's triangles begin.
        first_triangle: u32,
        /// How many there are.
        triangles: u32,
    },
    /// Follow a light.
    Light {
        /// Which one.
        index: usize,
        /// With 64-bit flux sums, after narrow ones have wrapped.
        wide_sums: bool,
    },
    /// Take what a light left that was done coarsely; the facts are the coarse ones.
    CoarseLight {
        /// Which one.
        index: usize,
        /// As of [`Run::Light`].
        wide_sums: bool,
        /// The scene whose maps are compared with.
        fine: &'a SceneFacts,
    },
    /// Look at the finished maps, beside what the light has left that was done coarsely.
    Frame,
    /// Make these rows of the picture.
    Band {
        /// First row.
        first_row: u32,
        /// Number of rows.
        rows: u32,
        /// Where in the pixel the rays go: away from its middle, in pixels.
        offset: [f64; 2],
        /// Samples that the picture already holds.
        sample_index: u32,
    },
}

/// How many workgroups a step runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Groups {
    /// As many as this.
    Direct([u32; 3]),
    /// As many as the head of this queue says.
    Queue(Slot),
    /// As many as this queue says from this word on.
    QueueAt(Slot, u32),
}

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// A compute dispatch.
    Compute(Groups),
    /// Draws a surface of a level map.
    DrawLevelMap {
        /// Which one.
        surface: Surface,
        /// Vertices.
        vertices: u32,
    },
    /// A compute dispatch that sees a further layer of the level map that was drawn.
    StoreLayer {
        /// Which one, 1 … layers − 1.
        layer: u32,
        /// Workgroups.
        groups: [u32; 3],
    },
    /// Draws what lies nearest to a plane into that plane's slice image.
    DrawSlice {
        /// Which plane.
        plane: u32,
        /// Texels along each side of the image.
        texels: u32,
        /// Vertices.
        vertices: u32,
    },
    /// A compute dispatch that reads a plane's slice image.
    OverSlice {
        /// Workgroups.
        groups: [u32; 3],
        /// Which plane.
        plane: u32,
    },
}

/// What is drawn of a mesh from the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The nearest.
    Front,
    /// The farthest.
    Back,
    /// The nearest behind layer `layer` − 1.
    Layer(u32),
}

/// One dispatch or draw.
#[derive(Clone, Debug)]
pub struct Step {
    /// Entry point (of a draw: the vertex entry point).
    pub entry: &'static str,
    /// What it does.
    pub work: Work,
    /// Bytes of the uniform variables, by name.
    pub uniforms: Vec<(&'static str, Vec<u8>)>,
}

/// A pass: everything the planner and the executor need to know of it.
#[derive(Clone, Copy, Debug)]
pub struct PassDesc {
    /// Name; the shader is `shaders/passes/<name>.wgsl`.
    pub name: &'static str,
    /// How often it runs.
    pub repeat: Repeat,
    /// Slots it cannot do without.
    pub reads: &'static [Slot],
    /// Slots it takes where they are there.
    pub reads_if_present: &'static [Slot],
    /// Slots it fills.
    pub writes: &'static [Slot],
    /// Why it is in (`Ok`) or out (`Err`), as a sentence.
    pub wanted: fn(&SceneFacts) -> Result<String, String>,
    /// Its dispatches for one run.
    pub steps: fn(&SceneFacts, Run<'_>) -> Vec<Step>,
}
