//! One piece of work and who waits for it.

use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, oneshot};
use tokio_util::sync::CancellationToken;

use super::backend::RenderBackend;
use super::error::JobError;
use super::place::Place;
use crate::render::RenderError;

/// What a job is told when it runs.
pub(super) struct JobContext<'a> {
    /// Set when nobody waits any more.
    pub(super) cancel: &'a CancellationToken,
    /// From arrival until the thread took the job up.
    pub(super) queued: Duration,
}

/// A job on its way to the thread, or running.
pub(super) struct Job {
    /// What to do and whom to tell.
    pub(super) work: Box<dyn Work>,
    /// Set when nobody waits any more.
    pub(super) cancel: CancellationToken,
    /// The place in the queue, given back when the work has ended.
    pub(super) place: Place,
    /// The right to the thread, given back with the place.
    pub(super) _thread: OwnedSemaphorePermit,
}

/// Work that can be run again after a device loss.
pub(super) trait Work: Send {
    /// Runs once. A success is delivered; an error is returned, for the caller to decide between another try and `fail`.
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
    /// Pairs work with where its answer goes.
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
            // The receiver may be gone: then nobody wants the answer.
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
