//! Irradiance volume: horizontal slices through the water, each with the exact coverage of all beams, kept from frame to frame. Each texel
//! has the flux that falls through it and its mean direction; light at any point is looked up between the slices along that direction. After
//! the 3D texture of light of Mercier (eikonal caustics), filled by beams instead of a solver.
//!
//! Every beam is cut with every slice, so the cost does not depend on the receivers, and a receiver that moves costs a look-up only. Objects
//! do not shade the slices; their shadows are cast at the look-up, with the hard edges of the mean direction.

pub mod field_slices;

use super::{Conformance, Method};
use crate::facts::method::FieldGrid;
use crate::facts::{MethodFacts, Product, SceneFacts};
use crate::scene::{Dial, DialKind};
use crate::stages::field_irradiance;
use crate::stages::shaders::embed_shaders;

/// How many slices the water has.
pub static SLICES: Dial = Dial {
    name: "slices",
    help: "Horizontal slices of the water, from the floor to the crests. Time and memory of the first frame grow with them; between slices \
        the error falls with the square of their distance.",
    kind: DialKind::Integer {
        least: 2,
        most: 512,
        default: 64,
    },
};

/// How many texels a slice has.
pub static SLICE_TEXELS: Dial = Dial {
    name: "slice_texels",
    help: "Texels along the longer side of a slice. Memory grows with their square.",
    kind: DialKind::Integer {
        least: 4,
        most: 2048,
        default: 256,
    },
};

/// See the module.
pub static METHOD: Method = Method {
    name: "irradiance_volume",
    summary: "beams are cut with horizontal slices, which are kept; every point looks its light up between them along its mean direction",
    paper: "our own, after the 3D texture of light of Mercier, Eikonal Approximation for Real-Time Height Field Caustics",
    dials: &[&SLICES, &SLICE_TEXELS],
    shaders: embed_shaders!["methods/irradiance_volume/field_slices.wgsl"],
    shared_dials: &["water_cells"],
    passes: &[&field_slices::PASS, &field_irradiance::PASS],
    // With the cells of water alone the error falls to that of slices and their texels.
    expected_order: 0.0,
    dials_can_be_chosen: false,
    facts: |quality| MethodFacts {
        field: Some(FieldGrid {
            slices: SLICES.integer(quality),
            texels: SLICE_TEXELS.integer(quality),
        }),
        ..MethodFacts::new(METHOD.name, Product::Field)
    },
    supports,
    conformance: Conformance {
        sine_pool_error_at_256: 1e-2,
        skips: &[(
            "slopes_of_20",
            "waves so steep throw most of half a million beams over whole slices: with the default slices and texels that takes minutes",
        )],
    },
};

/// Slices hold light that falls from the surface.
fn supports(facts: &SceneFacts) -> Result<(), String> {
    let mut sets = facts.lights.beam_sets.iter();
    match sets.find(|set| set.is_submerged()) {
        None => Ok(()),
        Some(set) => Err(format!(
            "the slices of an irradiance volume hold light that falls from the surface of the water, and light {} is under it",
            set.light_index
        )),
    }
}
