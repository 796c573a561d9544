//! The float64 truth on the CPU: the light on floors, objects and what a camera sees, by counting plain rays, and in closed form.
//!
//! Nothing here is a port of a shader. The renderer carries flux in beams with exact coverage on a water grid; the reference
//! refracts single rays and counts where they land. Both read the same scene, `physics` and `waves`; nothing else is shared.
//!
//! - `truth`: one entry for every kind of output, and what it answers; `disk` keeps the answers;
//! - `settings`: how long to count, and why a scene cannot be counted;
//! - `checks`: figures that can be counted with, and the lights that count;
//! - `place`: a scene in local coordinates, and where a ray meets the water; `sky`, its skies;
//! - `window`: the piece of water that can light a map;
//! - `lattice`: where the rays start; `slanted`: the same in cells that fit a tilted receiver; `rings`: the same around the foot of a
//!   point light; `strata`: the one or the other;
//! - `light`: a light in its place, and its ray through a place of the water;
//! - `refract`: many rays at once through the surface;
//! - `occluders`: the triangles a ray meets;
//! - floor maps: `floor`, the texels rays are counted in; `tally`, what a batch of rays brought, term by term; `trace`, one sun,
//!   one lattice, all rays; `lamp`, the same for a point light; `map`, rounds of ever finer lattices until the map is good enough;
//! - maps on objects: `texels`, where the map's texels lie; `object_rays`, the rays of one light that may strike an object;
//!   `object_map`, where they do;
//! - views: `camera`, the points that pixels show; `patch`, the light through the water on one of them, searched from there; `shine`,
//!   that of a point light under water, straight; `view`, all of them;
//! - `shadow_edge`: which values lie near the edge of a shadow;
//! - `closed_form` and `paraboloid`: scenes with a formula instead of rays.
//!
//! Model: suns are points at infinity; what a point light under water sends up to the surface ends there; waves do not shade each
//! other and light that a surface reflects is not followed; objects stop light under the water only, not on its way to the water;
//! light that is refracted upwards is lost.

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
pub use window::{LightWindow, light_window};
