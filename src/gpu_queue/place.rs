//! A place in the queue, held from before a scene is prepared until its job has ended.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use tokio::sync::OwnedSemaphorePermit;

use super::queue::lock;

/// A place in the queue. A request that gets none is refused before any work is done for it.
#[derive(Debug)]
pub struct Place {
    pub(super) arrival: Instant,
    /// When it was taken.
    since: Instant,
    held: Held,
    /// Released together with the place.
    _permit: OwnedSemaphorePermit,
}

impl Place {
    pub(super) fn new(arrival: Instant, held: Held, permit: OwnedSemaphorePermit) -> Self {
        let mut all = lock(&held.0);
        let since = Instant::now();
        all.push(since);
        drop(all);
        Self {
            arrival,
            since,
            held,
            _permit: permit,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut all = lock(&self.held.0);
        // Places taken at the same instant are interchangeable.
        if let Some(index) = all.iter().position(|since| *since == self.since) {
            all.swap_remove(index);
        }
    }
}

/// The times at which the places held now were taken.
#[derive(Clone, Debug, Default)]
pub(super) struct Held(Arc<Mutex<Vec<Instant>>>);

impl Held {
    /// Whether a request that may have looked up its meshes before `moment` still has a job to run.
    pub(super) fn since_before(&self, moment: Instant) -> bool {
        lock(&self.0).iter().any(|since| *since <= moment)
    }
}
