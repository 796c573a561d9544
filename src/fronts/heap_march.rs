//! Fast marching: cells are accepted in the order in which the front reaches them, with a binary heap.
//!
//! Source: Mercier, algorithm 1; Sethian (1996).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::stencil::Stencil;
use super::{Arrivals, Front, Grid, Order, Start};

/// Cells whose times are given, cells that are closed, and the costs of the others.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// The grid.
    pub grid: &'a Grid,
    /// Given times.
    pub starts: &'a [Start],
    /// The first cells of each column that the front never enters, x fastest; empty if there are none.
    pub closed: Vec<usize>,
    /// Cost F of each cell; empty for 1 everywhere.
    pub costs: Vec<f64>,
    /// Order of the differences.
    pub order: Order,
}

impl<'a> Problem<'a> {
    /// Water below a front.
    pub fn below(grid: &'a Grid, front: &Front, starts: &'a [Start], order: Order) -> Self {
        Self {
            grid,
            starts,
            closed: front.columns.iter().map(|column| column.air).collect(),
            costs: Vec::new(),
            order,
        }
    }

    /// Cost of the cell with this index.
    pub(super) fn cost(&self, index: usize) -> f64 {
        self.costs.get(index).copied().unwrap_or(1.0)
    }

    /// Whether the front never enters a cell.
    pub(super) fn is_closed(&self, [i, j, k]: [usize; 3]) -> bool {
        let column = i + self.grid.size[0] * j;
        self.closed.get(column).is_some_and(|closed| k < *closed)
    }
}

/// A time in the heap; the earliest comes first, and of equal times the cell that comes first in the array.
#[derive(Clone, Copy, PartialEq)]
struct Trial {
    time_m: f64,
    place: u32,
}

impl Eq for Trial {}

impl Ord for Trial {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_time = other.time_m.total_cmp(&self.time_m);
        by_time.then_with(|| other.place.cmp(&self.place))
    }
}

impl PartialOrd for Trial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Mark of a cell whose time no update changes.
const KEPT: f64 = f64::NEG_INFINITY;

/// Marches through the grid.
pub fn march(problem: &Problem<'_>) -> Arrivals {
    march_with(problem, |_, _| {})
}

/// Marches, and calls `accepted` for each cell that was not given, with the index of the neighbour that the front reached first.
pub(super) fn march_with(
    problem: &Problem<'_>,
    mut accepted: impl FnMut(usize, usize),
) -> Arrivals {
    let grid = problem.grid;
    let mut arrivals = Arrivals::none(grid);
    let stencil = Stencil::of(&arrivals, problem.order);
    let strides = arrivals.strides;
    // The padding and closed cells are kept as they are.
    let mut trials = vec![KEPT; arrivals.padded.len()];
    for k in 0..grid.size[2] {
        for j in 0..grid.size[1] {
            let first = arrivals.place([0, j, k]);
            for (i, trial) in trials[first..][..grid.size[0]].iter_mut().enumerate() {
                if !problem.is_closed([i, j, k]) {
                    *trial = f64::INFINITY;
                }
            }
        }
    }
    let mut given: Vec<Trial> = Vec::with_capacity(problem.starts.len());
    for start in problem.starts {
        let place = arrivals.place(grid.cell(start.index));
        trials[place] = KEPT;
        given.push(Trial {
            time_m: start.time_m,
            place: place as u32,
        });
    }
    // The earliest is last.
    given.sort_unstable();
    let mut heap: BinaryHeap<Trial> = BinaryHeap::new();
    let index_of = |place: usize| index_of(grid, strides, place);
    loop {
        let from_heap = match (given.last(), heap.peek()) {
            (None, None) => break,
            (Some(given), Some(trial)) => trial > given,
            (given, _) => given.is_none(),
        };
        let next = if from_heap { heap.pop() } else { given.pop() };
        let Some(Trial { time_m, place }) = next else {
            break;
        };
        let place = place as usize;
        // An entry is out of date if the cell was updated since.
        if from_heap && (trials[place] != time_m || arrivals.padded[place].is_finite()) {
            continue;
        }
        arrivals.padded[place] = time_m;
        if from_heap {
            let neighbours = strides.iter().flat_map(|s| [place - s, place + s]);
            let first =
                neighbours.min_by(|a, b| arrivals.padded[*a].total_cmp(&arrivals.padded[*b]));
            if let Some(first) = first {
                accepted(index_of(place), index_of(first));
            }
        }
        for neighbour in strides.iter().flat_map(|s| [place - s, place + s]) {
            if trials[neighbour] == KEPT || arrivals.padded[neighbour].is_finite() {
                continue;
            }
            let cost = if problem.costs.is_empty() {
                1.0
            } else {
                problem.cost(index_of(neighbour))
            };
            let time_m = stencil.update(&arrivals.padded, neighbour, cost);
            if time_m != trials[neighbour] {
                trials[neighbour] = time_m;
                heap.push(Trial {
                    time_m,
                    place: neighbour as u32,
                });
            }
        }
    }
    arrivals
}

/// Index in the grid of a place in the padded array.
fn index_of(grid: &Grid, strides: [usize; 3], place: usize) -> usize {
    let pad = Arrivals::PAD;
    let k = place / strides[2];
    let j = place % strides[2] / strides[1];
    let i = place % strides[1];
    grid.index([i - pad, j - pad, k - pad])
}
