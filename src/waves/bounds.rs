//! Bounds of a spline and its derivatives, found in one pass over its coefficients.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

/// Directions in which slopes are bounded; a multiple of 4.
const DIRECTIONS: usize = 32;

/// Values that are treated together, so that the compiler uses vector instructions.
pub(super) const LANES: usize = 8;

/// Rows of cells that a task treats.
const ROWS: usize = 16;

pub(super) type Lanes = [f64; LANES];

/// Bounds of a spline and its derivatives, true at every point.
#[derive(Debug, PartialEq)]
pub(super) struct Bounds {
    /// Largest |height|, m.
    pub(super) height_m: f64,
    /// Largest slope along each of [`DIRECTIONS`] directions.
    slopes: [f64; DIRECTIONS],
    /// Largest second derivative along any direction, 1/m.
    pub(super) second_per_m: f64,
    /// Largest third derivative along any direction, 1/m².
    pub(super) third_per_m2: f64,
}

impl Bounds {
    /// Bounds of the spline with these coefficients, row by row along x, which repeat after `size`; `step` is their distance, m.
    pub(super) fn of(coefficients: &[f64], [width, height]: [usize; 2], step: DVec2) -> Self {
        let row = |z: usize| padded(&coefficients[z % height * width..][..width]);
        let sweep = |first: usize, count: usize, slopes: &Slopes| {
            let rows: Vec<Vec<f64>> = (first..first + count + 3).map(row).collect();
            let mut sweep = Sweep::of(width, step, *slopes);
            for rows in rows.windows(4) {
                sweep.row([&rows[0], &rows[1], &rows[2], &rows[3]]);
            }
            sweep
        };
        let firsts: Vec<usize> = (0..height).step_by(ROWS).collect();
        // A look at a few rows tells which slopes of the others may exceed these.
        let slopes = firsts
            .par_iter()
            .step_by(2)
            .map(|first| sweep(*first, 1, &Slopes::default()).slopes)
            .reduce(Slopes::default, Slopes::joined);
        let most = firsts
            .par_iter()
            .map(|first| sweep(*first, ROWS.min(height - first), &slopes).most())
            .reduce(Most::default, Most::joined);

        let (sx, sz) = (step.x, step.y);
        let [xx, xz, zz, xxx, xxz, xzz, zzz] = most.differences;
        let (xx, xz, zz) = (xx / (sx * sx), xz / (sx * sz), zz / (sz * sz));
        let (xxx, zzz) = (xxx / sx.powi(3), zzz / sz.powi(3));
        let (xxz, xzz) = (xxz / (sx * sx * sz), xzz / (sx * sz * sz));
        // Between points half a step apart, a function exceeds its bilinear interpolation by less than this.
        let over = |along_x: f64, along_z: f64| (sx * sx * along_x + sz * sz * along_z) / 32.0;
        let over_slope = over(xxx.hypot(xxz), xzz.hypot(zzz));
        Self {
            height_m: most.coefficient.min(most.height + over(xx, zz)),
            slopes: most.slopes.map(|slope| slope + over_slope),
            second_per_m: (xx * xx + 2.0 * xz * xz + zz * zz).sqrt(),
            third_per_m2: (xxx * xxx + 3.0 * (xxz * xxz + xzz * xzz) + zzz * zzz).sqrt(),
        }
    }

    /// Largest slope in any direction.
    pub(super) fn slope(&self) -> f64 {
        (0..DIRECTIONS)
            .map(|i| self.corner(i).length())
            .fold(0.0, f64::max)
    }

    /// Upper bound of the slope along the unit vector `u`.
    pub(super) fn slope_along(&self, u: DVec2) -> f64 {
        self.rim_slope(u).dot(u)
    }

    /// A slope that no slope exceeds along the unit vector `u`.
    pub(super) fn rim_slope(&self, u: DVec2) -> DVec2 {
        let turns = u.y.atan2(u.x) / TAU;
        self.corner((turns.rem_euclid(1.0) * DIRECTIONS as f64) as usize % DIRECTIONS)
    }

