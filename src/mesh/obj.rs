//! OBJ and MTL in.

/// Why a mesh was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Nothing to read.
    #[error("the mesh is empty")]
    Empty,
}
