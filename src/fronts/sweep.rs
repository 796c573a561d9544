//! The parallel solver: slice by slice, all cells of a slice at the same time.
//!
//! Light goes mostly down, so a cell depends strongly on the cell above and weakly on its neighbours in the slice: where the front is
//! inclined by α, an error of a neighbour arrives multiplied by about tan α. So a few rounds over a slice settle it. Sweeps down and up
//! are repeated until a whole sweep changes nothing, so fronts that move upwards are found as well. The result solves the same
//! equations as fast marching. It does not depend on the number of threads: a round reads only the round before.
//!
//! Source: Zhao, "A fast sweeping method for eikonal equations", Math. Comp. 74 (2005), and Jeong and Whitaker, "A fast iterative
//! method for eikonal equations", SIAM J. Sci. Comput. 30 (2008): the ideas; the order of the work is ours.

use rayon::prelude::*;

use super::stencil::Stencil;
use super::{Arrivals, Order, Problem};

/// Changes below this share of a cell count as none.
const SETTLED: f64 = 1e-6;

/// The most rounds over a slice in one visit.
const MOST_ROUNDS: usize = 400;

/// The most sweeps.
const MOST_SWEEPS: usize = 64;

/// The same where times are polished: the corrections are small, and beside shocks some cells never rest.
const POLISHING_ROUNDS: usize = 40;
const POLISHING_SWEEPS: usize = 4;

/// What the parallel solver did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepReport {
    /// Sweeps through all slices, including the last, which changed nothing.
    pub sweeps: usize,
    /// Rounds over single slices.
    pub rounds: usize,
    /// Cell updates.
    pub updates: u64,
    /// Whether a whole sweep changed nothing in the end.
    pub settled: bool,
}

/// Solves the problem of fast marching by sweeps.
pub fn sweep(problem: &Problem<'_>) -> (Arrivals, SweepReport) {
    let grid = problem.grid;
    let mut arrivals = Arrivals::none(grid);
    let open = open_cells(problem, &arrivals);
    for start in problem.starts {
        let place = arrivals.place(grid.cell(start.index));
        arrivals.padded[place] = start.time_m;
    }
    let solver = Solver {
        most: [MOST_ROUNDS, MOST_SWEEPS],
        problem,
        stencil: Stencil::of(&arrivals, problem.order),
        open: &open,
        enough_m: SETTLED * grid.step_m.min_element(),
    };
    let report = solver.run(&mut arrivals);
    (arrivals, report)
}

/// Polishes times of second order, however they were found.
///
/// In a valley of the times along an axis, between rays that part, fast marching takes the slope as 0 or by a difference of first order.
/// That is a small error of the times, but it changes from one cell to the next, so it shows in the curvature: on a sphere
/// by 30 %, on every grid, next to the planes in which such cells lie. A polished cell takes the slope there by a difference of second
/// order across the valley. Cells on both sides then depend on each other; a heap cannot do that, rounds can.
pub fn polish(problem: &Problem<'_>, arrivals: &mut Arrivals) -> SweepReport {
    let open = open_cells(problem, arrivals);
    let solver = Solver {
        most: [POLISHING_ROUNDS, POLISHING_SWEEPS],
        problem,
        stencil: Stencil::polishing(arrivals),
        open: &open,
        enough_m: SETTLED * problem.grid.step_m.min_element(),
    };
    solver.run(arrivals)
}

/// Cells that updates may change, with the padding.
fn open_cells(problem: &Problem<'_>, arrivals: &Arrivals) -> Vec<bool> {
    let grid = problem.grid;
    let mut open = vec![false; arrivals.padded.len()];
    for k in 0..grid.size[2] {
        for j in 0..grid.size[1] {
            let first = arrivals.place([0, j, k]);
            for (i, open) in open[first..][..grid.size[0]].iter_mut().enumerate() {
                *open = !problem.is_closed([i, j, k]);
            }
        }
    }
    for start in problem.starts {
        open[arrivals.place(grid.cell(start.index))] = false;
    }
    open
}

