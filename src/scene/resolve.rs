//! Looks up the meshes of a valid scene by their ids, so that it can be rendered.

use std::sync::Arc;

use super::error::{Issue, IssueKind, SceneError};
use super::types::Scene;
use crate::config::Limits;
use crate::kept::Kept;
use crate::mesh::Mesh;

/// A validated scene with the meshes of its objects: everything that a frame needs.
#[derive(Clone, Debug)]
pub struct ResolvedScene {
    /// The scene as requested.
    pub scene: Scene,
    /// The mesh of each object, in the order of `scene.objects`.
    pub meshes: Vec<Arc<Mesh>>,
    /// What is computed from the scene and may serve again: for another frame, or other dials.
    pub kept: Kept,
}

/// Where the data is that scenes refer to by content id. A function from ids to meshes is enough where nothing else is needed.
pub trait Assets {
    /// The mesh with this id.
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>>;

    /// Where results are kept. By default nowhere beyond this scene.
    fn kept(&self) -> Kept {
        Kept::default()
    }
}

impl<F: Fn(&str) -> Option<Arc<Mesh>>> Assets for F {
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>> {
        self(id)
    }
}

impl ResolvedScene {
    /// A valid scene without objects, which refers to nothing.
    pub fn bare(scene: Scene) -> Self {
        Self {
            scene,
            meshes: Vec::new(),
            kept: Kept::default(),
        }
    }

    /// The scene as JSON with every default written out; meshes are named by their content ids.
    pub fn canonical_json(&self) -> String {
        serde_json::to_string(&self.scene).expect("a scene always serialises")
    }

    /// `blake3:…` of [`Self::canonical_json`].
    pub fn hash(&self) -> String {
        format!(
            "blake3:{}",
            blake3::hash(self.canonical_json().as_bytes()).to_hex()
        )
    }
}

/// Validates a scene and looks up the mesh of every object.
///
/// # Errors
///
/// All findings of [`Scene::validate`] and every unknown mesh together. [`SceneError::kind`] is [`IssueKind::UnknownMesh`] only
/// if nothing else is wrong.
pub fn resolve(
    scene: Scene,
    limits: &Limits,
    assets: impl Assets,
) -> Result<ResolvedScene, SceneError> {
    let mut issues = scene
        .validate(limits)
        .err()
        .map_or_else(Vec::new, |error| error.issues);
    let mut meshes = Vec::with_capacity(scene.objects.len().min(limits.max_objects));
    for (index, object) in scene.objects.iter().take(limits.max_objects).enumerate() {
        match assets.mesh(&object.mesh) {
            Some(mesh) => meshes.push(mesh),
            // `validate` has reported an empty id.
            None if object.mesh.is_empty() => {}
            None => issues.push(unknown_mesh(index, &object.mesh)),
        }
    }
    if issues.is_empty() {
        Ok(ResolvedScene {
            scene,
            meshes,
            kept: assets.kept(),
        })
    } else {
        Err(SceneError { issues })
    }
}

fn unknown_mesh(index: usize, id: &str) -> Issue {
    Issue::invalid(
        format!("/objects/{index}/mesh"),
        format!("there is no mesh `{}`", super::strict::quoted(id)),
        "the id of an uploaded mesh, `blake3:…`, from the answer of POST /v1/meshes",
    )
    .of_kind(IssueKind::UnknownMesh)
}
