//! Finds and reads the MTL files that an OBJ file names.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use crate::mesh::obj;

/// Reads the MTL files of `obj`, which was read from `path`, in the order in which it names them, each once.
///
/// A name is a path relative to the OBJ file, with `/` or `\`. It may lead anywhere inside the folder of the scene or of the OBJ
/// file, and never outside: of any other path, only the last part counts, as the name of a file beside the OBJ file. `notes` says
/// what was not found.
pub fn read(obj: &[u8], path: &Path, scene_folder: &Path, notes: &mut Vec<String>) -> Vec<Vec<u8>> {
    let place = Place {
        beside: normal(path.parent().unwrap_or(Path::new(""))),
        scene: normal(scene_folder),
    };
    let mut files = Vec::new();
    let mut known: Vec<PathBuf> = Vec::new();
    for names in obj::material_libraries(obj) {
        for name in place.split(&names) {
            let found = place.find(name);
            if known.contains(&found) {
                continue;
            }
            match fs::read(&found) {
                Ok(bytes) => {
                    if !place.is_inside(name) {
                        notes.push(format!(
                            "{}: the material library `{name}` is outside of the scene's folder; `{}` beside the OBJ file was read instead",
                            path.display(),
                            last_part(name)
                        ));
                    }
                    files.push(bytes);
                    known.push(found);
                }
                Err(error) => notes.push(place.not_read(path, name, &error)),
            }
        }
    }
    files
}

/// Where the files of a mesh may be. The paths are normal: without `.` and, but for leading ones, `..`.
struct Place {
    /// The folder of the OBJ file.
    beside: PathBuf,
    /// The folder of the scene file.
    scene: PathBuf,
}

impl Place {
    /// The names in what follows an `mtllib`: the whole text if there is such a file, because names may contain spaces; else what ends
    /// in `.mtl`; else the words, if one of them is a file.
    fn split<'a>(&self, names: &'a str) -> Vec<&'a str> {
        let splits = [
            vec![names],
            after_extensions(names),
            names.split_ascii_whitespace().collect(),
        ];
        let is_file = |name: &&str| self.find(name).is_file();
        splits
            .into_iter()
            .find(|split| split.iter().any(is_file))
            .unwrap_or_else(|| after_extensions(names))
    }

    /// The file of a name.
    fn find(&self, name: &str) -> PathBuf {
        self.inside(name)
            .unwrap_or_else(|| self.beside.join(last_part(name)))
    }

    fn is_inside(&self, name: &str) -> bool {
        self.inside(name).is_some()
    }

    /// The path of a name, if it is relative and stays inside.
    fn inside(&self, name: &str) -> Option<PathBuf> {
        let name = name.replace('\\', "/");
        if name.starts_with('/') || name.contains([':', '\0']) {
            return None;
        }
        let path = normal(&self.beside.join(name));
        [&self.scene, &self.beside]
            .into_iter()
            .any(|folder| is_in(&path, folder))
            .then_some(path)
    }

    fn not_read(&self, path: &Path, name: &str, error: &io::Error) -> String {
        let found = self.find(name);
        format!(
            "{}: the material library `{name}` cannot be read as {}: {error}",
            path.display(),
            found.display()
        )
    }
}

/// Splits where a name ends in `.mtl`.
fn after_extensions(names: &str) -> Vec<&str> {
    let mut split = Vec::new();
    let mut start = 0;
    for (end, _) in names.match_indices(|c: char| c.is_ascii_whitespace()) {
        let name = &names[start..end];
        if name.to_ascii_lowercase().ends_with(".mtl") {
            split.push(name.trim_ascii());
            start = end;
        }
    }
    split.push(names[start..].trim_ascii());
    split.retain(|name| !name.is_empty());
    split
}

/// The part of a path after its last separator, on every operating system.
fn last_part(name: &str) -> &str {
    name.rsplit(['/', '\\', ':', '\0'])
        .next()
        .unwrap_or_default()
}

/// A path without `.`, and with each `..` taken together with the folder before it. Links are not looked at: a scene may link to
/// libraries elsewhere.
fn normal(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => _ = parts.pop(),
            (Component::ParentDir, Some(Component::RootDir)) => {}
            _ => parts.push(part),
        }
    }
    parts.into_iter().collect()
}

/// Whether a normal path is below a normal folder.
fn is_in(path: &Path, folder: &Path) -> bool {
    path.strip_prefix(folder).is_ok_and(|rest| {
        rest.components()
            .all(|part| matches!(part, Component::Normal(_)))
    }) && path != folder
}
