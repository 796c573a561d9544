//! Where the rays start: a square lattice, rotated so that no texel edge runs along its rows.
//!
//! The lattice of the Gaussian integer p + iq holds the points (a p − b q, a q + b p)/M, M = p² + q², of integer a and b. It
//! repeats with every cell and has exactly M points in each, so flat water gives every texel the same count, to the ray. With
//! q/p near the golden section and small partial quotients, lines along the texel edges meet the points evenly; wavy edges
//! are sampled no worse. (Known from numerical integration as the Fibonacci lattice when p and q are Fibonacci numbers: Niederreiter,
//! Random Number Generation and Quasi-Monte Carlo Methods, 1992, §5.)

use glam::DVec2;

use super::window::LightWindow;

/// Points of the second half's lattice per point of the first's, at most. Two shifts of one lattice could be alike by chance
/// where the water varies along one direction only, and the error would look smaller than it is; lattices of different sizes,
/// turned in opposite directions, cannot.
pub(super) const SECOND_HALF: f64 = 0.96;

/// A lattice with `p² + q²` points per cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    p: f64,
    q: f64,
    /// Size of a cell, m: a texel, or several when few rays are wanted.
    cell_m: DVec2,
    /// Shift of the points, in steps and rows, 0 … 1 each.
    shift: DVec2,
    /// 1, or −1 for the mirror image in z.
    side: f64,
}

/// A run of points: `start_m + i · step_m`, `i` below `count`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) start_m: DVec2,
    pub(super) count: u64,
}

impl Lattice {
    /// At most `points_per_texel` points per texel, above 0; turned in one direction, or in the other if `mirrored`.
    pub(super) fn new(points_per_texel: f64, texel_m: DVec2, shift: DVec2, mirrored: bool) -> Self {
        let mut cell_m = texel_m;
        let mut points_per_cell = points_per_texel;
        while points_per_cell < 1.0 {
            cell_m *= 2.0;
            points_per_cell *= 4.0;
        }
        let (p, q) = gaussian_integer(points_per_cell);
        Self {
            p: f64::from(p),
            q: f64::from(q),
            cell_m,
            shift,
            side: if mirrored { -1.0 } else { 1.0 },
        }
    }

    fn points_per_cell(&self) -> f64 {
        self.p * self.p + self.q * self.q
    }

    pub(super) fn points_per_texel(&self, texel_m: DVec2) -> f64 {
        texel_m.x * texel_m.y / self.area_per_point_m2()
    }

    /// Water per point, m².
    pub(super) fn area_per_point_m2(&self) -> f64 {
        self.cell_m.x * self.cell_m.y / self.points_per_cell()
    }

    /// From a point to the next of its row, m.
    pub(super) fn step_m(&self) -> DVec2 {
        DVec2::new(self.p, self.side * self.q) * self.cell_m / self.points_per_cell()
    }

    /// The corners of `window` in cells, as the unmirrored lattice sees it.
    fn corners(&self, window: &LightWindow) -> (DVec2, DVec2) {
        let (low, high) = (window.min_m / self.cell_m, window.max_m / self.cell_m);
        if self.side > 0.0 {
            (low, high)
        } else {
            (DVec2::new(low.x, -high.y), DVec2::new(high.x, -low.y))
        }
    }

    /// Numbers of the first row that meets `window` and the one after the last.
    pub(super) fn rows(&self, window: &LightWindow) -> (i64, i64) {
        let (low, high) = self.corners(window);
        // Along the rows' normal the window reaches from its upper left to its lower right corner.
        let first = -self.q * high.x + self.p * low.y - self.shift.y;
        let last = -self.q * low.x + self.p * high.y - self.shift.y;
        (first.ceil() as i64, last.floor() as i64 + 1)
    }

    /// The points of row `number` within `window`.
    pub(super) fn row(&self, number: i64, window: &LightWindow) -> Row {
        let m = self.points_per_cell();
        let (low, high) = self.corners(window);
        let (low, high) = (low * m, high * m);
        let b = number as f64 + self.shift.y;
        let mut first = (low.x + b * self.q) / self.p;
        let mut last = (high.x + b * self.q) / self.p;
        if self.q > 0.0 {
            first = first.max((low.y - b * self.p) / self.q);
            last = last.min((high.y - b * self.p) / self.q);
        }
        let first = (first - self.shift.x).ceil();
        let count = ((last - self.shift.x).floor() - first + 1.0).max(0.0);
        let a = first + self.shift.x;
        let (x, z) = (a * self.p - b * self.q, a * self.q + b * self.p);
        Row {
            start_m: DVec2::new(x, self.side * z) * self.cell_m / m,
            count: count as u64,
        }
    }
}

/// p and q with p² + q² at most `norm` (1 …) and as near to it as a q/p allows that is near the golden section and has small
/// partial quotients, so that the points are evenly spread along both axes.
fn gaussian_integer(norm: f64) -> (u32, u32) {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let p_near = (norm / (1.0 + golden * golden)).sqrt() as u32;
    let reach = 2 + p_near / 50;
    let mut best = (f64::INFINITY, 1, 0);
    for p in p_near.saturating_sub(reach).max(1)..=p_near + reach {
        let q_near = (f64::from(p) * golden).round() as u32;
        for q in q_near.saturating_sub(reach)..=(q_near + reach).min(p) {
            let short = 1.0 - (f64::from(p).powi(2) + f64::from(q).powi(2)) / norm;
            // On folding waves the error per ray hardly depends on the quotients; a ray not sent costs more. Measured with
            // weights 1 … 1000: flat from 20 on.
            let score = f64::from(worst_quotient(p, q)) + 40.0 * short;
            if short >= 0.0 && score < best.0 {
                best = (score, p, q);
            }
        }
    }
    (best.1, best.2)
}

/// Largest partial quotient of the continued fraction of q/p; `u32::MAX` when they share a factor.
fn worst_quotient(p: u32, q: u32) -> u32 {
    let (mut a, mut b, mut worst) = (p, q, 0);
    while b != 0 {
        worst = worst.max(a / b);
        (a, b) = (b, a % b);
    }
    if a == 1 { worst } else { u32::MAX }
}

/// A fixed pseudo-random number in 0 … 1 for a key (splitmix64: Steele, Lea, Flood, OOPSLA 2014).
pub(super) fn uniform(key: u64) -> f64 {
    let mut z = key.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 11) as f64 * (-53f64).exp2()
}
