//! OBJ and MTL in (minimal stand-in; the mesh branch's version wins).

/// Why a mesh was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Nothing to read.
    #[error("the mesh is empty")]
    Empty,
    /// The store has no room.
    #[error("the mesh store is full")]
    StoreFull {
        /// What the mesh would take.
        needed_bytes: u64,
        /// What is held.
        used_bytes: u64,
        /// What may be held.
        budget_bytes: u64,
    },
}
