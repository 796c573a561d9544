//! Reference planes (Tipprasert 2006, ch. 4): the thesis's own method to place light on meshes. Rays are intersected with planes through
//! the object's box; their light is accepted where the level map is within half a plane distance. For comparison.

pub mod depth_profile;
pub mod plane_deposit;

use super::reference_planes::PLANES;
use super::{Conformance, Method};
use crate::facts::method::LeavesOut;
use crate::facts::{MethodFacts, Product};
use crate::scene::{Dial, DialKind, DialWord};
use crate::stages::shaders::embed_shaders;
use crate::stages::{deposit, hits, irradiance, landed, split, unfollowed};

/// The word of [`SLICING`] that leaves planes out.
pub const SMART: &str = "smart";

/// Which reference planes are used.
pub static SLICING: Dial = Dial {
    name: "slicing",
    help: "Which reference planes are used.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "uniform",
                help: "all of them",
            },
            DialWord {
                name: SMART,
                help: "those near which the level map has a surface (Tipprasert 2006, §4.7.2): the same picture with fewer planes",
            },
        ],
        default: "uniform",
    },
};

/// See the module.
pub static METHOD: Method = Method {
    name: "planes",
    summary: "light is accepted on a mesh where reference planes come near its level map",
    paper: "Tipprasert 2006, ch. 4",
    dials: &[&PLANES, &SLICING],
    shaders: embed_shaders![
        "methods/planes/depth_profile.wgsl",
        "methods/planes/plane_deposit.wgsl"
    ],
    shared_dials: &[
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
        conserves_energy: false,
        lights_meshes_by_hits: false,
        reference_planes: PLANES.integer(quality),
        // A beam may light texels of each plane.
        deposits_per_beam: PLANES.integer(quality),
        skips_empty_planes: SLICING.word(quality) == SMART,
        leaves_out: LeavesOut {
            shadows_on_objects: true,
            further_layers: true,
            ..LeavesOut::default()
        },
        ..MethodFacts::new(METHOD.name, Product::ReceiverMaps)
    },
    supports: |_| Ok(()),
    conformance: Conformance {
        sine_pool_error_at_256: 5e-3,
        skips: &[],
    },
};
