//! Published experiments done again with this program: the thesis's comparison of level maps with slice images and of smart with
//! uniform slicing (Tipprasert 2006, ch. 5), in our numbers, with the true error that the thesis could not measure.
//!
//! `scene` makes the scene of a shape, `measure` renders it each way, `study` holds what was found, `paper` what the thesis found,
//! `markdown`, `csv` and `write` make files of it.

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
pub use scene::{Way, scene};
pub use study::{Experiment, HitPoint, MemoryExample, MeshResult, PlanePoint, WayFigures};
pub use write::{FEATURED, plots, write};
