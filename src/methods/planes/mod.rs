//! Reference planes (Tipprasert 2006, ch. 4): the thesis's own way to place light on meshes. Rays are cut with planes through the
//! object's box, and their light is accepted where the level map is within half a distance of planes. To compare with.

pub mod depth_profile;
pub mod plane_deposit;

use super::{Conformance, Method};
use crate::facts::method::LeavesOut;
use crate::facts::{MethodFacts, Product};
use crate::stages::{deposit, hits, irradiance, landed, split, unfollowed};

/// See the module.
pub static METHOD: Method = Method {
    name: "planes",
    summary: "light is accepted on a mesh where reference planes come near its level map",
    paper: "Tipprasert 2006, ch. 4",
    dials: &[
        "planes",
        "slicing",
        "water_cells",
        "map_texels",
        "level_map_texels",
        "level_of_detail",
    ],
    passes: &[
        &hits::PASS,
        &deposit::PASS,
        &split::PASS,
        &depth_profile::PASS,
        &plane_deposit::PASS,
        &unfollowed::PASS,
        &landed::PASS,
        &irradiance::PASS,
    ],
    expected_order: 0.0,
    dials_can_be_chosen: false,
    facts: |quality| MethodFacts {
        name: METHOD.name,
        product: Product::ReceiverMaps,
        conserves_energy: false,
        lights_meshes_by_hits: false,
        reference_planes: quality.planes,
        // A beam may light texels of each plane.
        deposits_per_beam: quality.planes,
        has_scratch_map: false,
        leaves_out: LeavesOut {
            shadows_on_objects: true,
            further_layers: true,
        },
    },
    supports: |_| Ok(()),
    conformance: Conformance {
        sine_pool_error_at_256: 5e-3,
        skips: &[],
    },
};
