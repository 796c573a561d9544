//! One step of the waves in a basin with obstacles: heights at the samples, flows at the faces between them.

use rayon::prelude::*;

use super::cells::Cells;
use super::footprint::Footprint;

/// What the absorbing layer leaves of the amplitude of a wave that crosses it at a right angle and comes back.
const LAYER_LEAVES: f64 = 1e-5;

/// Power with which damping grows into the layer.
const LAYER_POWER: i32 = 3;

/// Samples in a piece of work for a thread.
const PIECE_SAMPLES: usize = 16_384;

/// Heights at a step and flows half a step before it.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// The parts of the heights that flows along x and z make, m.
    pub(super) parts_m: [Vec<f64>; 2],
    /// Flows through the faces before the samples along x and z, m²/s.
    pub(super) flows: [Vec<f64>; 2],
    /// Flows as they would be without the layer, m²/s; empty if they are the same or follow from the others.
    pub(super) free: [Vec<f64>; 2],
}

impl State {
    /// The sum of the parts, m.
    pub(super) fn heights_m(&self) -> Vec<f64> {
        let [x, z] = &self.parts_m;
        x.iter().zip(z).map(|(x, z)| x + z).collect()
    }

    /// Bytes of all numbers.
    pub(super) fn bytes(&self) -> u64 {
        let arrays = self.parts_m.iter().chain(&self.flows).chain(&self.free);
        arrays
            .map(|array| size_of_val(array.as_slice()) as u64)
            .sum()
    }
}

/// How waves move on a grid.
pub(super) struct Leapfrog<'a> {
    cells: &'a Cells,
    footprint: &'a Footprint,
    step_s: f64,
    /// Whether flows without the layer are kept: damped water with a layer.
    keeps_free: bool,
    /// What a step leaves of the flow without the layer.
    free_left: f64,
    axes: [Axis; 2],
}

/// Factors of a step along one axis, for each sample and for the face before it.
struct Axis {
    /// What a step adds to the flow without the layer per difference of heights, m/s.
    free_gain: f64,
    /// What a step leaves of the flow in the layer, and the share of the change without the layer that it adds.
    flow_left: Vec<f64>,
    flow_gain: Vec<f64>,
    /// What a step leaves of a height, and what it takes from it per difference of flows, s/m.
    height_left: Vec<f64>,
    height_gain: Vec<f64>,
}

/// (1 − e^(−rate t)) / rate, the integral of e^(−rate s) over 0 … t, for any sign of t.
pub(super) fn decayed(rate_per_s: f64, time_s: f64) -> f64 {
    let exponent = rate_per_s * time_s;
    if exponent == 0.0 {
        time_s
    } else {
        time_s * (-(-exponent).exp_m1() / exponent)
    }
}

/// The integral of [`decayed`] over 0 … t, t at least 0.
pub(super) fn decayed_twice(rate_per_s: f64, time_s: f64) -> f64 {
    let exponent = rate_per_s * time_s;
    if exponent < 1e-4 {
        // The next term is below 10⁻⁹ of this.
        0.5 * time_s * time_s * (1.0 - exponent / 3.0 + exponent * exponent / 12.0)
    } else {
        (time_s - decayed(rate_per_s, time_s)) / rate_per_s
    }
}

impl Axis {
    fn of(cells: &Cells, axis: usize, speed_m_per_s: f64, damping_per_s: f64, step_s: f64) -> Self {
        let step_m = cells.step_m[axis];
        let width_m = cells.layer as f64 * step_m;
        let most_per_s = if cells.layer == 0 {
            0.0
        } else {
            0.5 * f64::from(LAYER_POWER + 1) * speed_m_per_s * -LAYER_LEAVES.ln() / width_m
        };
        let layer_per_s =
            |index: f64| most_per_s * cells.outside(axis, index).min(1.0).powi(LAYER_POWER);
        let over_samples = |of: &dyn Fn(f64) -> f64, shift: f64| -> Vec<f64> {
            let indices = (0..cells.size[axis]).map(|index| index as f64 - shift);
            indices.map(|index| of(layer_per_s(index))).collect()
        };
        let left = |rate_per_s: f64| (-rate_per_s * step_s).exp();
        let mean_left = |rate_per_s: f64| decayed(rate_per_s, step_s) / step_s;
        let gain = |rate_per_s: f64| decayed(rate_per_s, step_s) / step_m;
        Self {
            free_gain: speed_m_per_s * speed_m_per_s * gain(2.0 * damping_per_s),
            flow_left: over_samples(&left, 0.5),
            flow_gain: over_samples(&mean_left, 0.5),
            height_left: over_samples(&left, 0.0),
            height_gain: over_samples(&gain, 0.0),
        }
    }
}

