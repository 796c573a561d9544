//! How far an image is from the truth, and what it cost to get that near: the figures of an image (`metrics`), and what a
//! study of a scene found (`study`).

pub mod dial;
pub mod estimate;
pub mod metrics;
pub mod study;

pub use metrics::{MetricError, convergence_order};
