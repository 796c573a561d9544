//! How much light the first arrival does not show.
//!
//! The eikonal equation keeps the first front that reaches a cell. Light whose rays have crossed others arrives later and is lost: where a
//! caustic has an area, the field has a line. A ray of the water is straight in the model. It is followed down, and where the field
//! says that another front was there before, its light is lost from there on.
//!
//! Source: Mercier, §3.3 and §5.1, describes the loss; the measure is ours.

use rayon::prelude::*;

use super::{Arrivals, Column, Front};

/// A ray is lost where another front was earlier by this share of a cell; less is the error of the times.
const EARLIER: f64 = 0.1;

/// By slice from the top: the share of the rays inside the box that other rays have overtaken. Each column of cells has one ray,
/// all with the same flux.
pub fn lost_shares(arrivals: &Arrivals, front: &Front) -> Vec<f64> {
    let grid = arrivals.grid;
    let margin_m = EARLIER * grid.step_m.min_element();
    (0..grid.size[2])
        .into_par_iter()
        .map(|k| {
            let depth_m = grid.origin_m.z + k as f64 * grid.step_m.z;
            let (mut lost, mut all) = (0_usize, 0_usize);
            for column in &front.columns {
                let path_m = (depth_m - column.surface_m.z) / column.direction.z;
                if let Some(first_m) = first_at(arrivals, column, path_m, k) {
                    all += 1;
                    lost += usize::from(first_m < column.time_m + path_m - margin_m);
                }
            }
            lost as f64 / all.max(1) as f64
        })
        .collect()
}

/// The time of the first front where a ray meets slice `k`, linear between cells; `None` outside and in the air.
fn first_at(arrivals: &Arrivals, column: &Column, path_m: f64, k: usize) -> Option<f64> {
    if path_m < 0.0 {
        return None;
    }
    let grid = arrivals.grid;
    let at = (column.surface_m + column.direction * path_m - grid.origin_m) / grid.step_m;
    let axis = |axis: usize| {
        let most = grid.size[axis] as f64 - 1.0;
        let at = at[axis];
        if !(-1e-9..=most + 1e-9).contains(&at) {
            return None;
        }
        let low = (at.max(0.0) as usize).min(grid.size[axis].saturating_sub(2));
        let high = (low + 1).min(grid.size[axis] - 1);
        Some(([low, high], at - low as f64))
    };
    let (([x0, x1], fx), ([z0, z1], fz)) = (axis(0)?, axis(1)?);
    let time = |i, j| arrivals.time_m([i, j, k]);
    let near = time(x0, z0)? * (1.0 - fx) + time(x1, z0)? * fx;
    let far = time(x0, z1)? * (1.0 - fx) + time(x1, z1)? * fx;
    Some(near * (1.0 - fz) + far * fz)
}
