//! The GPU thread: builds the backend, runs jobs, and recovers from device loss and panics.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::watch;

use super::backend::RenderBackend;
use super::error::JobError;
use super::job::{Job, JobContext};
use super::place::Held;
use super::queue::lock;
use super::status::{GpuState, GpuStatus};
use crate::gpu::GpuError;
use crate::render::{RenderError, SelfCheck, SelfCheckItem};
use crate::stats::CacheStats;

/// How long the thread sleeps when there is nothing to do. The loss of an idle device is noticed within this time.
const IDLE_PERIOD: Duration = Duration::from_secs(1);

/// Pause between tries to open a device that could not be opened.
const REOPEN_PERIOD: Duration = Duration::from_secs(5);

/// Weight of the newest job in the typical job time.
const JOB_TIME_WEIGHT: f64 = 0.25;

/// Ids of deleted meshes, with the time of deletion.
pub(super) type Forgotten = Arc<Mutex<BTreeMap<String, Instant>>>;

type Factory = Box<dyn FnMut() -> Result<Box<dyn RenderBackend>, GpuError> + Send>;

/// How a run of a job failed.
enum Failure {
    /// The backend returned an error.
    Error(RenderError),
    /// The backend panicked with this message.
    Panic(String),
}

/// State of the thread.
pub(super) struct Worker {
    factory: Factory,
    jobs: Receiver<Job>,
    publish: watch::Sender<GpuStatus>,
    forgotten: Forgotten,
    held: Held,
    last_try: Instant,
    /// Counts of the caches of earlier devices.
    gone: [CacheStats; 2],
}

impl Worker {
    pub(super) fn new(
        factory: Factory,
        jobs: Receiver<Job>,
        publish: watch::Sender<GpuStatus>,
        forgotten: Forgotten,
        held: Held,
    ) -> Self {
        Self {
            factory,
            jobs,
            publish,
            forgotten,
            held,
            last_try: Instant::now(),
            gone: [CacheStats::default(), CacheStats::default()],
        }
    }

