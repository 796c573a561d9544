//! The scenes of the project, as the command line reads them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use caustica::assets::MeshStore;
use caustica::cli::scene_file;
use caustica::cli::scene_flags::{SceneArgs, SceneOverrides};
use caustica::config::Limits;
use caustica::mesh::Mesh;
use caustica::scene::{ResolvedScene, Scene};
use serde_json::Value;

/// The folder of the scenes.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// Names (without `.json`) of all scenes, sorted.
pub(crate) fn names() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .expect("the project has scenes")
        .filter_map(|entry| {
            let name = entry.expect("the folder can be read").file_name();
            let name = name.into_string().expect("names are UTF-8");
            name.strip_suffix(".json").map(str::to_owned)
        })
        .collect();
    names.sort();
    assert!(!names.is_empty(), "no scenes in {}", folder().display());
    names
}

/// A scene file with fields replaced (JSON pointer and text).
pub(crate) fn load(name: &str, overrides: &[(&str, &str)]) -> ResolvedScene {
    let overrides = overrides
        .iter()
        .map(|&(pointer, text)| (pointer.to_owned(), text.to_owned()))
        .collect();
    let args = SceneArgs {
        scene: folder().join(format!("{name}.json")),
        overrides: SceneOverrides(overrides),
    };
    let loaded = scene_file::load(&args, None, &Limits::default());
    loaded
        .unwrap_or_else(|error| panic!("{name}: {error}"))
        .resolved
}

/// A mesh of the project by its file name.
pub(crate) fn mesh(file: &str) -> Arc<Mesh> {
    let path = folder().join("meshes").join(file);
    let text = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    mesh_of(&text)
}

/// A mesh from the text of an OBJ file.
pub(crate) fn mesh_of(obj: &[u8]) -> Arc<Mesh> {
    let store = MeshStore::new(&Limits::default());
    let inserted = store.insert_obj(obj, &[]).expect("a mesh");
    inserted.mesh
}

/// A scene from JSON; `objects[i].mesh` may be the file name of a mesh of the project.
pub(crate) fn scene(mut value: Value) -> ResolvedScene {
    let mut meshes = Vec::new();
    if let Some(objects) = value.get_mut("objects").and_then(Value::as_array_mut) {
        for object in objects {
            let mesh = mesh(object["mesh"].as_str().expect("a file name"));
            object["mesh"] = Value::from(mesh.id.clone());
            meshes.push(mesh);
        }
    }
    with_meshes(value, &meshes)
}

/// A scene from JSON whose objects name some of `meshes` by id.
pub(crate) fn with_meshes(value: Value, meshes: &[Arc<Mesh>]) -> ResolvedScene {
    let scene = Scene::from_value(value).unwrap_or_else(|error| panic!("{error}"));
    let find = |id: &str| meshes.iter().find(|mesh| mesh.id == id).cloned();
    caustica::methods::resolve(scene, &Limits::default(), find)
        .unwrap_or_else(|error| panic!("{error}"))
}