/// Memory for a row: its heights, those of the row before it, and differences.
struct Rows {
    before_m: Vec<f64>,
    here_m: Vec<f64>,
    rises_m: Vec<f64>,
}

impl<'a> Leapfrog<'a> {
    /// Waves of `speed_m_per_s` on the grid of `footprint`, damped by `damping_per_s`, in steps of `step_s`.
    pub(super) fn of(
        cells: &'a Cells,
        footprint: &'a Footprint,
        speed_m_per_s: f64,
        damping_per_s: f64,
        step_s: f64,
    ) -> Self {
        Self {
            cells,
            footprint,
            step_s,
            keeps_free: damping_per_s > 0.0 && cells.layer > 0,
            free_left: (-2.0 * damping_per_s * step_s).exp(),
            axes: [0, 1].map(|axis| Axis::of(cells, axis, speed_m_per_s, damping_per_s, step_s)),
        }
    }

    /// Length of a step, s.
    pub(super) fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Water at rest.
    pub(super) fn at_rest(&self) -> State {
        let zeros = |count: usize| [vec![0.0; count], vec![0.0; count]];
        let count = self.cells.count();
        State {
            parts_m: zeros(count),
            flows: zeros(count),
            free: zeros(if self.keeps_free { count } else { 0 }),
        }
    }

    /// Moves a state by one step: flows first, then heights.
    pub(super) fn step(&self, state: &mut State) {
        let [flows_x, flows_z] = &mut state.flows;
        let [free_x, free_z] = &mut state.free;
        let parts_m = &state.parts_m;
        self.both(
            || self.move_flows(0, parts_m, flows_x, free_x),
            || self.move_flows(1, parts_m, flows_z, free_z),
        );
        let [parts_x, parts_z] = &mut state.parts_m;
        let [flows_x, flows_z] = &state.flows;
        self.both(
            || self.move_heights(0, parts_x, flows_x),
            || self.move_heights(1, parts_z, flows_z),
        );
    }

    /// Does both, at the same time if the grid is large enough for that to be worth its while.
    fn both(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        if self.cells.count() > PIECE_SAMPLES {
            rayon::join(one, other);
        } else {
            one();
            other();
        }
    }

    /// Samples of the rows in a piece of work.
    fn piece(&self) -> usize {
        let width = self.cells.size[0];
        (PIECE_SAMPLES / width).max(1) * width
    }

    fn move_flows(
        &self,
        axis: usize,
        parts_m: &[Vec<f64>; 2],
        flows: &mut [f64],
        free: &mut [f64],
    ) {
        let (width, piece) = (self.cells.size[0], self.piece());
        let rows = || Rows {
            before_m: vec![0.0; width],
            here_m: vec![0.0; width],
            rises_m: vec![0.0; width],
        };
        let pieces = flows.par_chunks_mut(piece).enumerate();
        if self.keeps_free {
            pieces.zip(free.par_chunks_mut(piece)).for_each_init(
                rows,
                |rows, ((i, flows), free)| {
                    self.move_piece_of_flows(axis, parts_m, i * piece / width, rows, flows, free);
                },
            );
        } else {
            pieces.for_each_init(rows, |rows, (i, flows)| {
                self.move_piece_of_flows(axis, parts_m, i * piece / width, rows, flows, &mut []);
            });
        }
    }

