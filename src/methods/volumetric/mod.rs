//! The volumetric method (Tipprasert 2006, §5.2.1), the thesis's baseline for level maps: every plane of a mesh has an image of its slice,
//! drawn again for each frame, which masks a caustics map of all beams. For comparison.

pub mod slice_deposit;

use super::reference_planes::PLANES;
use super::{Conformance, Method};
use crate::facts::method::LeavesOut;
use crate::facts::{MethodFacts, Product};
use crate::stages::shaders::embed_shaders;
use crate::stages::{deposit, hits, irradiance, landed, split, unfollowed};

/// See the module.
pub static METHOD: Method = Method {
    name: "volumetric",
    summary: "an image of each plane's slice, drawn anew for every frame, masks the light of all beams",
    paper: "Tipprasert 2006, §5.2.1",
    dials: &[&PLANES],
    shaders: embed_shaders!["methods/volumetric/slice_deposit.wgsl"],
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
        &slice_deposit::PASS,
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
        deposits_per_beam: PLANES.integer(quality),
        has_scratch_map: true,
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
