//! Admission, deadline and cancellation: the callers' side of the GPU thread.

use std::io;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tokio::sync::{Semaphore, oneshot, watch};
use tokio::time::timeout_at;
use tokio_util::sync::CancellationToken;

use super::backend::RenderBackend;
use super::error::JobError;
use super::job::{Job, JobContext, Typed};
use super::place::{Held, Place};
use super::status::{GpuState, GpuStatus};
use super::worker::{Forgotten, Worker};
use crate::cache::{WarmUp, WarmedMap};
use crate::frame::Frame;
use crate::gpu::GpuError;
use crate::mesh::Mesh;
use crate::plan::Plan;
use crate::render::{Prepared, RenderError, SelfCheck};

/// Name of the GPU thread.
pub const THREAD_NAME: &str = "caustica-gpu";

/// Size and deadline of the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QueueSettings {
    /// Jobs that may wait while one runs. One more is refused.
    pub waiting: usize,
    /// Time from arrival after which a caller gets [`JobError::DeadlinePassed`].
    pub deadline: Duration,
}

/// A handle on the GPU thread; clones share it. The thread ends with [`GpuQueue::close`] or with the last handle.
#[derive(Clone, Debug)]
pub struct GpuQueue {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    settings: QueueSettings,
    /// A permit for each job that is prepared, waits or runs: `waiting` + 1 in all.
    places: Arc<Semaphore>,
    held: Held,
    /// The permit to send a job to the thread: 1 in all.
    thread: Arc<Semaphore>,
    sender: Mutex<Option<SyncSender<Job>>>,
    join: Mutex<Option<JoinHandle<()>>>,
    status: watch::Receiver<GpuStatus>,
    forgotten: Forgotten,
    closing: CancellationToken,
}

impl GpuQueue {
    /// Starts the thread. It builds its backend with `factory`, and rebuilds it after each loss.
    ///
    /// # Errors
    /// If the operating system refuses a thread.
    pub fn start<F>(settings: QueueSettings, factory: F) -> io::Result<Self>
    where
        F: FnMut() -> Result<Box<dyn RenderBackend>, GpuError> + Send + 'static,
    {
        // At most one job is in the channel, since its sender holds the thread's only permit.
        let (sender, jobs) = std::sync::mpsc::sync_channel(1);
        let (publish, status) = watch::channel(GpuStatus::default());
        let forgotten = Forgotten::default();
        let held = Held::default();
        let worker = Worker::new(
            Box::new(factory),
            jobs,
            publish,
            Arc::clone(&forgotten),
            held.clone(),
        );
        let join = std::thread::Builder::new()
            .name(THREAD_NAME.to_owned())
            .spawn(move || worker.run())?;
        Ok(Self {
            shared: Arc::new(Shared {
                settings,
                places: Arc::new(Semaphore::new(settings.waiting.saturating_add(1))),
                held,
                thread: Arc::new(Semaphore::new(1)),
                sender: Mutex::new(Some(sender)),
                join: Mutex::new(Some(join)),
                status,
                forgotten,
                closing: CancellationToken::new(),
            }),
        })
    }

    /// A place in the queue for a request that arrived at `arrival` and has looked up its meshes. It is taken before the scene is
    /// prepared.
    ///
    /// # Errors
    /// [`JobError::QueueFull`] at once if there is no place; [`JobError::Unavailable`] or [`JobError::Cancelled`] if
    /// nothing can run.
    pub fn place(&self, arrival: Instant) -> Result<Place, JobError> {
        let shared = &self.shared;
        if let GpuState::Failed(why) = &shared.status.borrow().state {
            return Err(JobError::Unavailable(why.clone()));
        }
        let permit = Arc::clone(&shared.places)
            .try_acquire_owned()
            .map_err(|_| self.refusal())?;
        Ok(Place::new(arrival, shared.held.clone(), permit))
    }

    /// Renders. The time from arrival until the thread took the job, minus the time to prepare the scene, goes into
    /// `stats.time_ms.queue`.
    ///
    /// # Errors
    /// [`JobError`]; dropping the future cancels the job, and a job that has not started never does.
    pub async fn render(&self, place: Place, prepared: Prepared) -> Result<Frame, JobError> {
        self.submit(place, move |backend, context| {
            let mut frame = backend.render(&prepared, context.cancel)?;
            let queued_ms = context.queued.as_secs_f64() * 1e3;
            // The time to prepare is in `plan`. The scene may have been prepared before the request arrived.
            frame.stats.time_ms.queue = (queued_ms - prepared.took_ms()).max(0.0);
            Ok(frame)
        })
        .await
    }

