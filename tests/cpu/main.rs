//! Tests that need no adapter.
//!
//! `scene_parse`, `scene_shapes`: JSON to scene, and what is said about bad JSON. `scene_validate`, `scene_output`: ranges,
//! limits, references. `scene_resolve`: meshes by id. `scene_overrides`: single fields replaced from outside. `cli`,
//! `cli_scene_file`, `cli_program`: the command line.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(
    clippy::needless_pass_by_value,
    reason = "`json!` literals are passed as they are"
)]

mod cli;
mod cli_program;
mod cli_scene_file;
mod folder;
mod scene_output;
mod scene_overrides;
mod scene_parse;
mod scene_resolve;
mod scene_shapes;
mod scene_validate;
