//! The variance of each wave of a sea: the directional spectrum, integrated over the wave's cell of wave vectors.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::physics::constants::GRAVITY_M_PER_S2;
use crate::physics::dispersion;
use crate::physics::sea::{self, Elfouhaily, FrequencySpectrum};
use crate::physics::spreading::{self, Spread};
use crate::physics::turns::sin_cos_turns;
use crate::scene::{Dispersion, Scene, SpectrumModel, SpectrumWaves, Spreading};

/// Points of the midpoint rule per distance from the origin: a cell at the distance r, in cells, has (48/r)² of them, so that they lie
/// 2 % of the wave number apart everywhere. The peak of JONSWAP is 14 % wide.
const POINTS: f64 = 48.0;

/// Most points along a side of a cell.
const MOST_POINTS: f64 = 24.0;

/// The directional spectrum of a sea.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    model: Model,
    spreading: Spreading,
    swell: f64,
    /// Direction of the wind.
    wind: DVec2,
    depth_m: f64,
    /// Frequency and phase speed of the waves at the peak.
    peak_rad_per_s: f64,
    peak_speed_m_per_s: f64,
    /// Wind speed over the phase speed at the peak.
    inverse_age: f64,
    friction_velocity_m_per_s: f64,
}

#[derive(Clone, Copy, Debug)]
enum Model {
    Frequency(FrequencySpectrum),
    /// A frequency spectrum, reduced for the depth.
    Shallow(FrequencySpectrum),
    Phillips {
        wind_m_per_s: f64,
    },
    Elfouhaily(Elfouhaily),
}

impl Spectrum {
    /// `None` without wind.
    pub(super) fn of(waves: &SpectrumWaves, scene: &Scene) -> Option<Self> {
        let wind_m_per_s = waves.wind_speed_m_s;
        if wind_m_per_s <= 0.0 {
            return None;
        }
        let jonswap = || FrequencySpectrum::jonswap(wind_m_per_s, waves.fetch_m, waves.gamma);
        let model = match waves.model {
            SpectrumModel::Phillips => Model::Phillips { wind_m_per_s },
            SpectrumModel::PiersonMoskowitz => {
                Model::Frequency(FrequencySpectrum::pierson_moskowitz(wind_m_per_s))
            }
            SpectrumModel::Jonswap => Model::Frequency(jonswap()),
            SpectrumModel::Tma => Model::Shallow(jonswap()),
            SpectrumModel::Elfouhaily => {
                Model::Elfouhaily(Elfouhaily::of(wind_m_per_s, waves.fetch_m))
            }
        };
        let deep = |peak: f64| (peak, GRAVITY_M_PER_S2 / peak);
        let (peak_rad_per_s, peak_speed_m_per_s) = match model {
            Model::Frequency(spectrum) | Model::Shallow(spectrum) => {
                deep(spectrum.peak_rad_per_s())
            }
            Model::Phillips { wind_m_per_s } => deep(sea::phillips_peak(wind_m_per_s)),
            Model::Elfouhaily(spectrum) => {
                (spectrum.peak_rad_per_s(), spectrum.peak_speed_m_per_s())
            }
        };
        let default = match waves.model {
            SpectrumModel::Elfouhaily => Spreading::Elfouhaily,
            _ => Spreading::Cos2,
        };
        let (sin, cos) = sin_cos_turns(waves.wind_direction_deg / 360.0);
        Some(Self {
            model,
            spreading: waves.spreading.unwrap_or(default),
            swell: waves.swell,
            wind: DVec2::new(cos, sin),
            depth_m: match (scene.water.dispersion, &scene.floor) {
                (Dispersion::FiniteDepth, Some(floor)) => floor.depth_m,
                _ => f64::INFINITY,
            },
            peak_rad_per_s,
            peak_speed_m_per_s,
            inverse_age: wind_m_per_s / peak_speed_m_per_s,
            friction_velocity_m_per_s: sea::friction_velocity(wind_m_per_s),
        })
    }

    /// Frequency of the waves of wave number `k_per_m`, Hz.
    pub(super) fn frequency_hz(&self, k_per_m: f64) -> f64 {
        dispersion::with_surface_tension(k_per_m, self.depth_m).0 / TAU
    }

    /// Variances, m², of the waves with the wave vectors (i, j) · `step_per_m` and −(i, j) · `step_per_m`; (i, j) is not (0, 0).
    pub(super) fn variances_m2(&self, i: i32, j: i32, step_per_m: f64) -> [f64; 2] {
        let centre = DVec2::new(f64::from(i), f64::from(j));
        let count = (POINTS / centre.length()).ceil().clamp(1.0, MOST_POINTS) as u32;
        let offset = |index: u32| (f64::from(index) + 0.5) / f64::from(count) - 0.5;
        let mut sums = [0.0; 2];
        for row in 0..count {
            for column in 0..count {
                let place = centre + DVec2::new(offset(column), offset(row));
                let length = place.length();
                let (level, spread) = self.at(length * step_per_m);
                if level > 0.0 && level.is_finite() {
                    let cos = place.dot(self.wind) / length;
                    sums[0] += level * spread.density(cos);
                    sums[1] += level * spread.density(-cos);
                }
            }
        }
        let area = (step_per_m / f64::from(count)).powi(2);
        let [along, against] = sums.map(|sum| sum * area);
        if self.spreading != Spreading::Cos2 {
            return [along, against];
        }
        // No waves against the wind: a cell across the border gives all to the wave that runs with the wind.
        let downwind = centre.dot(self.wind);
        if downwind > 0.0 || (downwind == 0.0 && (j, i) > (0, 0)) {
            [along + against, 0.0]
        } else {
            [0.0, along + against]
        }
    }

    /// Variance per area of wave vectors, m⁴, at the wave number `k_per_m`, of all directions together as if they were 1 rad, and how it
    /// spreads over directions.
    fn at(&self, k_per_m: f64) -> (f64, Spread) {
        let (omega, group_speed) = dispersion::with_surface_tension(k_per_m, self.depth_m);
        let per_wave_number = match self.model {
            Model::Frequency(spectrum) => spectrum.at(omega) * group_speed,
            Model::Shallow(spectrum) => {
                let factor = if self.depth_m.is_finite() {
                    sea::depth_factor(k_per_m * self.depth_m)
                } else {
                    1.0
                };
                spectrum.at(omega) * group_speed * factor
            }
            Model::Phillips { wind_m_per_s } => sea::phillips(k_per_m, wind_m_per_s),
            Model::Elfouhaily(spectrum) => spectrum.at(k_per_m),
        };
        let ratio = omega / self.peak_rad_per_s;
        let spread = match self.spreading {
            Spreading::Cos2 => Spread::cos2(ratio, self.swell),
            Spreading::Hasselmann => Spread::hasselmann(ratio, self.inverse_age, self.swell),
            Spreading::DonelanBanner => Spread::donelan_banner(ratio, self.swell),
            Spreading::Elfouhaily => {
                let delta = spreading::elfouhaily_delta(
                    sea::phase_speed(k_per_m),
                    self.peak_speed_m_per_s,
                    self.friction_velocity_m_per_s,
                );
                Spread::elfouhaily(delta, ratio, self.swell)
            }
        };
        (per_wave_number / k_per_m, spread)
    }
}
