//! Files between being written and being in their place.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::target::target_of;
use super::temporary::create_beside;

/// A file whose bytes are ready; [`Pending::finish`] puts it in its place.
#[derive(Debug)]
pub struct Pending<'a> {
    target: PathBuf,
    bytes: &'a [u8],
    way: Way,
}

/// How a file gets to its place.
#[derive(Debug)]
enum Way {
    /// The temporary file is renamed.
    Rename(NamedTempFile),
    /// The existing file is overwritten.
    InPlace,
    /// A device or pipe is written to.
    Through,
}

/// Writes `bytes` to the file that `path` leads to.
///
/// # Errors
///
/// Those of [`Pending::new`] and [`Pending::finish`].
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    Pending::new(path, bytes)?.finish()
}

/// Fails if the file that `path` leads to cannot be written. Changes nothing.
///
/// # Errors
///
/// Those that [`Pending::new`] would have.
pub fn check(path: &Path) -> io::Result<()> {
    let target = target_of(path)?;
    match way_to(&target)? {
        Way::Rename(temporary) => temporary.close(),
        Way::InPlace => OpenOptions::new().write(true).open(target).map(drop),
        // Opening a pipe may wait for its reader, and close what the reader waits for.
        Way::Through => Ok(()),
    }
}

impl<'a> Pending<'a> {
    /// Writes `bytes` to a temporary file, if the target is to be replaced. Until [`Self::finish`] the target is as it was.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::IsADirectory`] if `path` is a folder; errors of the file system. The temporary file is removed.
    pub fn new(path: &Path, bytes: &'a [u8]) -> io::Result<Self> {
        let target = target_of(path)?;
        let mut way = way_to(&target)?;
        if let Way::Rename(temporary) = &mut way {
            temporary.as_file_mut().write_all(bytes)?;
            temporary.as_file().sync_all()?;
        }
        Ok(Self { target, bytes, way })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    ///
    /// Errors of the file system. A file that is written in place may then be incomplete.
    pub fn finish(self) -> io::Result<()> {
        let Self { target, bytes, way } = self;
        match way {
            Way::Rename(temporary) => match temporary.persist(&target) {
                Ok(_) => Ok(()),
                Err(failed) if cannot_be_renamed_over(&failed.error) => {
                    drop(failed.file);
                    write_in_place(&target, bytes)
                }
                Err(failed) => Err(failed.error),
            },
            Way::InPlace => write_in_place(&target, bytes),
            Way::Through => {
                let mut device = OpenOptions::new().write(true).open(&target)?;
                device.write_all(bytes)
            }
        }
    }
}

/// Decides how to write to `target`, which is no link. Creates the temporary file if one is needed.
fn way_to(target: &Path) -> io::Result<Way> {
    let about = match fs::metadata(target) {
        Ok(about) => about,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return create_beside(target).map(Way::Rename);
        }
        Err(error) => return Err(error),
    };
    if about.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !about.is_file() {
        return Ok(Way::Through);
    }
    if is_shared(&about) || fs::symlink_metadata(target)?.is_symlink() {
        return Ok(Way::InPlace);
    }
    match create_beside(target) {
        Ok(temporary) if has_same_owner_and_mode(temporary.as_file(), &about) => {
            Ok(Way::Rename(temporary))
        }
        Ok(_) => Ok(Way::InPlace),
        Err(error) if is_folder_without_permission(&error) => Ok(Way::InPlace),
        Err(error) => Err(error),
    }
}

/// Whether renaming would take the file away from its other names.
#[cfg(unix)]
fn is_shared(about: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(about) > 1
}

#[cfg(not(unix))]
fn is_shared(_: &Metadata) -> bool {
    false
}

/// Gives `file` the mode of the one that it replaces, if it has the same owner and group. Returns whether all three are the same then;
/// some file systems do not let the mode be set.
#[cfg(unix)]
fn has_same_owner_and_mode(file: &File, replaced: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let owner = |about: &Metadata| (about.uid(), about.gid());
    let has_owner = file
        .metadata()
        .is_ok_and(|about| owner(&about) == owner(replaced));
    has_owner && file.set_permissions(replaced.permissions()).is_ok()
}

#[cfg(not(unix))]
fn has_same_owner_and_mode(_: &File, _: &Metadata) -> bool {
    true
}

/// Whether an error says that no file can be created in a folder, although files in it may be writable.
fn is_folder_without_permission(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem
    )
}

/// Whether an error says that the target is there but cannot be renamed over: a mount point, or a file that is not ours in a folder
/// such as `/tmp`. The temporary file may also be gone, where a file system has no locks.
fn cannot_be_renamed_over(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::ResourceBusy
            | ErrorKind::CrossesDevices
            | ErrorKind::PermissionDenied
            | ErrorKind::NotFound
    )
}

/// Empties the file first, so that half of the new file is never followed by the rest of the old one.
fn write_in_place(target: &Path, bytes: &[u8]) -> io::Result<()> {
    let emptied = OpenOptions::new().write(true).truncate(true).open(target);
    let mut file = match emptied {
        Err(error) if error.kind() == ErrorKind::NotFound => File::create(target)?,
        // Opened without the right to create it: in folders such as `/tmp`, the system refuses that for files of others.
        emptied => emptied?,
    };
    file.write_all(bytes)?;
    file.sync_all()
}
