//! The narrow band: cells next to the water, with the time at which the front reaches them.
//!
//! The time is measured to the surface itself, not to its nearest vertex; the paper names the latter as the cause of its noise. The
//! point q of the surface whose ray meets the cell is found by Newton's method. With slowness e, tangents a of the surface and the ray's
//! direction u, where u − e is normal to the surface and |u| = 1, it is the q with (p − q)·a = ((p − q)·u)(e·a).
//! Then φ = e·q + (p − q)·u. For e = 0 this is the signed distance to the surface.
//!
//! Source: Mercier, algorithm 1, §5.1 and §5.4 (distance to the surface as the remedy); Fermat's principle.

use glam::{DMat2, DVec2, DVec3};
use rayon::prelude::*;

use super::{Frame, FrontError, Grid};

/// Steps of Newton's method.
const MOST_STEPS: usize = 40;

/// Steps of Newton's method stop below this share of a cell. The error of a time is of second order in the error of the point.
const ENOUGH: f64 = 1e-6;

/// Height and slope of the water at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// Height above the level of the water, m.
    pub height_m: f64,
    /// (∂h/∂x, ∂h/∂z).
    pub slope: DVec2,
}

/// A cell whose time is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Its index in the grid.
    pub index: usize,
    /// The time at which the front reaches it, as a path in water, m; negative in the air.
    pub time_m: f64,
    /// Unit direction of its ray.
    pub direction: DVec3,
}

/// The water above a column of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Point of the surface in model coordinates, m.
    pub surface_m: DVec3,
    /// Unit direction of the ray that enters there.
    pub direction: DVec3,
    /// The time at which it enters, m.
    pub time_m: f64,
    /// Cells of the column from the top that are in the air and not in the narrow band.
    pub air: usize,
    /// Cells of the column from the top to the end of the narrow band.
    pub band_end: usize,
}

/// The narrow band.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// The cells of the band, by index.
    pub starts: Vec<Start>,
    /// The columns, x fastest.
    pub columns: Vec<Column>,
    /// Cells for which Newton's method did not come to rest; their times belong to its last point.
    pub unsettled: usize,
}

/// A point of the surface, with what a step of Newton's method needs.
struct Foot {
    point_m: DVec3,
    tangents: [DVec3; 2],
    direction: DVec3,
}

/// The water as a map from (x, z) to the model.
struct Surface<'a, F> {
    frame: &'a Frame,
    water: &'a F,
}

impl<F: Fn(DVec2) -> Height> Surface<'_, F> {
    fn height(&self, at_m: DVec2) -> Result<Height, FrontError> {
        let found = (self.water)(at_m);
        if found.height_m.is_finite() && found.slope.is_finite() {
            return Ok(found);
        }
        Err(FrontError::Water {
            x_m: at_m.x,
            z_m: at_m.y,
            height_m: found.height_m,
            slope: found.slope.to_array(),
        })
    }

    fn foot(&self, at_m: DVec2) -> Result<Foot, FrontError> {
        let Height { height_m, slope } = self.height(at_m)?;
        let map = &self.frame.model_from_surface;
        let tangents = [
            DVec3::new(1.0, 0.0, -slope.x),
            DVec3::new(0.0, 1.0, -slope.y),
        ]
        .map(|t| *map * t);
        let normal = tangents[0].cross(tangents[1]).normalize();
        let down = normal * normal.z.signum();
        // u = e + λ N with |u| = 1.
        let e = self.frame.slowness;
        let along = e.dot(down);
        let lambda = (along * along + 1.0 - e.length_squared()).sqrt() - along;
        Ok(Foot {
            point_m: *map * at_m.extend(-height_m),
            tangents,
            direction: e + lambda * down,
        })
    }

    /// Where the surface stands above the model point (X, Z).
    fn above(&self, model_m: DVec2, enough_m: f64) -> Result<DVec2, FrontError> {
        let map = &self.frame.model_from_surface;
        let across = DMat2::from_cols(map.x_axis.truncate(), map.y_axis.truncate()).inverse();
        let mut at_m = across * model_m;
        for _ in 0..MOST_STEPS {
            let height_m = self.height(at_m)?.height_m;
            let next_m = across * (model_m + height_m * map.z_axis.truncate());
            let moved_m = next_m.distance(at_m);
            at_m = next_m;
            if moved_m < enough_m {
                break;
            }
        }
        Ok(at_m)
    }

    /// Time and direction at the model point `p_m`, from the guess `at_m`; whether Newton's method came to rest.
    fn arrival(
        &self,
        p_m: DVec3,
        mut at_m: DVec2,
        enough_m: f64,
    ) -> Result<(f64, DVec3, bool), FrontError> {
        let e = self.frame.slowness;
        let mut settled = false;
        let mut foot = self.foot(at_m)?;
        for _ in 0..MOST_STEPS {
            let gap_m = p_m - foot.point_m;
            let path_m = gap_m.dot(foot.direction);
            let [a, b] = foot.tangents;
            let miss = DVec2::new(
                gap_m.dot(a) - path_m * e.dot(a),
                gap_m.dot(b) - path_m * e.dot(b),
            );
            // The change of the tangents is left out: the band is thin, so each step still shrinks the miss.
            let row = |t: DVec3| {
                let by = |s: DVec3| t.dot(s) - e.dot(t) * s.dot(foot.direction);
                DVec2::new(by(a), by(b))
            };
            let matrix = DMat2::from_cols(row(a), row(b)).transpose();
            let step_m = matrix.inverse() * miss;
            if step_m.length() < enough_m {
                settled = true;
                break;
            }
            at_m += step_m;
            foot = self.foot(at_m)?;
        }
        let path_m = (p_m - foot.point_m).dot(foot.direction);
        Ok((e.dot(foot.point_m) + path_m, foot.direction, settled))
    }
}

