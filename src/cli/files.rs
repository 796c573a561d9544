//! Where results go: files, written whole by [`output_files`], or stdout.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::error::CliError;
use super::notes;
use crate::output_files;
use crate::scene::ImageFormat;

/// Where a result goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// Standard output: `-`, or a name such as `/dev/stdout`.
    Stdout,
    /// A file, device or pipe.
    File(PathBuf),
}

impl Destination {
    /// The destination that a user means by `path`.
    pub fn of(path: &Path) -> Self {
        if path == Path::new("-") || output_files::is_stdout(path) {
            Self::Stdout
        } else {
            Self::File(path.to_owned())
        }
    }

    /// The image format that the name asks for. `None` if it asks for none: stdout, and devices, pipes and open
    /// files (`/dev/fd/3`) without an extension.
    ///
    /// # Errors
    ///
    /// [`CliError::Usage`] for a file whose name does not end in `.png` or `.exr`.
    pub fn format(&self) -> Result<Option<ImageFormat>, CliError> {
        let Self::File(path) = self else {
            return Ok(None);
        };
        let is_stream =
            std::fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir());
        if (is_stream || output_files::is_open_file(path)) && path.extension().is_none() {
            return Ok(None);
        }
        format_of(path).map(Some)
    }

    /// Refuses a place that cannot be written to, before time is spent on rendering, and removes what a killed run left there.
    ///
    /// # Errors
    ///
    /// As [`check_place`].
    pub fn check(&self) -> Result<(), CliError> {
        match self {
            Self::Stdout => Ok(()),
            Self::File(path) => {
                check_place(path)?;
                output_files::clear_leftovers([path.as_path()]);
                Ok(())
            }
        }
    }

    /// Writes a result.
    ///
    /// # Errors
    ///
    /// [`CliError::Write`].
    pub fn write(&self, bytes: &[u8]) -> Result<(), CliError> {
        match self {
            Self::Stdout => print_bytes(bytes),
            Self::File(path) => write_whole(path, bytes),
        }
    }

    /// The name for messages.
    pub fn name(&self) -> String {
        match self {
            Self::Stdout => "stdout".to_owned(),
            Self::File(path) => path.display().to_string(),
        }
    }
}

/// Writes `bytes` to the file that `path` leads to: whole or not at all, except where [`output_files`] has to write in place.
///
/// # Errors
///
/// [`CliError::Write`].
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    output_files::write(path, bytes).map_err(|error| CliError::write(path, error))
}

/// Refuses a path that cannot be written to, before time is spent on rendering.
///
/// # Errors
///
/// [`CliError::Usage`] when the directory of the file does not exist, or `path` is a directory; [`CliError::Write`] for all other
/// reasons.
pub fn check_place(path: &Path) -> Result<(), CliError> {
    let refused = |reason: String| {
        let path = path.display();
        Err(CliError::Usage(format!("cannot write {path}: {reason}")))
    };
    let failed = |error| CliError::write(path, error);
    if path.is_dir() {
        return refused("it is a directory; the name of a file is needed".to_owned());
    }
    let target = output_files::target_of(path).map_err(failed)?;
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return refused(format!("there is no directory {}", folder.display()));
    }
    output_files::check(path).map_err(failed)
}

/// Refuses `path` if it leads to the scene file, which would be overwritten; `what` is what is to be written there.
///
/// # Errors
///
/// [`CliError::Usage`].
pub fn refuse_scene_file(what: &str, path: &Path, scene: &Path) -> Result<(), CliError> {
    let is_stream = [path, scene].contains(&Path::new("-"));
    if !is_stream && output_files::is_same_file(path, scene) {
        let path = path.display();
        return Err(CliError::Usage(format!(
            "{what} would overwrite the scene file, to which {path} leads; accepted: another file"
        )));
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
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> Result<(), CliError> {
    // On a terminal, the result appears after what was said before it.
    notes::flush();
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
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
