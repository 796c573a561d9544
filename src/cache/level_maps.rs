//! The level-map cache: one arena on the GPU, keyed by mesh, light direction in mesh space, resolution and layers.
//!
//! A level map does not depend on the waves, so one serves every frame of an animation. The arena is one buffer (shaders bind
//! it whole) with ranges handed out first-fit; when there is no room, the maps that were used longest ago go first, never
//! those that the frame at hand needs. A map counts as there once it is built, not when its range is reserved: a frame that breaks
//! off leaves nothing that a later one could take for a map.

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

    /// Whether a map is there, built.
    pub fn contains(&self, key: &LevelMapKey) -> bool {
        self.entries.get(key).is_some_and(|entry| entry.built)
    }

    /// Byte offset in the arena of a map that is there or reserved.
    pub fn offset(&self, key: &LevelMapKey) -> Option<u64> {
        self.entries.get(key).map(|e| e.offset)
    }

    /// Makes room for all of `keys` at once and says which have to be built; counts hits and evictions. Each of those that have
    /// to be is then told to [`Self::built`], or forgotten.
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
            // All fit, but not around the pieces that are there already: those are built again, side by side with the rest.
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

    /// Gives each key a range, and says whether all have one.
    fn place_all(&mut self, keys: &[LevelMapKey]) -> bool {
        keys.iter().all(|key| self.place(key))
    }

    /// Gives a key a range, if need be of maps that the frame at hand does not use.
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

    /// Forgets maps that were reserved and not built, so that a frame that broke off leaves no empty map behind.
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
