//! Seas from wave spectra: the sum of many waves with random heights and phases.
//!
//! The waves have the wave vectors 2π/L (i, j) of a tile of side L. The height is Re Σ A e^(i (k·x − ω t)); the real and the imaginary
//! part of A are independent and normal, with the variance that the spectrum has in the wave's cell. Everything but the phases ω t is
//! found once for a sea and kept.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex64;

use super::choppy::Choppy;
use super::clock::{Clock, Unit};
use super::grid::{Computed, Edges};
use super::spectrum::Spectrum;
use super::spline::{self, Spline};
use super::{chance, fourier};
use crate::kept::Key;
use crate::physics::turns::sin_cos_turns;
use crate::scene::{Issue, ResolvedScene, Scene, SceneError, SpectrumModel, SpectrumWaves};

/// Mean squared heights below this, m², are none.
const NO_VARIANCE_M2: f64 = 1e-200;

/// The sea of the scene's wave `index` at `scene.time_s` on its tile, whose first sample is at (0, 0), with `refinement` times
/// `waves.samples` samples along each side.
///
/// # Errors
/// A choppiness with which the surface would fold.
pub(super) fn computed(
    waves: &SpectrumWaves,
    index: usize,
    resolved: &ResolvedScene,
    refinement: u32,
) -> Result<Computed, SceneError> {
    let size = (waves.samples * refinement) as usize;
    let step_m = DVec2::splat(waves.tile_m / size as f64);
    let sea = Sea::kept(waves, resolved);
    let mut shortest_wave_m = waves.band_m()[0];
    let spline = if sea.columns.is_empty() {
        shortest_wave_m = f64::INFINITY;
        let flat = vec![0.0; size * size];
        Spline::of(Edges::Repeats, flat, [size; 2], step_m, DVec2::ZERO)
    } else {
        let moved = sea.at(resolved.scene.time_s);
        // These are no heights but the coefficients of the spline through them.
        let scale = |i: usize| spline::in_coefficients(i as f64 / size as f64);
        let height = fourier::values(&moved, size, scale);
        if waves.choppiness == 0.0 {
            Spline::of(Edges::Repeats, height, [size; 2], step_m, DVec2::ZERO)
        } else {
            let displacement = [0, 1].map(|axis| {
                let along = displaced(&moved, axis, step_m.x);
                fourier::values(&along, size, scale)
            });
            let choppy = Choppy {
                size,
                height,
                displacement,
            };
            let displaced = choppy
                .heights(waves.choppiness)
                .map_err(|most| folds(waves, index, resolved.scene.time_s, most))?;
            // Crests are narrower, as those of a Gerstner wave of this steepness; but what the samples do not carry is not there.
            let narrowed_m = shortest_wave_m * (1.0 - displaced.strain).powf(1.5);
            shortest_wave_m = narrowed_m.max(waves.shortest_carried_m());
            Spline::through(displaced.heights_m, [size; 2], step_m, DVec2::ZERO)
        }
    };
    Ok(Computed {
        spline,
        shortest_wave_m,
        slope_lost: sea.slope_lost,
        description: description(waves.model).to_owned(),
    })
}

/// The displacement along x (0) or z (1), in units of `unit_m`: i k/|k| times the height.
fn displaced(heights: &fourier::HalfSpectrum, axis: usize, unit_m: f64) -> fourier::HalfSpectrum {
    let reach = heights.len() as f64 - 1.0;
    let columns = heights.iter().enumerate();
    columns
        .map(|(i, column)| {
            let coefficients = column.iter().enumerate();
            coefficients
                .map(|(row, coefficient)| {
                    let k = [i as f64, row as f64 - reach];
                    let length = k[0].hypot(k[1]);
                    let share = if length > 0.0 { k[axis] / length } else { 0.0 };
                    Complex64::I * coefficient * (share / unit_m)
                })
                .collect()
        })
        .collect()
}

