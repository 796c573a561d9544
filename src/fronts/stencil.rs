//! One upwind update of the eikonal equation |∇φ| = F on a grid, and the array it works on.
//!
//! Along each axis the neighbour that the front reaches first is upwind. First order: (φ − φ₁)/h. Second order, where the next cell on
//! that side was reached still earlier: (3 φ − 4 φ₁ + φ₂)/(2 h). The squares of these differences sum to F².
//!
//! Source: Sethian, "A fast marching level set method for monotonically advancing fronts", PNAS 93 (1996); Rickett and Fomel,
//! "A second-order fast marching eikonal solver" (2000).

use super::Grid;

/// Layers of cells around the grid that are never reached, so that no update asks whether a neighbour exists.
const PAD: usize = 2;

/// Slope of the times up to which a valley is one: more is a kink.
const VALLEY: f64 = 0.2;

/// Order of the differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The error falls with the first power of the step.
    First,
    /// With the second power, where the front is smooth.
    Second,
}

/// Times at which the front reaches the cells of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrivals {
    /// The grid.
    pub grid: Grid,
    /// Times with the padding, m; infinite where the front does not come.
    pub(super) padded: Vec<f64>,
    /// Distances in `padded` to the next cell along x, z and depth.
    pub(super) strides: [usize; 3],
}

impl Arrivals {
    pub(super) const PAD: usize = PAD;

    /// A grid that no front has reached.
    pub(super) fn none(grid: &Grid) -> Self {
        let [nx, nz, nd] = grid.size.map(|n| n + 2 * PAD);
        Self {
            grid: *grid,
            padded: vec![f64::INFINITY; nx * nz * nd],
            strides: [1, nx, nx * nz],
        }
    }

    /// Place of a cell in the padded array.
    pub(super) fn place(&self, cell: [usize; 3]) -> usize {
        let steps = cell.iter().zip(self.strides);
        steps.map(|(i, stride)| (i + PAD) * stride).sum()
    }

    /// The time at which the front reaches a cell, m; `None` where it does not come.
    pub fn time_m(&self, cell: [usize; 3]) -> Option<f64> {
        let time_m = self.padded[self.place(cell)];
        time_m.is_finite().then_some(time_m)
    }

    /// Number of cells that the front does not reach.
    pub fn unreached(&self) -> usize {
        let reached = self.padded.iter().filter(|time_m| time_m.is_finite());
        self.grid.cells() - reached.count()
    }

    /// Bytes of the array.
    pub fn bytes(grid: &Grid) -> u64 {
        let cells = grid.size.map(|n| (n + 2 * PAD) as u64);
        8 * cells.iter().product::<u64>()
    }
}

/// An update of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stencil {
    strides: [usize; 3],
    /// 1 / h² along each axis.
    weights: [f64; 3],
    second: bool,
    /// Largest rise of the times, from a neighbour to the next cell beyond, that counts as a valley along each axis; 0 if valleys are not
    /// treated.
    valleys: [f64; 3],
}

/// What one axis adds to the equation: weight · (φ − anchor)², and the neighbour's time.
#[derive(Clone, Copy)]
struct Term {
    neighbour: f64,
    anchor: f64,
    weight: f64,
}

impl Stencil {
    pub(super) fn of(arrivals: &Arrivals, order: Order) -> Self {
        Self {
            strides: arrivals.strides,
            weights: (1.0 / (arrivals.grid.step_m * arrivals.grid.step_m)).to_array(),
            second: order == Order::Second,
            valleys: [0.0; 3],
        }
    }

    /// An update of second order that keeps the slope in valleys of the times.
    pub(super) fn polishing(arrivals: &Arrivals) -> Self {
        Self {
            valleys: (VALLEY * arrivals.grid.step_m).to_array(),
            ..Self::of(arrivals, Order::Second)
        }
    }

    /// The time at `place` that follows from its neighbours at cost `cost`; infinite if none has been reached.
    #[inline]
    pub(super) fn update(&self, times: &[f64], place: usize, cost: f64) -> f64 {
        let mut terms = [Term {
            neighbour: f64::INFINITY,
            anchor: 0.0,
            weight: 0.0,
        }; 3];
        let mut count = 0;
        for axis in 0..3 {
            let (stride, weight) = (self.strides[axis], self.weights[axis]);
            let (before, after) = (times[place - stride], times[place + stride]);
            let (neighbour, next) = if before <= after {
                (before, place - 2 * stride)
            } else {
                (after, place + 2 * stride)
            };
            if neighbour == f64::INFINITY {
                continue;
            }
            let mut term = Term {
                neighbour,
                anchor: neighbour,
                weight,
            };
            if self.second {
                let further = times[next];
                let rise = further - neighbour;
                if rise <= 0.0 || rise < self.valleys[axis] {
                    term.anchor = neighbour + (neighbour - further) * (1.0 / 3.0);
                    term.weight = 2.25 * weight;
                    // In a valley the cell may be earlier than its neighbour.
                    term.neighbour = neighbour.min(term.anchor);
                }
            }
            insert(&mut terms, &mut count, term);
        }
        if count == 0 {
            return f64::INFINITY;
        }
        solve(&terms[..count], cost)
    }
}

/// Adds a term to the first `count`, which stay in the order in which the front reaches the neighbours.
#[inline]
fn insert(terms: &mut [Term; 3], count: &mut usize, term: Term) {
    let mut at = *count;
    while at > 0 && terms[at - 1].neighbour > term.neighbour {
        terms[at] = terms[at - 1];
        at -= 1;
    }
    terms[at] = term;
    *count += 1;
}

/// The root of Σ weight (φ − anchor)² = cost² over as many terms, from the first on, as the front has reached by then.
#[inline]
fn solve(terms: &[Term], cost: f64) -> f64 {
    // Relative to the first anchor, so that nothing cancels.
    let base = terms[0].anchor;
    let (mut weights, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let mut root = 0.0;
    for (number, term) in terms.iter().enumerate() {
        let anchor = term.anchor - base;
        if number > 0 && term.neighbour - base >= root {
            break;
        }
        weights += term.weight;
        sum += term.weight * anchor;
        squares += term.weight * anchor * anchor;
        let discriminant = sum * sum - weights * (squares - cost * cost);
        if discriminant < 0.0 {
            break;
        }
        let next = (sum + discriminant.sqrt()) / weights;
        // A term of second order may ask for a time before its own neighbour's.
        if next < term.neighbour - base {
            break;
        }
        root = next;
    }
    base + root
}
