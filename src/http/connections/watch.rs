//! What each connection is doing, and which one is closed to make room.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::Instant;

/// Why the service closed a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum CloseReason {
    /// No request, or half of one, for too long.
    Idle,
    /// It waited, and another connection needed the place.
    Evicted,
    /// The client did not read its answer.
    Stalled,
}

impl CloseReason {
    pub(in super::super) const ALL: [Self; 3] = [Self::Idle, Self::Evicted, Self::Stalled];

    pub(in super::super) fn word(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Evicted => "evicted",
            Self::Stalled => "stalled",
        }
    }
}

/// A client counts as waiting when nothing of its request's body has arrived for this time: clients that send steadily are not closed
/// for a new connection.
const BODY_PAUSE: Duration = Duration::from_secs(1);

/// All open connections.
#[derive(Debug)]
pub(super) struct Open {
    places: Arc<Semaphore>,
    watches: Mutex<BTreeMap<u64, Arc<Watch>>>,
    next: AtomicU64,
    /// A connection has started to wait, or its request's body has paused.
    waits: Arc<Notify>,
}

impl Open {
    pub(super) fn new(most: u32) -> Self {
        Self {
            places: Arc::new(Semaphore::new(most as usize)),
            watches: Mutex::default(),
            next: AtomicU64::new(0),
            waits: Arc::default(),
        }
    }

    /// A place for a new connection: a free one, else that of the connection that has waited longest, else the first to become
    /// free.
    pub(super) async fn place(&self) -> OwnedSemaphorePermit {
        loop {
            if let Ok(place) = Arc::clone(&self.places).try_acquire_owned() {
                return place;
            }
            let evicted = self.evict_longest_waiting();
            let next = self.next_pause();
            tokio::select! {
                place = Arc::clone(&self.places).acquire_owned() => {
                    return place.expect("the semaphore is never closed");
                }
                // A connection that was evicted frees its place soon.
                () = self.waits.notified(), if !evicted => {}
                // A client whose body pauses for long enough starts to wait.
                () = tokio::time::sleep_until(next.unwrap_or_else(Instant::now)), if !evicted && next.is_some() => {}
            }
        }
    }

    /// Closes the connection that has waited longest; returns whether there is one that waits.
    pub(super) fn evict_longest_waiting(&self) -> bool {
        let watches = self.watches();
        let waiting = watches
            .values()
            .filter_map(|watch| Some((watch.waiting_since()?, watch)));
        let mut waiting: Vec<_> = waiting.collect();
        waiting.sort_by_key(|(since, _)| *since);
        // A request may arrive meanwhile; then it is the next one's turn.
        waiting.iter().any(|(_, watch)| watch.evict())
    }

    /// When the next connection starts to wait if nothing more of its request's body arrives.
    fn next_pause(&self) -> Option<Instant> {
        let watches = self.watches();
        let awaited = watches.values().filter_map(|watch| match *watch.phase() {
            Phase::Busy { awaited, .. } => Some(awaited? + BODY_PAUSE),
            _ => None,
        });
        awaited.min()
    }

