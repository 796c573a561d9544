//! Finds and reads the MTL files that an OBJ file names.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use crate::mesh::obj;

/// Most `mtllib` lines of an OBJ file that are followed.
const MOST_LIBRARIES: usize = 100;

/// Reads the MTL files of `obj`, which was read from `path`, in the order in which it names them, each once.
///
/// A name is a path relative to the OBJ file, with `/` or `\`. It may lead anywhere inside the folder of the scene or of the OBJ
/// file, and never outside: of any other path, only the last part counts, as the name of a file beside the OBJ file. `notes` says
/// what was not found.
pub fn read(obj: &[u8], path: &Path, scene_folder: &Path, notes: &mut Vec<String>) -> Vec<Vec<u8>> {
    let place = Place {
        beside: real(path.parent().unwrap_or(Path::new(""))),
        scene: real(scene_folder),
    };
    let mut files = Vec::new();
    let mut known: BTreeSet<PathBuf> = BTreeSet::new();
    let named = obj::material_libraries(obj);
    if named.len() > MOST_LIBRARIES {
        notes.push(format!(
            "{}: only the first {MOST_LIBRARIES} of {} lines `mtllib` are read",
            path.display(),
            named.len()
        ));
    }
    for names in named.iter().take(MOST_LIBRARIES) {
        for name in place.split(names) {
            let found = place.find(name);
            if !known.insert(found.clone()) {
                continue;
            }
            let shown = shorten(name);
            match fs::read(&found) {
                Ok(bytes) => {
                    if !place.is_inside(name) {
                        notes.push(format!(
                            "{}: the material library `{shown}` is outside of the scene's folder; `{}` beside the OBJ file was read instead",
                            path.display(),
                            shorten(last_part(name))
                        ));
                    }
                    files.push(bytes);
                }
                Err(error) => notes.push(format!(
                    "{}: the material library `{shown}` cannot be read as {}: {error}",
                    path.display(),
                    shorten(&found.display().to_string())
                )),
            }
        }
    }
    files
}

/// At most 200 characters of a name, for notes.
fn shorten(name: &str) -> String {
    name.chars().take(200).collect()
}

/// A folder without links, so that folders can be compared; as it is given if it does not exist.
fn real(folder: &Path) -> PathBuf {
    let given = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    fs::canonicalize(given).unwrap_or_else(|_| normal(folder))
}

/// Where the files of a mesh may be.
struct Place {
    /// The folder of the OBJ file.
    beside: PathBuf,
    /// The folder of the scene file.
    scene: PathBuf,
}

impl Place {
    /// The names in what follows an `mtllib`: the whole text if there is such a file, because names may contain spaces; else what ends
    /// in `.mtl`; else the words, if one of them is a file. Quotes around a name and a comment after it do not belong to it.
    fn split<'a>(&self, names: &'a str) -> Vec<&'a str> {
        let uncommented = names.split(" #").next().unwrap_or(names).trim_ascii();
        let splits = [
            vec![names],
            vec![unquoted(uncommented)],
            after_extensions(uncommented),
            uncommented.split_ascii_whitespace().map(unquoted).collect(),
        ];
        let is_file = |name: &&str| self.find(name).is_file();
        splits
            .into_iter()
            .find(|split| split.iter().any(is_file))
            .unwrap_or_else(|| after_extensions(uncommented))
    }

    /// The file of a name. If there is none, a file of the same name in other capitals, as Windows would find it.
    fn find(&self, name: &str) -> PathBuf {
        let path = self
            .inside(name)
            .unwrap_or_else(|| self.beside.join(last_part(name)));
        if path.exists() {
            return path;
        }
        in_other_capitals(&path).unwrap_or(path)
    }

    fn is_inside(&self, name: &str) -> bool {
        self.inside(name).is_some()
    }

    /// The path of a name, if it stays inside.
    fn inside(&self, name: &str) -> Option<PathBuf> {
        let name = name.replace('\\', "/");
        if name.contains([':', '\0']) {
            return None;
        }
        let path = normal(&self.beside.join(name));
        [&self.scene, &self.beside]
            .into_iter()
            .any(|folder| is_in(&path, folder))
            .then_some(path)
    }
}

/// A name without quotes around it.
fn unquoted(name: &str) -> &str {
    let inner = name
        .strip_prefix('"')
        .and_then(|name| name.strip_suffix('"'));
    inner.unwrap_or(name)
}

/// The file in the folder of `path` whose name differs in capitals only; of several the first in order.
fn in_other_capitals(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_str()?.to_lowercase();
    let entries = fs::read_dir(path.parent()?).ok()?;
    entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().and_then(|name| name.to_str());
            name.is_some_and(|name| name.to_lowercase() == wanted)
        })
        .min()
}

/// Splits where a name ends in `.mtl`.
fn after_extensions(names: &str) -> Vec<&str> {
    let mut split = Vec::new();
    let mut start = 0;
    for (end, _) in names.match_indices(|c: char| c.is_ascii_whitespace()) {
        let name = &names[start..end];
        if name.to_ascii_lowercase().ends_with(".mtl") {
            split.push(unquoted(name.trim_ascii()));
            start = end;
        }
    }
    split.push(unquoted(names[start..].trim_ascii()));
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
