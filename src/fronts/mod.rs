//! Light fields that fronts of light leave in a grid, computed on the CPU: the eikonal equation and the wave equation below a water
//! surface.
//!
//! | file | holds |
//! |---|---|
//! | `grid` | sample points in a box |
//! | `frame` | model coordinates, in which the front moves at speed 1, for finite indices and suns off the zenith |
//! | `front` | the narrow band next to the water: times to the surface itself |
//! | `stencil` | one upwind update, first and second order |
//! | `heap_march` | fast marching with a binary heap |
//! | `sweep` | the parallel solver of the same equations |
//! | `boundary` | the sides of the box |
//! | `curvature` | curvature of the fronts, and the concentration of light that follows |
//! | `crossing` | how much light the first arrival does not show |
//! | `dissipation` | a plane wave simulation below a threshold depth |
//! | `eikonal` | all of the above in one run: water to irradiance |
//! | `fit` | irradiance from field values by a fitted power law |
//! | `wave`, `wave_step`, `wave_band`, `wave_plan` | the wave equation in a thin active band |
//!
//! All vectors are (x, z, depth) in metres; depth grows downwards from the level of the water. The water is a closure from (x, z) to
//! [`Height`], so nothing here knows how waves are made.
//!
//! Source: Mercier, "Eikonal Approximation for Real-Time Height Field Caustics" (Université de Montréal, IFT6042).

mod boundary;
mod crossing;
mod curvature;
mod dissipation;
mod eikonal;
mod error;
mod fit;
mod frame;
mod front;
mod grid;
mod heap_march;
mod stencil;
mod sweep;
mod wave;
mod wave_band;
mod wave_plan;
mod wave_step;

pub use boundary::with_sides;
pub use crossing::lost_shares;
pub use curvature::{Concentration, Curvature, concentration, laplacian_per_m};
pub use dissipation::{Dissipated, Dissipation};
pub use eikonal::{EikonalField, EikonalSettings, Solver};
pub use error::FrontError;
pub use fit::{Distance, Fit, PowerLaw, fit};
pub use frame::Frame;
pub use front::{Column, Front, Height, Start};
pub use grid::{Grid, MOST_CELLS};
pub use heap_march::{Problem, march};
pub use stencil::{Arrivals, Order};
pub use sweep::{SweepReport, polish, sweep};
pub use wave::{WaveReport, Waves};
pub use wave_plan::{Pulse, Sides, Sum, WaveLimits, WavePlan, WaveSettings};
