//! The only access to the GPU: a bounded queue in front of one thread.
//!
//! * [`backend`]: what the thread owns, as a trait, so that tests need no GPU;
//! * [`error`]: why a job failed;
//! * [`job`]: work and the caller who waits for it;
//! * [`place`]: a place in the queue, the right to submit a job;
//! * [`queue`]: admission, deadline and cancellation, on the callers' side;
//! * [`status`]: the state of the device, published to all;
//! * [`worker`]: the thread, which builds the backend, runs jobs and recovers.
//!
//! A caller takes a place in the queue or is refused at once, prepares its scene, then waits for the worker until its deadline. A
//! place is held until the work has ended, even if the caller has left before. So an abandoned render still counts against the
//! limit while it runs.

pub mod backend;
pub mod error;
mod job;
mod place;
pub mod queue;
pub mod status;
mod worker;

pub use backend::RenderBackend;
pub use error::JobError;
pub use place::Place;
pub use queue::{GpuQueue, QueueSettings};
pub use status::{GpuState, GpuStatus};
