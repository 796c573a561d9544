//! The level-map cache: one arena on the GPU, keyed by mesh, light direction in mesh space, resolution and layers.
//!
//! A level map does not depend on the waves, so one serves every frame of an animation. The arena is one buffer (shaders bind
//! it whole) with ranges handed out first-fit; when there is no room, the maps that were used longest ago go first, never
//! those that the frame at hand needs.

pub mod arena;

pub use arena::{Arena, ArenaError};

use std::collections::BTreeMap;

use crate::scene::placement::LevelMapKey;
use crate::stats::CacheStats;

/// A cached map.
#[derive(Clone, Debug)]
struct Entry {
    offset: u64,
    bytes: u64,
    last_used: u64,
}

/// Which map lies where in the arena.
#[derive(Debug)]
pub struct LevelMapCache {
    arena: Arena,
    entries: BTreeMap<LevelMapKey, Entry>,
    clock: u64,
    totals: CacheStats,
}

impl LevelMapCache {
    /// An empty cache of at most `budget_bytes`.
    pub fn new(budget_bytes: u64) -> Self {
        let totals = CacheStats {
            budget_bytes,
            ..CacheStats::default()
        };
        Self {
            arena: Arena::new(budget_bytes),
            entries: BTreeMap::new(),
            clock: 0,
            totals,
        }
    }

    /// Whether a map is there.
    pub fn contains(&self, key: &LevelMapKey) -> bool {
        self.entries.contains_key(key)
    }

    /// Byte offset of a map in the arena.
    pub fn offset(&self, key: &LevelMapKey) -> Option<u64> {
        self.entries.get(key).map(|e| e.offset)
    }

    /// Makes room for all of `keys` at once and says which have to be built; counts hits, misses and evictions.
    ///
    /// # Errors
    /// When they do not fit the budget together.
    pub fn reserve(&mut self, keys: &[&LevelMapKey]) -> Result<Vec<LevelMapKey>, ArenaError> {
        let needed: u64 = keys.iter().map(|key| key.bytes()).sum();
        if needed > self.totals.budget_bytes {
            return Err(ArenaError {
                needed_bytes: needed,
                budget_bytes: self.totals.budget_bytes,
            });
        }
        self.clock += 1;
        for key in keys {
            if let Some(entry) = self.entries.get_mut(*key) {
                entry.last_used = self.clock;
                self.totals.hits += 1;
            }
        }
        let missing: Vec<LevelMapKey> = keys
            .iter()
            .filter(|key| !self.entries.contains_key(**key))
            .map(|key| (*key).clone())
            .collect();
        for key in &missing {
            let bytes = key.bytes();
            let offset = loop {
                if let Some(offset) = self.arena.allocate(bytes) {
                    break offset;
                }
                if !self.evict_oldest() {
                    // What the frame needs fits, but not around the pieces it already has: start over with an empty arena.
                    self.clear();
                    self.totals.hits = self
                        .totals
                        .hits
                        .saturating_sub((keys.len() - missing.len()) as u64);
                    return self.reserve(keys);
                }
            };
            self.totals.misses += 1;
            self.entries.insert(
                key.clone(),
                Entry {
                    offset,
                    bytes,
                    last_used: self.clock,
                },
            );
        }
        Ok(missing)
    }

    fn evict_oldest(&mut self) -> bool {
        let oldest = self
            .entries
            .iter()
            .filter(|(_, entry)| entry.last_used < self.clock)
            .min_by_key(|(_, entry)| entry.last_used)
            .map(|(key, _)| key.clone());
        let Some(key) = oldest else { return false };
        self.remove(&key);
        self.totals.evictions += 1;
        true
    }

    fn remove(&mut self, key: &LevelMapKey) {
        if let Some(entry) = self.entries.remove(key) {
            self.arena.free(entry.offset, entry.bytes);
        }
    }

    /// Forgets maps that were reserved but not built, so that a failed frame leaves no empty map behind.
    pub fn forget(&mut self, keys: &[LevelMapKey]) {
        for key in keys {
            self.remove(key);
        }
    }

    /// Forgets all maps of a mesh.
    pub fn forget_mesh(&mut self, mesh: &str) {
        let keys: Vec<LevelMapKey> = self
            .entries
            .keys()
            .filter(|key| key.mesh == mesh)
            .cloned()
            .collect();
        self.forget(&keys);
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.totals.evictions += self.entries.len() as u64;
        self.entries.clear();
        self.arena.clear();
    }

    /// Counts since the start, and what is held now.
    pub fn stats(&self) -> CacheStats {
        CacheStats {
            entries: self.entries.len() as u64,
            bytes: self.entries.values().map(|e| e.bytes).sum(),
            ..self.totals.clone()
        }
    }
}
