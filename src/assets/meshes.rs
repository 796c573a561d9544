//! Meshes by id.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::config::Limits;
use crate::mesh::{Mesh, MeshError, MeshInfo, obj};

/// Meshes by content id, for many threads, within a budget of bytes. Nothing is thrown out to make room: a mesh stays
/// until it is removed, and one that does not fit is refused.
#[derive(Debug)]
pub struct MeshStore {
    limits: Limits,
    held: RwLock<Held>,
}

#[derive(Debug, Default)]
struct Held {
    meshes: BTreeMap<String, Arc<Mesh>>,
    bytes: u64,
}

/// A mesh that is in the store now.
#[derive(Clone, Debug)]
pub struct Inserted {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Whether it was not there before.
    pub created: bool,
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
            held: RwLock::default(),
        }
    }

    /// Reads a mesh and keeps it; the same bytes give the mesh that is there already, without reading them again.
    ///
    /// Takes up to seconds for the largest meshes; other calls go on meanwhile.
    ///
    /// # Errors
    /// What [`obj::read`] refuses, and [`MeshError::StoreFull`].
    pub fn insert_obj(&self, obj: &[u8], mtl: Option<&[u8]>) -> Result<Inserted, MeshError> {
        if let Some(mesh) = self.get(&obj::id(obj, mtl)) {
            return Ok(Inserted {
                mesh,
                created: false,
            });
        }
        let mesh = Arc::new(obj::read(obj, mtl, &self.limits)?);
        let needed_bytes = mesh.bytes();
        let mut held = self.write();
        // Another thread may have brought the same mesh in the meantime.
        if let Some(mesh) = held.meshes.get(&mesh.id) {
            return Ok(Inserted {
                mesh: Arc::clone(mesh),
                created: false,
            });
        }
        if held.bytes.saturating_add(needed_bytes) > self.limits.mesh_store_bytes {
            return Err(MeshError::StoreFull {
                needed_bytes,
                used_bytes: held.bytes,
                budget_bytes: self.limits.mesh_store_bytes,
            });
        }
        held.bytes += needed_bytes;
        held.meshes.insert(mesh.id.clone(), Arc::clone(&mesh));
        Ok(Inserted {
            mesh,
            created: true,
        })
    }

    /// The mesh of an id.
    pub fn get(&self, id: &str) -> Option<Arc<Mesh>> {
        self.read().meshes.get(id).cloned()
    }

    /// Forgets a mesh; whether it was there. Frames that hold it keep it until they are done.
    pub fn remove(&self, id: &str) -> bool {
        let mut held = self.write();
        let Some(mesh) = held.meshes.remove(id) else {
            return false;
        };
        held.bytes -= mesh.bytes();
        true
    }

    /// All meshes, sorted by id.
    pub fn list(&self) -> Vec<MeshInfo> {
        self.read().meshes.values().map(|m| m.info()).collect()
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.read().bytes
    }

    // No code that holds the lock can panic half-way through a change, so a poisoned lock guards sound data.
    fn read(&self) -> RwLockReadGuard<'_, Held> {
        self.held.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Held> {
        self.held.write().unwrap_or_else(PoisonError::into_inner)
    }
}
