//! Looks up the meshes and other files of a valid scene by their ids, so that it can be rendered.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::error::{Issue, IssueKind, SceneError};
use super::field_frames::{self, FieldFrames};
use super::types::Scene;
use crate::config::Limits;
use crate::fields::Field;
use crate::kept::Kept;
use crate::mesh::Mesh;

/// A validated scene with the meshes of its objects and the files of its waves: everything that a frame needs.
#[derive(Clone, Debug)]
pub struct ResolvedScene {
    /// The scene as requested.
    pub scene: Scene,
    /// The mesh of each object, in the order of `scene.objects`.
    pub meshes: Vec<Arc<Mesh>>,
    /// The frames of each height field, by index into `scene.water.waves`.
    pub fields: BTreeMap<usize, Arc<FieldFrames>>,
    /// What is computed from the scene and may serve again: for another frame, or other dials.
    pub kept: Kept,
}

/// Where the data is that scenes refer to by content id. A function from ids to meshes is enough where nothing else is needed.
pub trait Assets {
    /// The mesh with this id.
    fn mesh(&self, id: &str) -> Option<Arc<Mesh>>;

    /// The file of numbers with this id. By default there is none.
    fn field(&self, id: &str) -> Option<Arc<Field>> {
        let _ = id;
        None
    }

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
    /// A valid scene without objects and height fields, which refers to nothing.
    pub fn bare(scene: Scene) -> Self {
        Self {
            scene,
            meshes: Vec::new(),
            fields: BTreeMap::new(),
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

/// Validates a scene and looks up the mesh of every object and the files of every height field.
///
/// # Errors
///
/// All findings of [`Scene::validate`], every unknown mesh, and what is wrong with the files of height fields together.
/// [`SceneError::kind`] is [`IssueKind::UnknownMesh`] or [`IssueKind::UnknownAsset`] only if nothing else is wrong.
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
    let fields = if scene.water.waves.len() <= limits.max_waves {
        field_frames::find(&scene, &assets, &mut issues)
    } else {
        BTreeMap::new()
    };
    if issues.is_empty() {
        Ok(ResolvedScene {
            scene,
            meshes,
            fields,
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
