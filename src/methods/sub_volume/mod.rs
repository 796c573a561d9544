//! Sub-volumes (Iwasaki, Dobashi & Nishita 2002, ch. 4 and 5): the illumination volume below each triangle of the water is cut by horizontal
//! sample planes; intensities are computed at the corners of the parts, the sub-volumes, and interpolated within them.
//!
//! The paper draws sub-volumes with a stencil: a back face marks the pixels whose point lies in front of it, and the front face adds its shade
//! where a mark is and the point lies behind it. So a point gets light from the sub-volumes that it lies in. Here each point makes the same
//! test itself, in the triangle in which the horizontal plane through it cuts the volume, and finds its volumes in a hierarchy over the water
//! grid: a camera that looks through waves or at mirror images has no outline of a volume on its screen, and texels of a map have no camera.
//! Both tests select the same points, but for one difference: the paper closes a sub-volume by flat triangles between its corners, here its
//! sides are the surfaces between the straight edges, so that neighbours share them exactly. The paper takes only volumes that meet the
//! bounding box of an object; points in the box reach only those through the hierarchy.
//!
//! Two approximations are the paper's, and each is a dial with a better word as its default:
//!
//! - *Shade* ([`SHADE`]). Gouraud shading of the front face gives a point the intensity of another place, up to a sub-volume nearer to the eye.
//!   It is an artefact of the hardware: light on a surface then depends on where it is seen from, and the error falls only with the first
//!   power of the number of planes. Intensity interpolated at the point itself is simpler here, and its error falls with the second power.
//! - *Intensity* ([`INTENSITY`]). The flux ratio is inversely proportional to a triangle's area. Interpolated linearly between areas of the
//!   ratio r, a sub-volume gives (r + 1/r + 4) / 6 times its flux, without bound where a triangle lies at a focus. Scaled, every sub-volume
//!   gives just its flux, also where it crosses itself: then its area passes through 0 between the planes, and the triangles are turned over.
//!   The paper removes such sub-volumes from its shafts of light (§3.2) and does not mention them for caustics; here they stay, since
//!   otherwise the caustic itself would be dark.
//!
//! The floor is a flat plane and has its own triangles (§4.2), so nothing is interpolated there. Shadows are those of rays, or the paper's
//! shadow maps under flat water ([`SHADOWS`]).
//!
//! Not the paper's: light is turned to a receiver by its own direction (the paper takes that of flat water), and flux is that through the tilted
//! triangle of the water, so that flat water has the closed form.

pub mod flat_water_shadows;
pub mod point_in_sub_volume;

use super::{Conformance, Method};
use crate::facts::method::LeavesOut;
use crate::facts::source::Source;
use crate::facts::{MethodFacts, Product, SceneFacts};
use crate::scene::{Dial, DialKind, DialWord};
use crate::stages::shaders::embed_shaders;
use crate::stages::volume_bounds;

/// How many parts a volume is cut into.
pub static SAMPLE_PLANES: Dial = Dial {
    name: "sample_planes",
    help: "Sample planes that cut the illumination volumes between the water and the deepest receiver. The error on objects falls with them; \
        time does not depend on them, nor does the floor.",
    kind: DialKind::Integer {
        least: 2,
        most: 256,
        default: 20,
    },
};

/// The word of [`SHADE`] for what the paper draws.
pub const FACE: &str = "face";

/// Which place of a sub-volume a point has the intensity of.
pub static SHADE: Dial = Dial {
    name: "shade",
    help: "Which intensity a point in a sub-volume gets.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "point",
                help: "that at the point",
            },
            DialWord {
                name: FACE,
                help: "that of the front face before it, on the straight line to the eye (Iwasaki et al. 2002, §4.3.1); a map is seen from above",
            },
        ],
        default: "point",
    },
};

/// The word of [`INTENSITY`] for the paper's flux ratio.
pub const FLUX_RATIO: &str = "flux_ratio";

/// How bright the corners of a sub-volume are.
pub static INTENSITY: Dial = Dial {
    name: "intensity",
    help: "Intensity at the corners of a sub-volume.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "scaled",
                help: "in the ratio of the flux ratios, such that the sub-volume carries its flux",
            },
            DialWord {
                name: FLUX_RATIO,
                help: "the flux ratio (Iwasaki et al. 2002, §4.1): too bright where areas differ, without bound next to a focus",
            },
        ],
        default: "scaled",
    },
};

/// The word of [`SHADOWS`] for the paper's.
pub const FLAT_WATER: &str = "flat_water";
/// The word of [`SHADOWS`] that leaves them out.
pub const OFF: &str = "off";

/// Whether objects cast shadows, and which.
pub static SHADOWS: Dial = Dial {
    name: "shadows",
    help: "Shadows of objects under water.",
    kind: DialKind::Word {
        words: &[
            DialWord {
                name: "on",
                help: "a ray from the point to where its light enters the water looks for objects",
            },
            DialWord {
                name: FLAT_WATER,
                help: "those under flat water, from shadow maps of level_map_texels along the sun (Iwasaki et al. 2002, §5): as sharp as the \
                    map's grid, and in the wrong place under waves; not for point lights",
            },
            DialWord {
                name: OFF,
                help: "light that an object blocks still reaches what is behind it",
            },
        ],
        default: "on",
    },
};

/// Whether shadows are those of flat water.
fn has_flat_shadows(facts: &SceneFacts) -> bool {
    SHADOWS.word(&facts.quality) == FLAT_WATER
}

/// See the module.
pub static METHOD: Method = Method {
    name: "sub_volume",
    summary: "every point gets the light of the illumination volumes that it lies in, interpolated between horizontal planes that cut them; \
        no lights under water, no shafts of light",
    paper: "Iwasaki, Dobashi & Nishita 2002, ch. 4 and 5, with its shading, intensity and shadows as dials",
    dials: &[&SAMPLE_PLANES, &SHADE, &INTENSITY, &SHADOWS],
    shaders: embed_shaders![
        "methods/sub_volume/flat_water_shadows.wgsl",
        "methods/sub_volume/point_in_sub_volume.wgsl",
    ],
    shared_dials: &["water_cells", "level_map_texels"],
    passes: &[
        &volume_bounds::PASS,
        &flat_water_shadows::PASS,
        &point_in_sub_volume::PASS,
    ],
    // A texel has its mean in the truth, and here the light at one point of it; the difference stays.
    expected_order: 0.0,
    dials_can_be_chosen: false,
    facts: |quality| MethodFacts {
        conserves_energy: false,
        leaves_out: LeavesOut {
            shadows: SHADOWS.word(quality) == OFF,
            waves_in_shadows: SHADOWS.word(quality) == FLAT_WATER,
            ..LeavesOut::default()
        },
        ..MethodFacts::new(METHOD.name, Product::PointIrradiance)
    },
    supports,
    conformance: Conformance {
        sine_pool_error_at_256: 6e-2,
        skips: &[],
    },
};

fn supports(facts: &SceneFacts) -> Result<(), String> {
    volume_bounds::starts_at_the_surface(facts)?;
    let mut sets = facts.lights.beam_sets.iter();
    let other = sets.find(|set| !matches!(set.source, Source::Sun { .. }));
    match other {
        Some(set) if has_flat_shadows(facts) => Err(format!(
            "shadows under flat water are along the rays of a sun, and light {} is a point light; shadows by rays take any light",
            set.light_index
        )),
        _ => Ok(()),
    }
}
