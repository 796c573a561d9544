//! Passes that several methods share, and the slots between them. Each file holds one pass with its slots and structs; its shader has
//! the same name in `shaders/stages/`.
//!
//! | what | files |
//! |---|---|
//! | water and its rays | `surface` (the one to copy), `beams`, `hits`, `unfollowed` |
//! | level maps | `level_map`, `level_map_pyramid` |
//! | flux on receivers | `deposit`, `split`, `landed`, `irradiance`; shared by them: `light`, `receivers`, `maps`, `sums`, `term`, `queues` |
//! | points that pixels see or texels lie at | `points`: the slot; `camera_hits` and `texel_points` fill it; `sky_and_air_lights`, `camera_irradiance`, `shade` |
//! | the kept field of light | `light_field`: its slots; `field_irradiance`: its light at points |
//! | the frame's estimate of its own error | `coarse_irradiance`, `estimate` |
//! | the water as an output of its own | `water_map` |
//! | caustic volumes | `volume_bounds`: shared by methods in which points find their volumes |
//! | reference planes | `reference_planes`: shared by methods that slice objects |
//!
//! Bindings are matched by name: a WGSL variable has the name of the slot it binds.

pub mod beams;
pub mod camera_hits;
pub mod camera_irradiance;
pub mod coarse_irradiance;
pub mod deposit;
pub mod estimate;
pub mod field_irradiance;
pub mod gpu_values;
pub mod hits;
pub mod irradiance;
pub mod landed;
pub mod level_map;
pub mod level_map_pyramid;
pub mod light;
pub mod light_field;
pub mod maps;
pub mod objects;
pub mod points;
pub mod queues;
pub mod receivers;
pub mod reference_planes;
pub mod shade;
pub mod shaders;
pub mod sky_and_air_lights;
pub mod split;
pub mod sums;
pub mod surface;
pub mod term;
pub mod texel_points;
pub mod unfollowed;
pub mod volume_bounds;
pub mod water_map;

use crate::facts::SceneFacts;
use crate::graph::{self, Program};

/// This program as an instance of the generic graph.
#[derive(Clone, Copy, Debug)]
pub struct Caustica;

impl Program for Caustica {
    type Facts = SceneFacts;
    type LevelMap = level_map::LevelMapRun;
}

/// A pass.
pub type Pass = graph::PassDesc<Caustica>;
/// A slot.
pub type Slot = graph::SlotDesc<Caustica>;
/// The steps of a pass, by scope.
pub type Steps = graph::Steps<Caustica>;
/// A dispatch or draw.
pub type Step = graph::Step<Caustica>;
/// The workgroups of a dispatch.
pub type Groups = graph::Groups<Caustica>;
/// A run of a pass.
pub type Run<'a> = graph::Run<'a, Caustica>;
/// What a step does.
pub type Work = graph::Work<Caustica>;

/// Passes that run before those of the method: the level maps, the water and the rays under it.
pub static BEFORE_METHOD: [&Pass; 4] = [
    &level_map::PASS,
    &level_map_pyramid::PASS,
    &surface::PASS,
    &beams::PASS,
];

/// Passes that run after the method has made its maps: the estimate of the error, the points of the picture, and the irradiance at
/// them that does not depend on the method.
pub static AFTER_MAPS: [&Pass; 5] = [
    &coarse_irradiance::PASS,
    &estimate::PASS,
    &camera_hits::PASS,
    &texel_points::PASS,
    &sky_and_air_lights::PASS,
];

/// Passes that run last: the irradiance at the points, from the maps, and the picture; or the map of the water.
pub static PICTURE: [&Pass; 3] = [&camera_irradiance::PASS, &shade::PASS, &water_map::PASS];
