//! Level maps (Tipprasert 2006), with light placed where rays hit. Each ray is marched into the position map of a mesh until it crosses
//! the surface (the thesis's stated next step); beams span the hits and are deposited with exact texel coverage. The default method.

use super::{Conformance, Method};
use crate::facts::{MethodFacts, Product};
use crate::stages::{deposit, hits, irradiance, landed, split, unfollowed};

/// See the module.
pub static METHOD: Method = Method {
    name: "level_map",
    summary: "beams end where their rays hit the floor or cross a mesh's level map",
    paper: "Tipprasert 2006, with its next step (§6.2): light placed on the actual hit",
    dials: &[],
    shaders: &[],
    shared_dials: &[
        "water_cells",
        "map_texels",
        "level_map_texels",
        "layers",
        "level_of_detail",
        "split_levels",
    ],
    passes: &[
        &hits::PASS,
        &deposit::PASS,
        &split::PASS,
        &unfollowed::PASS,
        &landed::PASS,
        &irradiance::PASS,
    ],
    expected_order: 2.0,
    dials_can_be_chosen: true,
    facts: |_| MethodFacts::new(METHOD.name, Product::ReceiverMaps),
    supports: |_| Ok(()),
    conformance: Conformance {
        sine_pool_error_at_256: 5e-3,
        skips: &[],
    },
};
