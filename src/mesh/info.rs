//! The description of a mesh, for lists and answers.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{HierarchyNode, Material, Mesh, Triangle};
use crate::stats::Warning;

/// A stored mesh, without its triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshInfo {
    /// `blake3:<hex>` of the uploaded bytes.
    pub id: String,
    /// Number of triangles kept.
    pub triangles: usize,
    /// Bounds of the kept triangles, in the file's coordinates.
    pub bounds_m: MeshBounds,
    /// Number of materials that triangles use.
    pub materials: Vec<Material>,
    /// Host memory of the mesh, bytes.
    pub bytes: u64,
    /// What was repaired or left out while reading.
    pub warnings: Vec<Warning>,
}

/// An axis-aligned box, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshBounds {
    /// Lower corner, m.
    pub min: [f64; 3],
    /// Upper corner, m.
    pub max: [f64; 3],
}

impl Mesh {
    /// The description of the mesh.
    pub fn info(&self) -> MeshInfo {
        MeshInfo {
            id: self.id.clone(),
            triangles: self.triangles.len(),
            bounds_m: MeshBounds {
                min: (self.origin_m + self.min_m.as_dvec3()).to_array(),
                max: (self.origin_m + self.max_m.as_dvec3()).to_array(),
            },
            materials: self.materials.clone(),
            bytes: self.bytes(),
            warnings: self.warnings.clone(),
        }
    }

    /// Host memory of the mesh, bytes.
    pub fn bytes(&self) -> u64 {
        let texts = self.materials.iter().map(|m| m.name.len()).sum::<usize>()
            + self
                .warnings
                .iter()
                .map(|w| w.code.len() + w.message.len())
                .sum::<usize>();
        let all = size_of::<Self>()
            + self.id.len()
            + texts
            + self.triangles.len() * size_of::<Triangle>()
            + self.hierarchy.len() * size_of::<HierarchyNode>()
            + self.materials.len() * size_of::<Material>()
            + self.warnings.len() * size_of::<Warning>();
        all as u64
    }
}
