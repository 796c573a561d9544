//! A job: its work and the caller who waits for it.

use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, oneshot};
use tokio_util::sync::CancellationToken;

use super::backend::RenderBackend;
use super::error::JobError;
use super::place::Place;
use crate::render::RenderError;

/// What a job gets when it runs.
pub(super) struct JobContext<'a> {
    /// Set when the caller no longer waits.
    pub(super) cancel: &'a CancellationToken,
    /// Time from arrival until the thread took the job.
    pub(super) queued: Duration,
}

/// A job that is being sent to the thread, or runs.
pub(super) struct Job {
    /// The work, and where its result is delivered.
    pub(super) work: Box<dyn Work>,
    /// Set when the caller no longer waits.
    pub(super) cancel: CancellationToken,
    /// The place in the queue, released when the work has ended.
    pub(super) place: Place,
    /// The permit to use the thread, released together with the place.
    pub(super) _thread: OwnedSemaphorePermit,
}

/// Work that can be run again after a device loss.
pub(super) trait Work: Send {
    /// Runs once. A success is delivered; an error is returned, and the caller decides whether to retry or to `fail`.
    fn run(
        &mut self,
        backend: &mut dyn RenderBackend,
        context: &JobContext<'_>,
    ) -> Result<(), RenderError>;

    /// Delivers an error.
    fn fail(self: Box<Self>, error: JobError);
}

/// Work with its reply channel.
pub(super) struct Typed<T, F> {
    call: F,
    reply: Option<oneshot::Sender<Result<T, JobError>>>,
}

impl<T, F> Typed<T, F>
where
    F: FnMut(&mut dyn RenderBackend, &JobContext<'_>) -> Result<T, RenderError>,
{
    /// Work whose answer goes to `reply`.
    pub(super) fn new(call: F, reply: oneshot::Sender<Result<T, JobError>>) -> Self {
        Self {
            call,
            reply: Some(reply),
        }
    }
}

impl<T, F> Work for Typed<T, F>
where
    T: Send,
    F: FnMut(&mut dyn RenderBackend, &JobContext<'_>) -> Result<T, RenderError> + Send,
{
    fn run(
        &mut self,
        backend: &mut dyn RenderBackend,
        context: &JobContext<'_>,
    ) -> Result<(), RenderError> {
        let answer = (self.call)(backend, context)?;
        if let Some(reply) = self.reply.take() {
            // The receiver may be gone; the answer is then dropped.
            let _ = reply.send(Ok(answer));
        }
        Ok(())
    }

    fn fail(mut self: Box<Self>, error: JobError) {
        if let Some(reply) = self.reply.take() {
            let _ = reply.send(Err(error));
        }
    }
}
