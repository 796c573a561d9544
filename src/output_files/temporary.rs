//! Temporary files: their names, their locks, and what killed processes left.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::target::{folder_of, target_of};

/// Random characters in a name, so that processes with the same id in different containers use different names.
const RANDOM_CHARS: usize = 6;

/// Longest part of a file name that is repeated in the temporary name, bytes. Some file systems allow only 143 bytes in all.
const MAX_REPEATED: usize = 100;

const END: &str = ".tmp";

/// Start of the temporary names of a file: `.frame.0001.png.`. Of a long name a part and a hash are used.
fn start_of(name: &OsStr) -> OsString {
    let mut start = OsString::from(".");
    if name.len() <= MAX_REPEATED {
        start.push(name);
    } else {
        let text = name.to_string_lossy();
        let mut cut = MAX_REPEATED / 2;
        while !text.is_char_boundary(cut) {
            cut -= 1;
        }
        let hash = blake3::hash(name.as_encoded_bytes()).to_hex();
        start.push(&text[..cut]);
        start.push("~");
        start.push(&hash[..16]);
    }
    start.push(".");
    start
}

/// The start of a temporary name, as [`start_of`] made it.
fn start_in(temporary: &OsStr) -> Option<&[u8]> {
    let name = temporary.as_encoded_bytes().strip_suffix(END.as_bytes())?;
    let (start, random) = name.split_at_checked(name.len().checked_sub(RANDOM_CHARS)?)?;
    let is_own = start.starts_with(b".")
        && start.ends_with(b".")
        && random.iter().all(u8::is_ascii_alphanumeric);
    is_own.then_some(start)
}

/// Creates a locked temporary file beside `target`.
pub(super) fn create_beside(target: &Path) -> io::Result<NamedTempFile> {
    let start = start_of(target.file_name().unwrap_or_default());
    let mut builder = Builder::new();
    builder.prefix(&start).suffix(END).rand_bytes(RANDOM_CHARS);
    // Created by the standard library, so that mode and errors are those of any new file.
    let create = |path: &Path| {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create_new(true).open(path)
    };
    loop {
        let temporary = builder.make_in(folder_of(target), create)?;
        // File systems without locks have no leftovers that can be told from files in use, so nothing is removed there.
        let _ = temporary.as_file().lock();
        // Another process may have locked and removed the file before this one locked it.
        if is_linked(temporary.as_file())? {
            return Ok(temporary);
        }
    }
}

#[cfg(unix)]
fn is_linked(file: &File) -> io::Result<bool> {
    Ok(std::os::unix::fs::MetadataExt::nlink(&file.metadata()?) > 0)
}

/// Elsewhere an open file cannot be removed.
#[cfg(not(unix))]
fn is_linked(_: &File) -> io::Result<bool> {
    Ok(true)
}

/// Removes temporary files of `paths` whose process has ended. Each folder is listed once. What cannot be removed stays: it does not
/// prevent writing.
pub fn clear_leftovers<'a>(paths: impl IntoIterator<Item = &'a Path>) {
    let mut folders: BTreeMap<PathBuf, BTreeSet<Vec<u8>>> = BTreeMap::new();
    for target in paths.into_iter().filter_map(|path| target_of(path).ok()) {
        if let Some(name) = target.file_name() {
            let starts = folders.entry(folder_of(&target).to_owned()).or_default();
            starts.insert(start_of(name).into_encoded_bytes());
        }
    }
    for (folder, starts) in folders {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        for name in entries.filter_map(|entry| Some(entry.ok()?.file_name())) {
            if start_in(&name).is_some_and(|start| starts.contains(start)) {
                remove_if_left_over(&folder.join(name));
            }
        }
    }
}

fn remove_if_left_over(path: &Path) {
    let is_file = fs::symlink_metadata(path).is_ok_and(|about| about.is_file());
    if !is_file {
        return;
    }
    // Some file systems lock only files that are open for writing.
    let Ok(file) = OpenOptions::new().read(true).write(true).open(path) else {
        return;
    };
    if file.try_lock().is_ok() {
        // Removed while it is locked: a process that has just created it notices, and creates another.
        let _ = fs::remove_file(path);
    }
}
