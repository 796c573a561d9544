//! The mesh store.

use std::sync::Arc;

use super::store::{Full, Store, Stored};
use crate::config::Limits;
use crate::mesh::{Mesh, MeshError, MeshInfo, obj};
use crate::scene::Assets;

/// Meshes by content id, shared between threads, within a budget of bytes. Nothing is evicted: a mesh stays until it is removed,
/// and a mesh that does not fit is refused.
#[derive(Debug)]
pub struct MeshStore {
    limits: Limits,
    store: Store<Mesh>,
}

/// A mesh in the store.
#[derive(Clone, Debug)]
pub struct Inserted {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Whether this upload added it.
    pub created: bool,
}

impl Stored for Mesh {
    fn id(&self) -> &str {
        &self.id
    }

    fn bytes(&self) -> u64 {
        self.bytes()
    }
}

impl Default for MeshStore {
    fn default() -> Self {
        Self::new(&Limits::default())
    }
}

impl MeshStore {
    /// An empty store; `limits.mesh_store_bytes` and `limits.max_triangles` apply.
    pub fn new(limits: &Limits) -> Self {
        Self {
            limits: *limits,
            store: Store::new(limits.mesh_store_bytes),
        }
    }

    /// Reads a mesh with its MTL files, and stores it. If the same bytes are stored already, returns that mesh without reading them again.
    ///
    /// The largest meshes take seconds; other calls are not blocked meanwhile.
    ///
    /// # Errors
    /// What [`obj::read`] refuses, and [`MeshError::StoreFull`].
    pub fn insert_obj(&self, obj: &[u8], mtls: &[&[u8]]) -> Result<Inserted, MeshError> {
        if let Some(mesh) = self.get(&obj::id(obj, mtls)) {
            return Ok(Inserted {
                mesh,
                created: false,
            });
        }
        let mesh = obj::read(obj, mtls, &self.limits)?;
        match self.store.insert(mesh) {
            Ok((mesh, created)) => Ok(Inserted { mesh, created }),
            Err(Full {
                needed_bytes,
                used_bytes,
                budget_bytes,
            }) => Err(MeshError::StoreFull {
                needed_bytes,
                used_bytes,
                budget_bytes,
            }),
        }
    }

    /// The mesh with this id.
    pub fn get(&self, id: &str) -> Option<Arc<Mesh>> {
        self.store.get(id)
    }

    /// Removes a mesh; returns whether it was stored. Frames that use it keep it until they are done.
    pub fn remove(&self, id: &str) -> bool {
        self.store.remove(id)
    }

    /// All meshes, sorted by id.
    pub fn list(&self) -> Vec<MeshInfo> {
        self.store.list(Mesh::info)
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.store.bytes()
    }
}

impl Assets for &MeshStore {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self.get(id)
    }
}
