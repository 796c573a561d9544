//! Why there is no picture.

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// No setting was measured.
    #[error("there is nothing to draw: {0} has no settings; at least one is needed")]
    Empty(String),
    /// No such sweep.
    #[error("there is no sweep {index}; the study has {sweeps}, counted from 0")]
    NoSweep {
        /// What was asked for.
        index: usize,
        /// How many there are.
        sweeps: usize,
    },
    /// A figure is NaN or infinite, or negative where it cannot be.
    #[error("{what} of {setting} is {value}; it must be finite and not negative")]
    Figure {
        /// Name of the figure.
        what: &'static str,
        /// Of which setting, or of the truth.
        setting: String,
        /// What.
        value: f64,
    },
    /// The images do not belong to the study.
    #[error("the images do not fit the study: {0}")]
    Images(String),
    /// A picture cannot be shown or compared.
    #[error(transparent)]
    Metric(#[from] crate::accuracy::metrics::MetricError),
    /// The drawing library failed.
    #[error("cannot draw: {0}")]
    Draw(String),
    /// The PNG encoder failed.
    #[error("cannot write PNG: {0}")]
    Png(String),
}
