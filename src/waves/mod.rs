//! Wave models: from a scene's wave components to height and slope at a point and moment.
//!
//! Phases are kept in turns and reduced in f64, so t = 10⁶ s is as good as t = 0, and a surface can be re-centred anywhere
//! before its figures become f32.

use glam::{DVec2, DVec3};

use crate::physics::{dispersion, refraction, turns::sin_cos_turns};
use crate::scene::{Dispersion, Scene, Wave};

/// One sine at one moment: h = A sin(2π (x·f_x + z·f_z + p)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineComponent {
    /// A, m.
    pub amplitude_m: f64,
    /// Spatial frequency along x and z, turns per metre.
    pub frequency_per_m: DVec2,
    /// Phase at the origin, turns, in −½ … ½.
    pub phase_turns: f64,
}

/// Height and slope of the water at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// y − level, m.
    pub height_m: f64,
    /// (∂h/∂x, ∂h/∂z).
    pub slope: DVec2,
}

/// The water surface at one moment, heights relative to the water at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterSurface {
    /// The components, added up.
    pub components: Vec<SineComponent>,
}

impl WaterSurface {
    /// The surface of `scene` at `scene.time_s`.
    pub fn of(scene: &Scene) -> Self {
        let depth_m = match (scene.water.dispersion, &scene.floor) {
            (Dispersion::FiniteDepth, Some(floor)) => floor.depth_m,
            _ => f64::INFINITY,
        };
        let components = scene
            .water
            .waves
            .iter()
            .map(|Wave::Sine(wave)| {
                let k_per_m = std::f64::consts::TAU / wave.wavelength_m;
                let turns_per_s = match wave.period_s {
                    Some(period_s) => 1.0 / period_s,
                    None => dispersion::angular_frequency(k_per_m, depth_m) / std::f64::consts::TAU,
                };
                let (sin_d, cos_d) = sin_cos_turns(wave.direction_deg / 360.0);
                SineComponent {
                    amplitude_m: wave.amplitude_m,
                    frequency_per_m: DVec2::new(cos_d, sin_d) / wave.wavelength_m,
                    phase_turns: reduce_turns(
                        reduce_turns(wave.phase_deg / 360.0)
                            - reduce_turns(turns_per_s * scene.time_s),
                    ),
                }
            })
            .collect();
        Self { components }
    }

    /// Height and slope at (x, z), m.
    pub fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        let mut height_m = 0.0;
        let mut slope = DVec2::ZERO;
        for c in &self.components {
            let (sin, cos) = sin_cos_turns(
                x_m * c.frequency_per_m.x + z_m * c.frequency_per_m.y + c.phase_turns,
            );
            height_m += c.amplitude_m * sin;
            slope += c.frequency_per_m * (std::f64::consts::TAU * c.amplitude_m * cos);
        }
        SurfacePoint { height_m, slope }
    }

    /// The same surface with (x, z) = (0, 0) moved to `origin_m`.
    pub fn recentred(&self, origin_m: DVec2) -> Self {
        let components = self
            .components
            .iter()
            .map(|c| SineComponent {
                phase_turns: reduce_turns(
                    c.phase_turns
                        + reduce_turns(origin_m.x * c.frequency_per_m.x)
                        + reduce_turns(origin_m.y * c.frequency_per_m.y),
                ),
                ..*c
            })
            .collect();
        Self { components }
    }

    /// Whether the bounds of heights and slopes and the shortest wave depend on time.
    pub fn bounds_change_with_time(&self) -> bool {
        // Sines: their phases do, their amplitudes and wavelengths do not.
        false
    }

    /// Largest |height| that the components can add up to, m.
    pub fn max_height_m(&self) -> f64 {
        self.components.iter().map(|c| c.amplitude_m).sum()
    }

    /// Largest slope that the components can add up to along the horizontal unit vector `u`.
    pub fn max_slope_along(&self, u: DVec2) -> f64 {
        self.components
            .iter()
            .map(|c| std::f64::consts::TAU * c.amplitude_m * c.frequency_per_m.dot(u).abs())
            .sum()
    }

    /// Largest steepness in any direction (an upper bound).
    pub fn max_slope(&self) -> f64 {
        self.components
            .iter()
            .map(|c| std::f64::consts::TAU * c.amplitude_m * c.frequency_per_m.length())
            .sum()
    }

    /// Length of the shortest wave, m; infinite for flat water.
    pub fn shortest_wave_m(&self) -> f64 {
        self.components
            .iter()
            .filter(|c| c.amplitude_m > 0.0)
            .map(|c| 1.0 / c.frequency_per_m.length())
            .fold(f64::INFINITY, f64::min)
    }

    /// Slopes on the rim of all that the components can add up to, seen along `directions` evenly spaced directions: where the
    /// extreme tilts are. Empty for flat water.
    pub fn rim_slopes(&self, directions: u32) -> Vec<DVec2> {
        if self.max_slope() == 0.0 {
            return Vec::new();
        }
        (0..directions)
            .map(|i| {
                let u =
                    DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / f64::from(directions));
                self.components
                    .iter()
                    .map(|c| {
                        let gradient = c.frequency_per_m * (std::f64::consts::TAU * c.amplitude_m);
                        gradient * gradient.dot(u).signum()
                    })
                    .sum()
            })
            .collect()
    }
}

/// Unit normal (up) at a surface point.
pub fn normal(point: SurfacePoint) -> DVec3 {
    refraction::normal_from_slope(point.slope.x, point.slope.y)
}

fn reduce_turns(turns: f64) -> f64 {
    turns - turns.round()
}
