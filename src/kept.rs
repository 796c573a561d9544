//! Results that are kept for whoever needs them again, within a budget of bytes: each under a hash of all that it was computed from.

use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes that are kept by default, 256 MiB.
pub const DEFAULT_BYTES: u64 = 1 << 28;

/// Results by the hashes of their sources. Clones share them.
///
/// A result must depend on nothing but what was hashed: then it makes no difference whether it was kept or is computed again. If the
/// budget is exceeded, those that were not used for the longest time are dropped.
#[derive(Clone)]
pub struct Kept {
    shelf: Arc<Mutex<Shelf>>,
}

/// The hash of a result's sources.
pub type Key = [u8; 32];

struct Shelf {
    results: HashMap<Key, Entry>,
    bytes: u64,
    budget_bytes: u64,
    /// Number of uses so far.
    uses: u64,
}

struct Entry {
    result: Arc<dyn Any + Send + Sync>,
    bytes: u64,
    last_use: u64,
}

impl Default for Kept {
    fn default() -> Self {
        Self::within(DEFAULT_BYTES)
    }
}

impl std::fmt::Debug for Kept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Kept({} bytes)", self.bytes())
    }
}

impl Kept {
    /// Nothing yet; at most `budget_bytes`. With 0 nothing is ever kept.
    pub fn within(budget_bytes: u64) -> Self {
        Self {
            shelf: Arc::new(Mutex::new(Shelf {
                results: HashMap::new(),
                bytes: 0,
                budget_bytes,
                uses: 0,
            })),
        }
    }

    /// The result under `key`, if it is kept. Results of different types never share a key.
    pub fn get<T: Send + Sync + 'static>(&self, key: &Key) -> Option<Arc<T>> {
        let mut shelf = self.shelf();
        shelf.uses += 1;
        let now = shelf.uses;
        let entry = shelf.results.get_mut(key)?;
        entry.last_use = now;
        Arc::clone(&entry.result).downcast().ok()
    }

    /// Keeps `result`, which occupies `bytes`, and returns it. If there is one under `key` already, that one stays.
    pub fn put<T: Send + Sync + 'static>(&self, key: Key, result: T, bytes: u64) -> Arc<T> {
        let result = Arc::new(result);
        let mut shelf = self.shelf();
        if bytes > shelf.budget_bytes || shelf.results.contains_key(&key) {
            return result;
        }
        shelf.uses += 1;
        let entry = Entry {
            result: Arc::clone(&result) as Arc<dyn Any + Send + Sync>,
            bytes,
            last_use: shelf.uses,
        };
        shelf.results.insert(key, entry);
        shelf.bytes += bytes;
        while shelf.bytes > shelf.budget_bytes {
            shelf.drop_oldest();
        }
        result
    }

    /// The result under `key`; if it is not kept, `make` computes it and says how many bytes it occupies. Nothing waits for `make`: two
    /// threads that need the same at the same time both compute it.
    pub fn get_or<T: Send + Sync + 'static>(
        &self,
        key: Key,
        make: impl FnOnce() -> (T, u64),
    ) -> Arc<T> {
        self.get(&key).unwrap_or_else(|| {
            let (result, bytes) = make();
            self.put(key, result, bytes)
        })
    }

    /// Bytes of all results.
    pub fn bytes(&self) -> u64 {
        self.shelf().bytes
    }

    // No code that holds the lock can panic in the middle of a change.
    fn shelf(&self) -> MutexGuard<'_, Shelf> {
        self.shelf.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf {
    fn drop_oldest(&mut self) {
        let oldest = self.results.iter().min_by_key(|(_, entry)| entry.last_use);
        if let Some(key) = oldest.map(|(key, _)| *key)
            && let Some(entry) = self.results.remove(&key)
        {
            self.bytes -= entry.bytes;
        }
    }
}