    /// Moves the flows of the rows from `first` on.
    fn move_piece_of_flows(
        &self,
        axis: usize,
        parts_m: &[Vec<f64>; 2],
        first: usize,
        rows: &mut Rows,
        flows: &mut [f64],
        free: &mut [f64],
    ) {
        let [width, height] = self.cells.size;
        let factors = &self.axes[axis];
        add_row(parts_m, (first + height - 1) % height, &mut rows.before_m);
        for (line, flows) in flows.chunks_exact_mut(width).enumerate() {
            let row = first + line;
            add_row(parts_m, row, &mut rows.here_m);
            if axis == 0 {
                rows.rises_m[0] = rows.here_m[0] - rows.here_m[width - 1];
                for (rise_m, pair) in rows.rises_m[1..].iter_mut().zip(rows.here_m.windows(2)) {
                    *rise_m = pair[1] - pair[0];
                }
            } else {
                let pairs = rows.here_m.iter().zip(&rows.before_m);
                for (rise_m, (here_m, before_m)) in rows.rises_m.iter_mut().zip(pairs) {
                    *rise_m = here_m - before_m;
                }
            }
            let open = &self.footprint.open[axis][row * width..][..width];
            let places = open.iter().zip(&rows.rises_m).enumerate();
            let factors_at = |column: usize| {
                let index = [column, row][axis];
                (factors.flow_left[index], factors.flow_gain[index])
            };
            if self.keeps_free {
                let free = &mut free[line * width..][..width];
                for ((flow, free), (column, (open, rise_m))) in
                    flows.iter_mut().zip(free).zip(places)
                {
                    let (left, gain) = factors_at(column);
                    let moved = self.free_left * *free - factors.free_gain * rise_m;
                    let change = moved - *free;
                    *flow = if *open {
                        left * *flow + gain * change
                    } else {
                        0.0
                    };
                    *free = if *open { moved } else { 0.0 };
                }
            } else {
                // Without damping or without a layer one factor of each pair is 1.
                for (flow, (column, (open, rise_m))) in flows.iter_mut().zip(places) {
                    let (left, gain) = factors_at(column);
                    let moved = left * self.free_left * *flow - gain * factors.free_gain * rise_m;
                    *flow = if *open { moved } else { 0.0 };
                }
            }
            std::mem::swap(&mut rows.before_m, &mut rows.here_m);
        }
    }

    fn move_heights(&self, axis: usize, parts_m: &mut [f64], flows: &[f64]) {
        let ([width, height], piece) = (self.cells.size, self.piece());
        let factors = &self.axes[axis];
        parts_m
            .par_chunks_mut(piece)
            .enumerate()
            .for_each(|(i, parts_m)| {
                for (row, line) in (i * piece / width..).zip(parts_m.chunks_exact_mut(width)) {
                    let here = &flows[row * width..][..width];
                    if axis == 0 {
                        let after = here[1..].iter().chain(&here[..1]);
                        let factors = factors.height_left.iter().zip(&factors.height_gain);
                        for ((part_m, (left, gain)), (after, here)) in
                            line.iter_mut().zip(factors).zip(after.zip(here))
                        {
                            *part_m = left * *part_m - gain * (after - here);
                        }
                    } else {
                        let after = &flows[(row + 1) % height * width..][..width];
                        let (left, gain) = (factors.height_left[row], factors.height_gain[row]);
                        for (part_m, (after, here)) in line.iter_mut().zip(after.iter().zip(here)) {
                            *part_m = left * *part_m - gain * (after - here);
                        }
                    }
                }
            });
    }

    /// Heights one step before a state: a step of the heights, undone.
    pub(super) fn heights_before_m(&self, state: &State) -> Vec<f64> {
        let [width, height] = self.cells.size;
        let [axis_x, axis_z] = &self.axes;
        let ([parts_x, parts_z], [flows_x, flows_z]) = (&state.parts_m, &state.flows);
        let mut before_m = vec![0.0; self.cells.count()];
        for (row, line) in before_m.chunks_exact_mut(width).enumerate() {
            for (column, before_m) in line.iter_mut().enumerate() {
                let at = row * width + column;
                let right = row * width + (column + 1) % width;
                let below = (row + 1) % height * width + column;
                let x = parts_x[at] + axis_x.height_gain[column] * (flows_x[right] - flows_x[at]);
                let z = parts_z[at] + axis_z.height_gain[row] * (flows_z[below] - flows_z[at]);
                *before_m = x / axis_x.height_left[column] + z / axis_z.height_left[row];
            }
        }
        before_m
    }
}

/// The heights of a row.
fn add_row(parts_m: &[Vec<f64>; 2], row: usize, heights_m: &mut [f64]) {
    let [x, z] = parts_m
        .each_ref()
        .map(|parts_m| &parts_m[row * heights_m.len()..]);
    for ((height_m, x), z) in heights_m.iter_mut().zip(x).zip(z) {
        *height_m = x + z;
    }
}
