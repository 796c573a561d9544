//! Tests that need no adapter.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod image_exr;
mod image_metadata;
mod image_png;
mod image_support;
mod mesh_hierarchy;
mod mesh_obj;
mod mesh_store;
mod project;
mod teapot;
mod tone;
