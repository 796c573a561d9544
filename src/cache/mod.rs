//! The level-map cache: ranges of one buffer (`arena`), the place of each map and the order of eviction (`cache`), and requests to build
//! maps before a frame needs them (`warm`).

pub mod arena;
pub mod cache;
pub mod warm;

pub use arena::{Arena, ArenaError};
pub use cache::LevelMapCache;
pub use warm::{WarmSun, WarmUp, WarmedMap};
