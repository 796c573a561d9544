//! The file that a path leads to.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Most symbolic links of one path; the limit of Linux.
const MAX_LINKS: usize = 40;

/// Follows symbolic links to the file to write, which need not exist.
///
/// # Errors
///
/// [`io::ErrorKind::InvalidInput`] for links in a circle and for a path without a file name; other errors of the file system.
pub fn target_of(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..=MAX_LINKS {
        let is_folder_name = target
            .as_os_str()
            .as_encoded_bytes()
            .last()
            .is_some_and(|byte| std::path::is_separator(char::from(*byte)));
        if is_folder_name || target.file_name().is_none() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "this is the name of a folder; the name of a file is needed",
            ));
        }
        match fs::symlink_metadata(&target) {
            Ok(about) if about.is_symlink() && !is_descriptor(&target) => {
                let next = fs::read_link(&target)?;
                target = folder_of(&target).join(next);
            }
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => return Ok(target),
        }
    }
    Err(io::Error::new(
        io::ErrorKind::InvalidInput,
        format!("the symbolic link leads in a circle, or over more than {MAX_LINKS} links"),
    ))
}

/// Whether a link stands for an open file, as in `/proc/self/fd/1`. Its text is not always a path.
fn is_descriptor(link: &Path) -> bool {
    let Some(folder) = link.parent() else {
        return false;
    };
    folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
}

/// Whether `path` leads to this process's stdout, as `/dev/stdout` does.
pub fn is_stdout(path: &Path) -> bool {
    let own = format!("/proc/{}/fd/1", std::process::id());
    let names = [
        "/dev/fd/1",
        "/proc/self/fd/1",
        "/proc/thread-self/fd/1",
        &own,
    ];
    path == Path::new("/dev/stdout")
        || target_of(path).is_ok_and(|target| names.iter().any(|name| target == Path::new(name)))
}

/// Whether `path` leads to a file that this process has open, as `/dev/fd/3` does.
pub fn is_open_file(path: &Path) -> bool {
    target_of(path).is_ok_and(|target| is_descriptor(&target))
}

/// Whether what is written to one path replaces what is written to the other: both lead to the same file, which need not exist.
/// Devices and pipes keep nothing, so they are not meant.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    match (fs::metadata(one), fs::metadata(other)) {
        (Ok(about_one), Ok(about_other)) => {
            about_one.is_file()
                && about_other.is_file()
                && (is_same_inode(&about_one, &about_other) || has_same_place(one, other))
        }
        (Err(_), Err(_)) => has_same_place(one, other),
        _ => false,
    }
}

#[cfg(unix)]
fn is_same_inode(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same_inode(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    false
}

/// Whether two paths lead to the same name in the same folder.
fn has_same_place(one: &Path, other: &Path) -> bool {
    let place_of = |path: &Path| -> Option<PathBuf> {
        let target = target_of(path).ok()?;
        let folder = fs::canonicalize(folder_of(&target)).ok()?;
        Some(folder.join(target.file_name()?))
    };
    place_of(one).is_some_and(|place| Some(place) == place_of(other))
}

/// The folder that a file is in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
