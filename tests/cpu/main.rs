//! Tests that need no adapter.

mod metrics;
mod physics;
mod reference;
mod reference_meshes;
mod waves;