impl Front {
    /// The narrow band of `water` in a grid of model coordinates: `band` cells (1 … 8) on each side of the surface, more where it is
    /// steep. Second order needs 2.
    ///
    /// # Errors
    /// Water that is not finite or stands above the grid; a band out of range.
    pub fn of<F>(grid: &Grid, frame: &Frame, water: &F, band: f64) -> Result<Self, FrontError>
    where
        F: Fn(DVec2) -> Height + Sync,
    {
        if !(1.0..=8.0).contains(&band) {
            return Err(FrontError::Setting {
                setting: "band",
                value: band,
                accepted: "1 to 8 cells",
            });
        }
        let surface = Surface { frame, water };
        let rows = (0..grid.size[1]).into_par_iter().map(|j| {
            let columns = (0..grid.size[0]).map(|i| surface.column(grid, [i, j], band));
            columns.collect::<Result<Vec<_>, _>>()
        });
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        let mut front = Self {
            starts: Vec::new(),
            columns: Vec::with_capacity(grid.slice()),
            unsettled: 0,
        };
        for (column, starts, unsettled) in rows.into_iter().flatten() {
            front.columns.push(column);
            front.starts.extend(starts);
            front.unsettled += unsettled;
        }
        front.starts.sort_unstable_by_key(|start| start.index);
        Ok(front)
    }
}

impl<F: Fn(DVec2) -> Height> Surface<'_, F> {
    /// A column, its cells in the band, and how many of them are unsettled.
    fn column(
        &self,
        grid: &Grid,
        [i, j]: [usize; 2],
        band: f64,
    ) -> Result<(Column, Vec<Start>, usize), FrontError> {
        let step_m = grid.step_m;
        let enough_m = ENOUGH * step_m.min_element();
        let top_m = grid.point_m([i, j, 0]);
        let at_m = self.above(top_m.truncate(), enough_m)?;
        let foot = self.foot(at_m)?;
        let depth_m = foot.point_m.z;
        if depth_m < top_m.z - 0.5 * step_m.z {
            return Err(FrontError::AboveGrid {
                x_m: top_m.x,
                z_m: top_m.y,
                above_m: top_m.z - depth_m,
            });
        }
        // How much the depth of the surface changes to the next cell.
        let normal = foot.tangents[0].cross(foot.tangents[1]);
        let rise_m = (normal.x.abs() * step_m.x + normal.y.abs() * step_m.y) / normal.z.abs();
        let half_m = band * (step_m.z + rise_m);
        let cells_above = |edge_m: f64| {
            let count = ((edge_m - top_m.z) / step_m.z).ceil();
            count.clamp(0.0, grid.size[2] as f64) as usize
        };
        let (air, band_end) = (cells_above(depth_m - half_m), cells_above(depth_m + half_m));
        let mut unsettled = 0;
        let mut starts = Vec::with_capacity(band_end - air);
        for k in air..band_end {
            let cell = [i, j, k];
            let (time_m, direction, settled) = self.arrival(grid.point_m(cell), at_m, enough_m)?;
            unsettled += usize::from(!settled);
            starts.push(Start {
                index: grid.index(cell),
                time_m,
                direction,
            });
        }
        let column = Column {
            surface_m: foot.point_m,
            direction: foot.direction,
            time_m: self.frame.slowness.dot(foot.point_m),
            air,
            band_end,
        };
        Ok((column, starts, unsettled))
    }
}
