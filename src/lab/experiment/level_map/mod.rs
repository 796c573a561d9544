//! Repeats published experiments: the thesis's comparison of level maps with slice images and of smart with uniform slicing
//! (Tipprasert 2006, ch. 5), with the true error, which the thesis could not measure.
//!
//! `scene` makes the scene of a shape, `measure` renders it with each technique, `study` holds our measurements and `paper` the thesis's;
//! `markdown`, `csv` and `write` write files.

mod csv;
mod markdown;
mod measure;
mod paper;
mod scene;
mod study;
mod write;

pub use csv::to_csv;
pub use markdown::to_markdown;
pub use measure::{ExperimentError, FindTruth, Render, Settings, measure};
pub use scene::{Technique, scene};
pub use study::{Experiment, HitPoint, MemoryExample, MeshResult, PlanePoint, TechniqueFigures};
pub use write::{FEATURED, plots, write};
