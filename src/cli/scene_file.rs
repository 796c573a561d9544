//! Reads a scene file and its meshes, which are named by paths relative to it.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::Path;

use super::error::CliError;
use super::material_files;
use super::scene_flags::SceneArgs;
use crate::assets::MeshStore;
use crate::config::Limits;
use crate::methods;
use crate::scene::parse::read_json;
use crate::scene::{ImageFormat, Issue, ResolvedScene, Scene, SceneError, overrides};

/// Prefix of a mesh that is named by content id, not by path.
const ID_PREFIX: &str = "blake3:";

/// JSON pointer to the file format.
const FORMAT: &str = "/output/format";

/// A scene that can be rendered.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene; meshes are named by content id.
    pub resolved: ResolvedScene,
    /// Notes about the meshes for the user, one sentence each.
    pub notes: Vec<String>,
}

/// Reads the scene file, replaces fields, reads the meshes, and checks everything.
///
/// `format` is that of the output file's name; it takes precedence over the scene.
///
/// # Errors
///
/// [`CliError::Read`] for the scene file, [`CliError::Scene`] for all errors in it, unreadable meshes included,
/// [`CliError::Usage`] if `--format` contradicts `format`.
pub fn load(
    args: &SceneArgs,
    format: Option<ImageFormat>,
    limits: &Limits,
) -> Result<SceneFile, CliError> {
    let path = args.scene.as_path();
    let bytes = read_scene(path)?;
    let mut changes = args.overrides.0.clone();
    if let Some(format) = format {
        changes.push(format_change(format, &changes)?);
    }
    let from_bytes = || {
        let mut value = read_json(&bytes)?;
        overrides::apply(&mut value, &changes);
        with_meshes(Scene::from_value(value)?, directory_of(path), limits)
    };
    from_bytes().map_err(|error| CliError::Scene {
        file: path.display().to_string(),
        error,
    })
}

fn read_scene(path: &Path) -> Result<Vec<u8>, CliError> {
    let read = if path == Path::new("-") {
        let mut bytes = Vec::new();
        io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        fs::read(path)
    };
    read.map_err(|error| CliError::read(path, error))
}

fn directory_of(path: &Path) -> &Path {
    path.parent().unwrap_or_else(|| Path::new(""))
}

/// The override that sets the scene's format to that of the file's name.
fn format_change(
    format: ImageFormat,
    changes: &[(String, String)],
) -> Result<(String, String), CliError> {
    let word = match format {
        ImageFormat::Png => "png",
        ImageFormat::Exr => "exr",
    };
    let asked = changes.iter().find(|(pointer, _)| pointer == FORMAT);
    match asked {
        Some((_, asked)) if asked.trim() != word => Err(CliError::Usage(format!(
            "--format {asked} contradicts the name of the output file, which ends in .{word}; leave one of them out"
        ))),
        _ => Ok((FORMAT.to_owned(), word.to_owned())),
    }
}

/// Replaces paths of meshes by content ids.
fn with_meshes(
    mut scene: Scene,
    directory: &Path,
    limits: &Limits,
) -> Result<SceneFile, SceneError> {
    let store = MeshStore::new(limits);
    let mut notes = Vec::new();
    let mut issues = Vec::new();
    let mut known: BTreeMap<String, Result<String, String>> = BTreeMap::new();
    for (index, object) in scene
        .objects
        .iter_mut()
        .take(limits.max_objects)
        .enumerate()
    {
        if object.mesh.is_empty() || object.mesh.starts_with(ID_PREFIX) {
            continue;
        }
        let read = known.entry(object.mesh.clone()).or_insert_with(|| {
            read_mesh(&store, directory, &directory.join(&object.mesh), &mut notes)
        });
        match read {
            Ok(id) => object.mesh.clone_from(id),
            Err(reason) => issues.push(Issue::invalid(
                format!("/objects/{index}/mesh"),
                format!("the mesh `{}` cannot be used: {reason}", object.mesh),
                "the path of an OBJ file, relative to the scene file",
            )),
        }
    }
    if issues.is_empty() {
        let resolved = methods::resolve(scene, limits, &store)?;
        return Ok(SceneFile { resolved, notes });
    }
    let others = methods::validate(&scene, limits).err();
    let others = others.map_or_else(Vec::new, |error| error.issues);
    issues.splice(0..0, others);
    Err(SceneError { issues })
}

/// Reads an OBJ file, and the MTL files it names. Returns the mesh's id.
fn read_mesh(
    store: &MeshStore,
    scene_folder: &Path,
    path: &Path,
    notes: &mut Vec<String>,
) -> Result<String, String> {
    let obj = fs::read(path).map_err(|error| error.to_string())?;
    let mtls = material_files::read(&obj, path, scene_folder, notes);
    let mtls: Vec<&[u8]> = mtls.iter().map(Vec::as_slice).collect();
    let inserted = store
        .insert_obj(&obj, &mtls)
        .map_err(|error| error.to_string())?;
    let of_mesh = inserted.mesh.warnings.iter();
    notes.extend(of_mesh.map(|warning| format!("{}: {}", path.display(), warning.message)));
    Ok(inserted.mesh.id.clone())
}
