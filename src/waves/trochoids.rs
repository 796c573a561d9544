//! Gerstner waves: a sum of trochoids.
//!
//! A trochoid is given by x = (α − s sin α)/k, h = A cos α + ½ s A. The first is Kepler's equation with the eccentricity s.

use std::f64::consts::TAU;

use glam::DVec2;

use super::sines::{reduce_turns, running};
use super::surface::{Curvature, SurfacePoint};
use crate::scene::{Scene, Wave};

/// Newton steps for Kepler's equation in f64; up to a steepness of 0.95 six are exact to rounding.
const STEPS: usize = 8;

/// One trochoid at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Trochoid {
    /// A, m.
    amplitude_m: f64,
    /// s, 0 … 0.95.
    steepness: f64,
    /// Spatial frequency along x and z, turns per metre.
    frequency_per_m: DVec2,
    /// Phase at the origin, turns, in −½ … ½.
    phase_turns: f64,
}

/// Height and its first two derivatives by the phase angle.
struct Profile {
    height_m: f64,
    first_m: f64,
    second_m: f64,
}

impl Trochoid {
    fn profile(&self, turns: f64) -> Profile {
        let (s, amplitude_m) = (self.steepness, self.amplitude_m);
        let angle = TAU * reduce_turns(turns);
        // Danby's first guess.
        let mut alpha = angle + 0.85 * s * if angle < 0.0 { -1.0 } else { 1.0 };
        for _ in 0..STEPS {
            alpha -= (alpha - s * alpha.sin() - angle) / (1.0 - s * alpha.cos());
        }
        let (sin, cos) = alpha.sin_cos();
        let rate = 1.0 - s * cos;
        Profile {
            height_m: amplitude_m * (cos + 0.5 * s),
            first_m: -amplitude_m * sin / rate,
            second_m: -amplitude_m * (cos - s) / rate.powi(3),
        }
    }

    fn turns_at(&self, x_m: f64, z_m: f64) -> f64 {
        x_m * self.frequency_per_m.x + z_m * self.frequency_per_m.y + self.phase_turns
    }

    /// Wave number along x and z, rad/m.
    fn k(&self) -> DVec2 {
        self.frequency_per_m * TAU
    }

    /// Largest slope, along the wave.
    fn max_slope(&self) -> f64 {
        self.amplitude_m * self.k().length() / (1.0 - self.steepness * self.steepness).sqrt()
    }
}

/// A sum of trochoids.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Trochoids {
    components: Vec<Trochoid>,
}

impl Trochoids {
    /// The Gerstner waves of `scene` at `scene.time_s`.
    pub(super) fn of(scene: &Scene) -> Self {
        let waves = scene.water.waves.iter().filter_map(|wave| match wave {
            Wave::Gerstner(wave) => Some(wave),
            _ => None,
        });
        let components = waves
            .map(|wave| {
                let (frequency_per_m, phase_turns) = running(
                    scene,
                    wave.wavelength_m,
                    wave.direction_deg,
                    wave.phase_deg,
                    wave.period_s,
                );
                Trochoid {
                    amplitude_m: wave.amplitude_m,
                    steepness: wave.steepness_used(),
                    frequency_per_m,
                    phase_turns,
                }
            })
            .collect();
        Self { components }
    }

