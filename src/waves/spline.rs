//! Surfaces given by samples: an interpolating cubic B-spline over an even grid.
//!
//! Second derivatives are continuous; the caustics of a surface made of facets would show the facets. Source: Unser, Aldroubi and
//! Eden, "B-Spline Signal Processing: Part II", IEEE Trans. Signal Processing 41(2), 1993.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::bounds::Bounds;
use super::grid::Edges;
use super::surface::{Curvature, SurfacePoint};
use crate::physics::turns::sin_cos_turns;

/// Pole of the filter that turns samples into coefficients.
const POLE: f64 = -0.267_949_192_431_122_7;

/// Steps after which the filter has forgotten a sample: |POLE|³⁰ < 10⁻¹⁷.
const MEMORY: usize = 30;

/// Coefficients around samples in flat water: in [`SETTLING`] steps those of the samples fall to 10⁻⁹ of them, the outermost
/// [`ZEROS`] are 0. With so many zeros at both ends, a grid that repeats is the same as one with zeros beyond it, so that all of
/// filter, evaluation and bounds serves both.
const PADDING: usize = SETTLING + ZEROS;
const SETTLING: usize = 16;
const ZEROS: usize = 2;

/// Heights on an even grid, and the spline through them. Beyond the grid it repeats along x and z, or the water is flat.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    edges: Edges,
    /// Numbers of coefficients along x and z.
    size: [usize; 2],
    /// Distances of the samples along x and z, m.
    step_m: DVec2,
    /// Place of the first coefficient, m.
    corner_m: DVec2,
    /// Row by row along x.
    coefficients: Arc<[f64]>,
    bounds: Arc<Bounds>,
}

/// A spline is its coefficients: two with the same have the same bounds.
impl PartialEq for Spline {
    fn eq(&self, other: &Self) -> bool {
        self.edges == other.edges
            && self.size == other.size
            && self.step_m == other.step_m
            && self.corner_m == other.corner_m
            && self.coefficients == other.coefficients
    }
}

impl Spline {
    /// The spline through `heights_m`, which repeats. `corner_m` is the place of the first sample; rows run along x.
    pub(super) fn through(
        heights_m: Vec<f64>,
        size: [usize; 2],
        step_m: DVec2,
        corner_m: DVec2,
    ) -> Self {
        let mut coefficients = heights_m;
        filter(&mut coefficients, size);
        Self::of(Edges::Repeats, coefficients, size, step_m, corner_m)
    }

