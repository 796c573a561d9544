//! Meshes: reading OBJ and MTL (`obj`, with `scan`, `mtl` and `text`, which check the texts first, and `polygon`, which cuts polygons
//! into triangles), repairs (`repair`), errors (`error`), a ray hierarchy over the triangles (`hierarchy`), and a description of each
//! mesh (`info`).

mod error;
pub mod hierarchy;
mod info;
pub(crate) mod mtl;
pub mod obj;
mod polygon;
pub(crate) mod repair;
mod scan;
mod text;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

pub use error::MeshError;
pub use hierarchy::HierarchyNode;
pub use info::{MeshBounds, MeshInfo};
pub use mtl::DEFAULT_ALBEDO;
pub use scan::MAX_COORDINATE_M;

/// A triangle mesh, immutable after reading.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// `blake3:<hex>` of the uploaded bytes.
    pub id: String,
    /// Middle of the bounds in file coordinates, m. All following coordinates are relative to it, so that f32 keeps the detail.
    pub origin_m: DVec3,
    /// Lower corner of the bounds, relative to `origin_m`, m.
    pub min_m: Vec3,
    /// Upper corner of the bounds, relative to `origin_m`, m.
    pub max_m: Vec3,
    /// Triangles; none is degenerate.
    pub triangles: Vec<Triangle>,
    /// Materials; never empty.
    pub materials: Vec<Material>,
    /// Skip-pointer hierarchy over `triangles`, in traversal order.
    pub hierarchy: Vec<HierarchyNode>,
    /// What was repaired or left out while reading, one sentence each.
    pub warnings: Vec<crate::stats::Warning>,
}

/// One triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Corners relative to the mesh's origin, m. Counter-clockwise as seen from outside, if they are so in the file.
    pub positions_m: [Vec3; 3],
    /// Unit shading normals at the corners: the file's if it has them, else the face normal.
    pub normals: [Vec3; 3],
    /// Index into the mesh's materials.
    pub material: u32,
}

/// A diffuse material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Material {
    /// Name in the file; empty for the default material.
    pub name: String,
    /// Diffuse reflectance (MTL `Kd`), 0 … 1 per channel; 0.8 without a material.
    pub albedo: [f32; 3],
}
