//! How far an image is from the truth: the figures (`metrics`).

pub mod metrics;

pub use metrics::{MetricError, convergence_order};