    /// The corner of the polygon around all slopes between the directions `i` and `i` + 1.
    fn corner(&self, i: usize) -> DVec2 {
        let (a, b) = (direction(i), direction(i + 1));
        let (along_a, along_b) = (self.slopes[i], self.slopes[(i + 1) % DIRECTIONS]);
        // The point whose components along a and b are these.
        DVec2::new(along_a * b.y - along_b * a.y, along_b * a.x - along_a * b.x) / a.perp_dot(b)
    }
}

/// Largest magnitudes of the third differences of coefficients, which repeat after `size`: xxx, xxz, xzz, zzz.
pub(super) fn third_differences(coefficients: &[f64], [width, height]: [usize; 2]) -> [f64; 4] {
    let row = |z: usize| padded(&coefficients[z % height * width..][..width]);
    let found = (0..height).into_par_iter().map(|z| {
        let mut sweep = Sweep::of(width, DVec2::ONE, Slopes::default());
        let rows = [0, 1, 2, 3].map(|i| row(z + i));
        sweep.differences(rows.each_ref().map(Vec::as_slice));
        sweep.most()
    });
    let [.., xxx, xxz, xzz, zzz] = found.reduce(Most::default, Most::joined).differences;
    [xxx, xxz, xzz, zzz]
}

/// Unit vector of a direction.
fn direction(i: usize) -> DVec2 {
    DVec2::from_angle(TAU * i as f64 / DIRECTIONS as f64)
}

/// A row that repeats, with more of it at its end, so that whole blocks of lanes and their neighbours are there.
pub(super) fn padded(row: &[f64]) -> Vec<f64> {
    let length = row.len().next_multiple_of(LANES) + LANES;
    row.iter().copied().cycle().take(length).collect()
}

/// The larger of two numbers; `most` if the other is none. It is one instruction, unlike `f64::max`.
fn larger(value: f64, most: f64) -> f64 {
    if value > most { value } else { most }
}

pub(super) fn raise(most: &mut Lanes, value: impl Fn(usize) -> f64) {
    for (lane, most) in most.iter_mut().enumerate() {
        *most = larger(value(lane), *most);
    }
}

/// What was found in some rows.
#[derive(Clone, Copy)]
struct Most {
    /// Largest magnitudes: of the coefficients, of the heights at the points, and of the coefficients' differences, which are
    /// coefficients of derivatives, whose weights add up to 1: xx, xz, zz, xxx, xxz, xzz, zzz.
    coefficient: f64,
    height: f64,
    differences: [f64; 7],
    /// Largest slopes at the points.
    slopes: [f64; DIRECTIONS],
}

impl Default for Most {
    fn default() -> Self {
        Self {
            coefficient: 0.0,
            height: 0.0,
            differences: [0.0; 7],
            slopes: [0.0; DIRECTIONS],
        }
    }
}

impl Most {
    fn joined(a: Self, b: Self) -> Self {
        Self {
            coefficient: a.coefficient.max(b.coefficient),
            height: a.height.max(b.height),
            differences: std::array::from_fn(|i| a.differences[i].max(b.differences[i])),
            slopes: std::array::from_fn(|i| a.slopes[i].max(b.slopes[i])),
        }
    }
}

/// A search through rows of cells.
struct Sweep {
    /// Cells of a row, rounded up to whole blocks of lanes.
    width: usize,
    inverse_step: DVec2,
    /// See [`Most`]; by lanes.
    coefficient: Lanes,
    height: Lanes,
    differences: [Lanes; 7],
    slopes: Slopes,
    /// Coefficients of the spline along x at one z, and those of its derivative along z.
    value: Vec<f64>,
    down: Vec<f64>,
}

impl Sweep {
    fn of(width: usize, step: DVec2, slopes: Slopes) -> Self {
        let width = width.next_multiple_of(LANES);
        Self {
            width,
            inverse_step: step.recip(),
            coefficient: [0.0; LANES],
            height: [0.0; LANES],
            differences: [[0.0; LANES]; 7],
            slopes,
            value: vec![0.0; width + LANES],
            down: vec![0.0; width + LANES],
        }
    }

