//! Constants of nature, with their source.

/// Standard acceleration of gravity, m/s² (CGPM 1901).
pub const GRAVITY_M_PER_S2: f64 = 9.806_65;

/// Surface tension of water against air at 20 °C, N/m, rounded (IAPWS R1-76(2014): 0.072 75).
pub const SURFACE_TENSION_N_PER_M: f64 = 0.0728;

/// Density of water, kg/m³, rounded.
pub const WATER_DENSITY_KG_PER_M3: f64 = 1000.0;

/// Number of midpoints of the sums over a uniform sky, in [`super::fresnel::diffuse_transmittance`] and
/// [`super::sky::sky_path_factor`]. A choice of ours, not a constant of nature.
pub const SKY_INTEGRATION_STEPS: u32 = 4096;
