//! Photon mapping in image space (Mihálik 2008, ch. 7.1 and 8): a view from the sun holds the depth of what lies under water; a photon from
//! each cell of the water is refracted and followed to a receiver by a search in that view; its flux is added to a texel of the light's map,
//! which is looked up like a shadow map.
//!
//! View and map lie along the sun's rays *in the air*, as in the paper. Surfaces that are hidden from there get no light, although refracted
//! light may reach them; photons that end there are counted as unresolved, and their light falls on the surface that hides them.
//!
//! The paper leaves the shape of the view's window open. Here it is a rectangle of the water at rest, seen along the light, so that a
//! horizontal floor has one depth and square texels. The map covers the receivers only; the view also covers the water.

pub mod photon_draw;
pub mod photon_lookup;
pub mod photon_map;
pub mod photon_sums;
pub mod photon_view;
pub mod photons;
pub mod view;

use super::{Conformance, Method};
use crate::facts::method::{LeavesOut, OwnCells};
use crate::facts::source::Source;
use crate::facts::{MethodFacts, Product, SceneFacts};
use crate::scene::{Dial, DialKind, DialWord};
use crate::stages::shaders::embed_shaders;
use crate::stages::{hits, unfollowed};

/// How many photons are followed.
pub static PHOTONS_PER_SIDE: Dial = Dial {
    name: "photons",
    help: "Photons along each side of the water that lights the receivers. Time grows with their square; noise falls with about the power \
        1.5 of this number. Where there are fewer than texels of the map, some texels get none and the map shows a grid.",
    kind: DialKind::Integer {
        least: 16,
        most: 4096,
        default: 256,
    },
};

/// How fine the light's map is.
pub static MAP_TEXELS: Dial = Dial {
    name: "photon_map_texels",
    help: "Texels along each side of the light's map and of the view that photons are followed in. More show finer caustics and need more \
        photons.",
    kind: DialKind::Integer {
        least: 16,
        most: 2048,
        default: 256,
    },
};

/// How long the search in image space goes on.
pub static ITERATIONS: Dial = Dial {
    name: "iterations",
    help: "Steps of the search in image space; the one that comes nearest to the surface counts. A floor is found in two, objects need \
        more. Without effect on an exact search.",
    kind: DialKind::Integer {
        least: 1,
        most: 16,
        default: 3,
    },
};

/// The word of [`SEARCH`] for true intersections.
pub const EXACT: &str = "exact";

/// How the end of a photon is found.
pub static SEARCH: Dial = Dial {
    name: "search",
    help: "How a photon's end is found.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "image_space",
                help: "by steps in the view from the light (Mihálik 2008, §7.1)",
            },
            DialWord {
                name: EXACT,
                help: "as the intersection with the scene, to show the error of the search",
            },
        ],
        default: "image_space",
    },
};

/// The word of [`DEPOSIT`] for points with additive blending.
pub const DRAWN: &str = "gpu";

/// How flux is added to the map.
pub static DEPOSIT: Dial = Dial {
    name: "deposit",
    help: "How photons are added to the light's map; the maps are the same to rounding.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "atomic",
                help: "as integers, whose sum does not depend on their order",
            },
            DialWord {
                name: DRAWN,
                help: "as points with additive blending (Mihálik 2008, ch. 8); where the adapter cannot blend 32-bit floats, as integers",
            },
        ],
        default: "atomic",
    },
};

/// The word of [`LOOKUP`] for interpolation.
pub const INTERPOLATED: &str = "bilinear";

/// How the map is read.
pub static LOOKUP: Dial = Dial {
    name: "lookup",
    help: "How the light's map is read.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: INTERPOLATED,
                help: "interpolated between texel centres (Mihálik 2008, §9.2: with enabled filtering)",
            },
            DialWord {
                name: "nearest",
                help: "the texel at the point: no blur, and every texel's own noise",
            },
        ],
        default: INTERPOLATED,
    },
};

/// Most beam sets, each with a layer of the view: WebGPU's limit of layers.
const MOST_SETS: usize = 256;

/// Whether photons are drawn.
fn draws(facts: &SceneFacts) -> bool {
    DEPOSIT.word(&facts.quality) == DRAWN && facts.blends_float32
}

/// See the module.
pub static METHOD: Method = Method {
    name: "photon",
    summary: "photons from the water are followed through the sun's depth view, added to its map, and looked up like a shadow map; only \
        suns, and only surfaces that the sun sees along its rays in the air",
    paper: "Mihálik 2008, ch. 7.1 and 8",
    dials: &[
        &PHOTONS_PER_SIDE,
        &MAP_TEXELS,
        &ITERATIONS,
        &SEARCH,
        &DEPOSIT,
        &LOOKUP,
    ],
    shaders: embed_shaders![
        "methods/photon/photon_draw.wgsl",
        "methods/photon/photon_lookup.wgsl",
        "methods/photon/photon_map.wgsl",
        "methods/photon/photon_sums.wgsl",
        "methods/photon/photon_view.wgsl",
        "methods/photon/photons.wgsl",
    ],
    shared_dials: &[],
    passes: &[
        &hits::PASS,
        &unfollowed::PASS,
        &photon_view::PASS,
        &photons::PASS,
        &photon_sums::PASS,
        &photon_draw::PASS,
        &photon_map::PASS,
        &photon_lookup::PASS,
    ],
    // The map's texels limit it, however many photons there are.
    expected_order: 0.0,
    dials_can_be_chosen: false,
    facts: |quality| MethodFacts {
        conserves_energy: false,
        // It follows photons, and counts them.
        keeps_account: true,
        lands_in_view: true,
        own_cells: Some(OwnCells {
            cells: PHOTONS_PER_SIDE.integer(quality),
            dial: PHOTONS_PER_SIDE.name,
        }),
        leaves_out: LeavesOut {
            further_layers: true,
            ..LeavesOut::default()
        },
        ..MethodFacts::new(METHOD.name, Product::PointIrradiance)
    },
    supports: |facts| {
        let sets = &facts.lights.beam_sets;
        if let Some(set) = sets
            .iter()
            .find(|set| !matches!(set.source, Source::Sun { .. }))
        {
            return Err(format!(
                "its view from the light is orthographic, along the rays of a sun, and light {} is a point light",
                set.light_index
            ));
        }
        if sets.len() > MOST_SETS {
            return Err(format!(
                "it keeps a view for each of at most {MOST_SETS} beam sets, and the scene has {}",
                sets.len()
            ));
        }
        Ok(())
    },
    conformance: Conformance {
        // The paper's own setting, about one photon for two texels.
        sine_pool_error_at_256: 0.7,
        skips: &[],
    },
};
