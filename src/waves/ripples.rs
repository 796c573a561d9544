//! Ripples in basins: by their modes, and the choice between them and the other solutions, `open_water` and `tank`.
//!
//! The modes between reflecting walls are cos(mπx/Lx) cos(nπz/Lz): those of a tile of twice the basin's sides on which the surface is
//! even. A periodic basin is its own tile, and its modes have sines too. A drop's mound, folded at the walls or wrapped, has Gaussian
//! amplitudes; each mode then swings by itself, released at rest. Modes shorter than four samples are left out: the spline through
//! the samples would not follow them. Source: Lamb, Hydrodynamics, 6th ed., §257.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use rayon::prelude::*;

use super::footprint::Footprint;
use super::grid::{Edges, Heights};
use super::harmonics::{Line, Parts};
use super::{open_water, tank};
use crate::kept::Kept;
use crate::physics::dispersion::with_surface_tension;
use crate::physics::oscillator::{Elapsed, Oscillator};
use crate::physics::turns::sin_cos_turns;
use crate::scene::{RippleDrop, Ripples, Scene, Walls};

/// Modes whose Gaussian is below e^−this, 10⁻²⁰, are 0.
pub(super) const SMALLEST_EXPONENT: f64 = 45.0;

/// Samples of the shortest mode.
pub(super) const SAMPLES_PER_WAVE: usize = 4;

/// A wave is noticed if its slope is this share of that of the steepest mode.
pub(super) const NOTICED_SLOPE: f64 = 1e-3;

/// The basin at `scene.time_s` with its mirror images or the water around it, with `refinement` times `ripples.samples` samples along the
/// longer side. The waves are the same for every refinement; `footprint` is that of the obstacles on this grid.
pub(super) fn heights(
    ripples: &Ripples,
    scene: &Scene,
    refinement: u32,
    footprint: Option<&Footprint>,
    kept: &Kept,
) -> Heights {
    match (footprint, ripples.walls) {
        (Some(footprint), _) => tank::heights(ripples, scene, refinement, footprint, kept),
        (None, Walls::Absorbing) => open_water::heights(ripples, scene, refinement),
        (None, Walls::Reflecting | Walls::Periodic) => modal_heights(ripples, scene, refinement),
    }
}

/// What a basin is called in plans.
pub(super) fn description(ripples: &Ripples) -> String {
    let drops = match ripples.drops.len() {
        0 => "without drops".to_owned(),
        1 => "with 1 drop".to_owned(),
        count => format!("with {count} drops"),
    };
    match ripples.obstacles.len() {
        0 => format!("a basin {drops}"),
        1 => format!("a basin {drops} and 1 obstacle"),
        count => format!("a basin {drops} and {count} obstacles"),
    }
}

fn modal_heights(ripples: &Ripples, scene: &Scene, refinement: u32) -> Heights {
    let sides = Side::both(ripples);
    let size = sides.each_ref().map(|side| side.tile_samples(refinement));
    let step_m = DVec2::from_array([0, 1].map(|i| sides[i].tile_m() / size[i] as f64));
    let corner_m = DVec2::from_array(
        [0, 1].map(|i| sides[i].min_m + sides[i].first_sample(size[i]) * sides[i].tile_m()),
    );
    let bursts = Burst::fallen(ripples, scene.time_s, &sides);
    let (heights_m, shortest_wave_m) = if bursts.is_empty() {
        (vec![0.0; size[0] * size[1]], f64::INFINITY)
    } else {
        let lines: [Line; 2] =
            [0, 1].map(|i| Line::of(size[i], sides[i].first_sample(size[i]), sides[i].highest));
        let dispersion = dispersion(ripples, scene);
        let frequency = |k_per_m| dispersion(k_per_m).0;
        let columns: Vec<_> = (0..=sides[0].highest)
            .into_par_iter()
            .map(|m| {
                let modes = modes(m, &sides, &bursts, ripples.damping_per_s, &frequency);
                (lines[1].column(&modes), slopes(m, &sides, &modes))
            })
            .collect();
        let (columns, slopes): (Vec<_>, Vec<_>) = columns.into_iter().unzip();
        (lines[0].rows(&columns), shortest_wave_m(&slopes, &sides))
    };
    Heights {
        edges: Edges::Repeats,
        heights_m,
        size,
        step_m,
        corner_m,
        slope_lost: slope_lost(ripples),
        shortest_wave_m,
        description: description(ripples),
    }
}

