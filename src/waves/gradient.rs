//! Surfaces from slopes: the heights whose slopes differ least from given ones, in the mean square. Source of the principle: Frankot and
//! Chellappa, "A Method for Enforcing Integrability in Shape from Shading Algorithms", IEEE Trans. PAMI 10(4), 1988.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use rustfft::{FftDirection, FftPlanner};

/// Heights from slopes.
pub(super) struct Integrated {
    /// Row by row along x, with the mean 0, m.
    pub(super) heights_m: Vec<f64>,
    /// Share of the mean square slope that these heights do not have, 0 … 1.
    pub(super) no_gradient: f64,
}

impl Integrated {
    fn flat(count: usize) -> Self {
        Self {
            heights_m: vec![0.0; count],
            no_gradient: 0.0,
        }
    }
}

fn share(missing: f64, all: f64) -> f64 {
    // Sums of so many squares are no more exact.
    const ROUNDING: f64 = 1e-12;
    let share = missing / all;
    if share > ROUNDING {
        share.min(1.0)
    } else {
        0.0
    }
}

/// Slopes ∂h/∂x and ∂h/∂z that repeat: each wave by itself, exactly. A mean slope belongs to no surface that repeats.
pub(super) fn integrate_periodic(
    slopes: [Vec<f64>; 2],
    size: [usize; 2],
    step_m: DVec2,
) -> Integrated {
    let [width, height] = size;
    let [along_x, along_z] = slopes;
    let all: f64 = along_x
        .iter()
        .chain(&along_z)
        .map(|slope| slope * slope)
        .sum();
    if all == 0.0 {
        return Integrated::flat(width * height);
    }
    // Two real functions as the real and the imaginary part of one.
    let both = along_x.into_iter().zip(along_z);
    let both: Vec<Complex64> = both.map(|(x, z)| Complex64::new(x, z)).collect();
    let both = transformed(both, size, FftDirection::Forward);
    let at = |x: usize, z: usize| both[x * height + z];
    let mut carried = 0.0;
    let mut waves = vec![Complex64::ZERO; width * height];
    for x in 0..width {
        for z in 0..height {
            let k = DVec2::new(
                wave_number(x, width, step_m.x),
                wave_number(z, height, step_m.y),
            );
            let square = k.length_squared();
            if square == 0.0 {
                continue;
            }
            let (here, opposite) = (
                at(x, z),
                at((width - x) % width, (height - z) % height).conj(),
            );
            let slope_x = 0.5 * (here + opposite);
            let slope_z = Complex64::new(0.0, -0.5) * (here - opposite);
            let along = slope_x * k.x + slope_z * k.y;
            carried += along.norm_sqr() / square;
            waves[x * height + z] = Complex64::new(0.0, -1.0) * along / square;
        }
    }
    let count = (width * height) as f64;
    // Back from columns to rows.
    let heights = transformed(waves, [height, width], FftDirection::Inverse);
    Integrated {
        heights_m: heights.iter().map(|height| height.re / count).collect(),
        no_gradient: share(all - carried / count, all),
    }
}

/// Wave number of the wave `index`, rad/m. The wave of two samples has no direction, so it is left out.
fn wave_number(index: usize, count: usize, step_m: f64) -> f64 {
    let turns = match (2 * index).cmp(&count) {
        std::cmp::Ordering::Less => index as f64,
        std::cmp::Ordering::Equal => 0.0,
        std::cmp::Ordering::Greater => index as f64 - count as f64,
    };
    turns * TAU / (count as f64 * step_m)
}

