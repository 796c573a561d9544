//! The mounds that drops add to a basin that is computed in steps.

use std::f64::consts::TAU;

use super::cells::Cells;
use super::ripples::SAMPLES_PER_WAVE;
use crate::physics::oscillator::Elapsed;
use crate::scene::{RippleDrop, Ripples, Walls};

/// Radius of the narrowest mound, in samples: at four samples a wave its Gaussian is e^(−π²/2).
const NARROWEST: f64 = 2.0;

/// Beyond this distance, in radii, a mound is below 10⁻²⁰ of its height.
const REACH: f64 = 9.6;

/// The narrowest mound, m. Drops below are widened to it, with the same water.
pub(super) fn narrowest_m(ripples: &Ripples) -> f64 {
    let [x_m, z_m] = ripples.sample_steps_m();
    NARROWEST * x_m.max(z_m)
}

/// The drops of a basin, by the time since the first.
pub(super) struct Mounds {
    drops: Vec<(f64, RippleDrop)>,
    walls: Walls,
    /// Corners of the basin, m.
    min_m: [f64; 2],
    sides_m: [f64; 2],
    narrowest_m: f64,
}

impl Mounds {
    /// Drops without height are left out.
    pub(super) fn of(ripples: &Ripples) -> Self {
        let first_s = ripples.first_drop_s().unwrap_or(0.0);
        let mut drops: Vec<(f64, RippleDrop)> = ripples
            .drops
            .iter()
            .filter(|drop| drop.height_m != 0.0)
            .map(|drop| (Elapsed::between(first_s, drop.at_s).seconds(), *drop))
            .collect();
        drops.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            drops,
            walls: ripples.walls,
            min_m: ripples.min_m,
            sides_m: ripples.sides_m(),
            narrowest_m: narrowest_m(ripples),
        }
    }

    /// The drops after `from_s` and until `to_s`.
    pub(super) fn between(&self, from_s: f64, to_s: f64) -> std::ops::Range<usize> {
        let until = |time_s: f64| self.drops.partition_point(|(at_s, _)| *at_s <= time_s);
        until(from_s)..until(to_s)
    }

    /// Time of a drop since the first, s.
    pub(super) fn at_s(&self, index: usize) -> f64 {
        self.drops[index].0
    }

    /// The wave number of four samples, rad/m.
    pub(super) fn highest_per_m(&self) -> f64 {
        TAU * NARROWEST / (SAMPLES_PER_WAVE as f64 * self.narrowest_m)
    }

    /// Heights and radii, m, of the drops until `elapsed_s`.
    pub(super) fn fallen(&self, elapsed_s: f64) -> Vec<[f64; 2]> {
        let fallen = &self.drops[self.between(f64::NEG_INFINITY, elapsed_s)];
        fallen.iter().map(|(_, drop)| self.carried(drop)).collect()
    }

    /// Height and radius, m.
    fn carried(&self, drop: &RippleDrop) -> [f64; 2] {
        let radius_m = drop.radius_m.max(self.narrowest_m);
        [drop.height_m * (drop.radius_m / radius_m).powi(2), radius_m]
    }

    /// The mound of a drop at all samples, m; 0 where `inside` an obstacle. The mean height stays 0, except in water without walls.
    pub(super) fn heights_m(&self, index: usize, cells: &Cells, inside: &[bool]) -> Vec<f64> {
        let drop = &self.drops[index].1;
        let [height_m, radius_m] = self.carried(drop);
        let factors = [0, 1].map(|axis| self.factors(axis, drop.position_m[axis], radius_m, cells));
        let mut heights_m = Vec::with_capacity(cells.count());
        for z in &factors[1] {
            heights_m.extend(factors[0].iter().map(|x| height_m * (x * z)));
        }
        let taken_m = if self.walls == Walls::Absorbing {
            0.0
        } else {
            let open = heights_m.iter().zip(inside).filter(|(_, inside)| !**inside);
            let (sum_m, count) = open.fold((0.0, 0), |(sum, n), (height, _)| (sum + height, n + 1));
            if count == 0 {
                0.0
            } else {
                sum_m / f64::from(count)
            }
        };
        for (height_m, inside) in heights_m.iter_mut().zip(inside) {
            *height_m = if *inside { 0.0 } else { *height_m - taken_m };
        }
        heights_m
    }

    /// The mound along one axis, of height 1, with its images beyond the walls.
    fn factors(&self, axis: usize, position_m: f64, radius_m: f64, cells: &Cells) -> Vec<f64> {
        let (min_m, side_m) = (self.min_m[axis], self.sides_m[axis]);
        let gaussian = |distance_m: f64| (-0.5 * (distance_m / radius_m).powi(2)).exp();
        let tile_m = match self.walls {
            Walls::Absorbing => f64::INFINITY,
            Walls::Periodic => side_m,
            Walls::Reflecting => 2.0 * side_m,
        };
        let tiles = (REACH * radius_m / tile_m).ceil() as i32 + 1;
        let from_wall_m = position_m - min_m;
        (0..cells.size[axis])
            .map(|index| {
                let at_m = cells.place_m(axis, index) - min_m;
                if self.walls == Walls::Absorbing {
                    return gaussian(at_m - from_wall_m);
                }
                let images = (-tiles..=tiles).map(|tile| {
                    let moved_m = at_m - f64::from(tile) * tile_m;
                    let mirrored = match self.walls {
                        Walls::Reflecting => gaussian(moved_m + from_wall_m),
                        Walls::Periodic | Walls::Absorbing => 0.0,
                    };
                    gaussian(moved_m - from_wall_m) + mirrored
                });
                images.sum()
            })
            .collect()
    }
}
