//! The level-map cache: one arena on the GPU, keyed by mesh, light direction in mesh space, resolution and layers.
//!
//! A level map does not depend on the waves, so one serves every frame of an animation. The arena is one buffer (shaders bind it whole)
//! with ranges allocated first-fit. When there is no room, the least recently used maps are evicted, but never those of the current frame.
//! A map counts as cached once it is built, not when its range is reserved: a frame that is aborted leaves no range that a later frame
//! could mistake for a map.

use std::collections::{BTreeMap, BTreeSet};

use super::{Arena, ArenaError};
use crate::facts::placement::LevelMapKey;
use crate::stats::CacheStats;

/// A range of the arena that belongs to a map.
#[derive(Clone, Debug)]
struct Entry {
    offset: u64,
    bytes: u64,
    last_used: u64,
    built: bool,
}

/// The level maps in the arena, and their places.
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

    /// Whether a map is cached and built.
    pub fn contains(&self, key: &LevelMapKey) -> bool {
        self.entries.get(key).is_some_and(|entry| entry.built)
    }

    /// Byte offset in the arena of a map that is built or reserved.
    pub fn offset(&self, key: &LevelMapKey) -> Option<u64> {
        self.entries.get(key).map(|e| e.offset)
    }

    /// Reserves ranges for all of `keys` at once and returns those that must be built; counts hits and evictions. The caller then reports
    /// each finished map with [`Self::built`] and drops the others with [`Self::forget_unbuilt`].
    ///
    /// # Errors
    /// When they do not fit the budget together; nothing is changed then.
    pub fn reserve(&mut self, keys: &[&LevelMapKey]) -> Result<Vec<LevelMapKey>, ArenaError> {
        let mut seen = BTreeSet::new();
        let keys: Vec<&LevelMapKey> = keys.iter().copied().filter(|k| seen.insert(*k)).collect();
        let error = ArenaError {
            needed_bytes: keys.iter().map(|key| key.bytes()).sum(),
            budget_bytes: self.totals.budget_bytes,
        };
        if error.needed_bytes > error.budget_bytes {
            return Err(error);
        }
        self.clock += 1;
        let mut missing: Vec<LevelMapKey> = Vec::new();
        for &key in &keys {
            match self.entries.get_mut(key) {
                Some(entry) if entry.built => entry.last_used = self.clock,
                _ => {
                    self.remove(key);
                    missing.push(key.clone());
                }
            }
        }
        if !self.place_all(&missing) {
            // They would all fit, but not around the maps that are in place: the arena is emptied and all of them are built again.
            self.totals.evictions += self.entries.values().filter(|e| e.built).count() as u64;
            self.clear();
            missing = keys.iter().map(|key| (*key).clone()).collect();
            if !self.place_all(&missing) {
                return Err(error);
            }
        }
        self.totals.hits += (keys.len() - missing.len()) as u64;
        Ok(missing)
    }

    /// Allocates a range for each key; false if one does not fit.
    fn place_all(&mut self, keys: &[LevelMapKey]) -> bool {
        keys.iter().all(|key| self.place(key))
    }

    /// Allocates a range for a key; evicts maps that the current frame does not use if necessary.
    fn place(&mut self, key: &LevelMapKey) -> bool {
        let bytes = key.bytes();
        let offset = loop {
            match self.arena.allocate(bytes) {
                Some(offset) => break offset,
                None if self.evict_oldest() => {}
                None => return false,
            }
        };
        let entry = Entry {
            offset,
            bytes,
            last_used: self.clock,
            built: false,
        };
        self.entries.insert(key.clone(), entry);
        true
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

    /// Notes that a reserved map has been built; counts a miss.
    pub fn built(&mut self, key: &LevelMapKey) {
        if let Some(entry) = self.entries.get_mut(key)
            && !entry.built
        {
            entry.built = true;
            self.totals.misses += 1;
        }
    }

    /// Drops maps that were reserved and not built, so that an aborted frame leaves no empty map behind.
    pub fn forget_unbuilt(&mut self) {
        self.forget(|_, entry| !entry.built);
    }

    /// Forgets all maps of a mesh.
    pub fn forget_mesh(&mut self, mesh: &str) {
        self.forget(|key, _| key.mesh == mesh);
    }

    fn forget(&mut self, which: impl Fn(&LevelMapKey, &Entry) -> bool) {
        let arena = &mut self.arena;
        self.entries.retain(|key, entry| {
            let goes = which(key, entry);
            if goes {
                arena.free(entry.offset, entry.bytes);
            }
            !goes
        });
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
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
