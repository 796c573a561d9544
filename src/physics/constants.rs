//! Constants of nature, with their source.

/// Standard acceleration of gravity, m/s² (CGPM 1901).
pub const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// Number of midpoints of the sums over a uniform sky, in [`super::fresnel::diffuse_transmittance`] and
/// [`super::sky::sky_path_factor`]. A choice of ours, not a constant of nature.
pub const SKY_INTEGRATION_STEPS: u32 = 4096;
