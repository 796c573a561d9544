//! Choppy seas: surface points move to the sides as well, so that crests are sharper than troughs.
//!
//! A point that rests at q is at x = q + D(q) and at the height h(q). D is a gradient: the strain, the matrix of its derivatives, is
//! symmetric, and the map from q to x has an inverse if 1 + the smallest eigenvalue of the strain is above 0 everywhere. That is
//! proven for the splines of D, not only seen at their samples. Source: Tessendorf, "Simulating ocean water", SIGGRAPH course notes,
//! 2001; of its sign of D the one that sharpens crests.

use glam::{DMat2, DVec2};
use rayon::prelude::*;

use super::bounds::{
    LANES, Lanes, at_sample, between, block, padded, raise, slope_between, third_differences,
};
use super::spline::{dot, four_from, slopes, weights};

/// Largest magnitude of the strain's eigenvalues where it compresses: as the steepness of a Gerstner wave, 1 is a cusp.
const MOST_STRAIN: f64 = 0.95;

/// Offset, in samples, from which one more step of Newton's method leaves less than 10⁻¹⁰.
const NEAR: f64 = 1e-7;

/// Most steps of Newton's method, and halvings of one.
const MOST_STEPS: usize = 60;

/// A sea and its displacement, as coefficients of splines, row by row along x, on a square grid of `size` samples along each side.
pub(super) struct Choppy {
    pub(super) size: usize,
    /// m.
    pub(super) height: Vec<f64>,
    /// Along x and z at a choppiness of 1, in samples.
    pub(super) displacement: [Vec<f64>; 2],
}

/// Heights at the samples, with the mean 0.
pub(super) struct Displaced {
    pub(super) heights_m: Vec<f64>,
    /// Bound of the strain's eigenvalue where it compresses most, 0 … 0.95.
    pub(super) strain: f64,
}

impl Choppy {
    /// The heights over x at this choppiness.
    ///
    /// # Errors
    /// The largest choppiness that is allowed, if this one is larger.
    pub(super) fn heights(&self, choppiness: f64) -> Result<Displaced, f64> {
        let compression = self.compression();
        let strain = choppiness * compression;
        if strain > MOST_STRAIN {
            return Err(MOST_STRAIN / compression);
        }
        let pairs = self.displacement[0].iter().zip(&self.displacement[1]);
        let map = Map {
            size: self.size,
            displacement: pairs
                .map(|(x, z)| choppiness * DVec2::new(*x, *z))
                .collect(),
        };
        let mut heights_m = vec![0.0; self.size * self.size];
        let rows = heights_m.par_chunks_exact_mut(self.size).enumerate();
        rows.try_for_each(|(z, row)| {
            for (x, height_m) in row.iter_mut().enumerate() {
                let place = [x as i64, z as i64];
                let from = map.origin_of(place)?;
                *height_m = self.height_at(place, from);
            }
            Some(())
        })
        // Within the bound on the strain there is an inverse, and every step comes nearer to it.
        .ok_or(MOST_STRAIN / compression)?;
        let mean_m = heights_m.iter().sum::<f64>() / heights_m.len() as f64;
        for height_m in &mut heights_m {
            *height_m -= mean_m;
        }
        Ok(Displaced { heights_m, strain })
    }

    /// A bound of the largest compression at a choppiness of 1, minus the smallest eigenvalue of the strain. 0 if nothing moves.
    fn compression(&self) -> f64 {
        let [along_x, along_z] = &self.displacement;
        let size = self.size;
        let seen = (0..size)
            .into_par_iter()
            .map(|z| {
                let rows =
                    |of: &[f64]| [0, 1, 2, 3].map(|i| padded(&of[(z + i) % size * size..][..size]));
                compression_of_row(&rows(along_x), &rows(along_z))
            })
            .reduce(|| 0.0, f64::max);
        // Between points half a step apart, a function differs from its bilinear interpolation by less than 1/32 of its second
        // derivatives along x and z together. The smallest eigenvalue of a mixture of matrices is at least that of one of them, and an
        // error of the matrix moves it by no more than its size.
        let [xxx, xxz, xzz, zzz] = third_differences(along_x, [size; 2]);
        let xx = xxx + xzz;
        let one_xz = xxz + zzz;
        let [xxx, xxz, xzz, zzz] = third_differences(along_z, [size; 2]);
        let (xz, zz) = (0.5 * (one_xz + xxx + xzz), xxz + zzz);
        let error = (xx * xx + 2.0 * xz * xz + zz * zz).sqrt() / 32.0;
        if seen > 0.0 { seen + error } else { 0.0 }
    }

    fn height_at(&self, place: [i64; 2], from: DVec2) -> f64 {
        let around = Around::of(place, from, self.size);
        let (wx, wz) = (weights(around.t.x), weights(around.t.y));
        (0..4)
            .map(|row| wz[row] * dot(&around.row(&self.height, row), &wx))
            .sum()
    }
}

/// The map from places at rest to those at the moment.
struct Map {
    size: usize,
    /// Coefficients of the displacement, in samples.
    displacement: Vec<DVec2>,
}

