//! The store of files of numbers.

use std::collections::BTreeMap;
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::config::Limits;
use crate::fields::{self, Field, FieldError, FieldInfo};

/// Files by content id, shared between threads, within a budget of bytes. Nothing is evicted: a file stays until it is removed, and one
/// that does not fit is refused.
#[derive(Debug)]
pub struct FieldStore {
    budget_bytes: u64,
    held: RwLock<Held>,
}

#[derive(Debug, Default)]
struct Held {
    fields: BTreeMap<String, Arc<Field>>,
    bytes: u64,
}

/// A file in the store.
#[derive(Clone, Debug)]
pub struct InsertedField {
    /// The file.
    pub field: Arc<Field>,
    /// Whether this upload added it.
    pub created: bool,
}

impl FieldStore {
    /// An empty store; `limits.asset_store_bytes` applies.
    pub fn new(limits: &Limits) -> Self {
        Self {
            budget_bytes: limits.asset_store_bytes,
            held: RwLock::default(),
        }
    }

    /// Reads a file and stores it. If the same bytes are stored already, returns that file without reading them again.
    ///
    /// Other calls are not blocked meanwhile.
    ///
    /// # Errors
    /// What [`fields::read`] refuses, and [`FieldError::StoreFull`].
    pub fn insert(&self, bytes: &[u8]) -> Result<InsertedField, FieldError> {
        if let Some(field) = self.get(&fields::id(bytes)) {
            return Ok(InsertedField {
                field,
                created: false,
            });
        }
        let field = Arc::new(fields::read(bytes)?);
        let needed_bytes = field.bytes();
        let mut held = self.write();
        // Another thread may have added the same file meanwhile.
        if let Some(field) = held.fields.get(&field.id) {
            return Ok(InsertedField {
                field: Arc::clone(field),
                created: false,
            });
        }
        if held.bytes.saturating_add(needed_bytes) > self.budget_bytes {
            return Err(FieldError::StoreFull {
                needed_bytes,
                used_bytes: held.bytes,
                budget_bytes: self.budget_bytes,
            });
        }
        held.bytes += needed_bytes;
        held.fields.insert(field.id.clone(), Arc::clone(&field));
        Ok(InsertedField {
            field,
            created: true,
        })
    }

    /// The file with this id.
    pub fn get(&self, id: &str) -> Option<Arc<Field>> {
        self.read().fields.get(id).cloned()
    }

    /// Removes a file; returns whether it was stored. Frames that use it keep it until they are done.
    pub fn remove(&self, id: &str) -> bool {
        let mut held = self.write();
        let Some(field) = held.fields.remove(id) else {
            return false;
        };
        held.bytes -= field.bytes();
        true
    }

    /// All files, sorted by id.
    pub fn list(&self) -> Vec<FieldInfo> {
        self.read().fields.values().map(|f| f.info()).collect()
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.read().bytes
    }

    // No code that holds the lock can panic in the middle of a change, so the data behind a poisoned lock is valid.
    fn read(&self) -> RwLockReadGuard<'_, Held> {
        self.held.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Held> {
        self.held.write().unwrap_or_else(PoisonError::into_inner)
    }
}
