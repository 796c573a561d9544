//! The sides of the box: where rays come in from water outside, the times are given by the water extended along its tangents.
//!
//! Without them, the first cells at a side would send a circular front into the box, which looks curved and so too bright. A front whose
//! rays have the unit direction u runs along a side at the cost √(1 − u²ₙ), n the side's normal. Two passes per side, as the paper: a
//! front of cost 1 from the water's edge carries the directions to all cells of the side; a second front runs at the costs that follow.
//! First the same is done along the side's own upright edges.
//!
//! Two things differ from the paper. Its cost is 1 / cos θ for a tangent that rises at θ; the time to the cell below is h cos θ,
//! and so is our cost. And only cells where rays come in are given; where rays leave the box, the inside knows better and the upwind
//! differences need no value.
//!
//! Source: Mercier, §3.2 and algorithm 2.

use glam::DVec3;

use super::heap_march::march_with;
use super::{Front, Grid, Order, Problem, Start, march};

/// Rays count as coming in above this component of their direction.
const COMES_IN: f64 = 1e-9;

/// A side of the box: the axis (0 for x, 1 for z) that it closes, and whether it stands at that axis's end.
#[derive(Clone, Copy)]
struct Side {
    axis: usize,
    at_end: bool,
}

impl Side {
    /// Index along the axis.
    fn index(self, grid: &Grid) -> usize {
        if self.at_end {
            grid.size[self.axis] - 1
        } else {
            0
        }
    }

    /// Whether a ray of this direction comes in.
    fn comes_in(self, direction: DVec3) -> bool {
        let inwards = if self.at_end { -1.0 } else { 1.0 };
        inwards * direction[self.axis] > COMES_IN
    }
}

/// All given times of a front: its narrow band, and the cells at the sides where rays come in.
pub fn with_sides(grid: &Grid, front: &Front, order: Order) -> Vec<Start> {
    let mut starts = front.starts.clone();
    for axis in [0, 1] {
        for at_end in [false, true] {
            if grid.size[axis] > 1 {
                starts.extend(side(grid, front, order, Side { axis, at_end }));
            }
        }
    }
    // A cell of two sides has the earlier time.
    starts.sort_by(|a, b| a.index.cmp(&b.index).then(a.time_m.total_cmp(&b.time_m)));
    starts.dedup_by_key(|start| start.index);
    starts
}

/// Given times of the cells of a side, below the narrow band.
fn side(grid: &Grid, front: &Front, order: Order, side: Side) -> Vec<Start> {
    let other = 1 - side.axis;
    let at = side.index(grid);
    let mut plane = *grid;
    plane.size[side.axis] = 1;
    let to_volume = |mut cell: [usize; 3]| {
        cell[side.axis] = at;
        cell
    };
    let column = |along: usize| {
        let mut cell = [at; 2];
        cell[other] = along;
        &front.columns[cell[0] + grid.size[0] * cell[1]]
    };
    let closed: Vec<usize> = (0..plane.size[other])
        .map(|along| column(along).air)
        .collect();
    // The band's cells, with their index in the plane.
    let mut starts: Vec<Start> = Vec::new();
    for along in 0..plane.size[other] {
        for k in column(along).air..column(along).band_end {
            let mut cell = [0, 0, k];
            cell[other] = along;
            let found = front
                .starts
                .binary_search_by_key(&grid.index(to_volume(cell)), |start| start.index);
            if let Ok(found) = found {
                starts.push(Start {
                    index: plane.index(cell),
                    ..front.starts[found]
                });
            }
        }
    }
    let band = starts.len();
    // Upright edges: straight down from the band, at the cost of the ray at its end.
    if plane.size[other] > 1 {
        for at_end in [false, true] {
            let edge = Side {
                axis: other,
                at_end,
            };
            let along = edge.index(&plane);
            let ends = (starts[..band].iter())
                .filter(|start| plane.cell(start.index)[other] == along)
                .max_by_key(|start| start.index);
            let Some(last) = ends.copied().filter(|last| edge.comes_in(last.direction)) else {
                continue;
            };
            let cost = last.direction.z.abs();
            let from = plane.cell(last.index)[2];
            for k in from + 1..plane.size[2] {
                let mut cell = [0, 0, k];
                cell[other] = along;
                starts.push(Start {
                    index: plane.index(cell),
                    time_m: last.time_m + (k - from) as f64 * plane.step_m.z * cost,
                    direction: last.direction,
                });
            }
        }
    }
    // First pass: directions spread at cost 1.
    let mut directions = vec![DVec3::ZERO; plane.cells()];
    for start in &starts {
        directions[start.index] = start.direction;
    }
    let spread = Problem {
        grid: &plane,
        starts: &starts[..band],
        closed: closed.clone(),
        costs: Vec::new(),
        order: Order::First,
    };
    march_with(&spread, |cell, from| directions[cell] = directions[from]);
    // Second pass: the front itself.
    let cost = |direction: &DVec3| {
        let normal = direction[side.axis];
        (1.0 - normal * normal).max(0.0).sqrt()
    };
    let run = Problem {
        grid: &plane,
        starts: &starts,
        closed,
        costs: directions.iter().map(cost).collect(),
        order,
    };
    let times = march(&run);
    let mut given = Vec::new();
    for (index, direction) in directions.into_iter().enumerate() {
        let cell = plane.cell(index);
        let below = cell[2] >= column(cell[other]).band_end;
        if let Some(time_m) = times
            .time_m(cell)
            .filter(|_| below && side.comes_in(direction))
        {
            given.push(Start {
                index: grid.index(to_volume(cell)),
                time_m,
                direction,
            });
        }
    }
    given
}
