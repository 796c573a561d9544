//! Tests that need an adapter (software Vulkan is enough). None is skipped: without an adapter they fail.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(
    clippy::needless_pass_by_value,
    reason = "`json!` literals are passed as they are"
)]

mod accuracy_program;
mod accuracy_service;
mod batches;
mod beam_sets;
mod camera_layers;
mod caustic_volumes;
mod chosen_dials;
mod conformance;
mod determinism;
mod energy;
mod estimate;
mod experiment;
#[allow(dead_code, reason = "the tests of files use what is not used here")]
#[path = "../support/field_files.rs"]
mod field_support;
mod flat;
#[allow(
    dead_code,
    reason = "the tests of scene files use what is not used here"
)]
#[path = "../cpu/folder.rs"]
mod folder;
mod footprint;
mod formulas;
mod hard_cases;
mod harness;
mod height_fields;
mod instances;
#[path = "../support/instances.rs"]
mod instances_scene;
mod irradiance_volume;
mod kernels;
mod lamp_truths;
mod lamps;
mod layers;
mod legs;
mod level_maps;
mod level_maps_service;
mod living_water;
mod memory;
mod own_passes;
mod photon;
mod photon_plain;
mod plain_sub_volumes;
mod plain_volumes;
mod planes;
mod planted;
mod points;
mod properties;
#[path = "../support/scene_files.rs"]
mod scene_files;
mod sea_study;
mod serve_program;
mod service;
mod shadows;
mod sine_pool;
mod splitting;
mod study;
mod sub_volumes;
mod symmetry;
mod tiles;
#[path = "../support/truths.rs"]
mod truths;
mod view;
mod water_maps;
mod wide_sums;
