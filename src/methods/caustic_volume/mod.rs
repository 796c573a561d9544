//! Caustic volumes (Sandberg & Falemo 2005): the light between three neighbouring refracted rays is a volume, and every point of the picture or
//! map gets the light of all volumes that it lies in.
//!
//! The paper draws the volumes on the screen, because the pixels that a volume may light are then found by drawing it. Here a camera sees
//! the points through the waves or mirrored in them, so a volume has no outline on the screen. Each point finds its volumes instead, in a
//! hierarchy over the water grid. The light at a point is the paper's, and its cost depends neither on the number of receivers nor on the waves
//! on the way to the camera.

pub mod point_in_volume;

use super::{Conformance, Method};
use crate::facts::method::LeavesOut;
use crate::facts::{MethodFacts, Product};
use crate::scene::{Dial, DialKind, DialWord};
use crate::stages::shaders::embed_shaders;
use crate::stages::volume_bounds;

/// The word of [`DENSITY`] for a density that varies within a volume's cut.
pub const LINEAR: &str = "linear";
/// The word of [`SHADOWS`] that leaves them out.
pub const OFF: &str = "off";

/// How the light of a volume varies within its cut.
pub static DENSITY: Dial = Dial {
    name: "density",
    help: "How the light of a volume varies across it.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "constant",
                help: "it is even (Sandberg & Falemo 2005, §3.4)",
            },
            DialWord {
                name: LINEAR,
                help: "it is taken linearly between the corners, where it is the mean over the volumes around them: smooth, with the same \
                    flux in all",
            },
        ],
        default: "constant",
    },
};

/// Whether objects cast shadows.
pub static SHADOWS: Dial = Dial {
    name: "shadows",
    help: "Whether objects cast shadows under water; the paper has none.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "on",
                help: "a ray from the point to where its light enters the water looks for objects",
            },
            DialWord {
                name: OFF,
                help: "light that an object blocks still reaches what is behind it",
            },
        ],
        default: "on",
    },
};

/// See the module.
pub static METHOD: Method = Method {
    name: "caustic_volume",
    summary: "every point gets the light of the volumes between neighbouring refracted rays that it lies in",
    paper: "Sandberg & Falemo 2005, with shadows and a smooth density as dials",
    dials: &[&DENSITY, &SHADOWS],
    shaders: embed_shaders!["methods/caustic_volume/point_in_volume.wgsl"],
    shared_dials: &["water_cells", "level_map_texels"],
    passes: &[&volume_bounds::PASS, &point_in_volume::PASS],
    // A texel has its mean in the truth, and here the light at one point of it; the difference stays. At points the error falls with the cell's
    // size, with a linear density with its square.
    expected_order: 0.0,
    dials_can_be_chosen: false,
    facts: |quality| MethodFacts {
        conserves_energy: false,
        leaves_out: LeavesOut {
            shadows: SHADOWS.word(quality) == OFF,
            ..LeavesOut::default()
        },
        ..MethodFacts::new(METHOD.name, Product::PointIrradiance)
    },
    supports: volume_bounds::starts_at_the_surface,
    conformance: Conformance {
        sine_pool_error_at_256: 6e-2,
        skips: &[],
    },
};
