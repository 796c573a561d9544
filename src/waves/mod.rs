//! The water surface at one moment: height, slope and curvature, at a point or along a row, and bounds of all of them.
//!
//! - `surface`: [`Surface`], the one interface; it knows the kinds of water and hides them;
//! - `row`: the points of a row, evaluated a block at a time;
//! - `sines`: a sum of sines, the only kind so far.
//!
//! To add a kind: a file of its own with the methods that [`Surface`] passes on, and a variant of the `Kind` in `surface`.
//! Nothing outside this folder may depend on how a surface is made up; a test in `tests/cpu/rooms.rs` holds that.

mod row;
mod sines;
mod surface;

pub use row::{ROW_POINTS, RowPoints, Rows};
pub use surface::{Curvature, Surface, SurfacePoint, normal};
