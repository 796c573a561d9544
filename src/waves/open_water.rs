//! Ripples in a basin with absorbing walls and without obstacles: the solution of open water, which no wave comes back from.
//!
//! A drop's mound is round, and so are its ripples: h(r, t) = H R² ∫ e^(−k²R²/2) a(k, t) J₀(kr) k dk, where a is the swing of waves of
//! wave number k. The integral is taken by Gauss's formula on short panels; along r it is interpolated. Waves shorter than four samples are
//! left out, as in basins that are solved by their modes. Source: Lamb, Hydrodynamics, 6th ed., §255.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::cells::{Cells, falling};
use super::grid::{Edges, Heights};
use super::ripples::{NOTICED_SLOPE, SAMPLES_PER_WAVE, SMALLEST_EXPONENT, description, dispersion};
use crate::physics::oscillator::{Elapsed, Oscillator};
use crate::scene::{RippleDrop, Ripples, Scene};

/// Waves are gone when they have run this many times as far as the farthest sample; they fade on the second half of the way.
const GONE: f64 = 4.0;

/// Points of Gauss's formula on a panel.
const POINTS: usize = 16;

/// Places along r per length of the shortest wave.
const PLACES_PER_WAVE: f64 = 8.0;

/// Wave numbers at which the shortest wave is sought.
const PROBES: u32 = 2048;

/// The basin and the water around it at `scene.time_s`.
pub(super) fn heights(ripples: &Ripples, scene: &Scene, refinement: u32) -> Heights {
    let cells = Cells::of(ripples, refinement);
    let rings = Rings::of(ripples, scene);
    let mut heights_m = vec![0.0; cells.count()];
    if !rings.rings.is_empty() {
        let rows = heights_m.par_chunks_exact_mut(cells.size[0]);
        rows.enumerate().for_each(|(row, heights_m)| {
            let z_m = cells.place_m(1, row);
            for (column, height_m) in heights_m.iter_mut().enumerate() {
                *height_m = rings.at(cells.place_m(0, column), z_m);
            }
        });
    }
    cells.fade(&mut heights_m);
    Heights {
        edges: Edges::Flat,
        heights_m,
        size: cells.size,
        step_m: cells.step_m.into(),
        corner_m: cells.corner_m(),
        slope_lost: slope_lost(ripples),
        shortest_wave_m: rings.shortest_wave_m,
        description: description(ripples),
    }
}

/// See [`super::ripples::slope_lost`]. The mean square slope of a mound with all waves up to k is its whole one times
/// 1 − (1 + k²R²) e^(−k²R²).
pub(super) fn slope_lost(ripples: &Ripples) -> f64 {
    let (mut lost, mut all) = (0.0, 0.0);
    for drop in &ripples.drops {
        let square = drop.height_m * drop.height_m;
        let x = (highest_per_m(ripples) * drop.radius_m).powi(2);
        lost += square * (1.0 + x) * (-x).exp();
        all += square;
    }
    if all > 0.0 { lost / all } else { 0.0 }
}

/// The wave number of four samples, rad/m.
fn highest_per_m(ripples: &Ripples) -> f64 {
    let [x_m, z_m] = ripples.sample_steps_m();
    TAU / (SAMPLES_PER_WAVE as f64 * x_m.max(z_m))
}

/// Length of the shortest wave that is noticed among those of `drops`, each with height, m, and radius, m, up to the wave number
/// `highest_per_m`; infinite if there are none.
pub(super) fn shortest_wave_m(drops: &[[f64; 2]], highest_per_m: f64) -> f64 {
    let slope = |probe: u32| {
        let k = highest_per_m * (f64::from(probe) / f64::from(PROBES));
        let amplitudes = drops.iter().map(|[height_m, radius_m]| {
            height_m.abs() * radius_m * radius_m * (-0.5 * (k * radius_m).powi(2)).exp()
        });
        k * amplitudes.sum::<f64>()
    };
    let slopes: Vec<f64> = (1..=PROBES).map(slope).collect();
    let most = slopes.iter().copied().fold(0.0, f64::max);
    let noticed = |slope: &f64| *slope > 0.0 && *slope >= NOTICED_SLOPE * most;
    match slopes.iter().rposition(noticed) {
        Some(probe) => TAU * f64::from(PROBES) / (highest_per_m * (probe as f64 + 1.0)),
        None => f64::INFINITY,
    }
}

/// The ripples of all drops.
struct Rings {
    rings: Vec<Ring>,
    /// Distance of the places along r, m.
    place_step_m: f64,
    shortest_wave_m: f64,
}

