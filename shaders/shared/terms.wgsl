// Terms of the energy account; one (low, high) pair per term and channel, see term.rs.
const TERM_EMITTED: u32 = 0u;
const TERM_REFLECTED: u32 = 1u;
const TERM_MISSED: u32 = 2u;
const TERM_EXTINGUISHED: u32 = 3u;
const TERM_LEFT: u32 = 6u;
const TERM_LANDED: u32 = 9u;
const TERM_UNRESOLVED: u32 = 12u;       // flux of unresolved pieces, which straddle receivers after the last halving
const TERM_UNRESOLVED_COUNT: u32 = 13u; // number of unresolved pieces
const TERM_CUT: u32 = 14u;              // flux of unresolved pieces halved fewer times than requested, because the queue was full
const TERM_FACING_AWAY: u32 = 15u;      // flux of slopes that face away from the light
const TERM_LEAVING_AGAIN: u32 = 16u;    // flux of beams that leave the water again
const TERM_BARED_FLOOR: u32 = 17u;      // flux of beams that start below the floor
