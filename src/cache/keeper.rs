//! Things that are kept on the GPU from frame to frame, in the ranges of one buffer: level maps (keyed by mesh, light direction in mesh
//! space, resolution and layers, so that one serves every frame of an animation), and fields of light (keyed by water and moment, light,
//! box and resolution, so that one serves every frame in which only receivers or the camera move).
//!
//! Each kind has a buffer of its own, its arena, which shaders bind whole; ranges are allocated first-fit. When there is no room, the least
//! recently used things are evicted, but never those of the current frame. A thing counts as kept once it is built, not when its range is
//! reserved: a frame that is aborted leaves no range that a later frame could mistake for its content.

use std::collections::{BTreeMap, BTreeSet};

use super::{Arena, ArenaError};
use crate::facts::field::FieldKey;
use crate::facts::placement::LevelMapKey;
use crate::stats::CacheStats;

/// What identifies a kept thing, and says how much room it takes.
pub trait Key: Clone + Ord {
    /// What the host keeps beside the thing.
    type Note;

    /// Name of such things, plural.
    const THINGS: &'static str;

    /// Size in the arena, bytes.
    fn bytes(&self) -> u64;
}

impl Key for LevelMapKey {
    type Note = ();
    const THINGS: &'static str = "level maps";

    fn bytes(&self) -> u64 {
        Self::bytes(self)
    }
}

impl Key for FieldKey {
    /// The raw account of each slice, see [`crate::stages::light_field`].
    type Note = Vec<u64>;
    const THINGS: &'static str = "fields of light";

    fn bytes(&self) -> u64 {
        self.bytes
    }
}

/// The level maps on the GPU.
pub type LevelMapCache = Keeper<LevelMapKey>;
/// The fields of light on the GPU.
pub type FieldCache = Keeper<FieldKey>;

/// A range of the arena that belongs to a thing.
#[derive(Clone, Debug)]
struct Entry<N> {
    offset: u64,
    bytes: u64,
    last_used: u64,
    /// What the host keeps beside it; `None` until it is built.
    note: Option<N>,
}

/// The things in an arena, and their places.
#[derive(Debug)]
pub struct Keeper<K: Key> {
    arena: Arena,
    entries: BTreeMap<K, Entry<K::Note>>,
    clock: u64,
    totals: CacheStats,
}

impl<K: Key> Keeper<K> {
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

    /// Whether a thing is kept and built.
    pub fn contains(&self, key: &K) -> bool {
        self.note(key).is_some()
    }

    /// What the host keeps beside a thing that is built.
    pub fn note(&self, key: &K) -> Option<&K::Note> {
        self.entries.get(key)?.note.as_ref()
    }

    /// Byte offset in the arena of a thing that is built or reserved.
    pub fn offset(&self, key: &K) -> Option<u64> {
        self.entries.get(key).map(|e| e.offset)
    }

    /// Reserves ranges for all of `keys` at once and returns those that must be built; counts hits and evictions. The caller then reports
    /// each finished thing with [`Self::built`] and drops the others with [`Self::forget_unbuilt`].
    ///
    /// # Errors
    /// When they do not fit the budget together; nothing is changed then.
    pub fn reserve(&mut self, keys: &[&K]) -> Result<Vec<K>, ArenaError> {
        let mut seen = BTreeSet::new();
        let keys: Vec<&K> = keys.iter().copied().filter(|k| seen.insert(*k)).collect();
        let error = ArenaError {
            things: K::THINGS,
            needed_bytes: keys.iter().map(|key| key.bytes()).sum(),
            budget_bytes: self.totals.budget_bytes,
        };
        if error.needed_bytes > error.budget_bytes {
            return Err(error);
        }
        self.clock += 1;
        let mut missing: Vec<K> = Vec::new();
        for &key in &keys {
            match self.entries.get_mut(key) {
                Some(entry) if entry.note.is_some() => entry.last_used = self.clock,
                _ => {
                    self.remove(key);
                    missing.push(key.clone());
                }
            }
        }
        if !self.place_all(&missing) {
            // They would all fit, but not around those that are in place: the arena is emptied and all of them are built again.
            self.totals.evictions +=
                self.entries.values().filter(|e| e.note.is_some()).count() as u64;
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
    fn place_all(&mut self, keys: &[K]) -> bool {
        keys.iter().all(|key| self.place(key))
    }

    /// Allocates a range for a key; evicts things that the current frame does not use if necessary.
    fn place(&mut self, key: &K) -> bool {
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
            note: None,
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

    fn remove(&mut self, key: &K) {
        if let Some(entry) = self.entries.remove(key) {
            self.arena.free(entry.offset, entry.bytes);
        }
    }

    /// Notes that a reserved thing has been built, with what the host keeps beside it; counts a miss.
    pub fn built(&mut self, key: &K, note: K::Note) {
        if let Some(entry) = self.entries.get_mut(key)
            && entry.note.is_none()
        {
            entry.note = Some(note);
            self.totals.misses += 1;
        }
    }

    /// Drops things that were reserved and not built, so that an aborted frame leaves none empty behind.
    pub fn forget_unbuilt(&mut self) {
        self.forget(|_, entry| entry.note.is_none());
    }

    fn forget(&mut self, which: impl Fn(&K, &Entry<K::Note>) -> bool) {
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

impl LevelMapCache {
    /// Forgets all maps of a mesh.
    pub fn forget_mesh(&mut self, mesh: &str) {
        self.forget(|key, _| key.mesh == mesh);
    }
}