struct Solver<'a> {
    problem: &'a Problem<'a>,
    stencil: Stencil,
    open: &'a [bool],
    enough_m: f64,
    /// The most rounds over a slice in one visit, and the most sweeps.
    most: [usize; 2],
}

impl Solver<'_> {
    /// Sweeps down and up until nothing changes.
    fn run(&self, arrivals: &mut Arrivals) -> SweepReport {
        let mut report = SweepReport {
            sweeps: 0,
            rounds: 0,
            updates: 0,
            settled: false,
        };
        let mut next = vec![f64::INFINITY; arrivals.strides[2]];
        let slices = self.problem.grid.size[2];
        while report.sweeps < self.most[1] && !report.settled {
            let down = report.sweeps.is_multiple_of(2);
            let mut changed = false;
            for step in 0..slices {
                let k = if down { step } else { slices - 1 - step };
                changed |= self.settle(arrivals, &mut next, k, &mut report);
            }
            report.sweeps += 1;
            report.settled = !changed;
        }
        report
    }

    /// Rounds over slice `k` until it settles. Returns whether anything changed.
    fn settle(
        &self,
        arrivals: &mut Arrivals,
        next: &mut [f64],
        k: usize,
        report: &mut SweepReport,
    ) -> bool {
        let (depth, width) = (self.problem.grid.size[1], arrivals.strides[1]);
        let mut active = vec![true; depth];
        let mut changed_at_all = false;
        for _ in 0..self.most[0] {
            let times = &arrivals.padded;
            // Rows of the slice with its padding; row j of the grid is row j + 2.
            let rows = next.par_chunks_mut(width).enumerate();
            let moved: Vec<Option<f64>> = rows
                .map(|(row, next)| {
                    let j = row.checked_sub(Arrivals::PAD).filter(|j| *j < depth)?;
                    active[j].then(|| self.round(arrivals, times, next, [j, k]))
                })
                .collect();
            let moved = &moved[Arrivals::PAD..][..depth];
            report.rounds += 1;
            for (j, moved_m) in moved.iter().enumerate() {
                let Some(moved_m) = moved_m else { continue };
                report.updates += self.problem.grid.size[0] as u64;
                if *moved_m > 0.0 {
                    let first = arrivals.place([0, j, k]);
                    let from = (j + Arrivals::PAD) * width + Arrivals::PAD;
                    let count = self.problem.grid.size[0];
                    arrivals.padded[first..][..count].copy_from_slice(&next[from..][..count]);
                }
            }
            let is_moved = |j: usize| moved[j].is_some_and(|moved_m| moved_m > self.enough_m);
            changed_at_all |= (0..depth).any(is_moved);
            let reach = if self.problem.order == Order::Second {
                2
            } else {
                1
            };
            active = (0..depth)
                .map(|j| (j.saturating_sub(reach)..=(j + reach).min(depth - 1)).any(is_moved))
                .collect();
            if !active.contains(&true) {
                break;
            }
        }
        changed_at_all
    }

    /// One round over a row: new times into `next`, with its padding. Returns the largest change, m.
    fn round(
        &self,
        arrivals: &Arrivals,
        times: &[f64],
        next: &mut [f64],
        [j, k]: [usize; 2],
    ) -> f64 {
        let grid = self.problem.grid;
        let first = arrivals.place([0, j, k]);
        let mut most_m: f64 = 0.0;
        for i in 0..grid.size[0] {
            let place = first + i;
            let old_m = times[place];
            let mut new_m = old_m;
            if self.open[place] {
                let cost = self.problem.cost(grid.index([i, j, k]));
                new_m = self.stencil.update(times, place, cost);
                if new_m != old_m {
                    let moved_m = (new_m - old_m).abs();
                    most_m = most_m.max(if moved_m.is_nan() { 0.0 } else { moved_m });
                }
            }
            next[Arrivals::PAD + i] = new_m;
        }
        most_m
    }
}
