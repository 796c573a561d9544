//! How far an image is from the truth: `metrics` (numbers against numbers), `flip` and `luv` (pictures against pictures, made by
//! `display`), and `estimate`, a frame's estimate of its own error.

pub mod display;
pub mod estimate;
pub mod flip;
pub mod luv;
pub mod metrics;

pub use display::LinearImage;
pub use metrics::{MetricError, convergence_order};
