//! The store of files of numbers.

use std::sync::Arc;

use super::store::{Full, Store, Stored};
use crate::config::Limits;
use crate::fields::{self, Field, FieldError, FieldInfo};

/// Files by content id, shared between threads, within a budget of bytes. Nothing is evicted: a file stays until it is removed, and one
/// that does not fit is refused.
#[derive(Debug)]
pub struct FieldStore {
    store: Store<Field>,
}

/// A file in the store.
#[derive(Clone, Debug)]
pub struct InsertedField {
    /// The file.
    pub field: Arc<Field>,
    /// Whether this upload added it.
    pub created: bool,
}

impl Stored for Field {
    fn id(&self) -> &str {
        &self.id
    }

    fn bytes(&self) -> u64 {
        self.bytes()
    }
}

impl FieldStore {
    /// An empty store; `limits.asset_store_bytes` applies.
    pub fn new(limits: &Limits) -> Self {
        Self {
            store: Store::new(limits.asset_store_bytes),
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
        let field = fields::read(bytes)?;
        match self.store.insert(field) {
            Ok((field, created)) => Ok(InsertedField { field, created }),
            Err(Full {
                needed_bytes,
                used_bytes,
                budget_bytes,
            }) => Err(FieldError::StoreFull {
                needed_bytes,
                used_bytes,
                budget_bytes,
            }),
        }
    }

    /// The file with this id.
    pub fn get(&self, id: &str) -> Option<Arc<Field>> {
        self.store.get(id)
    }

    /// Removes a file; returns whether it was stored. Frames that use it keep it until they are done.
    pub fn remove(&self, id: &str) -> bool {
        self.store.remove(id)
    }

    /// All files, sorted by id.
    pub fn list(&self) -> Vec<FieldInfo> {
        self.store.list(Field::info)
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.store.bytes()
    }
}