    /// Plans with what is cached now. Nothing runs on the GPU except trial renders to choose dials.
    ///
    /// # Errors
    /// As [`GpuQueue::render`].
    pub async fn plan(&self, place: Place, prepared: Prepared) -> Result<Plan, JobError> {
        self.submit(place, move |backend, context| {
            backend.plan(&prepared, context.cancel)
        })
        .await
    }

    /// Builds level maps of a mesh for later frames, and reports for each sun which maps are ready.
    ///
    /// # Errors
    /// As [`GpuQueue::render`]. Level maps finished before the error stay.
    pub async fn warm(
        &self,
        mesh: Arc<Mesh>,
        wanted: WarmUp,
        arrival: Instant,
    ) -> Result<Vec<WarmedMap>, JobError> {
        self.submit(self.place(arrival)?, move |backend, context| {
            backend.warm(&mesh, &wanted, context.cancel)
        })
        .await
    }

    /// Runs the self-check again: compares the GPU with float64 physics.
    ///
    /// # Errors
    /// As [`GpuQueue::render`].
    pub async fn self_check(&self, arrival: Instant) -> Result<SelfCheck, JobError> {
        self.submit(self.place(arrival)?, |backend, _| {
            backend.self_check().map_err(RenderError::from)
        })
        .await
    }

    /// Frees what is cached for a mesh, before the next job or within about a second. What jobs submitted earlier still build for
    /// the mesh is freed after them. Never waits and never fails.
    pub fn forget_mesh(&self, id: &str) {
        lock(&self.shared.forgotten).insert(id.to_owned(), Instant::now());
    }

    /// The present state of the device; never waits for a job.
    pub fn status(&self) -> GpuStatus {
        self.shared.status.borrow().clone()
    }

    /// Like [`GpuQueue::status`], as a channel to wait for changes.
    pub fn watch(&self) -> watch::Receiver<GpuStatus> {
        self.shared.status.clone()
    }

    /// Size and deadline.
    pub fn settings(&self) -> QueueSettings {
        self.shared.settings
    }

    /// Jobs that are prepared, wait or run now.
    pub fn depth(&self) -> usize {
        (self.shared.settings.waiting + 1).saturating_sub(self.shared.places.available_permits())
    }

    /// Cancels the running job, refuses the waiting ones, and blocks until the thread has ended and the device is freed.
    pub fn close(&self) {
        self.shared.closing.cancel();
        self.shared.places.close();
        self.shared.thread.close();
        drop(lock(&self.shared.sender).take());
        let join = lock(&self.shared.join).take();
        if let Some(join) = join {
            // The panic hook has printed a panic outside the guarded calls; the thread has ended already.
            let _ = join.join();
        }
    }

    async fn submit<T, F>(&self, place: Place, call: F) -> Result<T, JobError>
    where
        T: Send + 'static,
        F: FnMut(&mut dyn RenderBackend, &JobContext<'_>) -> Result<T, RenderError>
            + Send
            + 'static,
    {
        let shared = &self.shared;
        let deadline = (place.arrival + shared.settings.deadline).into();
        let late = |_| JobError::DeadlinePassed {
            deadline_s: shared.settings.deadline.as_secs_f64(),
        };

        // Wait for the thread until the deadline. If the future is dropped here, nothing has been queued.
        let thread = timeout_at(deadline, Arc::clone(&shared.thread).acquire_owned())
            .await
            .map_err(late)?
            .map_err(|_| JobError::Cancelled)?;

        let cancel = shared.closing.child_token();
        let guard = cancel.clone().drop_guard();
        let (reply, answer) = oneshot::channel();
        let job = Job {
            work: Box::new(Typed::new(call, reply)),
            cancel,
            place,
            _thread: thread,
        };
        match lock(&shared.sender).as_ref() {
            Some(sender) => sender.try_send(job).map_err(|_| JobError::Cancelled)?,
            None => return Err(JobError::Cancelled),
        }
        let result = timeout_at(deadline, answer)
            .await
            .map_err(late)?
            .unwrap_or(Err(JobError::Cancelled));
        guard.disarm();
        result
    }

    /// Why there is no place: closed, or full.
    fn refusal(&self) -> JobError {
        let waiting = self.shared.settings.waiting;
        if self.shared.places.is_closed() {
            return JobError::Cancelled;
        }
        let seconds = self.shared.status.borrow().job_s * waiting.max(1) as f64;
        JobError::QueueFull {
            waiting,
            retry_after_s: (seconds.ceil() as u64).clamp(1, 60),
        }
    }
}

/// Locks a mutex and ignores poisoning: values are only replaced as a whole.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
