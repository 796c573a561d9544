//! Why a job has no answer.

use crate::render::RenderError;

/// Why a job has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// Every place in the queue is taken; nothing was queued.
    #[error("{waiting} requests are waiting already, which is the most that may")]
    QueueFull {
        /// Places in the queue.
        waiting: usize,
        /// When to try again, s, from the time that recent jobs took.
        retry_after_s: u64,
    },
    /// The deadline passed, in the queue or while the job ran; it never starts, or is cancelled.
    #[error("no result within {deadline_s} s of arrival")]
    DeadlinePassed {
        /// Time allowed from arrival, s.
        deadline_s: f64,
    },
    /// The service is shutting down, or nobody waits any more.
    #[error("cancelled")]
    Cancelled,
    /// There is no working device, and it is not being rebuilt at this moment.
    #[error("no GPU to run on: {0}")]
    Unavailable(String),
    /// The backend panicked: a defect of ours. It has been rebuilt.
    #[error("the renderer panicked: {0}")]
    Panicked(String),
    /// The backend said no.
    #[error(transparent)]
    Render(#[from] RenderError),
}
