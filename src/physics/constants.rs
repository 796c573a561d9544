//! Constants of nature, with their source.

/// Standard acceleration of gravity, m/s² (CGPM 1901).
pub const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// Transmittance of flat water (ior 1.333) for light from a uniform sky, flux-weighted over the hemisphere; see
/// [`super::fresnel::diffuse_transmittance`], which computes it for any ior.
pub const SKY_INTEGRATION_STEPS: u32 = 4096;
