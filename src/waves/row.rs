//! The surface along rows of evenly spaced points, a block at a time. Blocks are plain arrays, so that the compiler uses vector
//! instructions.

use glam::DVec2;

use super::sines::SineRows;
use super::spline::Spline;
use super::trochoids::Trochoids;

/// Points of a block.
pub const ROW_POINTS: usize = 128;

/// One value per point of a block.
pub(super) type Lanes = [f64; ROW_POINTS];

/// Height and slope at the points of a block.
#[derive(Clone, Debug)]
pub struct RowPoints {
    /// y − level, m.
    pub height_m: [f64; ROW_POINTS],
    /// ∂h/∂x.
    pub slope_x: [f64; ROW_POINTS],
    /// ∂h/∂z.
    pub slope_z: [f64; ROW_POINTS],
}

impl RowPoints {
    /// Flat water.
    pub const FLAT: Self = Self {
        height_m: [0.0; ROW_POINTS],
        slope_x: [0.0; ROW_POINTS],
        slope_z: [0.0; ROW_POINTS],
    };
}

/// A surface along rows with a fixed step; made by [`super::Surface::rows`].
#[derive(Clone, Debug)]
pub struct Rows {
    pub(super) step_m: DVec2,
    pub(super) sines: SineRows,
    pub(super) trochoids: Trochoids,
    pub(super) splines: Vec<Spline>,
}

impl Rows {
    /// Height and slope at [`ROW_POINTS`] points from `start_m`, (x, z), on.
    pub fn evaluate(&self, start_m: DVec2, points: &mut RowPoints) {
        points.clone_from(&RowPoints::FLAT);
        self.sines.evaluate(start_m, points);
        if self.trochoids.count() == 0 && self.splines.is_empty() {
            return;
        }
        for i in 0..ROW_POINTS {
            let at = start_m + self.step_m * i as f64;
            let others = self.splines.iter().map(|spline| spline.at(at.x, at.y));
            for point in others.chain([self.trochoids.at(at.x, at.y)]) {
                points.height_m[i] += point.height_m;
                points.slope_x[i] += point.slope.x;
                points.slope_z[i] += point.slope.y;
            }
        }
    }
}