/// The ripples of one drop.
struct Ring {
    middle_m: [f64; 2],
    /// Height, m, and its first two derivatives by r in units of places, at each place.
    profile: Vec<[f64; 3]>,
}

/// A wave number of the integral.
struct Node {
    k_per_m: f64,
    /// By drops: the factor of J₀(kr), m.
    amplitudes_m: Vec<f64>,
}

/// A drop that has fallen.
struct Fallen {
    drop: RippleDrop,
    elapsed: Elapsed,
    /// Distance after which its waves are gone, m.
    gone_m: f64,
}

impl Fallen {
    /// The share of waves with the group speed `speed_m_per_s` that is not gone. Damped waves spread like heat: less far.
    fn left(&self, speed_m_per_s: f64, damping_per_s: f64) -> f64 {
        let elapsed_s = self.elapsed.seconds();
        let run_m = speed_m_per_s * elapsed_s / (1.0 + damping_per_s * elapsed_s).sqrt();
        falling(2.0 * run_m / self.gone_m - 1.0)
    }
}

impl Rings {
    fn of(ripples: &Ripples, scene: &Scene) -> Self {
        let cells = Cells::of(ripples, 1);
        let farthest_m = |drop: &RippleDrop| {
            let [x_m, z_m] = [0, 1].map(|axis| {
                let last_m = cells.place_m(axis, cells.size[axis] - 1);
                let position_m = drop.position_m[axis];
                (position_m - cells.first_m[axis]).max(last_m - position_m)
            });
            x_m.hypot(z_m)
        };
        let fallen: Vec<Fallen> = ripples
            .drops
            .iter()
            .filter(|drop| drop.at_s <= scene.time_s && drop.height_m != 0.0)
            .map(|drop| Fallen {
                drop: *drop,
                elapsed: Elapsed::between(drop.at_s, scene.time_s),
                gone_m: GONE * (farthest_m(drop) + 10.0 * drop.radius_m),
            })
            .collect();
        let reach_m = fallen
            .iter()
            .map(|fallen| farthest_m(&fallen.drop))
            .fold(0.0, f64::max);
        let highest_per_m = highest_per_m(ripples);
        let nodes = nodes(ripples, scene, &fallen, reach_m, highest_per_m);
        let place_step_m = TAU / (highest_per_m * PLACES_PER_WAVE);
        // One place beyond the farthest sample.
        let places = (reach_m / place_step_m) as usize + 3;
        let drops = if nodes.is_empty() { 0 } else { fallen.len() };
        let profiles: Vec<Vec<[f64; 3]>> = (0..places)
            .into_par_iter()
            .map(|place| profile(place as f64 * place_step_m, place_step_m, &nodes, drops))
            .collect();
        let rings = fallen[..drops].iter().enumerate().map(|(i, fallen)| Ring {
            middle_m: fallen.drop.position_m,
            profile: profiles.iter().map(|of_drops| of_drops[i]).collect(),
        });
        let mounds: Vec<[f64; 2]> = fallen[..drops]
            .iter()
            .map(|fallen| [fallen.drop.height_m, fallen.drop.radius_m])
            .collect();
        Self {
            rings: rings.collect(),
            place_step_m,
            shortest_wave_m: shortest_wave_m(&mounds, highest_per_m),
        }
    }

    /// Height at (x, z), m: between places by the polynomial of degree 5 with their heights and derivatives.
    fn at(&self, x_m: f64, z_m: f64) -> f64 {
        let mut sum_m = 0.0;
        for ring in &self.rings {
            let r = (x_m - ring.middle_m[0]).hypot(z_m - ring.middle_m[1]) / self.place_step_m;
            let place = (r as usize).min(ring.profile.len() - 2);
            let t = r - place as f64;
            let ([a, a1, a2], [b, b1, b2]) = (ring.profile[place], ring.profile[place + 1]);
            let rise = b - a - a1 - 0.5 * a2;
            let (slope, bend) = (b1 - a1 - a2, b2 - a2);
            let c3 = 10.0 * rise - 4.0 * slope + 0.5 * bend;
            let c4 = -15.0 * rise + 7.0 * slope - bend;
            let c5 = 6.0 * rise - 3.0 * slope + 0.5 * bend;
            sum_m += a + t * (a1 + t * (0.5 * a2 + t * (c3 + t * (c4 + t * c5))));
        }
        sum_m
    }
}

