//! Caustica.
pub mod accuracy;
pub mod cli;
pub mod config;
pub mod frame;
pub mod gpu;
pub mod http;
pub mod image;
pub mod jobs;
pub mod mesh;
pub mod passes;
pub mod physics;
pub mod plan;
pub mod reference;
pub mod render;
pub mod scene;
pub mod stats;
pub mod waves;
