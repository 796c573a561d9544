//! Meshes by id (minimal stand-in; the mesh branch's version wins).

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::{Material, Mesh, MeshError};
use crate::config::Limits;
use crate::stats::Warning;

/// Meshes by content id.
#[derive(Debug, Default)]
pub struct MeshStore {
    meshes: Mutex<BTreeMap<String, Arc<Mesh>>>,
}

/// Result of an upload.
#[derive(Clone, Debug)]
pub struct Inserted {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Whether it was not known before.
    pub created: bool,
}

/// What is told about a mesh.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
pub struct MeshInfo {
    /// Id.
    pub id: String,
    /// Triangles.
    pub triangles: usize,
    /// Bounds, m.
    pub bounds_m: BoundsM,
    /// Materials.
    pub materials: usize,
    /// Host memory, bytes.
    pub bytes: u64,
    /// What was mended.
    pub warnings: Vec<Warning>,
}

/// Bounds, m.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
pub struct BoundsM {
    /// Lower corner.
    pub min: [f64; 3],
    /// Upper corner.
    pub max: [f64; 3],
}

impl Mesh {
    /// What is told about it.
    pub fn info(&self) -> MeshInfo {
        MeshInfo {
            id: self.id.clone(),
            triangles: 1,
            bounds_m: BoundsM {
                min: [0.0; 3],
                max: [1.0; 3],
            },
            materials: self.materials.len(),
            bytes: 0,
            warnings: self.warnings.clone(),
        }
    }
}

impl MeshStore {
    /// An empty store.
    pub fn new(_limits: &Limits) -> Self {
        Self::default()
    }

    /// Reads and keeps.
    pub fn insert_obj(&self, obj: &[u8], mtl: Option<&[u8]>) -> Result<Inserted, MeshError> {
        if !obj.windows(2).any(|w| w == b"f ") {
            return Err(MeshError::Empty);
        }
        let mut hasher = blake3::Hasher::new();
        hasher.update(obj);
        hasher.update(mtl.unwrap_or_default());
        let id = format!("blake3:{}", hasher.finalize().to_hex());
        let mut meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        let created = !meshes.contains_key(&id);
        let mesh = Arc::clone(meshes.entry(id.clone()).or_insert_with(|| {
            Arc::new(Mesh {
                id,
                origin_m: glam::DVec3::ZERO,
                min_m: glam::Vec3::ZERO,
                max_m: glam::Vec3::ONE,
                triangles: Vec::new(),
                materials: vec![Material {
                    name: String::new(),
                    albedo: [0.8; 3],
                }],
                hierarchy: Vec::new(),
                warnings: Vec::new(),
            })
        }));
        Ok(Inserted { mesh, created })
    }

    /// By id.
    pub fn get(&self, id: &str) -> Option<Arc<Mesh>> {
        let meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        meshes.get(id).cloned()
    }

    /// Forgets.
    pub fn remove(&self, id: &str) -> bool {
        let mut meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        meshes.remove(id).is_some()
    }

    /// All, by id.
    pub fn list(&self) -> Vec<MeshInfo> {
        let meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        meshes.values().map(|m| m.info()).collect()
    }
}