    /// See [`super::Surface::at`].
    pub(super) fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        let mut point = SurfacePoint::FLAT;
        for c in &self.components {
            let profile = c.profile(c.turns_at(x_m, z_m));
            point.height_m += profile.height_m;
            point.slope += c.k() * profile.first_m;
        }
        point
    }

    /// See [`super::Surface::curved_at`].
    pub(super) fn curved_at(&self, x_m: f64, z_m: f64) -> (SurfacePoint, Curvature) {
        let (mut point, mut curvature) = (SurfacePoint::FLAT, Curvature::FLAT);
        for c in &self.components {
            let profile = c.profile(c.turns_at(x_m, z_m));
            let k = c.k();
            point.height_m += profile.height_m;
            point.slope += k * profile.first_m;
            curvature.xx_per_m += profile.second_m * k.x * k.x;
            curvature.xz_per_m += profile.second_m * k.x * k.y;
            curvature.zz_per_m += profile.second_m * k.y * k.y;
        }
        (point, curvature)
    }

    /// See [`super::Surface::recentred`].
    pub(super) fn recentred(&self, origin_m: DVec2) -> Self {
        let moved = |c: &Trochoid| Trochoid {
            phase_turns: reduce_turns(
                c.phase_turns
                    + reduce_turns(origin_m.x * c.frequency_per_m.x)
                    + reduce_turns(origin_m.y * c.frequency_per_m.y),
            ),
            ..*c
        };
        Self {
            components: self.components.iter().map(moved).collect(),
        }
    }

    /// See [`super::Surface::max_height_m`].
    pub(super) fn max_height_m(&self) -> f64 {
        let most = |c: &Trochoid| c.amplitude_m * (1.0 + 0.5 * c.steepness);
        self.components.iter().map(most).sum()
    }

    /// See [`super::Surface::max_slope_along`].
    pub(super) fn max_slope_along(&self, u: DVec2) -> f64 {
        let along =
            |c: &Trochoid| c.max_slope() * c.frequency_per_m.normalize_or_zero().dot(u).abs();
        self.components.iter().map(along).sum()
    }

    /// See [`super::Surface::max_slope`].
    pub(super) fn max_slope(&self) -> f64 {
        self.components.iter().map(Trochoid::max_slope).sum()
    }

    /// See [`super::Surface::max_second_derivative_per_m`]: at the crests.
    pub(super) fn max_second_derivative_per_m(&self) -> f64 {
        let most =
            |c: &Trochoid| c.amplitude_m * c.k().length_squared() / (1.0 - c.steepness).powi(2);
        self.components.iter().map(most).sum()
    }

    /// See [`super::Surface::max_third_derivative_per_m2`].
    pub(super) fn max_third_derivative_per_m2(&self) -> f64 {
        // |h‴| = A |sin α| |1 − 3 s² + 2 s cos α| / (1 − s cos α)⁵, bounded factor by factor: sin α / (1 − s cos α) ≤ 1/√(1 − s²).
        let most = |c: &Trochoid| {
            let s = c.steepness;
            let shape = (1.0 + 3.0 * s * s + 2.0 * s) / (1.0 - s).powi(4) / (1.0 - s * s).sqrt();
            c.amplitude_m * c.k().length().powi(3) * shape
        };
        self.components.iter().map(most).sum()
    }

    /// The length of a sine whose crest is as narrow: the slope goes from its largest to its most negative value within about
    /// (1 − s)^1.5 of the half of a sine's length.
    fn crest_m(c: &Trochoid) -> f64 {
        (1.0 - c.steepness).powf(1.5) / c.frequency_per_m.length()
    }

    /// See [`super::Surface::shortest_wave_m`].
    pub(super) fn shortest_wave_m(&self) -> f64 {
        self.components
            .iter()
            .filter(|c| c.amplitude_m > 0.0)
            .map(Self::crest_m)
            .fold(f64::INFINITY, f64::min)
    }

    /// The slope that is largest along the unit vector `u`, among those that the components can add up to.
    pub(super) fn rim_slope(&self, u: DVec2) -> DVec2 {
        let largest = |c: &Trochoid| {
            let gradient = c.frequency_per_m.normalize_or_zero() * c.max_slope();
            gradient * gradient.dot(u).signum()
        };
        self.components.iter().map(largest).sum()
    }

    /// Number of trochoids.
    pub(super) fn count(&self) -> usize {
        self.components.len()
    }

    /// Two elements each: amplitude m, frequency turns/m, phase turns; steepness.
    pub(super) fn gpu_elements(&self) -> impl Iterator<Item = [f32; 4]> {
        self.components.iter().flat_map(|c| {
            let wave = [
                c.amplitude_m as f32,
                c.frequency_per_m.x as f32,
                c.frequency_per_m.y as f32,
                c.phase_turns as f32,
            ];
            [wave, [c.steepness as f32, 0.0, 0.0, 0.0]]
        })
    }
}
