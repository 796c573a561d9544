//! Water as a sum of sines.
//!
//! Phases are stored in turns and reduced in f64, so t = 10⁶ s is as accurate as t = 0, and a surface can be re-centred anywhere
//! before its values become f32.

use std::f64::consts::TAU;

use glam::DVec2;

use super::row::{Lanes, ROW_POINTS, RowPoints};
use super::surface::{Curvature, SurfacePoint};
use crate::physics::{dispersion, turns::sin_cos_turns};
use crate::scene::{Dispersion, Scene, Wave};

/// One sine at one time: h = A sin(2π (x·f_x + z·f_z + p)).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sine {
    /// A, m.
    amplitude_m: f64,
    /// Spatial frequency along x and z, turns per metre.
    frequency_per_m: DVec2,
    /// Phase at the origin, turns, in −½ … ½.
    phase_turns: f64,
}

/// Spatial frequency, turns per metre, and phase at the origin, turns, at `scene.time_s`, of a wave that runs without changing its shape.
/// Without a period it has that of the dispersion relation.
pub(super) fn running(
    scene: &Scene,
    wavelength_m: f64,
    direction_deg: f64,
    phase_deg: f64,
    period_s: Option<f64>,
) -> (DVec2, f64) {
    let depth_m = match (scene.water.dispersion, &scene.floor) {
        (Dispersion::FiniteDepth, Some(floor)) => floor.depth_m,
        _ => f64::INFINITY,
    };
    let k_per_m = TAU / wavelength_m;
    let turns_per_s = match period_s {
        Some(period_s) => 1.0 / period_s,
        None => dispersion::angular_frequency(k_per_m, depth_m) / TAU,
    };
    let (sin_d, cos_d) = sin_cos_turns(direction_deg / 360.0);
    let phase_turns =
        reduce_turns(reduce_turns(phase_deg / 360.0) - reduce_turns(turns_per_s * scene.time_s));
    (DVec2::new(cos_d, sin_d) / wavelength_m, phase_turns)
}

/// A sum of sines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sines {
    components: Vec<Sine>,
}

impl Sines {
    /// The waves of `scene` at `scene.time_s`.
    pub(super) fn of(scene: &Scene) -> Self {
        let waves = scene.water.waves.iter().filter_map(|wave| match wave {
            Wave::Sine(wave) => Some(wave),
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
                Sine {
                    amplitude_m: wave.amplitude_m,
                    frequency_per_m,
                    phase_turns,
                }
            })
            .collect();
        Self { components }
    }