    /// A new connection, which waits.
    pub(super) fn enter(&self) -> Arc<Watch> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let watch = Arc::new(Watch {
            number,
            phase: Mutex::new(Phase::Silent(Instant::now())),
            waits: Arc::clone(&self.waits),
            evicted: Notify::new(),
        });
        self.watches().insert(number, Arc::clone(&watch));
        watch
    }

    pub(super) fn leave(&self, watch: &Watch) {
        self.watches().remove(&watch.number);
    }

    /// Waits until no connection is open.
    pub(super) async fn emptied(&self, most: u32) {
        // An error means a closed semaphore, which nobody closes.
        let _ = self.places.acquire_many(most).await;
    }

    fn watches(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Watch>>> {
        self.watches.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a connection is doing.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Nothing of a request has arrived since then.
    Silent(Instant),
    /// A part of a header has arrived, its first byte then.
    Header(Instant),
    /// A request is in flight, or its answer is being written.
    Busy {
        /// If the client does not take any more of the answer: since when.
        stalled: Option<Instant>,
        /// If the service needs more of the request's body and the client sends none: since when.
        awaited: Option<Instant>,
    },
    /// The end of the answer has been handed over for writing.
    Ending { stalled: Option<Instant> },
    /// It is being closed to make room; nothing changes that.
    Evicted,
}

impl Phase {
    /// Since when the connection waits for its client; `None` if it does not, and while it is being closed.
    fn waiting_since(self) -> Option<Instant> {
        match self {
            Self::Silent(since) | Self::Header(since) => Some(since),
            Self::Busy { awaited, .. } => awaited.filter(|since| since.elapsed() >= BODY_PAUSE),
            Self::Ending { .. } | Self::Evicted => None,
        }
    }
}

/// When a connection is to be closed, and why.
pub(super) type Deadline = (Instant, CloseReason);

/// The state of one connection.
#[derive(Debug)]
pub(super) struct Watch {
    number: u64,
    phase: Mutex<Phase>,
    waits: Arc<Notify>,
    /// The connection has been evicted.
    pub(super) evicted: Notify,
}

impl Watch {
    fn phase(&self) -> MutexGuard<'_, Phase> {
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn waiting_since(&self) -> Option<Instant> {
        self.phase().waiting_since()
    }

    /// Closes the connection unless it is busy by now.
    fn evict(&self) -> bool {
        let mut phase = self.phase();
        let waiting = phase.waiting_since().is_some();
        if waiting {
            *phase = Phase::Evicted;
            self.evicted.notify_one();
        }
        waiting
    }

    /// Whether the connection is being closed to make room.
    pub(super) fn is_evicted(&self) -> bool {
        matches!(*self.phase(), Phase::Evicted)
    }

    /// A request begins; false if the connection is being closed.
    pub(super) fn begin(&self) -> bool {
        let mut phase = self.phase();
        let stays = !matches!(*phase, Phase::Evicted);
        if stays {
            *phase = Phase::Busy {
                stalled: None,
                awaited: None,
            };
        }
        stays
    }

    /// Bytes have arrived.
    pub(super) fn received(&self) {
        let mut phase = self.phase();
        if matches!(*phase, Phase::Silent(_)) {
            *phase = Phase::Header(Instant::now());
        }
    }

    /// The service needs more of the request's body than has arrived, or no longer does.
    pub(super) fn awaits_body(&self, awaits: bool) {
        if let Phase::Busy { awaited, .. } = &mut *self.phase() {
            if awaits && awaited.is_none() {
                self.waits.notify_one();
            }
            *awaited = awaits.then(|| awaited.unwrap_or_else(Instant::now));
        }
    }

    /// The client takes no more of the answer at the moment, or takes it again.
    pub(super) fn stalls(&self, stalls: bool) {
        if let Phase::Busy { stalled, .. } | Phase::Ending { stalled } = &mut *self.phase() {
            *stalled = stalls.then(|| stalled.unwrap_or_else(Instant::now));
        }
    }

    /// The end of the answer is in the server's buffer, or there is no more answer.
    pub(super) fn handed_over(&self) {
        let mut phase = self.phase();
        if let Phase::Busy { stalled, .. } = *phase {
            *phase = Phase::Ending { stalled };
        }
    }

    /// The server's buffer is written.
    pub(super) fn flushed(&self) {
        let mut phase = self.phase();
        if matches!(*phase, Phase::Ending { .. }) {
            *phase = Phase::Silent(Instant::now());
            self.waits.notify_one();
        }
    }

    /// When the connection is to be closed if nothing changes, and why.
    pub(super) fn deadline(
        &self,
        silent: Duration,
        header: Duration,
        idle: Duration,
    ) -> Option<Deadline> {
        match *self.phase() {
            Phase::Silent(since) => Some((since + silent, CloseReason::Idle)),
            Phase::Header(since) => Some((since + header, CloseReason::Idle)),
            Phase::Busy { stalled, awaited } => {
                let stalled = stalled.map(|since| (since + idle, CloseReason::Stalled));
                let awaited = awaited.map(|since| (since + idle, CloseReason::Idle));
                let both = stalled.into_iter().chain(awaited);
                both.min_by_key(|(deadline, _)| *deadline)
            }
            Phase::Ending { stalled } => stalled.map(|since| (since + idle, CloseReason::Stalled)),
            Phase::Evicted => Some((Instant::now(), CloseReason::Evicted)),
        }
    }
}