/// The share of the mean square slope that the grid does not carry, 0 … 1: that of the modes which are too short for it, of all drops at
/// their moments; 0 if there is no slope. Waves of different drops are taken as independent.
pub fn slope_lost(ripples: &Ripples) -> f64 {
    match (ripples.obstacles.is_empty(), ripples.walls) {
        (false, _) => tank::slope_lost(ripples),
        (true, Walls::Absorbing) => open_water::slope_lost(ripples),
        (true, Walls::Reflecting | Walls::Periodic) => modal_slope_lost(ripples),
    }
}

fn modal_slope_lost(ripples: &Ripples) -> f64 {
    let sides = Side::both(ripples);
    let (mut carried, mut all) = (0.0, 0.0);
    for drop in &ripples.drops {
        let square = |pairs: [Squares; 2]| {
            let [x, z] = pairs;
            drop.height_m * drop.height_m * (x.slope * z.height + x.height * z.slope)
        };
        carried += square([0, 1].map(|i| sides[i].carried_squares(drop, i)));
        all += square([0, 1].map(|i| sides[i].all_squares(drop, i)));
    }
    if all > 0.0 {
        (1.0 - carried / all).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Angular frequency, rad/s, and group speed, m/s, by wave number, rad/m. With a floor at depth 0 both are 0: the mounds stand still.
pub(super) fn dispersion(ripples: &Ripples, scene: &Scene) -> impl Fn(f64) -> (f64, f64) + Sync {
    let depth_m = scene.floor.as_ref().map(|floor| floor.depth_m);
    let shallow_m_per_s = ripples.shallow_m_per_s(depth_m);
    move |k_per_m| match shallow_m_per_s {
        Some(speed_m_per_s) => (k_per_m * speed_m_per_s, speed_m_per_s),
        None => with_surface_tension(k_per_m, depth_m.unwrap_or(f64::INFINITY)),
    }
}

/// Basins along one side of the tile after which the surface repeats.
fn mirrored(walls: Walls) -> usize {
    match walls {
        Walls::Reflecting => 2,
        Walls::Periodic | Walls::Absorbing => 1,
    }
}

/// A side of the basin.
struct Side {
    min_m: f64,
    length_m: f64,
    walls: Walls,
    /// Samples of the grid that is not refined.
    samples: usize,
    /// Number of the highest mode.
    highest: usize,
}

/// Mean squares of a mound's factor along one side, and of its slope.
struct Squares {
    height: f64,
    slope: f64,
}

impl Side {
    /// Along x and z.
    fn both(ripples: &Ripples) -> [Self; 2] {
        let (lengths_m, samples) = (ripples.sides_m(), ripples.side_samples());
        [0, 1].map(|i| {
            let samples = samples[i];
            let mirrored = mirrored(ripples.walls);
            Self {
                min_m: ripples.min_m[i],
                length_m: lengths_m[i],
                walls: ripples.walls,
                samples,
                highest: mirrored * samples / SAMPLES_PER_WAVE,
            }
        })
    }

    /// Length after which the surface repeats, m.
    fn tile_m(&self) -> f64 {
        mirrored(self.walls) as f64 * self.length_m
    }

    /// Samples of the tile.
    fn tile_samples(&self, refinement: u32) -> usize {
        mirrored(self.walls) * self.samples * refinement as usize
    }

    /// Place of the first of `count` samples, as a share of the tile. Between walls samples stand half a step from them.
    fn first_sample(&self, count: usize) -> f64 {
        match self.walls {
            Walls::Reflecting => 0.5 / count as f64,
            Walls::Periodic | Walls::Absorbing => 0.0,
        }
    }

    /// Wave number of a mode, rad/m.
    fn wave_number(&self, mode: usize) -> f64 {
        mode as f64 * (TAU / self.tile_m())
    }

    /// Factor of the mode, cos and sin, of the mound of a drop with `position_m` and `radius_m` along this side.
    fn factor(&self, mode: usize, position_m: f64, radius_m: f64) -> [f64; 2] {
        let one_or_two = if mode == 0 { 1.0 } else { 2.0 };
        let exponent = 0.5 * (self.wave_number(mode) * radius_m).powi(2);
        let amplitude = one_or_two * TAU.sqrt() * (radius_m / self.length_m) * (-exponent).exp();
        let (sin, cos) = sin_cos_turns(mode as f64 * ((position_m - self.min_m) / self.tile_m()));
        match self.walls {
            Walls::Reflecting => [amplitude * cos, 0.0],
            Walls::Periodic | Walls::Absorbing => [amplitude * cos, amplitude * sin],
        }
    }

    /// Mean squares of the modes up to `highest`.
    fn squares_to(&self, highest: usize, position_m: f64, radius_m: f64) -> Squares {
        let mut sums = Squares {
            height: 0.0,
            slope: 0.0,
        };
        for mode in 0..=highest.min(self.reach(radius_m)) {
            let [cos, sin] = self.factor(mode, position_m, radius_m);
            let mean = (cos * cos + sin * sin) * if mode == 0 { 1.0 } else { 0.5 };
            sums.height += mean;
            sums.slope += mean * self.wave_number(mode).powi(2);
        }
        sums
    }

    /// Mean squares of the modes that the grid carries.
    fn carried_squares(&self, drop: &RippleDrop, axis: usize) -> Squares {
        self.squares_to(self.highest, drop.position_m[axis], drop.radius_m)
    }

    /// Mean squares of all modes.
    fn all_squares(&self, drop: &RippleDrop, axis: usize) -> Squares {
        let (position_m, radius_m) = (drop.position_m[axis], drop.radius_m);
        // A wide mound has few modes. A narrow one has few images; the product of a Gaussian with its image at the distance d has the
        // integral √π r e^(−d²/4r²).
        if radius_m > 1e-2 * self.length_m {
            return self.squares_to(usize::MAX, position_m, radius_m);
        }
        let from_wall_m = position_m - self.min_m;
        let mut distances_m: Vec<f64> = [-1.0, 0.0, 1.0].map(|tiles| tiles * self.tile_m()).into();
        if self.walls == Walls::Reflecting {
            distances_m.extend([0.0, -1.0].map(|tiles| 2.0 * from_wall_m + tiles * self.tile_m()));
        }
        let mut sums = Squares {
            height: 0.0,
            slope: 0.0,
        };
        for distance_m in distances_m {
            let square = (distance_m / radius_m).powi(2);
            let shared = PI.sqrt() * (radius_m / self.length_m) * (-0.25 * square).exp();
            sums.height += shared;
            sums.slope += shared * (0.5 - 0.25 * square) / (radius_m * radius_m);
        }
        sums
    }

    /// The highest mode whose Gaussian is noticed, of a mound of this radius.
    fn reach(&self, radius_m: f64) -> usize {
        ((2.0 * SMALLEST_EXPONENT).sqrt() / (radius_m * self.wave_number(1))) as usize
    }
}

/// Drops that fell at the same moment: their modes swing together.
struct Burst {
    elapsed: Elapsed,
    mounds: Vec<Mound>,
}

/// What a drop added to the modes.
struct Mound {
    radius_m: f64,
    /// Factors, cos and sin, of the modes along x, m, and along z.
    factors: [Vec<[f64; 2]>; 2],
}

impl Burst {
    /// The drops that have fallen by `time_s`.
    fn fallen(ripples: &Ripples, time_s: f64, sides: &[Side; 2]) -> Vec<Self> {
        let mut drops: Vec<&RippleDrop> = ripples
            .drops
            .iter()
            .filter(|drop| drop.at_s <= time_s && drop.height_m != 0.0)
            .collect();
        drops.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
        drops
            .chunk_by(|a, b| a.at_s == b.at_s)
            .map(|together| Self {
                elapsed: Elapsed::between(together[0].at_s, time_s),
                mounds: together.iter().map(|drop| Mound::of(drop, sides)).collect(),
            })
            .collect()
    }
}

impl Mound {
    fn of(drop: &RippleDrop, sides: &[Side; 2]) -> Self {
        let factors = |axis: usize, height: f64| {
            let side = &sides[axis];
            (0..=side.highest.min(side.reach(drop.radius_m)))
                .map(|mode| side.factor(mode, drop.position_m[axis], drop.radius_m))
                .map(|factor| factor.map(|part| height * part))
                .collect()
        };
        Self {
            radius_m: drop.radius_m,
            factors: [factors(0, drop.height_m), factors(1, 1.0)],
        }
    }
}

/// Amplitudes of the modes (m, 0), (m, 1) … at the time of the frame.
fn modes(
    m: usize,
    sides: &[Side; 2],
    bursts: &[Burst],
    damping_per_s: f64,
    frequency: &impl Fn(f64) -> f64,
) -> Vec<Parts> {
    let [side_x, side_z] = sides;
    let k_x = side_x.wave_number(m);
    let oscillators: Vec<Oscillator> = (0..=side_z.highest)
        .map(|n| frequency(k_x.hypot(side_z.wave_number(n))))
        .map(|frequency| Oscillator::of(frequency, damping_per_s))
        .collect();
    let mut sums = vec![[0.0; 4]; oscillators.len()];
    let mut released: Vec<Parts> = sums.clone();
    for burst in bursts {
        released.fill([0.0; 4]);
        for mound in &burst.mounds {
            let Some([cos_x, sin_x]) = mound.factors[0].get(m) else {
                continue;
            };
            let left = 2.0 * SMALLEST_EXPONENT / mound.radius_m.powi(2) - k_x * k_x;
            let reach = (left.max(0.0).sqrt() / side_z.wave_number(1)) as usize;
            let along_z = mound.factors[1].iter().take(reach.saturating_add(1));
            for (parts, [cos_z, sin_z]) in released.iter_mut().zip(along_z) {
                parts[0] += cos_x * cos_z;
                parts[1] += cos_x * sin_z;
                parts[2] += sin_x * cos_z;
                parts[3] += sin_x * sin_z;
            }
        }
        for ((sum, parts), oscillator) in sums.iter_mut().zip(&released).zip(&oscillators) {
            if *parts != [0.0; 4] {
                let swing = oscillator.swing(burst.elapsed).amplitude;
                for (sum, part) in sum.iter_mut().zip(parts) {
                    *sum += swing * part;
                }
            }
        }
    }
    if m == 0 {
        // The mean height stays 0.
        sums[0] = [0.0; 4];
    }
    sums
}

/// Slopes of the modes (m, 0), (m, 1) …
fn slopes(m: usize, sides: &[Side; 2], modes: &[Parts]) -> Vec<f64> {
    let k_x = sides[0].wave_number(m);
    let modes = modes.iter().enumerate();
    modes
        .map(|(n, parts)| {
            let square: f64 = parts.iter().map(|part| part * part).sum();
            k_x.hypot(sides[1].wave_number(n)) * square.sqrt()
        })
        .collect()
}

/// Length of the shortest wave that is noticed, m; infinite if there are none. `slopes` are by m and n.
fn shortest_wave_m(slopes: &[Vec<f64>], sides: &[Side; 2]) -> f64 {
    let most = slopes.iter().flatten().copied().fold(0.0, f64::max);
    let mut shortest_m = f64::INFINITY;
    for (m, slopes) in slopes.iter().enumerate() {
        let noticed = |slope: &f64| *slope > 0.0 && *slope >= NOTICED_SLOPE * most;
        if let Some(n) = slopes.iter().rposition(noticed) {
            let k_per_m = sides[0].wave_number(m).hypot(sides[1].wave_number(n));
            shortest_m = shortest_m.min(TAU / k_per_m);
        }
    }
    shortest_m
}
