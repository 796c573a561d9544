//! Why there is no report.

use std::path::PathBuf;

use crate::lab::study::plot::PlotError;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A figure is NaN or infinite, which JSON cannot represent.
    #[error("the figure at {pointer} of the study is not finite; all figures must be")]
    NotFinite {
        /// JSON pointer into the study.
        pointer: String,
    },
    /// A picture could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A file could not be written; none was.
    #[error("cannot write {}: {reason}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
}