    /// A row of cells, which four rows of coefficients surround.
    fn row(&mut self, rows: [&[f64]; 4]) {
        self.differences(rows);
        let length = self.value.len();
        let [a, b, c, d] = rows.map(|row| &row[..length]);
        let (value, down) = (&mut self.value[..length], &mut self.down[..length]);
        for x in 0..length {
            value[x] = at_sample([a[x], b[x], c[x]]);
            down[x] = 0.5 * (c[x] - a[x]);
        }
        self.points();
        let (value, down) = (&mut self.value[..length], &mut self.down[..length]);
        for x in 0..length {
            value[x] = between([a[x], b[x], c[x], d[x]]);
            down[x] = slope_between([a[x], b[x], c[x], d[x]]);
        }
        self.points();
    }

    fn differences(&mut self, rows: [&[f64]; 4]) {
        // Copies, so that the compiler need not write them back each time.
        let [mut xx, mut xz, mut zz, mut xxx, mut xxz, mut xzz, mut zzz] = self.differences;
        let mut coefficient = self.coefficient;
        for x in (0..self.width).step_by(LANES) {
            let [a, b, c, d] = rows.map(|row| block(row, x));
            raise(&mut coefficient, |i| a[i].abs());
            raise(&mut xx, |i| (a[i + 2] - 2.0 * a[i + 1] + a[i]).abs());
            raise(&mut xxx, |i| {
                (a[i + 3] - a[i] - 3.0 * (a[i + 2] - a[i + 1])).abs()
            });
            let once: [f64; LANES + 2] = std::array::from_fn(|i| b[i] - a[i]);
            raise(&mut xz, |i| (once[i + 1] - once[i]).abs());
            raise(&mut xxz, |i| {
                (once[i + 2] - 2.0 * once[i + 1] + once[i]).abs()
            });
            let twice: [f64; LANES + 1] = std::array::from_fn(|i| c[i] - 2.0 * b[i] + a[i]);
            raise(&mut zz, |i| twice[i].abs());
            raise(&mut xzz, |i| (twice[i + 1] - twice[i]).abs());
            raise(&mut zzz, |i| (d[i] - a[i] - 3.0 * (c[i] - b[i])).abs());
        }
        self.differences = [xx, xz, zz, xxx, xxz, xzz, zzz];
        self.coefficient = coefficient;
    }

    /// The points of a line along x, half a step apart.
    fn points(&mut self) {
        let mut height = self.height;
        let scale = self.inverse_step;
        for x in (0..self.width).step_by(LANES) {
            let (v, d) = (block(&self.value, x), block(&self.down, x));
            let three = |line: &[f64; LANES + 3], i: usize| [line[i], line[i + 1], line[i + 2]];
            let four = |line: &[f64; LANES + 3], i: usize| {
                [line[i], line[i + 1], line[i + 2], line[i + 3]]
            };
            raise(&mut height, |i| at_sample(three(v, i)).abs());
            self.slopes.see(
                &std::array::from_fn(|i| 0.5 * (v[i + 2] - v[i]) * scale.x),
                &std::array::from_fn(|i| at_sample(three(d, i)) * scale.y),
            );
            raise(&mut height, |i| between(four(v, i)).abs());
            self.slopes.see(
                &std::array::from_fn(|i| slope_between(four(v, i)) * scale.x),
                &std::array::from_fn(|i| between(four(d, i)) * scale.y),
            );
        }
        self.height = height;
    }

    fn most(&self) -> Most {
        let most = |lanes: &Lanes| lanes.iter().copied().fold(0.0, f64::max);
        Most {
            coefficient: most(&self.coefficient),
            height: most(&self.height),
            differences: self.differences.each_ref().map(most),
            slopes: self.slopes.most,
        }
    }
}

/// A block of lanes and their neighbours.
pub(super) fn block(row: &[f64], first: usize) -> &[f64; LANES + 3] {
    row[first..first + LANES + 3]
        .try_into()
        .expect("rows are padded")
}

/// The spline at the middle one of three coefficients.
pub(super) fn at_sample([a, b, c]: [f64; 3]) -> f64 {
    (a + c) * (1.0 / 6.0) + b * (2.0 / 3.0)
}

/// The spline half-way between the middle two of four coefficients.
pub(super) fn between([a, b, c, d]: [f64; 4]) -> f64 {
    (a + d) * (1.0 / 48.0) + (b + c) * (23.0 / 48.0)
}

