//! Why a file was refused.

use super::MAX_SAMPLES;

/// Why a file was refused: what, and what is accepted.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FieldError {
    /// Nothing to read.
    #[error("the file is empty; accepted: NPY, EXR, or PNG of 16 bits")]
    Empty,
    /// The first bytes are those of no format that is read.
    #[error("the file is neither NPY nor EXR nor PNG; accepted: one of these")]
    UnknownFormat,
    /// Damaged, or of a variant that is not read.
    #[error("not a readable {format} file: {reason}")]
    Unreadable {
        /// `NPY`, `EXR` or `PNG`.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Numbers of a type that is not read.
    #[error("the {format} file has {found}; accepted: {accepted}")]
    NumberType {
        /// `NPY`, `EXR` or `PNG`.
        format: &'static str,
        /// The type in the file.
        found: String,
        /// The types that are read.
        accepted: &'static str,
    },
    /// An NPY array with other axes.
    #[error(
        "the array has the shape {found}; accepted: (rows, columns), (frames, rows, columns), and of slopes (rows, columns, 2) or \
         (frames, rows, columns, 2)"
    )]
    Shape {
        /// The shape in the file.
        found: String,
    },
    /// A side, the number of frames or the number of channels is 0.
    #[error("the file has no samples; accepted: at least one row, column and frame")]
    NoSamples,
    /// More samples than any scene can use.
    #[error(
        "the file has {samples} samples; accepted: at most {MAX_SAMPLES} in all channels and frames"
    )]
    TooLarge {
        /// Samples of all channels and frames.
        samples: u64,
    },
    /// The store is full.
    #[error(
        "the file takes {needed_bytes} bytes, but the asset store holds {used_bytes} of at most {budget_bytes} bytes; delete assets that \
         are not needed; a larger store is a setting of the program (CAUSTICA_ASSET_STORE_BYTES)"
    )]
    StoreFull {
        /// Bytes the file needs once it is read.
        needed_bytes: u64,
        /// Bytes held.
        used_bytes: u64,
        /// Maximum number of bytes held.
        budget_bytes: u64,
    },
}

impl FieldError {
    pub(super) fn unreadable(format: &'static str, reason: impl Into<String>) -> Self {
        Self::Unreadable {
            format,
            reason: reason.into(),
        }
    }
}
