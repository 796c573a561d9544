//! Errors of a job.

use crate::render::RenderError;

/// Why a job failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// Every place in the queue is taken. Nothing was queued.
    #[error("{waiting} requests are waiting already, the maximum")]
    QueueFull {
        /// Places in the queue.
        waiting: usize,
        /// When to try again, s, estimated from the time of recent jobs.
        retry_after_s: u64,
    },
    /// The deadline passed. A waiting job never starts; a running one is cancelled.
    #[error("no result within {deadline_s} s of arrival")]
    DeadlinePassed {
        /// Time allowed from arrival, s.
        deadline_s: f64,
    },
    /// The service is shutting down, or the caller no longer waits.
    #[error("cancelled")]
    Cancelled,
    /// There is no working device, and none is being rebuilt.
    #[error("no GPU to run on: {0}")]
    Unavailable(String),
    /// The backend panicked, which is a defect. It has been rebuilt.
    #[error("the renderer panicked: {0}")]
    Panicked(String),
    /// The backend returned an error.
    #[error(transparent)]
    Render(#[from] RenderError),
}
