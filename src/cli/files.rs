//! Writes files atomically: a file exists complete or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::error::CliError;
use crate::scene::ImageFormat;

/// Writes `bytes` to a temporary file beside `path` and renames it, so that no reader ever sees a partial file.
///
/// # Errors
///
/// [`CliError::Write`]; the temporary file is removed.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    let temporary = temporary_beside(path)?;
    let written = File::create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|error| {
        // The temporary file may not exist.
        let _ = fs::remove_file(&temporary);
        CliError::write(path, error)
    })
}

/// A name in the same directory that no other process uses.
fn temporary_beside(path: &Path) -> Result<PathBuf, CliError> {
    let Some(name) = path.file_name() else {
        return Err(CliError::Usage(format!(
            "{} is not the name of a file",
            path.display()
        )));
    };
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}.tmp", std::process::id()));
    Ok(path.with_file_name(temporary))
}

/// Refuses a path that cannot be written to, before time is spent on rendering.
///
/// # Errors
///
/// [`CliError::Usage`] when the directory of `path` does not exist, or `path` is a directory.
pub fn check_place(path: &Path) -> Result<(), CliError> {
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if !parent.is_dir() {
        let message = format!(
            "cannot write {}: there is no directory {}",
            path.display(),
            parent.display()
        );
        return Err(CliError::Usage(message));
    }
    if path.is_dir() {
        let message = format!(
            "cannot write {}: it is a directory; the name of a file is needed",
            path.display()
        );
        return Err(CliError::Usage(message));
    }
    Ok(())
}

/// The image format of a file's extension.
///
/// # Errors
///
/// [`CliError::Usage`] for any extension but `.png` and `.exr`.
pub fn format_of(path: &Path) -> Result<ImageFormat, CliError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "png" => Ok(ImageFormat::Png),
        "exr" => Ok(ImageFormat::Exr),
        _ => Err(CliError::Usage(format!(
            "{} has no known image format; accepted: a name that ends in .png or .exr",
            path.display()
        ))),
    }
}

/// Writes text to stdout. A closed pipe is not an error.
///
/// # Errors
///
/// [`CliError::Write`] for anything else.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CliError::write(Path::new("stdout"), error))
        }
        _ => Ok(()),
    }
}

/// A result as indented JSON with a line end.
pub fn json<T: serde::Serialize>(value: &T) -> String {
    let text = serde_json::to_string_pretty(value).expect("results always serialise");
    text + "\n"
}
