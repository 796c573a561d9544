//! The scene: what a request may say (`types`), how JSON becomes it (`parse`), what is refused (`validate`), and the
//! figures everything downstream is decided from (`facts`).
//!
//! To add a field: put it into `types` with unit, range and default in its doc comment, check its range in `validate`,
//! and run the tests, which tell where `openapi.yaml` has to follow.

pub mod facts;
pub mod parse;
pub mod placement;
pub mod types;
pub mod validate;
pub mod window;

pub use parse::SceneError;
pub use types::*;

use std::sync::Arc;

use crate::mesh::Mesh;

/// A validated scene with the meshes its objects name: all a frame needs.
#[derive(Clone, Debug)]
pub struct ResolvedScene {
    /// The scene as asked for.
    pub scene: Scene,
    /// The mesh of each object, in the order of `scene.objects`.
    pub meshes: Vec<Arc<Mesh>>,
}

impl ResolvedScene {
    /// `blake3:…` of the canonical JSON of the scene; meshes are in it by their content ids.
    pub fn hash(&self) -> String {
        let canonical = serde_json::to_vec(&self.scene).expect("a scene always serialises");
        format!("blake3:{}", blake3::hash(&canonical).to_hex())
    }
}
