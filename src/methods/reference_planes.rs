//! The dial shared by the methods that slice objects.

use crate::scene::{Dial, DialKind};

/// Most reference planes of an object; `MOST_PLANES` of the shaders is the same.
pub const MOST_PLANES: u32 = 1024;

/// How many reference planes cut an object.
pub static PLANES: Dial = Dial {
    name: "planes",
    help: "Planes that cut a mesh's box along the light, the n + 1 of Tipprasert 2006. Time grows with them, and memory where each has an \
        image of its own.",
    kind: DialKind::Integer {
        least: 2,
        most: MOST_PLANES,
        default: 51,
    },
};