    /// Runs until all senders are dropped.
    pub(super) fn run(mut self) {
        let mut backend = self.open();
        loop {
            match self.jobs.recv_timeout(IDLE_PERIOD) {
                Ok(job) => self.serve(&mut backend, job),
                Err(RecvTimeoutError::Timeout) => self.idle(&mut backend),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        discard(&mut backend);
    }

    /// Builds a backend, runs the self-check, and publishes the result.
    fn open(&mut self) -> Option<Box<dyn RenderBackend>> {
        self.last_try = Instant::now();
        let opened = catch_unwind(AssertUnwindSafe(|| {
            let mut backend = (self.factory)()?;
            let check = backend.self_check()?;
            let (adapter, dial_basis) = (backend.adapter(), backend.dial_basis());
            let caches = caches(&*backend);
            Ok::<_, GpuError>((adapter, dial_basis, check, caches, backend))
        }))
        .unwrap_or_else(|panic| Err(GpuError::Validation(panic_message(&*panic))));
        match opened {
            Ok((adapter, dial_basis, check, caches, backend)) => {
                let check = judged(check);
                tracing::info!(
                    adapter = adapter.name,
                    backend = adapter.backend,
                    software = adapter.software,
                    self_check = check.passed,
                    "GPU device opened"
                );
                self.publish.send_modify(|status| {
                    status.state = GpuState::Ready;
                    status.adapter = Some(adapter);
                    status.dial_basis = dial_basis;
                    status.self_check = Some(check);
                    [status.level_maps, status.fields] = self.since_the_start(&caches);
                });
                Some(backend)
            }
            Err(error) => {
                tracing::error!(%error, "no GPU device");
                self.publish.send_modify(|status| {
                    status.state = GpuState::Failed(error.to_string());
                    status.self_check = None;
                });
                None
            }
        }
    }

    /// Gives up the backend and builds another.
    fn reopen(&mut self, backend: &mut Option<Box<dyn RenderBackend>>, why: &str) {
        tracing::warn!(why, "rebuilding the GPU device");
        self.publish.send_modify(|status| {
            status.state = GpuState::Lost(why.to_owned());
            status.self_check = None;
            status.losses += 1;
            // The caches are lost with the device; their counts are kept.
            self.gone = [status.level_maps.clone(), status.fields.clone()];
            for cache in [&mut status.level_maps, &mut status.fields] {
                (cache.entries, cache.bytes) = (0, 0);
            }
        });
        discard(backend);
        *backend = self.open();
    }

    fn idle(&mut self, backend: &mut Option<Box<dyn RenderBackend>>) {
        match backend {
            Some(present) => {
                let polled = catch_unwind(AssertUnwindSafe(|| present.idle()));
                match polled {
                    Ok(Ok(())) => {
                        self.after_work(present);
                        // A request that looked up the mesh before it was deleted has a place by now.
                        lock(&self.forgotten).retain(|_, deleted| {
                            deleted.elapsed() < IDLE_PERIOD || self.held.since_before(*deleted)
                        });
                    }
                    Ok(Err(error)) if is_loss(&error) => self.reopen(backend, &error.to_string()),
                    Ok(Err(error)) => tracing::warn!(%error, "the idle device reported an error"),
                    Err(panic) => self.reopen(backend, &panic_message(&*panic)),
                }
            }
            None if self.last_try.elapsed() >= REOPEN_PERIOD => *backend = self.open(),
            None => {}
        }
    }

    /// Runs one job until it has an answer or an error, or the device is lost a second time.
    fn serve(&mut self, backend: &mut Option<Box<dyn RenderBackend>>, mut job: Job) {
        let queued = job.place.arrival.elapsed();
        let mut may_retry = true;
        loop {
            // Since arrival, the caller may have left and the device may have been lost.
            if job.cancel.is_cancelled() {
                return job.work.fail(JobError::Cancelled);
            }
            let Some(present) = backend else {
                let why = match &self.publish.borrow().state {
                    GpuState::Failed(why) => why.clone(),
                    state => format!("{state:?}"),
                };
                return job.work.fail(JobError::Unavailable(why));
            };
            let started = Instant::now();
            let context = JobContext {
                cancel: &job.cancel,
                queued,
            };
            let attempted = attempt(&mut job.work, &mut **present, &context, &self.forgotten);
            // This job, and jobs whose scenes are being prepared, may hold meshes deleted after they took their places.
            lock(&self.forgotten).retain(|_, deleted| self.held.since_before(*deleted));
            match attempted {
                Ok(()) => {
                    self.record_job_time(started.elapsed());
                    return self.after_work(present);
                }
                Err(Failure::Error(RenderError::Gpu(error))) if is_loss(&error) => {
                    self.reopen(backend, &error.to_string());
                    // A job that hangs is not retried: it would block the queue twice.
                    if !may_retry || matches!(error, GpuError::Timeout(_)) {
                        return job.work.fail(RenderError::Gpu(error).into());
                    }
                    may_retry = false;
                }
                Err(Failure::Error(RenderError::Cancelled)) => {
                    return job.work.fail(JobError::Cancelled);
                }
                Err(Failure::Error(error)) => {
                    self.after_work(present);
                    return job.work.fail(error.into());
                }
                Err(Failure::Panic(message)) => {
                    // Rebuild before answering, so that the service works again when the caller reads the answer.
                    self.reopen(backend, &format!("the renderer panicked: {message}"));
                    return job.work.fail(JobError::Panicked(message));
                }
            }
        }
    }

    fn record_job_time(&self, took: Duration) {
        self.publish.send_modify(|status| {
            let seconds = took.as_secs_f64();
            status.job_s = if status.job_s == 0.0 {
                seconds
            } else {
                status.job_s + JOB_TIME_WEIGHT * (seconds - status.job_s)
            };
        });
    }

    /// The statistics of the present device's caches, plus the counts of earlier devices.
    fn since_the_start(&self, caches: &[CacheStats; 2]) -> [CacheStats; 2] {
        std::array::from_fn(|k| CacheStats {
            hits: self.gone[k].hits + caches[k].hits,
            misses: self.gone[k].misses + caches[k].misses,
            evictions: self.gone[k].evictions + caches[k].evictions,
            ..caches[k].clone()
        })
    }

    /// Frees what is cached for deleted meshes, and publishes the state of the caches.
    fn after_work(&self, backend: &mut Box<dyn RenderBackend>) {
        let forgotten = &self.forgotten;
        let found = catch_unwind(AssertUnwindSafe(|| {
            forget(&mut **backend, forgotten);
            caches(&**backend)
        }));
        match found {
            Ok(found) => {
                let found = self.since_the_start(&found);
                self.publish
                    .send_modify(|status| [status.level_maps, status.fields] = found);
            }
            Err(panic) => {
                tracing::error!(panic = panic_message(&*panic), "the caches panicked");
            }
        }
    }
}

/// The statistics of a backend's caches: level maps, fields of light.
fn caches(backend: &dyn RenderBackend) -> [CacheStats; 2] {
    [backend.level_map_cache(), backend.field_cache()]
}

/// Runs a job once and catches its panics.
///
/// After a panic the backend is discarded, so an inconsistent state is never used.
fn attempt(
    work: &mut Box<dyn super::job::Work>,
    backend: &mut dyn RenderBackend,
    context: &JobContext<'_>,
    forgotten: &Mutex<BTreeMap<String, Instant>>,
) -> Result<(), Failure> {
    match catch_unwind(AssertUnwindSafe(|| {
        forget(backend, forgotten);
        work.run(backend, context)
    })) {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(Failure::Error(error)),
        Err(panic) => Err(Failure::Panic(panic_message(&*panic))),
    }
}

/// Frees what is cached for deleted meshes. Repeat it as long as jobs may run that were submitted with such a mesh before.
fn forget(backend: &mut dyn RenderBackend, forgotten: &Mutex<BTreeMap<String, Instant>>) {
    for id in lock(forgotten).keys() {
        backend.forget_mesh(id);
    }
}

/// Drops a backend. A panic while dropping must not end the thread.
fn discard(backend: &mut Option<Box<dyn RenderBackend>>) {
    if let Some(old) = backend.take()
        && let Err(panic) = catch_unwind(AssertUnwindSafe(move || drop(old)))
    {
        tracing::error!(
            panic = panic_message(&*panic),
            "dropping the device panicked"
        );
    }
}

/// Whether the device can no longer be used.
fn is_loss(error: &GpuError) -> bool {
    matches!(error, GpuError::DeviceLost(_) | GpuError::Timeout(_))
}

/// A self-check without any check counts as failed.
fn judged(mut check: SelfCheck) -> SelfCheck {
    if check.checks.is_empty() {
        check.passed = false;
        check.checks.push(SelfCheckItem {
            name: "no check ran".to_owned(),
            ..SelfCheckItem::default()
        });
    }
    check
}

fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    panic
        .downcast_ref::<&str>()
        .map(|message| (*message).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned())
}
