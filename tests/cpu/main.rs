//! Tests that need no adapter.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(
    clippy::needless_pass_by_value,
    reason = "`json!` literals are passed as they are"
)]

mod accuracy_dial;
mod accuracy_estimate;
mod accuracy_metrics;
mod accuracy_plot;
mod accuracy_report;
mod broken_fields;
mod choppy_sea;
mod cli;
mod cli_frames;
mod cli_notes;
mod cli_program;
mod cli_scene_file;
mod cli_streams;
mod comparison;
mod experiment;
mod field_files;
#[path = "../support/field_files.rs"]
mod field_support;
mod folder;
mod fronts_eikonal;
mod fronts_fit;
mod fronts_wave;
mod fuzz_cases;
#[path = "../../fuzz/checks/mod.rs"]
mod fuzz_checks;
mod grid_bounds;
mod height_fields;
mod image_exr;
mod image_metadata;
mod image_png;
mod image_support;
mod kept;
mod lamps;
mod level_map_cache;
mod light_field;

mod listen;
mod log;
mod mesh_hierarchy;
mod mesh_obj;
mod mesh_shapes;
mod mesh_store;
mod method_advice;
mod methods;
mod metrics;
mod mutants;
mod obstacles;
mod open_water;
mod output_files;
mod physics;
mod plans;
#[path = "../../examples/mutants/plants.rs"]
mod plants;
mod prepared;
mod project;
mod reference;
mod reference_closed_form;
mod reference_errors;
mod reference_lamps;
mod reference_lens;
mod reference_meshes;
mod reference_texels;
mod ripples;
mod rooms;
mod scene_camera;
mod scene_facts;
#[path = "../support/scene_files.rs"]
mod scene_files;
mod scene_output;
mod scene_overrides;
mod scene_parse;
mod scene_resolve;
mod scene_shapes;
mod scene_validate;
mod scene_warnings;
mod scene_waves;
mod sea;
mod sea_statistics;
mod sea_study;
mod shader_constants;
#[path = "../../examples/mutants/shader_plants.rs"]
mod shader_plants;
mod shaders;
#[path = "../support/surfaces.rs"]
mod surfaces;
#[path = "../support/synthetic_study.rs"]
mod synthetic_study;
mod teapot;
mod tone;
mod truth;
mod truth_disk;
#[path = "../support/truths.rs"]
mod truths;
mod tuning;
mod water_map;
mod waves;