fn folds(waves: &SpectrumWaves, index: usize, time_s: f64, most: f64) -> SceneError {
    // Rounded down, so that what is named is accepted.
    let most = (most * 1e3).floor() * 1e-3;
    Issue::invalid(
        format!("/water/waves/{index}/choppiness"),
        format!(
            "with a choppiness of {} crests of this sea fold over themselves, or nearly, at {time_s} s",
            waves.choppiness
        ),
        format!(
            "at most {most:.3} at this time; more of it with lower or fewer short waves (`significant_height_m`, `min_wavelength_m`)"
        ),
    )
    .into()
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

/// The waves of a sea.
struct Sea {
    unit: Unit,
    /// For i = 0, 1 … up to the reach; none if no wave has a height.
    columns: Vec<Vec<Pair>>,
    /// See [`Computed::slope_lost`]; for the grid without refinement.
    slope_lost: f64,
}

/// Two waves that run against each other, (i, j) and (−i, −j): the coefficient of e^(i k·x) is `cos` · cos ω t + `sin` · sin ω t.
struct Pair {
    j: i32,
    /// Frequency, in units of the sea.
    units: u64,
    cos: Complex64,
    sin: Complex64,
}

/// The waves with one i of 0 and more, and their opposites.
struct Column {
    pairs: Vec<Pair>,
    /// Mean squared height over tile and time, m².
    variance_m2: f64,
    /// Mean squared slope times (tile side)², and the part of it that the spline carries, m².
    slopes: [f64; 2],
}

impl Sea {
    fn kept(waves: &SpectrumWaves, resolved: &ResolvedScene) -> Arc<Self> {
        let scene = &resolved.scene;
        resolved.kept.get_or(key(waves, scene), || {
            let sea = Spectrum::of(waves, scene).and_then(|spectrum| Self::of(waves, &spectrum));
            let sea = sea.unwrap_or_else(|| Self {
                unit: Unit::of(waves.loop_s),
                columns: Vec::new(),
                slope_lost: 0.0,
            });
            let columns = sea.columns.iter();
            let bytes: usize = columns.map(|pairs| size_of_val(pairs.as_slice())).sum();
            (sea, (bytes + size_of::<Self>()) as u64)
        })
    }

    /// `None` if no wave has a height.
    fn of(waves: &SpectrumWaves, spectrum: &Spectrum) -> Option<Self> {
        let [shortest_m, _] = waves.band_m();
        let unit = Unit::of(waves.loop_s);
        // Waves are longer than two samples, whatever the scene says.
        let most = waves.samples as i32 / 2 - 1;
        let reach = ((waves.tile_m / shortest_m * (1.0 + SLACK)) as i32).clamp(0, most);
        let mut columns: Vec<Column> = (0..=reach)
            .into_par_iter()
            .map(|i| column(waves, spectrum, unit, i, reach))
            .collect();
        let variance_m2: f64 = columns.iter().map(|column| column.variance_m2).sum();
        if variance_m2 < NO_VARIANCE_M2 {
            return None;
        }
        let sum = |part: usize| -> f64 { columns.iter().map(|column| column.slopes[part]).sum() };
        let slope_lost = (1.0 - sum(1) / sum(0)).max(0.0);
        if let Some(height_m) = waves.significant_height_m {
            if height_m == 0.0 {
                return None;
            }
            let scale = height_m / (4.0 * variance_m2.sqrt());
            for pair in columns.iter_mut().flat_map(|column| &mut column.pairs) {
                pair.cos *= scale;
                pair.sin *= scale;
            }
        }
        Some(Self {
            unit,
            columns: columns.into_iter().map(|column| column.pairs).collect(),
            slope_lost,
        })
    }

    /// The coefficients of the waves at `time_s`.
    fn at(&self, time_s: f64) -> fourier::HalfSpectrum {
        let clock = self.unit.clock(time_s);
        let reach = self.columns.len() - 1;
        let columns = self.columns.par_iter().enumerate();
        columns
            .map(|(i, pairs)| {
                let mut coefficients = vec![Complex64::ZERO; 2 * reach + 1];
                for pair in pairs {
                    let j = (reach as i32 + pair.j) as usize;
                    coefficients[j] = pair.at(clock);
                    if i == 0 {
                        coefficients[2 * reach - j] = coefficients[j].conj();
                    }
                }
                coefficients
            })
            .collect()
    }
}

/// Hash of all that a sea depends on.
fn key(waves: &SpectrumWaves, scene: &Scene) -> Key {
    let sources = (
        "waves of a sea",
        waves,
        scene.water.dispersion,
        scene.floor.as_ref().map(|floor| floor.depth_m.to_bits()),
    );
    let text = serde_json::to_vec(&sources).expect("waves always serialise");
    *blake3::hash(&text).as_bytes()
}

impl Pair {
    /// The coefficient of e^(i k·x) at this moment.
    fn at(&self, clock: Clock) -> Complex64 {
        let (sin, cos) = sin_cos_turns(clock.turns(self.units));
        self.cos * cos + self.sin * sin
    }
}

/// Relative excess over the ends of the band that counts as rounding.
const SLACK: f64 = 1e-12;

fn column(waves: &SpectrumWaves, spectrum: &Spectrum, unit: Unit, i: i32, reach: i32) -> Column {
    let [shortest_m, longest_m] = waves.band_m();
    let step_per_m = TAU / waves.tile_m;
    let mut pairs = Vec::new();
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
        let [(along, a), (against, b)] = [(i, j, variances[0]), (-i, -j, variances[1])]
            .map(|(i, j, variance)| amplitude(waves.seed, i, j, variance));
        variance_m2 += a + b;
        let carried = carried_along_x * spline::carried(f64::from(j) / f64::from(waves.samples));
        let slope = (a + b) * distance * distance;
        slopes[0] += slope;
        slopes[1] += slope * carried * carried;
        // ½ (A e^(−iωt) + B* e^(iωt)), where A runs along and B against (i, j).
        let (along, against) = (0.5 * along, 0.5 * against.conj());
        pairs.push(Pair {
            j,
            units: unit.count(spectrum.frequency_hz(distance * step_per_m)),
            cos: along + against,
            sin: Complex64::I * (against - along),
        });
    }
    Column {
        pairs,
        variance_m2,
        slopes,
    }
}

/// A of the wave (i, j) that has `variance_m2` in the mean over all seas, and its variance in this sea. Source of the distribution: Box &
/// Muller, Annals of Mathematical Statistics 29, 1958.
fn amplitude(seed: u32, i: i32, j: i32, variance_m2: f64) -> (Complex64, f64) {
    if variance_m2 == 0.0 {
        return (Complex64::ZERO, 0.0);
    }
    let [size, angle] = chance::pair(seed, i, j);
    let variance_m2 = -variance_m2 * chance::above_zero(size).ln();
    let (sin, cos) = sin_cos_turns(angle.cast_signed() as f64 / 2.0_f64.powi(64));
    let amplitude_m = (2.0 * variance_m2).sqrt();
    (
        Complex64::new(amplitude_m * cos, amplitude_m * sin),
        variance_m2,
    )
}
