//! The wave equation φ_tt = Δφ from the water down, added up in every cell.
//!
//! A pulse starts at the water, at rest, so half of it goes up and leaves. A band around the box damps what enters it, more and more
//! inwards. Most cells are still at any time: rows are cut into segments, and a segment is computed only while waves are in
//! it or next to it.
//!
//! Rays that cross are no problem for waves, so nothing is lost behind a focus. But waves need several cells per length, so
//! caustics are as wide as some cells. And the sum of φ itself hardly shows a focus: integrated over all times, the equation
//! says that it solves Laplace's equation away from the water. Clamped at 0 or squared it shows more.
//!
//! Source: Mercier, §4, algorithm 3 and eq. 5 (band, active cells, clamping from §4 and §5.2).

use glam::DVec2;
use rayon::prelude::*;

use super::wave_band::Band;
use super::wave_plan::GHOSTS;
use super::wave_step::{SEGMENT, Step};
use super::{Frame, Front, FrontError, Grid, Height, Pulse, Sides, Sum, WavePlan, WaveSettings};

/// A share of a cell that is more than rounding.
const EVEN: f64 = 1e-9;

/// What a simulation did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveReport {
    /// Steps that were made.
    pub steps: usize,
    /// Share of the cells that were computed, on average over the steps.
    pub mean_active: f64,
    /// The same, in the step with most.
    pub most_active: f64,
    /// Largest |φ| inside the box after the last step; 0 if the waves have left.
    pub left_over: f64,
}

/// A simulation in progress.
pub struct Waves {
    plan: WavePlan,
    settings: WaveSettings,
    grid: Grid,
    now: Vec<f32>,
    /// The state a step earlier; the next state is written over it.
    before: Vec<f32>,
    sums: Vec<f32>,
    /// By segment, whether waves are in it.
    active: Vec<bool>,
    /// By segment, whether it was computed in the last step, so that it may hold other values than 0.
    held: Vec<bool>,
    bands: [Band; 3],
    strides: [usize; 3],
    segments: usize,
}

impl Waves {
    /// The water's pulse in the box of `plan`, which belongs to `grid` and `settings`.
    ///
    /// # Errors
    /// Water that is not finite, or stands above the damping band; a frame in which the surface is not lit at once.
    pub fn start<F>(
        grid: &Grid,
        plan: &WavePlan,
        settings: &WaveSettings,
        frame: &Frame,
        water: &F,
    ) -> Result<Self, FrontError>
    where
        F: Fn(DVec2) -> Height + Sync,
    {
        if frame.slowness.length() > 0.0 {
            return Err(FrontError::Setting {
                setting: "slowness",
                value: frame.slowness.length(),
                accepted: "0: waves start everywhere at once",
            });
        }
        let mut waves = Self::at_rest(grid, plan, settings);
        let mut whole = *grid;
        whole.size = plan.size;
        whole.origin_m -= grid.step_m * glam::DVec3::from_array(plan.band.map(|n| n as f64));
        let step_m = grid.step_m;
        let width = match settings.pulse {
            Pulse::Cells => 1.0,
            Pulse::Smooth(cells) => cells,
        };
        // The pulse is as wide as cells are along the surface's normal.
        let front = Front::of(&whole, frame, water, width + 0.5)?;
        for start in &front.starts {
            let cell_m = (start.direction.abs() * step_m).element_sum();
            let at = start.time_m / cell_m;
            let height = match settings.pulse {
                // A surface between two cells belongs to the upper one.
                Pulse::Cells if (at + EVEN).abs() <= 0.5 => 1.0,
                Pulse::Smooth(cells) if at.abs() < cells => {
                    (0.5 * std::f64::consts::PI * at / cells).cos().powi(2)
                }
                Pulse::Cells | Pulse::Smooth(_) => continue,
            };
            waves.set(whole.cell(start.index), height as f32);
        }
        waves.begin();
        Ok(waves)
    }

    /// Still water.
    pub(super) fn at_rest(grid: &Grid, plan: &WavePlan, settings: &WaveSettings) -> Self {
        let [nx, nz, nd] = plan.size.map(|n| n + 2 * GHOSTS);
        let segments = plan.size[0].div_ceil(SEGMENT);
        let bands = std::array::from_fn(|axis| Band::of(grid, plan, axis));
        Self {
            plan: *plan,
            settings: *settings,
            grid: *grid,
            now: vec![0.0; nx * nz * nd],
            before: vec![0.0; nx * nz * nd],
            sums: vec![0.0; grid.cells()],
            active: vec![false; segments * plan.size[1] * plan.size[2]],
            held: vec![false; segments * plan.size[1] * plan.size[2]],
            bands,
            strides: [1, nx, nx * nz],
            segments,
        }
    }

