//! Seas from wave spectra: the sum of many waves with random heights and phases.
//!
//! The waves have the wave vectors 2π/L (i, j) of a tile of side L. The height is Re Σ A e^(i (k·x − ω t)); the real and the imaginary
//! part of A are independent and normal, with the variance that the spectrum has in the wave's cell.

use std::f64::consts::TAU;

use rayon::prelude::*;
use rustfft::num_complex::Complex64;

use super::clock::Clock;
use super::grid::{Edges, Heights};
use super::spectrum::Spectrum;
use super::{chance, fourier, spline};
use crate::physics::turns::sin_cos_turns;
use crate::scene::{Scene, SpectrumModel, SpectrumWaves};

/// Mean squared heights below this, m², are none.
const NO_VARIANCE_M2: f64 = 1e-200;

/// The sea at `scene.time_s` on its tile, whose first sample is at (0, 0), with `refinement` times `waves.samples` samples along each side.
pub(super) fn heights(waves: &SpectrumWaves, scene: &Scene, refinement: u32) -> Heights {
    let samples = (waves.samples * refinement) as usize;
    let sea = Spectrum::of(waves, scene).and_then(|spectrum| Sea::of(waves, &spectrum, scene));
    let heights_m = match &sea {
        Some(sea) => fourier::values(&sea.coefficients, samples),
        None => vec![0.0; samples * samples],
    };
    Heights {
        edges: Edges::Repeats,
        heights_m,
        size: [samples; 2],
        step_m: glam::DVec2::splat(waves.tile_m / samples as f64),
        corner_m: glam::DVec2::ZERO,
        shortest_wave_m: sea.as_ref().map_or(f64::INFINITY, |_| waves.band_m()[0]),
        slope_lost: sea.map_or(0.0, |sea| sea.slope_lost),
        description: description(waves.model).to_owned(),
    }
}

fn description(model: SpectrumModel) -> &'static str {
    match model {
        SpectrumModel::Phillips => "a Phillips sea",
        SpectrumModel::PiersonMoskowitz => "a Pierson–Moskowitz sea",
        SpectrumModel::Jonswap => "a JONSWAP sea",
        SpectrumModel::Tma => "a TMA sea",
        SpectrumModel::Elfouhaily => "an Elfouhaily sea",
    }
}

/// The waves of a sea at one time.
struct Sea {
    coefficients: fourier::HalfSpectrum,
    /// See [`Heights::slope_lost`]; for the grid without refinement.
    slope_lost: f64,
}

/// The waves with one i of 0 and more, and their opposites.
struct Column {
    /// See [`fourier::HalfSpectrum`].
    coefficients: Vec<Complex64>,
    /// Mean squared height over tile and time, m².
    variance_m2: f64,
    /// Mean squared slope times (tile side)², and the part of it that the spline carries, m².
    slopes: [f64; 2],
}

impl Sea {
    /// `None` if no wave has a height.
    fn of(waves: &SpectrumWaves, spectrum: &Spectrum, scene: &Scene) -> Option<Self> {
        let [shortest_m, _] = waves.band_m();
        let clock = Clock::at(scene.time_s, waves.loop_s);
        // Waves are longer than two samples, whatever the scene says.
        let most = waves.samples as i32 / 2 - 1;
        let reach = ((waves.tile_m / shortest_m * (1.0 + SLACK)) as i32).clamp(0, most);
        let columns: Vec<Column> = (0..=reach)
            .into_par_iter()
            .map(|i| column(waves, spectrum, &clock, i, reach))
            .collect();
        let variance_m2: f64 = columns.iter().map(|column| column.variance_m2).sum();
        if variance_m2 < NO_VARIANCE_M2 {
            return None;
        }
        let sum = |part: usize| -> f64 { columns.iter().map(|column| column.slopes[part]).sum() };
        let slope_lost = (1.0 - sum(1) / sum(0)).max(0.0);
        let mut coefficients: Vec<_> = columns.into_iter().map(|c| c.coefficients).collect();
        if let Some(height_m) = waves.significant_height_m {
            if height_m == 0.0 {
                return None;
            }
            let scale = height_m / (4.0 * variance_m2.sqrt());
            for coefficient in coefficients.iter_mut().flatten() {
                *coefficient *= scale;
            }
        }
        Some(Self {
            coefficients,
            slope_lost,
        })
    }
}

/// Relative excess over the ends of the band that counts as rounding.
const SLACK: f64 = 1e-12;

fn column(waves: &SpectrumWaves, spectrum: &Spectrum, clock: &Clock, i: i32, reach: i32) -> Column {
    let [shortest_m, longest_m] = waves.band_m();
    let step_per_m = TAU / waves.tile_m;
    let mut coefficients = vec![Complex64::ZERO; 2 * reach as usize + 1];
    let mut variance_m2 = 0.0;
    let mut slopes = [0.0; 2];
    let carried_along_x = spline::carried(f64::from(i) / f64::from(waves.samples));
    let first = if i == 0 { 1 } else { -reach };
    for j in first..=reach {
        let distance = f64::from(i).hypot(f64::from(j));
        let length_m = waves.tile_m / distance;
        if length_m < shortest_m * (1.0 - SLACK) || length_m > longest_m * (1.0 + SLACK) {
            continue;
        }
        let variances = spectrum.variances_m2(i, j, step_per_m);
        if variances == [0.0; 2] {
            continue;
        }
        let phase = clock.phase(spectrum.frequency_hz(distance * step_per_m));
        let [(along, a), (against, b)] = [(i, j, variances[0]), (-i, -j, variances[1])]
            .map(|(i, j, variance)| amplitude(waves.seed, i, j, variance, phase));
        variance_m2 += a + b;
        let carried = carried_along_x * spline::carried(f64::from(j) / f64::from(waves.samples));
        let slope = (a + b) * distance * distance;
        slopes[0] += slope;
        slopes[1] += slope * carried * carried;
        coefficients[(reach + j) as usize] = 0.5 * (along + against.conj());
    }
    if i == 0 {
        for j in 1..=reach as usize {
            coefficients[reach as usize - j] = coefficients[reach as usize + j].conj();
        }
    }
    Column {
        coefficients,
        variance_m2,
        slopes,
    }
}

/// A e^(−i ω t) of the wave (i, j) that has `variance_m2` in the mean over all seas, and its variance in this sea; `phase` is ω t in 2⁻⁶⁴
/// turns. Source of the distribution: Box & Muller, Annals of Mathematical Statistics 29, 1958.
fn amplitude(seed: u32, i: i32, j: i32, variance_m2: f64, phase: u64) -> (Complex64, f64) {
    if variance_m2 == 0.0 {
        return (Complex64::ZERO, 0.0);
    }
    let [size, angle] = chance::pair(seed, i, j);
    let variance_m2 = -variance_m2 * chance::above_zero(size).ln();
    let turns = angle.wrapping_sub(phase).cast_signed() as f64 / 2.0_f64.powi(64);
    let (sin, cos) = sin_cos_turns(turns);
    let amplitude_m = (2.0 * variance_m2).sqrt();
    (
        Complex64::new(amplitude_m * cos, amplitude_m * sin),
        variance_m2,
    )
}
