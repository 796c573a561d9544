//! The water surface at one time: height, slope and curvature at a point or along a row, and bounds of all of them.
//!
//! - `surface`: [`Surface`], the only interface; it adds up the kinds of water;
//! - `row`: the points of a row, evaluated a block at a time;
//! - `sines`, `trochoids`: waves with a formula;
//! - `sea`, `ripples`: water that is computed on a grid (`grid`), and `spline`, the surface through the samples, with its `bounds`;
//! - `height_field`: water from samples that a user brings, and `gradient`, heights from slopes;
//! - `spectrum`, `chance`, `clock`, `fourier`: what a sea is made of: variances, random numbers, phases, and the sum of its waves;
//! - `choppy`: a sea whose points move to the sides as well;
//! - `harmonics`: the modes of a basin, added up on a grid;
//! - `open_water`: a basin whose walls absorb, without obstacles;
//! - `tank`: a basin with obstacles, in steps of time, on the samples of `cells`: `footprint` is where obstacles cut the water, `leapfrog`
//!   is one step, `mounds` what drops add, and `continued` fills in what is not water.
//!
//! To add a kind: a file of its own, and a line where `surface` collects them.
//! Nothing outside this folder may depend on how a surface is represented; a test in `tests/cpu/rooms.rs` checks that.

mod bounds;
mod cells;
mod chance;
mod choppy;
mod clock;
mod continued;
mod footprint;
mod fourier;
mod gradient;
mod grid;
mod harmonics;
mod height_field;
mod leapfrog;
mod mounds;
mod open_water;
mod ripples;
mod row;
mod sea;
mod sines;
mod spectrum;
mod spline;
mod surface;
mod tank;
mod trochoids;

pub use height_field::{FieldNotes, Rim};
pub use ripples::slope_lost;
pub use row::{ROW_POINTS, RowPoints, Rows};
pub use surface::{Curvature, Surface, SurfacePoint, normal};
