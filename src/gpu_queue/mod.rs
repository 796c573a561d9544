//! The one road to the GPU: a bounded queue in front of one thread.
//!
//! * [`backend`]: what the thread owns, as a trait, so that tests need no GPU;
//! * [`error`]: why a job has no answer;
//! * [`job`]: one piece of work and who waits for it;
//! * [`place`]: the right to hand in a job;
//! * [`queue`]: admission, deadline and cancellation, on the side of the callers;
//! * [`status`]: the state machine of the device, as everybody sees it;
//! * [`worker`]: the thread: building, running, recovering.
//!
//! A caller takes a place in the queue or is refused at once, prepares its scene, then waits for the worker until its deadline. Places
//! are held until the work has really ended, not until the caller loses interest, so an abandoned render cannot be overtaken by a
//! second one.

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
