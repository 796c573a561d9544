//! Objects on the GPU: the meshes, and where they are placed.

use super::Slot;
use crate::gpu_struct;
use crate::graph::Origin;

gpu_struct! {
    /// A placed mesh of `shaders/shared/geometry.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Instance = "Instance" {
        mesh_x: [f32; 4],
        mesh_y: [f32; 4],
        mesh_z: [f32; 4],
        albedo: [f32; 4],
        nodes: [[u32; 4]; 4],
        first_node: u32,
        node_count: u32,
        first_triangle: u32,
        pad: u32,
    }
}

/// Triangles and hierarchies of the meshes.
pub static GEOMETRY: Slot = Slot {
    origin: Origin::HostCached,
    ..Slot::buffer("geometry", "hierarchy nodes and triangles, m", |facts| {
        facts.receivers.geometry_bytes
    })
};

/// Placed meshes.
pub static INSTANCES: Slot = Slot {
    origin: Origin::Host,
    element: Some(Instance::LAYOUT),
    ..Slot::buffer(
        "instances",
        "placement, hierarchy over all m, albedo",
        // At least one: a binding may not be shorter than an element of its array.
        |facts| size_of::<Instance>() as u64 * facts.receivers.objects.len().max(1) as u64,
    )
};
