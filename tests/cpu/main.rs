//! Tests (cpu).
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod mesh_hierarchy;
mod mesh_obj;
mod mesh_store;
mod teapot;