/// Slopes ∂h/∂x and ∂h/∂z within edges. Slopes become rises, the mean slopes from sample to sample; the heights are those whose rises
/// differ least from these, found among the waves of the field with its mirror images.
pub(super) fn integrate_bounded(
    slopes: [Vec<f64>; 2],
    size: [usize; 2],
    step_m: DVec2,
) -> Integrated {
    let [width, height] = size;
    let [along_x, along_z] = slopes;
    let mut rises_x = vec![0.0; width * height];
    let lines = rises_x.chunks_exact_mut(width);
    for (rises, slopes) in lines.zip(along_x.chunks_exact(width)) {
        for i in 0..width - 1 {
            rises[i] = rise(width, i, |at| slopes[at]);
        }
    }
    let mut rises_z = vec![0.0; width * height];
    for x in 0..width {
        for i in 0..height - 1 {
            rises_z[i * width + x] = rise(height, i, |at| along_z[at * width + x]);
        }
    }
    let all: f64 = rises_x.iter().chain(&rises_z).map(|rise| rise * rise).sum();
    if all == 0.0 {
        return Integrated::flat(width * height);
    }
    let per_step = step_m.recip();
    // The normal equations: −div grad h = −div of the rises. Beyond the edges there is no rise.
    let divergence = |x: usize, z: usize| {
        let at = z * width + x;
        let before_x = if x > 0 { rises_x[at - 1] } else { 0.0 };
        let before_z = if z > 0 { rises_z[at - width] } else { 0.0 };
        (before_x - rises_x[at]) * per_step.x + (before_z - rises_z[at]) * per_step.y
    };
    let mirrored = [2 * width, 2 * height];
    let folded = |i: usize, count: usize| if i < count { i } else { 2 * count - 1 - i };
    let sources: Vec<Complex64> = (0..4 * width * height)
        .map(|i| {
            let (x, z) = (i % mirrored[0], i / mirrored[0]);
            Complex64::new(divergence(folded(x, width), folded(z, height)), 0.0)
        })
        .collect();
    let mut waves = transformed(sources, mirrored, FftDirection::Forward);
    for (i, wave) in waves.iter_mut().enumerate() {
        let (x, z) = (i / mirrored[1], i % mirrored[1]);
        let stiffness = |n: usize, count: usize, per_step: f64| {
            (2.0 * (0.5 * PI * n as f64 / count as f64).sin() * per_step).powi(2)
        };
        let sum = stiffness(x, width, per_step.x) + stiffness(z, height, per_step.y);
        *wave = if i == 0 { Complex64::ZERO } else { *wave / sum };
    }
    let heights = transformed(waves, [mirrored[1], mirrored[0]], FftDirection::Inverse);
    let count = (4 * width * height) as f64;
    let heights_m: Vec<f64> = (0..width * height)
        .map(|i| heights[i / width * mirrored[0] + i % width].re / count)
        .collect();
    let mut missing = 0.0;
    for (i, height_m) in heights_m.iter().enumerate() {
        if i % width + 1 < width {
            missing += ((heights_m[i + 1] - height_m) * per_step.x - rises_x[i]).powi(2);
        }
        if i / width + 1 < height {
            missing += ((heights_m[i + width] - height_m) * per_step.y - rises_z[i]).powi(2);
        }
    }
    Integrated {
        heights_m,
        no_gradient: share(missing, all),
    }
}

/// Mean slope between the samples `at` and `at` + 1 of a line of `count`: the integral of the polynomial through up to six samples around.
/// Source of the weights: Newton–Cotes rules of the middle interval; near the ends those of the first interval.
fn rise(count: usize, at: usize, slope: impl Fn(usize) -> f64) -> f64 {
    let sum = |first: usize, weights: &[f64]| -> f64 {
        let terms = weights.iter().enumerate();
        terms.map(|(i, weight)| weight * slope(first + i)).sum()
    };
    if at >= 2 && at + 3 < count {
        return sum(at - 2, &[11.0, -93.0, 802.0, 802.0, -93.0, 11.0]) / 1440.0;
    }
    if at >= 1 && at + 2 < count {
        return sum(at - 1, &[-1.0, 13.0, 13.0, -1.0]) / 24.0;
    }
    if at == 0 {
        sum(0, &[9.0, 19.0, -5.0, 1.0]) / 24.0
    } else {
        sum(count - 4, &[1.0, -5.0, 19.0, 9.0]) / 24.0
    }
}

/// The transform along both axes, without a factor. The result is transposed: row by row along the second axis.
fn transformed(
    mut values: Vec<Complex64>,
    [width, height]: [usize; 2],
    direction: FftDirection,
) -> Vec<Complex64> {
    let mut planner = FftPlanner::new();
    let along_x = planner.plan_fft(width, direction);
    values
        .par_chunks_exact_mut(width)
        .for_each(|line| along_x.process(line));
    let along_z = planner.plan_fft(height, direction);
    let mut columns = vec![Complex64::ZERO; width * height];
    columns
        .par_chunks_exact_mut(height)
        .enumerate()
        .for_each(|(x, column)| {
            for (z, value) in column.iter_mut().enumerate() {
                *value = values[z * width + x];
            }
            along_z.process(column);
        });
    columns
}