    fn place(&self, cell: [usize; 3]) -> usize {
        let steps = cell.iter().zip(self.strides);
        steps.map(|(i, stride)| (i + GHOSTS) * stride).sum()
    }

    /// Sets φ in a cell of the box with the band.
    pub(super) fn set(&mut self, cell: [usize; 3], height: f32) {
        let place = self.place(cell);
        self.now[place] = height;
        let [i, j, k] = cell;
        self.active[i / SEGMENT + self.segments * (j + self.plan.size[1] * k)] = true;
    }

    /// Makes the present state one at rest: a step backwards in time looks like a step forwards.
    pub(super) fn begin(&mut self) {
        self.mirror();
        // Half the change of a step from an equal state.
        self.before.copy_from_slice(&self.now);
        self.advance();
        // Now `now` is φ + Δ and `before` is φ; the state at rest wants φ and φ + Δ/2.
        for (now, before) in self.now.iter_mut().zip(&mut self.before) {
            let (stepped, start) = (*now, *before);
            *now = start;
            *before = start + 0.5 * (stepped - start);
        }
        self.mirror();
    }

    /// φ in a cell of the grid.
    pub fn value(&self, cell: [usize; 3]) -> f32 {
        let band = self.plan.band;
        self.now[self.place(std::array::from_fn(|axis| cell[axis] + band[axis]))]
    }

    /// The sums over all steps so far, times the step, by cell of the grid: m.
    pub fn sums(&self) -> &[f32] {
        &self.sums
    }

    /// Runs until the waves have left the box, or to the end of the plan.
    pub fn run(&mut self) -> WaveReport {
        let (mut all, mut most) = (0.0, 0.0_f64);
        let mut report = WaveReport {
            steps: 0,
            mean_active: 0.0,
            most_active: 0.0,
            left_over: 0.0,
        };
        while report.steps < self.plan.steps && self.is_any_inside() {
            let share = self.step();
            all += share;
            most = most.max(share);
            report.steps += 1;
        }
        report.mean_active = all / (report.steps.max(1)) as f64;
        report.most_active = most;
        report.left_over = self.largest_inside();
        report
    }

    /// Adds the present state to the sums and makes one step. Returns the share of the cells that were computed.
    pub fn step(&mut self) -> f64 {
        self.add();
        let share = self.advance();
        self.mirror();
        share
    }

    fn is_any_inside(&self) -> bool {
        let [_, nz, nd] = self.plan.size;
        let [bx, bz, bd] = self.plan.band;
        let [first, last] = [bx / SEGMENT, (bx + self.grid.size[0] - 1) / SEGMENT];
        let mut rows = (bd..nd - bd).flat_map(|k| (bz..nz - bz).map(move |j| j + nz * k));
        rows.any(|row| self.active[row * self.segments..][first..=last].contains(&true))
    }

    fn largest_inside(&self) -> f64 {
        let cells = 0..self.grid.cells();
        let values = cells.map(|index| f64::from(self.value(self.grid.cell(index)).abs()));
        values.fold(0.0, f64::max)
    }

    /// Adds φ or φ² to the sums.
    fn add(&mut self) {
        let [nx, nz, _] = self.grid.size;
        let (now, active, plan, strides) = (&self.now, &self.active, &self.plan, self.strides);
        let (segments, squares) = (self.segments, self.settings.sum == Sum::Squares);
        let step_m = plan.step_m as f32;
        let [bx, bz, bd] = plan.band;
        self.sums
            .par_chunks_mut(nx * nz)
            .enumerate()
            .for_each(|(k, slice)| {
                for (j, row) in slice.chunks_mut(nx).enumerate() {
                    let flags =
                        &active[(j + bz + plan.size[1] * (k + bd)) * segments..][..segments];
                    if !flags[bx / SEGMENT..].contains(&true) {
                        continue;
                    }
                    let from = bx
                        + GHOSTS
                        + (j + bz + GHOSTS) * strides[1]
                        + (k + bd + GHOSTS) * strides[2];
                    for (sum, value) in row.iter_mut().zip(&now[from..]) {
                        *sum += step_m * if squares { value * value } else { *value };
                    }
                }
            });
    }

