//! Curvature of the fronts, and how much brighter the light is than where it entered.
//!
//! The paper takes the Laplacian of the times as the curvature, κ = Δφ, and its brightness as the caustic. Rays are normal to the fronts,
//! so light that has come the path ℓ is as much brighter as the front was larger when it entered. With the front's principal
//! curvatures κ₁ + κ₂ = Δφ, negative where light converges, that is (1 − ℓ κ₁)(1 − ℓ κ₂). We call it the *concentration*. It is 1 for a
//! plane front, and 1 − ℓ Δφ where the water is curved in one direction only.
//!
//! Source: Mercier, eq. 3 and 4; concentration: conservation of flux along a tube of rays, ∇·(I ∇φ) = 0.

use glam::DVec3;
use rayon::prelude::*;

use super::{Arrivals, Frame, Grid};

/// Which curvature is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// The Laplacian alone, as the paper: 1 − ℓ Δφ.
    Laplacian,
    /// Both principal curvatures: 1 − ℓ Δφ + ℓ² K.
    Principal,
}

/// A value per cell of a grid, and the share of the cells that had to be raised to 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Concentration {
    /// The grid.
    pub grid: Grid,
    /// Values ≥ 0, x fastest, then z, then depth; 0 in the air.
    pub values: Vec<f32>,
    /// Share of the cells below the water whose value was negative, and set to 0. It happens where the front is far from smooth.
    pub raised: f64,
}

/// Times around a cell.
struct Around<'a> {
    arrivals: &'a Arrivals,
    cell: [usize; 3],
}

impl Around<'_> {
    fn time(&self, shifts: &[(usize, isize)]) -> Option<f64> {
        let mut cell = self.cell;
        for (axis, shift) in shifts {
            cell[*axis] = cell[*axis].checked_add_signed(*shift)?;
            if cell[*axis] >= self.arrivals.grid.size[*axis] {
                return None;
            }
        }
        self.arrivals.time_m(cell)
    }

    /// Direction of the ray: the gradient, made a unit vector; straight down where it is not known.
    fn direction(&self) -> DVec3 {
        let step_m = self.arrivals.grid.step_m;
        let along = |axis: usize| {
            let [low, here, high] = [-1, 0, 1].map(|shift| self.time(&[(axis, shift)]));
            match (low, here, high) {
                (Some(low), _, Some(high)) => 0.5 * (high - low) / step_m[axis],
                (Some(low), Some(here), None) => (here - low) / step_m[axis],
                (None, Some(here), Some(high)) => (high - here) / step_m[axis],
                _ => 0.0,
            }
        };
        DVec3::new(along(0), along(1), along(2)).normalize_or(DVec3::Z)
    }

    /// Second difference along an axis, 1/m; at the edge of the known times the nearest one inside, 0 without one.
    fn second(&self, axis: usize) -> f64 {
        let h = self.arrivals.grid.step_m[axis];
        [0, 1, -1]
            .into_iter()
            .find_map(|at| {
                let [low, here, high] =
                    [at - 1, at, at + 1].map(|shift| self.time(&[(axis, shift)]));
                Some((low? + high? - 2.0 * here?) / (h * h))
            })
            .unwrap_or(0.0)
    }

    /// Mixed second difference, 1/m; 0 at the edge of the known times.
    fn mixed(&self, a: usize, b: usize) -> f64 {
        let step_m = self.arrivals.grid.step_m;
        let corner = |i: isize, j: isize| self.time(&[(a, i), (b, j)]);
        let found = || {
            let sum = corner(1, 1)? + corner(-1, -1)? - corner(1, -1)? - corner(-1, 1)?;
            Some(sum / (4.0 * step_m[a] * step_m[b]))
        };
        found().unwrap_or(0.0)
    }
}

/// The Laplacian of the times at a cell, 1/m; `None` where the front does not come.
pub fn laplacian_per_m(arrivals: &Arrivals, cell: [usize; 3]) -> Option<f64> {
    arrivals.time_m(cell)?;
    let around = Around { arrivals, cell };
    Some((0..3).map(|axis| around.second(axis)).sum())
}

/// The concentration of light in every cell.
pub fn concentration(arrivals: &Arrivals, frame: &Frame, curvature: Curvature) -> Concentration {
    let grid = arrivals.grid;
    let mut values = vec![0.0_f32; grid.cells()];
    let counts: Vec<[usize; 2]> = (values.par_chunks_mut(grid.slice()).enumerate())
        .map(|(k, slice)| {
            let (mut raised, mut wet) = (0, 0);
            for (at, value) in slice.iter_mut().enumerate() {
                let cell = [at % grid.size[0], at / grid.size[0], k];
                let Some(found) = of_cell(arrivals, frame, cell, curvature) else {
                    continue;
                };
                wet += 1;
                raised += usize::from(found < 0.0);
                *value = found.max(0.0) as f32;
            }
            [raised, wet]
        })
        .collect();
    let [raised, wet] = counts
        .iter()
        .fold([0, 0], |sum, count| [sum[0] + count[0], sum[1] + count[1]]);
    Concentration {
        grid,
        values,
        raised: raised as f64 / (wet.max(1)) as f64,
    }
}

fn of_cell(
    arrivals: &Arrivals,
    frame: &Frame,
    cell: [usize; 3],
    curvature: Curvature,
) -> Option<f64> {
    let time_m = arrivals.time_m(cell)?;
    let around = Around { arrivals, cell };
    let path_m = frame.path_m(arrivals.grid.point_m(cell), time_m, around.direction());
    if path_m < 0.0 {
        return None;
    }
    let [xx, zz, dd] = [0, 1, 2].map(|axis| around.second(axis));
    let linear = 1.0 - path_m * (xx + zz + dd);
    if curvature == Curvature::Laplacian {
        return Some(linear);
    }
    // The second elementary symmetric function of the Hessian's eigenvalues; the one along the ray is 0.
    let [xz, xd, zd] = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| around.mixed(a, b));
    let product = xx * zz + xx * dd + zz * dd - xz * xz - xd * xd - zd * zd;
    Some(linear + path_m * path_m * product)
}