/// Its derivative there, per step.
pub(super) fn slope_between([a, b, c, d]: [f64; 4]) -> f64 {
    (d - a) * 0.125 + (c - b) * 0.625
}

/// The largest slopes along all directions. Few slopes have to be looked at in all of them: those outside of an ellipse that lies within
/// the polygon of the largest so far.
#[derive(Clone, Copy)]
struct Slopes {
    directions: [DVec2; DIRECTIONS],
    most: [f64; DIRECTIONS],
    /// The ellipse: [0] x² + [1] x z + [2] z² = 1.
    ellipse: [f64; 3],
    /// Sums of x², x z and z² of the slopes that were looked at: the shape of the ellipse.
    squares: [f64; 3],
}

impl Default for Slopes {
    fn default() -> Self {
        Self {
            directions: std::array::from_fn(direction),
            most: [0.0; DIRECTIONS],
            ellipse: [f64::INFINITY, 0.0, f64::INFINITY],
            squares: [0.0; 3],
        }
    }
}

impl Slopes {
    fn joined(a: Self, b: Self) -> Self {
        let mut joined = Self {
            most: std::array::from_fn(|i| a.most[i].max(b.most[i])),
            squares: std::array::from_fn(|i| a.squares[i] + b.squares[i]),
            ..a
        };
        joined.fit_ellipse();
        joined
    }

    #[inline]
    fn see(&mut self, x: &Lanes, z: &Lanes) {
        let [xx, xz, zz] = self.ellipse;
        let outside: Lanes =
            std::array::from_fn(|i| x[i] * (xx * x[i] + xz * z[i]) + zz * (z[i] * z[i]));
        // So that an ellipse that is no number has all slopes outside.
        let is_inside = outside
            .iter()
            .fold(true, |all, value| all & (*value <= 1.0));
        if !is_inside {
            self.look_at(x, z);
        }
    }

    #[cold]
    #[inline(never)]
    fn look_at(&mut self, x: &Lanes, z: &Lanes) {
        const QUARTER: usize = DIRECTIONS / 4;
        const HALF: usize = DIRECTIONS / 2;
        self.raise(0, x);
        self.raise(QUARTER, z);
        for i in 1..QUARTER {
            let d = self.directions[i];
            self.raise(i, &std::array::from_fn(|l| d.y * z[l] + d.x * x[l]));
            self.raise(HALF - i, &std::array::from_fn(|l| d.y * z[l] - d.x * x[l]));
        }
        for (x, z) in x.iter().zip(z) {
            self.squares[0] += x * x;
            self.squares[1] += x * z;
            self.squares[2] += z * z;
        }
        self.fit_ellipse();
    }

    /// Slopes along the direction `i`, and with the other sign along the opposite one.
    fn raise(&mut self, i: usize, along: &Lanes) {
        let (mut up, mut down) = (*along, along.map(|value| -value));
        let mut count = LANES / 2;
        while count > 0 {
            for lane in 0..count {
                up[lane] = larger(up[lane + count], up[lane]);
                down[lane] = larger(down[lane + count], down[lane]);
            }
            count /= 2;
        }
        let opposite = i + DIRECTIONS / 2;
        self.most[i] = larger(up[0], self.most[i]);
        self.most[opposite] = larger(down[0], self.most[opposite]);
    }

    /// Of the ellipses with the shape of the slopes' covariance, the largest that exceeds the largest slope along no direction.
    fn fit_ellipse(&mut self) {
        let [xx, xz, zz] = self.squares;
        // Waves along one direction have no such shape.
        let round = 1e-9 * (xx + zz);
        let (xx, zz) = (xx + round, zz + round);
        let size = (self.most.iter().zip(&self.directions)).map(|(most, d)| {
            most * most / (xx * d.x * d.x + 2.0 * xz * d.x * d.y + zz * d.y * d.y)
        });
        let size = size.fold(f64::INFINITY, f64::min) * (1.0 - 1e-9);
        let scale = 1.0 / (size * (xx * zz - xz * xz));
        self.ellipse = [zz * scale, -2.0 * xz * scale, xx * scale];
    }
}
