//! Ripples in a basin with obstacles, in steps of time.
//!
//! Heights stand at the samples, flows q at the faces between them: h_t = −∇·q, q_t = −c² ∇h − 2γ q, which is
//! h_tt + 2γ h_t = c² ∇²h. No water flows through faces that an obstacle closes. Heights and flows alternate (leapfrog), second order in
//! space and time; damping is integrated exactly over a step, so that it never limits the step. Beyond absorbing walls is a perfectly
//! matched layer: heights are split into the parts of x and z, and parts and flows are damped along their own axis with a rate σ that grows
//! into the layer. The layer is matched to damped water too: from the flow q̃ without the layer, q̃_t = −c² ∇h − 2γ q̃, follows
//! q_t + σ q = q̃_t.
//!
//! Steps are counted from the first drop, so a state depends on its number alone, not on which times were asked for before. A drop starts at
//! its own time: at the first step after it, its own solution is added as a Taylor series. Between steps, heights are interpolated by
//! polynomials of degree 3.
//!
//! Sources: Yee, "Numerical solution of initial boundary value problems involving Maxwell's equations in isotropic media", IEEE Trans.
//! Antennas and Propagation 14, 1966; Bérenger, "A perfectly matched layer for the absorption of electromagnetic waves", J. Computational
//! Physics 114, 1994.

use std::sync::Arc;

use super::cells::Cells;
use super::continued;
use super::footprint::Footprint;
use super::grid::{Edges, Heights};
use super::leapfrog::{Leapfrog, State, decayed, decayed_twice};
use super::mounds::Mounds;
use super::open_water::shortest_wave_m;
use super::ripples::description;
use crate::kept::{Kept, Key};
use crate::physics::oscillator::Elapsed;
use crate::scene::{Ripples, Scene, Walls};

/// States that may be kept beside those of the latest frames.
const MILESTONES: u64 = 24;

/// Fewest steps between two of them.
const FEWEST_STEPS: u64 = 64;

/// The basin at `scene.time_s` on the grid of `footprint`.
pub(super) fn heights(
    ripples: &Ripples,
    scene: &Scene,
    refinement: u32,
    footprint: &Footprint,
    kept: &Kept,
) -> Heights {
    let cells = Cells::of(ripples, refinement);
    let mut heights_m = vec![0.0; cells.count()];
    let mut wave_m = f64::INFINITY;
    let depth_m = scene.floor.as_ref().map(|floor| floor.depth_m);
    if let (Some(first_s), Some(speed_m_per_s)) =
        (ripples.first_drop_s(), ripples.shallow_m_per_s(depth_m))
        && first_s <= scene.time_s
    {
        let tank = Tank::of(ripples, refinement, speed_m_per_s, footprint, &cells);
        let elapsed_s = Elapsed::between(first_s, scene.time_s).seconds();
        // All steps on the threads of the pool: entering it takes as long as a step of a small basin.
        heights_m = rayon::scope(|_| tank.heights_m(elapsed_s, kept));
        wave_m = shortest_wave_m(&tank.mounds.fallen(elapsed_s), tank.mounds.highest_per_m());
    }
    cells.fade(&mut heights_m);
    continued::inside(&mut heights_m, &footprint.inside, &cells);
    let mirrored = ripples.walls == Walls::Reflecting;
    let size = cells.size;
    Heights {
        edges: match ripples.walls {
            Walls::Absorbing => Edges::Flat,
            Walls::Reflecting | Walls::Periodic => Edges::Repeats,
        },
        heights_m: if mirrored {
            continued::mirrored(&heights_m, size)
        } else {
            heights_m
        },
        size: if mirrored {
            size.map(|count| 2 * count)
        } else {
            size
        },
        step_m: cells.step_m.into(),
        corner_m: cells.corner_m(),
        slope_lost: slope_lost(ripples),
        shortest_wave_m: wave_m,
        description: description(ripples),
    }
}

