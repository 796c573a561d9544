//! A copy of the project with all plants in it. Each is inactive until an environment variable names it, so one build serves all plants.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::plants::Plant;

/// The copy and its target folder.
pub(crate) struct Tree {
    /// Root of the copy.
    pub(crate) root: PathBuf,
    /// Cargo's target folder for it, used for nothing else: `CAUSTICA_MUTANTS_TARGET`, or one beside the copy.
    pub(crate) target: PathBuf,
}

/// Environment variable that names the active plant: its index in the list, from 1.
pub(crate) const AWAKE: &str = "CAUSTICA_PLANT";

/// The function that plants call; it is added to the end of the copy's `src/lib.rs`.
const SWITCH: &str = r#"
/// Whether this plant is active.
pub(crate) fn planted(number: usize) -> bool {
    static AWAKE: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    let read = || std::env::var("CAUSTICA_PLANT").ok()?.parse().ok();
    *AWAKE.get_or_init(read) == Some(number)
}
"#;

impl Tree {
    /// Copies the files of `project` that git tracks or does not ignore, and inserts the plants. Unchanged files are not written, so that
    /// a second run builds less.
    pub(crate) fn copy(project: &Path, plants: &[Plant]) -> io::Result<Self> {
        let own = std::env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| project.join("target"), |target| project.join(target));
        let target = std::env::var_os("CAUSTICA_MUTANTS_TARGET").map_or_else(
            || own.join("mutants").join("target"),
            |target| project.join(target),
        );
        if target == own {
            // Cargo uses the same file names for both, so one would run what the other has built.
            return Err(io::Error::other(
                "CAUSTICA_MUTANTS_TARGET is the project's own target folder; it must be another",
            ));
        }
        let tree = Self {
            root: own.join("mutants").join("tree"),
            target,
        };
        let names = listed(project)?;
        for name in &names {
            let (from, to) = (project.join(name), tree.root.join(name));
            let content = planted(name, std::fs::read(&from)?, plants)?;
            if std::fs::read(&to).is_ok_and(|there| there == content) {
                continue;
            }
            if let Some(parent) = to.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(&to, content)?;
        }
        remove_others(&tree.root, &tree.root, &names)?;
        if !tree.target.join("release").is_dir() {
            lend_dependencies(&own.join("release"), &tree.target.join("release"))?;
        }
        Ok(tree)
    }
}

/// A file's text with its plants inserted.
fn planted(name: &Path, content: Vec<u8>, plants: &[Plant]) -> io::Result<Vec<u8>> {
    let here = |plant: &Plant| Path::new(plant.file) == name;
    let is_root = name == Path::new("src/lib.rs");
    if !is_root && !plants.iter().any(here) {
        return Ok(content);
    }
    let mut text = String::from_utf8(content).map_err(io::Error::other)?;
    for (index, plant) in plants.iter().enumerate().filter(|(_, plant)| here(plant)) {
        let count = text.matches(plant.from).count();
        if count != 1 {
            return Err(io::Error::other(format!(
                "{} says `{}` {count} times; it must be once",
                plant.file, plant.from
            )));
        }
        let (from, to) = (plant.from, plant.to);
        let both = format!(
            "if crate::planted({}) {{ {to} }} else {{ {from} }}",
            index + 1
        );
        // With the `if`, a statement is still a statement and an expression an expression.
        let both = if from.ends_with(';') {
            both
        } else {
            format!("({both})")
        };
        text = text.replacen(from, &both, 1);
    }
    if is_root {
        text.push_str(SWITCH);
    }
    Ok(text.into_bytes())
}

/// Copies the build results of other packages from the project's own builds, so that only the project itself is built again. Cargo
/// checks each and rebuilds what does not match.
fn lend_dependencies(own: &Path, target: &Path) -> io::Result<()> {
    for folder in [".fingerprint", "build", "deps"] {
        copy_folder(&own.join(folder), &target.join(folder))?;
    }
    Ok(())
}

/// Copies a folder of cargo's with the times of its files, which cargo compares; programs and the project's own files are not copied.
fn copy_folder(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        let name = entry.file_name();
        let is_own = name.to_string_lossy().contains(env!("CARGO_PKG_NAME"));
        let kind = entry.file_type()?;
        let (from, to) = (entry.path(), to.join(&name));
        if is_own || kind.is_symlink() {
            continue;
        }
        if kind.is_dir() {
            copy_folder(&from, &to)?;
        } else {
            std::fs::copy(&from, &to)?;
            let modified = entry.metadata()?.modified()?;
            let copy = std::fs::File::options().append(true).open(&to)?;
            copy.set_modified(modified)?;
        }
    }
    Ok(())
}

/// Files of the project, as git lists them.
fn listed(project: &Path) -> io::Result<BTreeSet<PathBuf>> {
    let output = Command::new("git")
        .args([
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
        ])
        .current_dir(project)
        .output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(io::Error::other(format!("git ls-files: {said}")));
    }
    let names = String::from_utf8(output.stdout).map_err(io::Error::other)?;
    Ok(names
        .split('\0')
        .filter(|name| !name.is_empty())
        .map(PathBuf::from)
        // Git lists what was deleted but not yet committed.
        .filter(|name| project.join(name).is_file())
        .collect())
}

/// Removes files of an earlier copy that the project no longer has: a stale test would be built and run.
fn remove_others(root: &Path, folder: &Path, names: &BTreeSet<PathBuf>) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.strip_prefix(root).map_err(io::Error::other)?;
        if path.is_dir() {
            remove_others(root, &path, names)?;
        } else if !names.contains(name) {
            std::fs::remove_file(&path)?;
        }
    }
    Ok(())
}