    /// See [`super::Surface::at`].
    pub(super) fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        let mut height_m = 0.0;
        let mut slope = DVec2::ZERO;
        for c in &self.components {
            let (sin, cos) = sin_cos_turns(
                x_m * c.frequency_per_m.x + z_m * c.frequency_per_m.y + c.phase_turns,
            );
            height_m += c.amplitude_m * sin;
            slope += c.frequency_per_m * (TAU * c.amplitude_m * cos);
        }
        SurfacePoint { height_m, slope }
    }

    /// See [`super::Surface::curved_at`].
    pub(super) fn curved_at(&self, x_m: f64, z_m: f64) -> (SurfacePoint, Curvature) {
        let (mut height_m, mut slope) = (0.0, DVec2::ZERO);
        let (mut xx, mut xz, mut zz) = (0.0, 0.0, 0.0);
        for c in &self.components {
            let (sin, cos) = sin_cos_turns(
                x_m * c.frequency_per_m.x + z_m * c.frequency_per_m.y + c.phase_turns,
            );
            let k = c.frequency_per_m * TAU;
            let high_m = c.amplitude_m * sin;
            height_m += high_m;
            slope += k * (c.amplitude_m * cos);
            xx -= high_m * k.x * k.x;
            xz -= high_m * k.x * k.y;
            zz -= high_m * k.y * k.y;
        }
        let curvature = Curvature {
            xx_per_m: xx,
            xz_per_m: xz,
            zz_per_m: zz,
        };
        (SurfacePoint { height_m, slope }, curvature)
    }

    /// See [`super::Surface::recentred`].
    pub(super) fn recentred(&self, origin_m: DVec2) -> Self {
        let components = self
            .components
            .iter()
            .map(|c| Sine {
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

    /// See [`super::Surface::max_height_m`].
    pub(super) fn max_height_m(&self) -> f64 {
        self.components.iter().map(|c| c.amplitude_m).sum()
    }

    /// See [`super::Surface::max_slope_along`].
    pub(super) fn max_slope_along(&self, u: DVec2) -> f64 {
        self.components
            .iter()
            .map(|c| TAU * c.amplitude_m * c.frequency_per_m.dot(u).abs())
            .sum()
    }

    /// See [`super::Surface::max_slope`].
    pub(super) fn max_slope(&self) -> f64 {
        self.components
            .iter()
            .map(|c| TAU * c.amplitude_m * c.frequency_per_m.length())
            .sum()
    }

    /// Upper bound of the derivative of this order along any direction, 1/m^(order − 1): Σ A k^order.
    pub(super) fn max_derivative(&self, order: i32) -> f64 {
        self.components
            .iter()
            .map(|c| c.amplitude_m * (TAU * c.frequency_per_m.length()).powi(order))
            .sum()
    }

    /// See [`super::Surface::shortest_wave_m`].
    pub(super) fn shortest_wave_m(&self) -> f64 {
        self.components
            .iter()
            .filter(|c| c.amplitude_m > 0.0)
            .map(|c| 1.0 / c.frequency_per_m.length())
            .fold(f64::INFINITY, f64::min)
    }

    /// The slope that is largest along the unit vector `u`, among those that the components can add up to.
    pub(super) fn rim_slope(&self, u: DVec2) -> DVec2 {
        self.components
            .iter()
            .map(|c| {
                let gradient = c.frequency_per_m * (TAU * c.amplitude_m);
                gradient * gradient.dot(u).signum()
            })
            .sum()
    }

    /// See [`super::Surface::rows`].
    pub(super) fn rows(&self, step_m: DVec2) -> SineRows {
        let tables = self.components.iter();
        SineRows {
            tables: tables.map(|c| StepTable::of(c, step_m)).collect(),
        }
    }

    /// Number of sines.
    pub(super) fn count(&self) -> usize {
        self.components.len()
    }

    /// Amplitude m, frequency turns/m, phase turns of each.
    pub(super) fn gpu_elements(&self) -> impl Iterator<Item = [f32; 4]> {
        self.components.iter().map(|c| {
            [
                c.amplitude_m as f32,
                c.frequency_per_m.x as f32,
                c.frequency_per_m.y as f32,
                c.phase_turns as f32,
            ]
        })
    }
}

/// One sine along a row: sin and cos of 0, 1, 2 … steps.
#[derive(Clone, Debug)]
struct StepTable {
    sine: Sine,
    /// 2π A f, the slope's amplitude.
    gradient: DVec2,
    sin: Lanes,
    cos: Lanes,
}

impl StepTable {
    fn of(sine: &Sine, step_m: DVec2) -> Self {
        let step_turns = sine.frequency_per_m.dot(step_m);
        let mut table = Self {
            sine: *sine,
            gradient: sine.frequency_per_m * (TAU * sine.amplitude_m),
            sin: [0.0; ROW_POINTS],
            cos: [0.0; ROW_POINTS],
        };
        for (i, (sin, cos)) in table.sin.iter_mut().zip(&mut table.cos).enumerate() {
            (*sin, *cos) = sin_cos_turns(step_turns * i as f64);
        }
        table
    }
}

/// The sines along rows with a fixed step.
#[derive(Clone, Debug)]
pub(super) struct SineRows {
    tables: Vec<StepTable>,
}

impl SineRows {
    /// Adds to `points`. Computes sin(α + iδ) from the sine and cosine of α, which are exact in every block, and those of iδ, which are in the
    /// table.
    pub(super) fn evaluate(&self, start_m: DVec2, points: &mut RowPoints) {
        for table in &self.tables {
            let Sine {
                amplitude_m,
                frequency_per_m,
                phase_turns,
            } = table.sine;
            let (sin, cos) = sin_cos_turns(start_m.dot(frequency_per_m) + phase_turns);
            let (high_s, high_c) = (amplitude_m * sin, amplitude_m * cos);
            let (gx, gz) = (table.gradient.x, table.gradient.y);
            for i in 0..ROW_POINTS {
                let (s, c) = (table.sin[i], table.cos[i]);
                let cosine = cos * c - sin * s;
                points.height_m[i] += high_s * c + high_c * s;
                points.slope_x[i] += gx * cosine;
                points.slope_z[i] += gz * cosine;
            }
        }
    }
}

pub(super) fn reduce_turns(turns: f64) -> f64 {
    turns - turns.round()
}