impl Map {
    /// Where the point rests that is displaced to the sample `place`, in samples from there. `None` if Newton's method fails.
    fn origin_of(&self, place: [i64; 2]) -> Option<DVec2> {
        let offset = |from: DVec2| {
            let (displacement, strain) = self.displacement_at(place, from);
            (from + displacement, strain)
        };
        let mut from = DVec2::ZERO;
        let (mut off, mut strain) = offset(from);
        for _ in 0..MOST_STEPS {
            let mut step = (DMat2::IDENTITY + strain).inverse() * off;
            if off.length() <= NEAR {
                return Some(from - step);
            }
            for halvings in 0.. {
                if halvings == MOST_STEPS {
                    return None;
                }
                let next = offset(from - step);
                if next.0.length() < off.length() {
                    from -= step;
                    (off, strain) = next;
                    break;
                }
                step *= 0.5;
            }
        }
        None
    }

    /// Displacement and strain at `from`, in samples from the sample `place`.
    fn displacement_at(&self, place: [i64; 2], from: DVec2) -> (DVec2, DMat2) {
        let around = Around::of(place, from, self.size);
        let (wx, dx) = (weights(around.t.x), slopes(around.t.x));
        let (wz, dz) = (weights(around.t.y), slopes(around.t.y));
        let mut value = DVec2::ZERO;
        let mut strain = DMat2::ZERO;
        for row in 0..4 {
            let [a, b, c, d] = around.row(&self.displacement, row);
            let across = a * wx[0] + b * wx[1] + c * wx[2] + d * wx[3];
            value += wz[row] * across;
            strain.x_axis += wz[row] * (a * dx[0] + b * dx[1] + c * dx[2] + d * dx[3]);
            strain.y_axis += dz[row] * across;
        }
        (value, strain)
    }
}

/// The coefficients around a point.
struct Around {
    /// Place in its cell.
    t: DVec2,
    columns: [usize; 4],
    /// Where rows start.
    starts: [usize; 4],
}

impl Around {
    fn of(place: [i64; 2], from: DVec2, size: usize) -> Self {
        let cell = from.floor();
        let [x, z] = [place[0] + cell.x as i64 - 1, place[1] + cell.y as i64 - 1];
        Self {
            t: from - cell,
            columns: four_from(x, size),
            starts: four_from(z, size).map(|row| row * size),
        }
    }

    fn row<T: Copy>(&self, coefficients: &[T], row: usize) -> [T; 4] {
        self.columns
            .map(|column| coefficients[self.starts[row] + column])
    }
}

/// The largest compression at the points of a row of cells that are half a step apart. Rows are padded.
fn compression_of_row(along_x: &[Vec<f64>; 4], along_z: &[Vec<f64>; 4]) -> f64 {
    let length = along_x[0].len();
    let mut most: Lanes = [0.0; LANES];
    for is_between in [false, true] {
        // Coefficients along x of the displacement and of its derivative along z.
        let lines = |rows: &[Vec<f64>; 4]| -> [Vec<f64>; 2] {
            let [a, b, c, d] = rows.each_ref().map(|row| &row[..length]);
            let (mut value, mut down) = (vec![0.0; length], vec![0.0; length]);
            for x in 0..length {
                if is_between {
                    value[x] = between([a[x], b[x], c[x], d[x]]);
                    down[x] = slope_between([a[x], b[x], c[x], d[x]]);
                } else {
                    value[x] = at_sample([a[x], b[x], c[x]]);
                    down[x] = 0.5 * (c[x] - a[x]);
                }
            }
            [value, down]
        };
        let ([x, x_down], [z, z_down]) = (lines(along_x), lines(along_z));
        for first in (0..length - LANES).step_by(LANES) {
            let [x, x_down, z, z_down] = [&x, &x_down, &z, &z_down].map(|line| block(line, first));
            raise(&mut most, |i| {
                compression(
                    0.5 * (x[i + 2] - x[i]),
                    0.5 * (at_sample(three(x_down, i)) + 0.5 * (z[i + 2] - z[i])),
                    at_sample(three(z_down, i)),
                )
            });
            raise(&mut most, |i| {
                compression(
                    slope_between(four(x, i)),
                    0.5 * (between(four(x_down, i)) + slope_between(four(z, i))),
                    between(four(z_down, i)),
                )
            });
        }
    }
    most.into_iter().fold(0.0, f64::max)
}

/// Minus the smaller eigenvalue of a symmetric matrix.
fn compression(xx: f64, xz: f64, zz: f64) -> f64 {
    (0.25 * (xx - zz) * (xx - zz) + xz * xz).sqrt() - 0.5 * (xx + zz)
}

fn three(line: &[f64; LANES + 3], i: usize) -> [f64; 3] {
    [line[i], line[i + 1], line[i + 2]]
}

fn four(line: &[f64; LANES + 3], i: usize) -> [f64; 4] {
    [line[i], line[i + 1], line[i + 2], line[i + 3]]
}
