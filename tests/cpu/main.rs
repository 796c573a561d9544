//! Tests that need no adapter.
#![allow(
    clippy::unwrap_used,
    reason = "a test that meets what it does not expect shall stop there"
)]

mod metrics;
mod physics;
mod reference;
mod reference_closed_form;
mod reference_errors;
mod reference_meshes;
mod waves;
