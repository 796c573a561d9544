//! Level maps between frames: ranges of one buffer (`arena`), which map lies where and which goes first (`level_maps`), and building maps
//! before a frame asks for them (`warm`).

pub mod arena;
pub mod level_maps;
pub mod warm;

pub use arena::{Arena, ArenaError};
pub use level_maps::LevelMapCache;
pub use warm::{WarmSun, WarmUp, WarmedMap};
