//! The command line. `args` declares it, each command has a file (`render`, `animate`, `accuracy` with `compare`, `experiment`, `calibrate`,
//! `hard_cases`, `plan`, `serve`, `selfcheck`, `health`), and `error` has the exit codes.
//!
//! Shared by the commands: `scene_flags` makes a flag of every field of `quality` and `output`, `scene_file` reads a scene with
//! its meshes, `material_files` the MTL files of a mesh, `frames` reads frame ranges, `frame_pattern` reads file name patterns,
//! `picture` renders and encodes, `files` writes results, `notes` writes to stderr, `progress` shows progress, `batch` reports on many
//! frames, `summary` describes the cost of a frame, `device_select` keeps a driver's layer from printing errors.

pub mod accuracy;
pub mod animate;
pub mod args;
pub mod batch;
pub mod calibrate;
mod device_select;
pub mod error;
pub mod experiment;
pub mod files;
pub mod frame_pattern;
pub mod frames;
pub mod hard_cases;
pub mod health;
pub mod material_files;
pub mod notes;
pub mod picture;
pub mod plan;
mod progress;
pub mod render;
pub mod scene_file;
pub mod scene_flags;
pub mod selfcheck;
pub mod serve;
pub mod summary;

pub use args::{Cli, main, run};
pub use error::CliError;
