//! The water surface at one time: height, slope and curvature at a point or along a row, and bounds of all of them.
//!
//! - `surface`: [`Surface`], the only interface; it hides the kinds of water;
//! - `row`: the points of a row, evaluated a block at a time;
//! - `sines`: a sum of sines, the only kind so far.
//!
//! To add a kind: a file of its own with the methods that [`Surface`] passes on, and a variant of the `Kind` in `surface`.
//! Nothing outside this folder may depend on how a surface is represented; a test in `tests/cpu/rooms.rs` checks that.

mod row;
mod sines;
mod surface;

pub use row::{ROW_POINTS, RowPoints, Rows};
pub use surface::{Curvature, Surface, SurfacePoint, normal};