/// See [`super::ripples::slope_lost`]. A mound of the same water that is wider by a factor is flatter by its square, and so is its slope.
pub(super) fn slope_lost(ripples: &Ripples) -> f64 {
    let narrowest_m = super::mounds::narrowest_m(ripples);
    let (mut carried, mut all) = (0.0, 0.0);
    for drop in &ripples.drops {
        let square = drop.height_m * drop.height_m;
        carried += square * (drop.radius_m / drop.radius_m.max(narrowest_m)).powi(4);
        all += square;
    }
    if all > 0.0 { 1.0 - carried / all } else { 0.0 }
}

/// A basin with obstacles, ready to be moved.
struct Tank<'a> {
    cells: &'a Cells,
    footprint: &'a Footprint,
    mounds: Mounds,
    /// c², m²/s².
    speed_squared: f64,
    damping_per_s: f64,
    leapfrog: Leapfrog<'a>,
    /// Hash of all that states depend on, except for their numbers.
    sources: Key,
}

impl<'a> Tank<'a> {
    fn of(
        ripples: &Ripples,
        refinement: u32,
        speed_m_per_s: f64,
        footprint: &'a Footprint,
        cells: &'a Cells,
    ) -> Self {
        let step_s = ripples.time_step_s(speed_m_per_s, refinement);
        let damping_per_s = ripples.damping_per_s;
        let text = serde_json::to_vec(&(
            "state of a basin",
            ripples,
            speed_m_per_s.to_bits(),
            refinement,
        ));
        let mut hasher = blake3::Hasher::new();
        hasher.update(&text.expect("ripples always serialise"));
        hasher.update(&footprint.bytes());
        Self {
            leapfrog: Leapfrog::of(cells, footprint, speed_m_per_s, damping_per_s, step_s),
            mounds: Mounds::of(ripples),
            speed_squared: speed_m_per_s * speed_m_per_s,
            sources: *hasher.finalize().as_bytes(),
            cells,
            footprint,
            damping_per_s,
        }
    }

    /// Heights `elapsed_s` after the first drop, at least 0.
    fn heights_m(&self, elapsed_s: f64, kept: &Kept) -> Vec<f64> {
        if self.speed_squared == 0.0 || !self.leapfrog.step_s().is_finite() {
            let mut state = self.leapfrog.at_rest();
            for index in self.mounds.between(f64::NEG_INFINITY, elapsed_s) {
                self.add(&mut state, index, 0.0, 0.0);
            }
            return state.heights_m();
        }
        let mut number = (elapsed_s / self.leapfrog.step_s()) as u64;
        // Rounding may have lifted the quotient.
        if number as f64 * self.leapfrog.step_s() > elapsed_s {
            number -= 1;
        }
        let state = self.state(number, kept);
        let start_s = number as f64 * self.leapfrog.step_s();
        let share = (elapsed_s - start_s) / self.leapfrog.step_s();
        let mut heights_m = state.heights_m();
        if share > 0.0 {
            self.interpolate(&state, share, &mut heights_m);
            // Drops after the step are not in the states around it.
            let mut fallen = self.leapfrog.at_rest();
            let mut any = false;
            for index in self.mounds.between(start_s, elapsed_s) {
                self.add(&mut fallen, index, elapsed_s - self.mounds.at_s(index), 0.0);
                any = true;
            }
            if any {
                for (height_m, more_m) in heights_m.iter_mut().zip(fallen.heights_m()) {
                    *height_m += more_m;
                }
            }
        }
        heights_m
    }

    /// Heights at the share 0 … 1 of the way to the next step, by Lagrange's polynomial through four steps.
    fn interpolate(&self, state: &State, share: f64, heights_m: &mut [f64]) {
        let before_m = self.leapfrog.heights_before_m(state);
        let mut later = state.clone();
        self.leapfrog.step(&mut later);
        let next_m = later.heights_m();
        self.leapfrog.step(&mut later);
        let [parts_x, parts_z] = &later.parts_m;
        let t = share;
        let weights = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        for (i, height_m) in heights_m.iter_mut().enumerate() {
            *height_m = weights[0] * before_m[i]
                + weights[1] * *height_m
                + weights[2] * next_m[i]
                + weights[3] * (parts_x[i] + parts_z[i]);
        }
    }