/// By drops: height and derivatives at the distance `r_m`.
fn profile(r_m: f64, place_step_m: f64, nodes: &[Node], drops: usize) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; drops];
    for node in nodes {
        let k = node.k_per_m;
        let (x, k_step) = (k * r_m, k * place_step_m);
        let (zeroth, first) = (libm::j0(x), libm::j1(x));
        let first_by_x = if x > 0.0 { first / x } else { 0.5 };
        let factors = [
            zeroth,
            -k_step * first,
            -k_step * k_step * (zeroth - first_by_x),
        ];
        for (sums, amplitude_m) in sums.iter_mut().zip(&node.amplitudes_m) {
            for (sum, factor) in sums.iter_mut().zip(factors) {
                *sum += amplitude_m * factor;
            }
        }
    }
    sums
}

/// The wave numbers of the integral that any drop has.
fn nodes(
    ripples: &Ripples,
    scene: &Scene,
    fallen: &[Fallen],
    reach_m: f64,
    highest_per_m: f64,
) -> Vec<Node> {
    let narrowest_m = fallen
        .iter()
        .map(|f| f.drop.radius_m)
        .fold(f64::INFINITY, f64::min);
    let widest_m = fallen.iter().map(|f| f.drop.radius_m).fold(0.0, f64::max);
    let gone_m = fallen.iter().map(|f| f.gone_m).fold(0.0, f64::max);
    let end_per_m = highest_per_m.min((2.0 * SMALLEST_EXPONENT).sqrt() / narrowest_m);
    // No phase of waves that are not gone turns faster along k than this distance; a panel holds two turns. Gaussians are followed too.
    let widest_panel_per_m = (2.0 * TAU / (reach_m + gone_m)).min(1.5 / widest_m);
    // tanh(kd) has poles on the imaginary axis, the nearest at π/(2d).
    let depth_m = scene.floor.as_ref().map(|floor| floor.depth_m);
    let near_zero_per_m = match (ripples.shallow_m_per_s(depth_m), depth_m) {
        (None, Some(depth_m)) => depth_m.recip(),
        _ => f64::INFINITY,
    };
    let (gauss_x, gauss_w) = gauss_legendre();
    let dispersion = dispersion(ripples, scene);
    let damping_per_s = ripples.damping_per_s;
    let mut nodes = Vec::new();
    let mut start_per_m = 0.0;
    while start_per_m < end_per_m && !fallen.is_empty() {
        let width_per_m = widest_panel_per_m.min(near_zero_per_m.max(start_per_m));
        let stop_per_m = (start_per_m + width_per_m).min(end_per_m);
        let half_per_m = 0.5 * (stop_per_m - start_per_m);
        for (x, w) in gauss_x.iter().zip(&gauss_w) {
            let k_per_m = start_per_m + half_per_m * (1.0 + x);
            let (frequency, speed_m_per_s) = dispersion(k_per_m);
            let oscillator = Oscillator::of(frequency, damping_per_s);
            let amplitudes_m: Vec<f64> = fallen
                .iter()
                .map(|f| {
                    let left = f.left(speed_m_per_s, damping_per_s);
                    let scaled = k_per_m * f.drop.radius_m;
                    if left == 0.0 || 0.5 * scaled * scaled > SMALLEST_EXPONENT {
                        return 0.0;
                    }
                    let mound_m = f.drop.height_m * f.drop.radius_m * scaled;
                    let share = (-0.5 * scaled * scaled).exp() * w * half_per_m;
                    mound_m * share * left * oscillator.swing(f.elapsed).amplitude
                })
                .collect();
            if amplitudes_m.iter().any(|amplitude_m| *amplitude_m != 0.0) {
                nodes.push(Node {
                    k_per_m,
                    amplitudes_m,
                });
            }
        }
        start_per_m = stop_per_m;
    }
    nodes
}

/// Points and weights of Gauss's formula on −1 … 1, by Newton's iteration on Legendre's polynomial. Source: Abramowitz and Stegun, 25.4.29.
fn gauss_legendre() -> ([f64; POINTS], [f64; POINTS]) {
    let (mut points, mut weights) = ([0.0; POINTS], [0.0; POINTS]);
    let n = POINTS as f64;
    for i in 0..POINTS {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for degree in 2..=POINTS {
                let d = degree as f64;
                (before, value) = (
                    value,
                    ((2.0 * d - 1.0) * x * value - (d - 1.0) * before) / d,
                );
            }
            slope = n * (before - x * value) / (1.0 - x * x);
            x -= value / slope;
        }
        points[i] = x;
        weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
    }
    (points, weights)
}
