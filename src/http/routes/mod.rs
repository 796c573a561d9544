//! The routes, one resource per file.

pub mod accuracy;
pub mod assets;
pub mod docs;
pub mod health;
pub mod info;
pub mod meshes;
pub mod metrics;
pub mod plan;
pub mod render;
