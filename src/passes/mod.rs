//! The passes: one Rust file and one WGSL file of the same name each, and one line in [`ALL`].
//!
//! To add a pass: write `shaders/passes/<name>.wgsl` and `src/passes/<name>.rs` with its [`PassDesc`], add what it writes to
//! [`slot::Slot`], and put it into [`ALL`] behind everything it reads. `surface.rs` is the one to copy. Bindings are matched by
//! name: a WGSL variable is called like the slot it binds.

pub mod beams;
pub mod camera_hits;
pub mod camera_irradiance;
pub mod coarse_irradiance;
pub mod deposit;
pub mod depth_profile;
pub mod desc;
pub mod estimate;
pub mod gpu_data;
pub mod hits;
pub mod irradiance;
pub mod landed;
pub mod level_map;
pub mod level_map_pyramid;
pub mod light;
pub mod maps;
pub mod plane_steps;
pub mod planes;
pub mod shade;
pub mod shaders;
pub mod slot;
pub mod split;
pub mod surface;
pub mod term;
pub mod unfollowed;
pub mod volumetric;

pub use desc::{Groups, PassDesc, Repeat, Step, Work};
pub use slot::Slot;

/// All passes in the order they run.
pub const ALL: [&PassDesc; 18] = [
    &level_map::PASS,
    &level_map_pyramid::PASS,
    &surface::PASS,
    &beams::PASS,
    &hits::PASS,
    &deposit::PASS,
    &split::PASS,
    &depth_profile::PASS,
    &planes::PASS,
    &volumetric::PASS,
    &unfollowed::PASS,
    &landed::PASS,
    &irradiance::PASS,
    &coarse_irradiance::PASS,
    &estimate::PASS,
    &camera_hits::PASS,
    &camera_irradiance::PASS,
    &shade::PASS,
];
