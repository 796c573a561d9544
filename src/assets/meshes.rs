//! The mesh store.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::config::Limits;
use crate::mesh::{Mesh, MeshError, MeshInfo, obj};
use crate::scene::Assets;

/// Meshes by content id, shared between threads, within a budget of bytes. Nothing is evicted: a mesh stays until it is removed,
/// and a mesh that does not fit is refused.
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

/// A mesh in the store.
#[derive(Clone, Debug)]
pub struct Inserted {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Whether this upload added it.
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
        let mesh = Arc::new(obj::read(obj, mtls, &self.limits)?);
        let needed_bytes = mesh.bytes();
        let mut held = self.write();
        // Another thread may have added the same mesh meanwhile.
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

    /// The mesh with this id.
    pub fn get(&self, id: &str) -> Option<Arc<Mesh>> {
        self.read().meshes.get(id).cloned()
    }

    /// Removes a mesh; returns whether it was stored. Frames that use it keep it until they are done.
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

    // No code that holds the lock can panic in the middle of a change, so the data behind a poisoned lock is valid.
    fn read(&self) -> RwLockReadGuard<'_, Held> {
        self.held.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Held> {
        self.held.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Assets for &MeshStore {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self.get(id)
    }
}