    /// The state with the given number, from the nearest one before it that is kept.
    fn state(&self, number: u64, kept: &Kept) -> Arc<State> {
        // Distances grow with the number, so that milestones stay few; each is one of the smaller distances too.
        let spacing = FEWEST_STEPS.max((number / MILESTONES).next_power_of_two());
        // All are looked up, so that those of other basins are dropped before them.
        let milestones = (1..=number / spacing).map(|i| i * spacing);
        let milestone = milestones
            .filter_map(|n| Some((n, self.kept_state(n, kept)?)))
            .fold(None, |_, found| Some(found));
        let oldest = milestone
            .as_ref()
            .map_or(0, |(n, _)| *n)
            .max(number.saturating_sub(spacing));
        let recent = (oldest..=number)
            .rev()
            .find_map(|n| Some((n, self.kept_state(n, kept)?)));
        let (mut now, start) = match recent.or(milestone) {
            Some((n, state)) if n == number => return state,
            Some((n, state)) => (n, (*state).clone()),
            None => (0, self.start()),
        };
        let mut state = start;
        while now < number {
            self.leapfrog.step(&mut state);
            now += 1;
            let (from_s, to_s) = (
                (now - 1) as f64 * self.leapfrog.step_s(),
                now as f64 * self.leapfrog.step_s(),
            );
            for index in self.mounds.between(from_s, to_s) {
                let since_s = to_s - self.mounds.at_s(index);
                self.add(
                    &mut state,
                    index,
                    since_s,
                    since_s - 0.5 * self.leapfrog.step_s(),
                );
            }
            if now % spacing == 0 && now < number {
                kept.put(self.key(now), state.clone(), state.bytes());
            }
        }
        let bytes = state.bytes();
        kept.put(self.key(number), state, bytes)
    }

    fn kept_state(&self, number: u64, kept: &Kept) -> Option<Arc<State>> {
        kept.get(&self.key(number))
    }

    fn key(&self, number: u64) -> Key {
        let mut hasher = blake3::Hasher::new_keyed(&self.sources);
        hasher.update(&number.to_le_bytes());
        *hasher.finalize().as_bytes()
    }

    /// The state with the number 0: drops of the first moment have fallen.
    fn start(&self) -> State {
        let mut state = self.leapfrog.at_rest();
        for index in self.mounds.between(f64::NEG_INFINITY, 0.0) {
            self.add(&mut state, index, 0.0, -0.5 * self.leapfrog.step_s());
        }
        state
    }

    /// Adds a drop's own solution: heights `since_s` after it, and flows at `flow_s` after it, which may be negative: the solution goes on
    /// to earlier times. h = h₀ + c² ∇²h₀ ∫∫ e^(−2γs) + O(s⁴), q = −c² ∇h₀ ∫ e^(−2γs) + O(s³).
    fn add(&self, state: &mut State, index: usize, since_s: f64, flow_s: f64) {
        let [width, height] = self.cells.size;
        let mound_m = self
            .mounds
            .heights_m(index, self.cells, &self.footprint.inside);
        let rate_per_s = 2.0 * self.damping_per_s;
        // Backwards a damped flow grows without bound. Where a step damps it away there is nothing to gain from following that far.
        let of_flow = decayed(rate_per_s, flow_s.max(-rate_per_s.recip()));
        let of_height = self.speed_squared * decayed_twice(rate_per_s, since_s);
        for axis in [0, 1] {
            let step_m = self.cells.step_m[axis];
            let open = &self.footprint.open[axis];
            let slope = |at: usize, before: usize| {
                if open[at] {
                    (mound_m[at] - mound_m[before]) / step_m
                } else {
                    0.0
                }
            };
            for row in 0..height {
                for column in 0..width {
                    let at = row * width + column;
                    let place = |index: usize| match axis {
                        0 => row * width + index % width,
                        _ => index % height * width + column,
                    };
                    let (index, count) = ([column, row][axis], self.cells.size[axis]);
                    let (before, after) = (place(index + count - 1), place(index + 1));
                    let here = slope(at, before);
                    let bend = (slope(after, at) - here) / step_m;
                    let flow = -self.speed_squared * of_flow * here;
                    state.flows[axis][at] += flow;
                    if let Some(free) = state.free[axis].get_mut(at) {
                        *free += flow;
                    }
                    state.parts_m[axis][at] += 0.5 * mound_m[at] + of_height * bend;
                }
            }
        }
    }
}
