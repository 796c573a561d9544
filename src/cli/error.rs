//! Errors of the command line, and their exit codes.

use std::io;
use std::path::{Path, PathBuf};

use crate::gpu::GpuError;
use crate::http::ServeError;
use crate::image::EncodeError;
use crate::render::RenderError;
use crate::scene::SceneError;

/// Exit code of failures that are worth a retry.
pub const EXIT_RETRY: u8 = 1;

/// Exit code of refusals: the same command will fail again.
pub const EXIT_REFUSED: u8 = 2;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The command line does not make sense.
    #[error("{0}")]
    Usage(String),
    /// The scene file is not a valid scene.
    #[error("{file}: {error}")]
    Scene {
        /// The file.
        file: String,
        /// What is wrong with it.
        error: SceneError,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {error}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A file cannot be written.
    #[error("cannot write {path}: {error}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// The frame cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The frame cannot be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// A study or a calibration failed.
    #[error("{0}")]
    Study(String),
    /// The GPU of this machine does not calculate as it should.
    #[error("the self-check failed: {failed} of {all} checks are outside their tolerance")]
    SelfCheck {
        /// Checks that failed.
        failed: usize,
        /// All checks.
        all: usize,
    },
    /// Hard cases that do not end as expected.
    #[error("{failed} of {all} hard cases do not end as expected")]
    HardCases {
        /// Cases that failed, or passed although they are known to fail.
        failed: usize,
        /// All cases.
        all: usize,
    },
    /// The service does not run, or does not accept work.
    #[error("{url} is not ready: {reason}")]
    NotReady {
        /// The address asked.
        url: String,
        /// Its answer, or why there was none.
        reason: String,
    },
    /// The service did not start, or stopped.
    #[error(transparent)]
    Serve(#[from] ServeError),
}

impl CliError {
    /// A file that cannot be read.
    pub fn read(path: &Path, error: io::Error) -> Self {
        Self::Read {
            path: path.to_owned(),
            error,
        }
    }

    /// A file that cannot be written.
    pub fn write(path: &Path, error: io::Error) -> Self {
        Self::Write {
            path: path.to_owned(),
            error,
        }
    }

    /// [`EXIT_RETRY`] if the same command may succeed later or elsewhere, [`EXIT_REFUSED`] if it cannot.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Scene { .. } | Self::Encode(_) | Self::Study(_) => EXIT_REFUSED,
            Self::Read { error, .. } | Self::Write { error, .. } => file_exit_code(error),
            Self::Render(RenderError::Gpu(error)) | Self::Gpu(error) => gpu_exit_code(error),
            Self::Render(RenderError::Cancelled) => EXIT_RETRY,
            Self::Render(_) => EXIT_REFUSED,
            Self::SelfCheck { .. } | Self::HardCases { .. } | Self::NotReady { .. } => EXIT_RETRY,
            Self::Serve(error) if error.is_refusal() => EXIT_REFUSED,
            Self::Serve(_) => EXIT_RETRY,
        }
    }
}

/// [`EXIT_REFUSED`] if the system will say the same again; 1 if the reason may pass, as a full disk does.
fn file_exit_code(error: &io::Error) -> u8 {
    use io::ErrorKind as Kind;
    let is_permanent = matches!(
        error.kind(),
        Kind::NotFound
            | Kind::PermissionDenied
            | Kind::ReadOnlyFilesystem
            | Kind::NotADirectory
            | Kind::IsADirectory
            | Kind::InvalidFilename
            | Kind::InvalidInput
            | Kind::InvalidData
            | Kind::FileTooLarge
            | Kind::NotSeekable
            | Kind::Unsupported
    );
    if is_permanent || is_link_in_a_circle(error) {
        EXIT_REFUSED
    } else {
        EXIT_RETRY
    }
}

/// ELOOP, for which the standard library has no stable name.
fn is_link_in_a_circle(error: &io::Error) -> bool {
    let code = if cfg!(target_os = "linux") { 40 } else { 62 };
    cfg!(unix) && error.raw_os_error() == Some(code)
}

/// A call that the driver refused will be refused again; all other errors may be temporary.
fn gpu_exit_code(error: &GpuError) -> u8 {
    match error {
        GpuError::Validation(_) => EXIT_REFUSED,
        _ => EXIT_RETRY,
    }
}
