//! Formulas of light and water in f64: one function each, with equation, source, units and domain.
//!
//! Depends on no other module of ours. `shaders/lib/` holds the same functions in f32 under the same names; `registry` lists each
//! pair with domain and tolerance, and a test fails if either half is missing.
//!
//! To add a formula: write it here and in `shaders/lib/`, add a row to [`registry::TWINS`]; the tests do the rest.

pub mod attenuation;
pub mod constants;
pub mod coverage;
pub mod dispersion;
pub mod fresnel;
pub mod interpolated_flux;
pub mod octahedral;
pub mod oscillator;
pub mod refraction;
pub mod registry;
pub mod sea;
pub mod sky;
pub mod slicing;
pub mod solid_angle;
pub mod spreading;
pub mod turns;
