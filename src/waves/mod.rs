//! The water surface at one time: height, slope and curvature at a point or along a row, and bounds of all of them.
//!
//! - `surface`: [`Surface`], the only interface; it adds up the kinds of water;
//! - `row`: the points of a row, evaluated a block at a time;
//! - `sines`, `trochoids`: waves with a formula;
//! - `sea`, `ripples`: water that is computed on a grid (`grid`), and `spline`, the surface through the samples, with its `bounds`;
//! - `spectrum`, `chance`, `clock`, `fourier`: what a sea is made of: variances, random numbers, phases, and the sum of its waves;
//! - `choppy`: a sea whose points move to the sides as well;
//! - `harmonics`: the modes of a basin, added up on a grid.
//!
//! To add a kind: a file of its own, and a line where `surface` collects them.
//! Nothing outside this folder may depend on how a surface is represented; a test in `tests/cpu/rooms.rs` checks that.

mod bounds;
mod chance;
mod choppy;
mod clock;
mod fourier;
mod grid;
mod harmonics;
mod ripples;
mod row;
mod sea;
mod sines;
mod spectrum;
mod spline;
mod surface;
mod trochoids;

pub use ripples::slope_lost;
pub use row::{ROW_POINTS, RowPoints, Rows};
pub use surface::{Curvature, Surface, SurfacePoint, normal};
