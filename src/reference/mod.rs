//! The float64 truth on the CPU: the light on floors, on objects and in camera views, by counting plain rays, and in closed form.
//!
//! Nothing here is a port of a shader. The renderer carries flux in beams with exact coverage on a water grid; the reference
//! refracts single rays and counts where they land. Both read the same scene, `physics` and `waves`; nothing else is shared.
//!
//! - `truth`: the entry point for all kinds of output, and its result; `disk` keeps results;
//! - `settings`: when to stop, and why a scene cannot be traced;
//! - `checks`: checks of the scene's values, and the lights that are traced;
//! - `place`: a scene in local coordinates, and where a ray meets the water; `sky`, its skies;
//! - `window`: the rectangle of water that can light a map;
//! - `lattice`: where the rays start; `slanted`: a lattice with cells that fit a tilted receiver; `rings`: a lattice around the foot of a
//!   point light; `strata`: either of these two;
//! - `light`: a light in local coordinates, and its ray through a place on the water;
//! - `refract`: many rays at once through the surface;
//! - `occluders`: the triangles that a ray hits;
//! - floor maps: `floor`, the map's texels; `tally`, sums over a batch of rays, term by term; `trace`, all rays of one sun and one lattice;
//!   `lamp`, the same for a point light; `map`, rounds of finer and finer lattices until the error is small enough;
//! - maps on objects: `texels`, where the map's texels lie; `object_rays`, the rays of one light that may hit an object;
//!   `object_map`, where they hit it;
//! - views: `camera`, the points that pixels show, and all ways of their rays; `patch`, the light through the water on one of them, searched from that point; `shine`,
//!   the direct light of a point light under water; `view`, all points;
//! - `shadow_edge`: which values lie near the edge of a shadow;
//! - `closed_form` and `paraboloid`: exact formulas for simple scenes.
//!
//! Model: suns are points at infinity. Light that a point light under water sends up ends at the surface. Waves do not shade each
//! other. Reflected light is not followed. Objects block light under the water only, not above it. Light that is refracted upwards is
//! lost.

mod camera;
mod checks;
pub mod closed_form;
mod disk;
mod floor;
mod lamp;
mod lattice;
mod light;
mod map;
mod object_map;
mod object_rays;
mod occluders;
mod paraboloid;
mod patch;
mod place;
mod refract;
mod rings;
mod settings;
mod shadow_edge;
mod shine;
mod sky;
mod slanted;
mod strata;
mod tally;
mod texels;
mod trace;
mod truth;
mod view;
mod window;

pub use map::{EnergyTerms, ReferenceMap, irradiance_map};
pub use settings::{ReferenceError, ReferenceSettings, TruthSettings};
pub use shadow_edge::shadow_edge;
pub use truth::{Truth, TruthKind, truth};
pub use view::{RadianceTruth, radiance};
pub use window::{LightWindow, light_window};

/// How much finer the grids of seas and basins are than the renderer's. What is left of their error in a map, up to 1.5·10⁻⁴, is a tenth of
/// the statistical error at which references stop by default. See [`crate::waves::Surface::refined`].
const REFINEMENT: u32 = 4;
