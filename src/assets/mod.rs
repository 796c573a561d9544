//! Data that scenes refer to by content id: meshes, and files of numbers.

pub mod fields;
pub mod meshes;
mod store;

pub use fields::{FieldStore, InsertedField};
pub use meshes::{Inserted, MeshStore};

use std::sync::Arc;

use crate::fields::Field;
use crate::mesh::Mesh;
use crate::scene::Assets;

impl Assets for (&MeshStore, &FieldStore) {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self.0.get(id)
    }

    fn field(&self, id: &str) -> Option<Arc<Field>> {
        self.1.get(id)
    }
}