    /// The spline through `heights_m`, around which the water is flat: beyond the samples it swings out, a quarter as high per
    /// sample, and ends 18 samples from them.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "the same arguments as `through`"
    )]
    pub(super) fn in_flat_water(
        heights_m: Vec<f64>,
        size: [usize; 2],
        step_m: DVec2,
        corner_m: DVec2,
    ) -> Self {
        let [width, height] = size.map(|count| count + 2 * PADDING);
        let mut coefficients = vec![0.0; width * height];
        let rows = coefficients.chunks_exact_mut(width).skip(PADDING);
        for (row, samples) in rows.zip(heights_m.chunks_exact(size[0])) {
            row[PADDING..][..size[0]].copy_from_slice(samples);
        }
        // The nearest copies are so far away that they add less than rounding does.
        filter(&mut coefficients, [width, height]);
        for (z, row) in coefficients.chunks_exact_mut(width).enumerate() {
            if z < ZEROS || z >= height - ZEROS {
                row.fill(0.0);
            }
            row[..ZEROS].fill(0.0);
            row[width - ZEROS..].fill(0.0);
        }
        let corner_m = corner_m - PADDING as f64 * step_m;
        Self::of(Edges::Flat, coefficients, [width, height], step_m, corner_m)
    }

    /// The spline with these coefficients, row by row along x. If it does not repeat, those at the edges are 0. `corner_m` is the place of
    /// the first.
    pub(super) fn of(
        edges: Edges,
        coefficients: Vec<f64>,
        size: [usize; 2],
        step_m: DVec2,
        corner_m: DVec2,
    ) -> Self {
        Self {
            edges,
            size,
            step_m,
            corner_m,
            bounds: Arc::new(Bounds::of(&coefficients, size, step_m)),
            coefficients: coefficients.into(),
        }
    }

    /// See [`super::Surface::recentred`].
    pub(super) fn recentred(&self, origin_m: DVec2) -> Self {
        let mut corner_m = self.corner_m - origin_m;
        if self.edges == Edges::Repeats {
            // The copy nearest to the origin, so that f32 holds its place.
            let tile_m = self.tile_m();
            corner_m -= tile_m * (corner_m / tile_m).round();
        }
        Self {
            corner_m,
            ..self.clone()
        }
    }

    /// Lengths of the sides of the grid, m.
    pub(super) fn tile_m(&self) -> DVec2 {
        self.step_m * DVec2::new(self.size[0] as f64, self.size[1] as f64)
    }

    /// See [`super::Surface::at`].
    pub(super) fn at(&self, x_m: f64, z_m: f64) -> SurfacePoint {
        let at = (DVec2::new(x_m, z_m) - self.corner_m) / self.step_m;
        if self.is_beyond(at) {
            return SurfacePoint::FLAT;
        }
        let cell = at.floor();
        let (t, first) = (at - cell, [cell.x as i64 - 1, cell.y as i64 - 1]);
        let (wx, dx) = (weights(t.x), slopes(t.x));
        let (wz, dz) = (weights(t.y), slopes(t.y));
        let mut sums = [0.0; 3];
        self.rows_at(first, |row, values| {
            let across = dot(values, &wx);
            sums[0] += wz[row] * across;
            sums[1] += wz[row] * dot(values, &dx);
            sums[2] += dz[row] * across;
        });
        SurfacePoint {
            height_m: sums[0],
            slope: DVec2::new(sums[1], sums[2]) / self.step_m,
        }
    }

    /// See [`super::Surface::curved_at`].
    pub(super) fn curved_at(&self, x_m: f64, z_m: f64) -> (SurfacePoint, Curvature) {
        let at = (DVec2::new(x_m, z_m) - self.corner_m) / self.step_m;
        if self.is_beyond(at) {
            return (SurfacePoint::FLAT, Curvature::FLAT);
        }
        let cell = at.floor();
        let (t, first) = (at - cell, [cell.x as i64 - 1, cell.y as i64 - 1]);
        let (wx, dx, cx) = (weights(t.x), slopes(t.x), curvatures(t.x));
        let (wz, dz, cz) = (weights(t.y), slopes(t.y), curvatures(t.y));
        let mut sums = [0.0; 6];
        self.rows_at(first, |row, values| {
            let (value, slope, curvature) = (dot(values, &wx), dot(values, &dx), dot(values, &cx));
            sums[0] += wz[row] * value;
            sums[1] += wz[row] * slope;
            sums[2] += dz[row] * value;
            sums[3] += wz[row] * curvature;
            sums[4] += dz[row] * slope;
            sums[5] += cz[row] * value;
        });
        let step = self.step_m;
        let point = SurfacePoint {
            height_m: sums[0],
            slope: DVec2::new(sums[1], sums[2]) / step,
        };
        let curvature = Curvature {
            xx_per_m: sums[3] / (step.x * step.x),
            xz_per_m: sums[4] / (step.x * step.y),
            zz_per_m: sums[5] / (step.y * step.y),
        };
        (point, curvature)
    }

    /// Whether a point, in steps from the first coefficient, is in the flat water beyond the grid.
    fn is_beyond(&self, at: DVec2) -> bool {
        let [width, height] = self.size.map(|count| count as f64);
        let is_within = (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y);
        self.edges == Edges::Flat && !is_within
    }

    /// Calls `add` with the four coefficients of each of the four rows from `first` on.
    fn rows_at(&self, first: [i64; 2], mut add: impl FnMut(usize, &[f64; 4])) {
        let [width, height] = self.size;
        let columns = four_from(first[0], width);
        for (row, line) in four_from(first[1], height).into_iter().enumerate() {
            let start = line * width;
            add(
                row,
                &columns.map(|column| self.coefficients[start + column]),
            );
        }
    }

    /// See [`super::Surface::max_height_m`].
    pub(super) fn max_height_m(&self) -> f64 {
        self.bounds.height_m
    }

    /// See [`super::Surface::max_slope_along`].
    pub(super) fn max_slope_along(&self, u: DVec2) -> f64 {
        self.bounds.slope_along(u).max(self.bounds.slope_along(-u))
    }

    /// See [`super::Surface::max_slope`].
    pub(super) fn max_slope(&self) -> f64 {
        self.bounds.slope()
    }

    /// See [`super::Surface::max_second_derivative_per_m`].
    pub(super) fn max_second_derivative_per_m(&self) -> f64 {
        self.bounds.second_per_m
    }

    /// See [`super::Surface::max_third_derivative_per_m2`].
    pub(super) fn max_third_derivative_per_m2(&self) -> f64 {
        self.bounds.third_per_m2
    }

    /// A slope that no slope exceeds along the unit vector `u`.
    pub(super) fn rim_slope(&self, u: DVec2) -> DVec2 {
        self.bounds.rim_slope(u)
    }

    /// The grid for the GPU, whose coefficients begin at the element `first`: place of the first coefficient and reciprocal steps;
    /// then numbers of coefficients along x and z, and `first`: whole numbers below 2²⁴; then 1 if it repeats, else 0.
    pub(super) fn gpu_header(&self, first: usize) -> [[f32; 4]; 2] {
        let [width, height] = self.size.map(|count| count as f32);
        let repeats = match self.edges {
            Edges::Repeats => 1.0,
            Edges::Flat => 0.0,
        };
        let (corner, inverse) = (self.corner_m.as_vec2(), self.step_m.recip().as_vec2());
        [
            [corner.x, corner.y, inverse.x, inverse.y],
            [width, height, first as f32, repeats],
        ]
    }

    /// The coefficients, m, row by row.
    pub(super) fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }
}

