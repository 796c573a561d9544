//! Tests that need no adapter. `scene_parse`: JSON to scene and what is said about bad JSON. `scene_validate`: ranges,
//! references, limits, meshes by id. `scene_overrides`: single fields replaced from outside. `cli`: the command line.

mod cli;
mod scene_overrides;
mod scene_parse;
mod scene_validate;
