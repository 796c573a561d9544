//! The level-map cache: ranges of one buffer (`arena`), the place of each map and the order of eviction (`level_maps`), and requests to
//! build maps before a frame needs them (`warm`).

pub mod arena;
pub mod level_maps;
pub mod warm;

pub use arena::{Arena, ArenaError};
pub use level_maps::LevelMapCache;
pub use warm::{WarmSun, WarmUp, WarmedMap};
