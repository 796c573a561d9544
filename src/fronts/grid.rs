//! An even grid of sample points in a box.

use glam::DVec3;

use super::FrontError;

/// The most cells of a grid.
pub const MOST_CELLS: usize = 1 << 28;

/// Sample points `origin_m + index · step_m`. A point is the centre of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Cells along x, z and depth, each at least 1.
    pub size: [usize; 3],
    /// The first sample point, m.
    pub origin_m: DVec3,
    /// Distances of neighbouring sample points along x, z and depth, m, above 0.
    pub step_m: DVec3,
}

impl Grid {
    /// A grid.
    ///
    /// # Errors
    /// No cells, more than [`MOST_CELLS`], or lengths that are not finite and positive.
    pub fn new(size: [usize; 3], origin_m: DVec3, step_m: DVec3) -> Result<Self, FrontError> {
        let refuse = |reason| FrontError::Grid {
            size,
            step_m: step_m.to_array(),
            reason,
        };
        let cells = size
            .iter()
            .try_fold(1_usize, |all, n| all.checked_mul(*n))
            .filter(|cells| (1..=MOST_CELLS).contains(cells));
        if cells.is_none() {
            return Err(refuse("1 to 2^28 cells are accepted"));
        }
        if !(origin_m.is_finite() && step_m.is_finite() && step_m.min_element() > 0.0) {
            return Err(refuse("steps have to be positive and all lengths finite"));
        }
        Ok(Self {
            size,
            origin_m,
            step_m,
        })
    }

    /// A grid whose cells fill the box from `low_m` to `high_m`.
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn filling(size: [usize; 3], low_m: DVec3, high_m: DVec3) -> Result<Self, FrontError> {
        let counts = DVec3::from_array(size.map(|n| n.max(1) as f64));
        let step_m = (high_m - low_m) / counts;
        Self::new(size, low_m + 0.5 * step_m, step_m)
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.size.iter().product()
    }

    /// Cells in a slice of one depth.
    pub fn slice(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// Position of a cell in arrays: x runs fastest, then z, then depth.
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        i + self.size[0] * (j + self.size[1] * k)
    }

    /// The cell at a position in arrays.
    pub fn cell(&self, index: usize) -> [usize; 3] {
        let [nx, nz, _] = self.size;
        [index % nx, index / nx % nz, index / (nx * nz)]
    }

    /// Sample point of a cell, m.
    pub fn point_m(&self, cell: [usize; 3]) -> DVec3 {
        self.origin_m + DVec3::from_array(cell.map(|i| i as f64)) * self.step_m
    }
}
