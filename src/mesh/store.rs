//! Meshes by id.

/// Meshes by content id.
#[derive(Debug, Default)]
pub struct MeshStore {}
