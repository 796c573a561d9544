//! Terms of the energy account, as in `shaders/shared/terms.wgsl` (a test compares the numbers). Spectral terms take three places. Terms
//! from [`UNRESOLVED`] on are no part of the balance; warnings report them.

/// Flux that falls on the simulated piece of water.
pub const EMITTED: usize = 0;
/// Reflected at the surface.
pub const REFLECTED: usize = 1;
/// Hits no receiver.
pub const MISSED: usize = 2;
/// Absorbed or scattered along the path, per channel.
pub const EXTINGUISHED: usize = 3;
/// Lands beyond the edges of the maps, per channel.
pub const LEFT: usize = 6;
/// Lands on the maps, per channel.
pub const LANDED: usize = 9;
/// Flux of unresolved pieces: parts of beams that straddle receivers after the last halving.
pub const UNRESOLVED: usize = 12;
/// Number of unresolved pieces.
pub const UNRESOLVED_COUNT: usize = 13;
/// Flux of the unresolved pieces that were halved fewer times than requested, because the queue was full.
pub const CUT: usize = 14;
/// Flux of slopes that face away from the light; water in their shadow receives this flux although it should not.
pub const FACING_AWAY: usize = 15;
/// Flux of beams that leave the water again.
pub const LEAVING_AGAIN: usize = 16;
/// Flux of beams that start below the floor.
pub const BARED_FLOOR: usize = 17;
