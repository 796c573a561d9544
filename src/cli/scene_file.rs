//! Reads a scene file, its meshes and its height fields, which are named by paths relative to it.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Read};
use std::path::Path;

use super::error::CliError;
use super::material_files;
use super::scene_flags::SceneArgs;
use crate::assets::{FieldStore, MeshStore};
use crate::config::Limits;
use crate::methods;
use crate::scene::height_field::MAX_FRAMES;
use crate::scene::parse::read_json;
use crate::scene::{ImageFormat, Issue, ResolvedScene, Scene, SceneError, Wave, overrides};

/// Prefix of a file that is named by content id, not by path.
const ID_PREFIX: &str = "blake3:";

/// JSON pointer to the file format.
const FORMAT: &str = "/output/format";

/// A scene that can be rendered.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene; meshes and height fields are named by content id.
    pub resolved: ResolvedScene,
    /// Notes about the meshes for the user, one sentence each.
    pub notes: Vec<String>,
}

/// Reads the scene file, replaces fields, reads the meshes and height fields, and checks everything.
///
/// `format` is that of the output file's name; it takes precedence over the scene.
///
/// # Errors
///
/// [`CliError::Read`] for the scene file, [`CliError::Scene`] for all errors in it, unreadable files included,
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
        with_files(Scene::from_value(value)?, directory_of(path), limits)
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

/// Replaces paths of meshes and height fields by content ids.
fn with_files(
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
    let fields = FieldStore::new(limits);
    issues.extend(read_fields(&mut scene, &fields, directory, limits));
    if issues.is_empty() {
        let resolved = methods::resolve(scene, limits, (&store, &fields))?;
        return Ok(SceneFile { resolved, notes });
    }
    let others = methods::validate(&scene, limits).err();
    let others = others.map_or_else(Vec::new, |error| error.issues);
    issues.splice(0..0, others);
    Err(SceneError { issues })
}

/// Reads the files of all height fields, and replaces their paths by content ids; returns what is wrong.
fn read_fields(
    scene: &mut Scene,
    store: &FieldStore,
    directory: &Path,
    limits: &Limits,
) -> Vec<Issue> {
    let mut issues = Vec::new();
    let mut known: BTreeMap<String, Result<String, String>> = BTreeMap::new();
    let waves = scene.water.waves.iter_mut().take(limits.max_waves);
    for (index, wave) in waves.enumerate() {
        let Wave::HeightField(field) = wave else {
            continue;
        };
        // More are refused without reading them.
        for (frame, name) in field.frames.iter_mut().take(MAX_FRAMES).enumerate() {
            if name.is_empty() || name.starts_with(ID_PREFIX) {
                continue;
            }
            let read = known
                .entry(name.clone())
                .or_insert_with(|| read_field(store, &directory.join(&*name)));
            match read {
                Ok(id) => name.clone_from(id),
                Err(reason) => issues.push(Issue::invalid(
                    format!("/water/waves/{index}/frames/{frame}"),
                    format!("the file `{name}` cannot be used: {reason}"),
                    "the path of an NPY, EXR or PNG file, relative to the scene file",
                )),
            }
        }
    }
    issues
}

/// Reads a file of numbers. Returns its id.
fn read_field(store: &FieldStore, path: &Path) -> Result<String, String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    let inserted = store.insert(&bytes).map_err(|error| error.to_string())?;
    Ok(inserted.field.id.clone())
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
