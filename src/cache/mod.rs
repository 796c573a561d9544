//! What stays on the GPU between frames, level maps and fields of light, each under a byte budget: ranges of one buffer (`arena`), the
//! place of each thing and the order of eviction (`keeper`), and requests to build level maps before a frame needs them (`warm`).

pub mod arena;
pub mod keeper;
pub mod warm;

pub use arena::{Arena, ArenaError};
pub use keeper::{FieldCache, LevelMapCache};
pub use warm::{WarmSun, WarmUp, WarmedMap};
