//! What both stores have in common: things by content id, shared between threads, within a budget of bytes.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// A thing that a store keeps.
pub(super) trait Stored {
    /// Its content id.
    fn id(&self) -> &str;
    /// Bytes that it occupies.
    fn bytes(&self) -> u64;
}

/// Things by content id. Nothing is evicted: a thing stays until it is removed, and one that does not fit is refused.
#[derive(Debug)]
pub(super) struct Store<T> {
    budget_bytes: u64,
    held: RwLock<Held<T>>,
}

#[derive(Debug)]
struct Held<T> {
    things: BTreeMap<String, Arc<T>>,
    bytes: u64,
}

/// Why a thing is refused: the store is full.
pub(super) struct Full {
    pub(super) needed_bytes: u64,
    pub(super) used_bytes: u64,
    pub(super) budget_bytes: u64,
}

impl<T: Stored> Store<T> {
    /// An empty store.
    pub(super) fn new(budget_bytes: u64) -> Self {
        Self {
            budget_bytes,
            held: RwLock::new(Held {
                things: BTreeMap::new(),
                bytes: 0,
            }),
        }
    }

    /// Stores a thing; returns what is stored under its id, and whether this call added it. Another thread may have added it meanwhile.
    pub(super) fn insert(&self, thing: T) -> Result<(Arc<T>, bool), Full> {
        let needed_bytes = thing.bytes();
        let mut held = self.write();
        if let Some(held) = held.things.get(thing.id()) {
            return Ok((Arc::clone(held), false));
        }
        if held.bytes.saturating_add(needed_bytes) > self.budget_bytes {
            return Err(Full {
                needed_bytes,
                used_bytes: held.bytes,
                budget_bytes: self.budget_bytes,
            });
        }
        held.bytes += needed_bytes;
        let thing = Arc::new(thing);
        held.things
            .insert(thing.id().to_owned(), Arc::clone(&thing));
        Ok((thing, true))
    }

    /// The thing with this id.
    pub(super) fn get(&self, id: &str) -> Option<Arc<T>> {
        self.read().things.get(id).cloned()
    }

    /// Removes a thing; returns whether it was stored. Frames that use it keep it until they are done.
    pub(super) fn remove(&self, id: &str) -> bool {
        let mut held = self.write();
        let Some(thing) = held.things.remove(id) else {
            return false;
        };
        held.bytes -= thing.bytes();
        true
    }

    /// Something of every thing, sorted by id.
    pub(super) fn list<I>(&self, info: impl Fn(&T) -> I) -> Vec<I> {
        self.read().things.values().map(|t| info(t)).collect()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> u64 {
        self.read().bytes
    }

    // No code that holds the lock can panic in the middle of a change, so the data behind a poisoned lock is valid.
    fn read(&self) -> RwLockReadGuard<'_, Held<T>> {
        self.held.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Held<T>> {
        self.held.write().unwrap_or_else(PoisonError::into_inner)
    }
}
