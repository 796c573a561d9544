//! How far an image is from the truth. `metrics` compares numbers; `flip` and `luv` compare pictures, which `display` makes;
//! `estimate` is a frame's estimate of its own error.

pub mod display;
pub mod estimate;
pub mod flip;
pub mod luv;
pub mod metrics;

pub use display::LinearImage;
pub use metrics::{MetricError, convergence_order};