    /// One step of the damped wave equation in the active segments and their neighbours; `now` and `before` change places.
    fn advance(&mut self) -> f64 {
        let [nx, nz, nd] = self.plan.size;
        let segments = self.segments;
        let near = self.near();
        self.clear(&near);
        let mut active = vec![false; self.active.len()];
        let row_stride = self.strides[1];
        let (now, near_ref) = (&self.now, &near);
        let step = Step::of(&self.grid, &self.plan, &self.settings, self.strides);
        let [band_x, band_z, band_d] = &self.bands;
        let slices = self
            .before
            .par_chunks_mut(self.strides[2])
            .skip(GHOSTS)
            .take(nd);
        let flags = active.par_chunks_mut(segments * nz);
        let computed: usize = slices
            .zip(flags)
            .enumerate()
            .map(|(k, (next, flags))| {
                let mut computed = 0;
                for j in 0..nz {
                    for s in 0..segments {
                        if !near_ref[s + segments * (j + nz * k)] {
                            continue;
                        }
                        let (from, to) = (s * SEGMENT, ((s + 1) * SEGMENT).min(nx));
                        computed += to - from;
                        let in_slice = GHOSTS + from + (j + GHOSTS) * row_stride;
                        flags[s + segments * j] = step.segment(
                            now,
                            (k + GHOSTS) * step.strides[2] + in_slice,
                            &mut next[in_slice..][..to - from],
                            [&band_x.left[from..to], &band_x.gain[from..to]],
                            [
                                band_z.left[j] * band_d.left[k],
                                band_z.gain[j] + band_d.gain[k],
                            ],
                        );
                    }
                }
                computed
            })
            .sum();
        std::mem::swap(&mut self.now, &mut self.before);
        self.active = active;
        self.held = near;
        computed as f64 / self.plan.cells as f64
    }

    /// Sets segments to 0 that are no longer computed.
    fn clear(&mut self, near: &[bool]) {
        let [nx, nz, _] = self.plan.size;
        for (index, near) in near.iter().enumerate() {
            if self.held[index] && !near {
                let (row, s) = (index / self.segments, index % self.segments);
                let place = self.place([s * SEGMENT, row % nz, row / nz]);
                let count = (nx - s * SEGMENT).min(SEGMENT);
                self.now[place..][..count].fill(0.0);
                self.before[place..][..count].fill(0.0);
            }
        }
    }

    /// The segments that hold waves or touch one that does, also at an edge or corner.
    fn near(&self) -> Vec<bool> {
        let [_, nz, nd] = self.plan.size;
        let segments = self.segments;
        let mut rows = vec![false; self.active.len()];
        // Along x and z within a slice, then along depth.
        rows.par_chunks_mut(segments * nz)
            .zip(self.active.par_chunks(segments * nz))
            .for_each(|(rows, active)| {
                for j in 0..nz {
                    for s in 0..segments {
                        let around = |j: usize| {
                            active[segments * j..][..segments]
                                [s.saturating_sub(1)..(s + 2).min(segments)]
                                .contains(&true)
                        };
                        rows[s + segments * j] = (j.saturating_sub(1)..(j + 2).min(nz)).any(around);
                    }
                }
            });
        let slice = segments * nz;
        let mut near = vec![false; self.active.len()];
        near.par_chunks_mut(slice)
            .enumerate()
            .for_each(|(k, near)| {
                for from in k.saturating_sub(1)..(k + 2).min(nd) {
                    for (near, row) in near.iter_mut().zip(&rows[from * slice..][..slice]) {
                        *near |= row;
                    }
                }
            });
        near
    }

    /// Copies the cells next to mirrors behind them.
    fn mirror(&mut self) {
        if self.settings.sides == Sides::Absorb {
            return;
        }
        let [nx, nz, nd] = self.plan.size;
        let [_, row, slice] = self.strides;
        let (first, last) = (GHOSTS, GHOSTS + nz - 1);
        self.now
            .par_chunks_mut(slice)
            .skip(GHOSTS)
            .take(nd)
            .for_each(|values| {
                for j in first..=last {
                    values[j * row] = values[j * row + 1];
                    values[j * row + nx + 1] = values[j * row + nx];
                }
                values.copy_within(first * row..(first + 1) * row, 0);
                values.copy_within(last * row..(last + 1) * row, (last + 1) * row);
            });
    }
}
