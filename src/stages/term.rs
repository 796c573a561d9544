//! Terms of the energy account, as in `shaders/shared/flux.wgsl` (a test compares the numbers). Spectral terms take three places.

/// Falls on the simulated piece of water.
pub const EMITTED: usize = 0;
/// Reflected at the surface.
pub const REFLECTED: usize = 1;
/// Meets no receiver.
pub const MISSED: usize = 2;
/// Absorbed or scattered on the way, per channel.
pub const EXTINGUISHED: usize = 3;
/// Passes the edges of the maps, per channel.
pub const LEFT: usize = 6;
/// Lies on the maps, per channel.
pub const LANDED: usize = 9;
/// Flux of beams that straddle receivers to the end.
pub const UNRESOLVED: usize = 12;
/// How many those are.
pub const UNRESOLVED_COUNT: usize = 13;
/// Flux of those that were halved less often than asked for, because the queue was full.
pub const CUT: usize = 14;
/// Flux of slopes that look away from the light: water in their shadow gets so much too much.
pub const FACING_AWAY: usize = 15;
/// Flux of beams that come out of the water again.
pub const LEAVING_AGAIN: usize = 16;
/// Flux of beams that start below the floor.
pub const BARED_FLOOR: usize = 17;
