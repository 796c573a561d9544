//! Level maps between frames: ranges of one buffer (`arena`), which map lies where and who goes first (`cache`), and building maps
//! before a frame asks for them (`warm`).

pub mod arena;
pub mod cache;
pub mod warm;

pub use arena::{Arena, ArenaError};
pub use cache::LevelMapCache;
pub use warm::{WarmSun, WarmUp, WarmedMap};