/// Amplitude of a wave of `frequency`, in waves per sample, in the coefficients of the spline through samples of one of amplitude 1.
pub(super) fn in_coefficients(frequency: f64) -> f64 {
    3.0 / (2.0 + sin_cos_turns(frequency).1)
}

/// Amplitude of a wave of `frequency`, in waves per sample, in the spline through samples of one of amplitude 1; the rest is in other
/// frequencies. Source: Unser, Aldroubi and Eden 1993, the Fourier transform of the cardinal spline.
pub(super) fn carried(frequency: f64) -> f64 {
    let x = std::f64::consts::PI * frequency;
    let sinc = if x == 0.0 { 1.0 } else { x.sin() / x };
    sinc.powi(4) * in_coefficients(frequency)
}

/// Four neighbouring indices from `first` on, of `count` that repeat.
pub(super) fn four_from(first: i64, count: usize) -> [usize; 4] {
    let mut index = first.rem_euclid(count as i64) as usize;
    // A division is slow: one is enough.
    std::array::from_fn(|_| {
        let this = index;
        index = if index + 1 == count { 0 } else { index + 1 };
        this
    })
}

pub(super) fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
}

/// Weights of the four coefficients around a point at `t`, 0 … 1, between the middle two.
pub(super) fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    ]
}

/// First derivatives of the weights.
pub(super) fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [
        -0.5 * s * s,
        -2.0 * t + 1.5 * t * t,
        2.0 * s - 1.5 * s * s,
        0.5 * t * t,
    ]
}

/// Second derivatives of the weights.
fn curvatures(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t]
}

/// Turns samples that repeat into coefficients, in place.
fn filter(values: &mut [f64], [width, height]: [usize; 2]) {
    // Columns are filtered in blocks of neighbours, transposed: a cache line holds eight of them.
    const BLOCK: usize = 16;
    values.par_chunks_exact_mut(width).for_each(filter_line);
    let source: &[f64] = values;
    let blocks: Vec<(usize, Vec<f64>)> = (0..width.div_ceil(BLOCK))
        .into_par_iter()
        .map(|block| {
            let columns = block * BLOCK..((block + 1) * BLOCK).min(width);
            let mut lines = vec![0.0; columns.len() * height];
            for row in 0..height {
                for (i, column) in columns.clone().enumerate() {
                    lines[i * height + row] = source[row * width + column];
                }
            }
            lines.chunks_exact_mut(height).for_each(filter_line);
            (columns.start, lines)
        })
        .collect();
    for (start, lines) in blocks {
        for (i, line) in lines.chunks_exact(height).enumerate() {
            for (row, value) in line.iter().enumerate() {
                values[row * width + start + i] = *value;
            }
        }
    }
}

/// The recursive filter along one line that repeats: forwards, then backwards, each started with what it would have come to.
fn filter_line(line: &mut [f64]) {
    let count = line.len();
    let mut sum = 0.0;
    for k in (0..MEMORY).rev() {
        sum = POLE * sum + 6.0 * line[(count - 1).wrapping_sub(k % count)];
    }
    for value in line.iter_mut() {
        sum = 6.0 * *value + POLE * sum;
        *value = sum;
    }
    let mut next = 0.0;
    for k in (0..MEMORY).rev() {
        next = POLE * (next - line[k % count]);
    }
    for value in line.iter_mut().rev() {
        next = POLE * (next - *value);
        *value = next;
    }
}
