//! Data that scenes refer to by content id: meshes.

pub mod meshes;

pub use meshes::{Inserted, MeshStore};
