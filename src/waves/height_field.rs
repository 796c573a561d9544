//! Water from numbers that a user brings.
//!
//! Frames are interpolated in time, slopes are integrated to heights, and a bounded field is blended to flat at its rim.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use super::gradient;
use super::grid::{Edges, Heights};
use crate::scene::{
    AfterLast, FieldEdges, FieldFrames, FieldHolds, FirstRow, HeightField, RowAxis,
};

/// A time this close to a frame's, in frames, is that frame's: times such as 7/30 s are rounded.
const SAME_FRAME: f64 = 1e-6;

/// Share of the mean square slope along an axis that may be in waves shorter than the shortest that counts.
const UNNOTICED_SLOPE: f64 = 1e-3;

/// Second derivative of the spline at samples of independent noise of 1, root mean square: that of its transfer function,
/// 6 (1 − cos w)/(2 + cos w).
const CURVATURE_OF_NOISE: f64 = 6.0;

/// First derivative likewise: 3 sin w/(2 + cos w).
const SLOPE_OF_NOISE: f64 = 1.18;

/// A moment of a sequence: frames and their weights, which add up to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moment {
    weights: Vec<(usize, f64)>,
}

impl Moment {
    /// Of a field of `count` frames.
    pub(super) fn at(waves: &HeightField, count: usize, time_s: f64) -> Self {
        let exactly = |frame: usize| Self {
            weights: vec![(frame, 1.0)],
        };
        if count == 1 {
            return exactly(0);
        }
        let at = (time_s - waves.start_s) * waves.frames_per_s.unwrap_or(1.0);
        let at = match waves.after {
            AfterLast::Hold => at.clamp(0.0, (count - 1) as f64),
            AfterLast::Loop => at.rem_euclid(count as f64),
        };
        let frame_at = |index: f64| match waves.after {
            AfterLast::Hold => index.clamp(0.0, (count - 1) as f64) as usize,
            AfterLast::Loop => index.rem_euclid(count as f64) as usize,
        };
        if (at - at.round()).abs() <= SAME_FRAME {
            return exactly(frame_at(at.round()));
        }
        let before = at.floor();
        let weights = catmull_rom(at - before);
        Self {
            weights: (0..4)
                .map(|i| (frame_at(before + i as f64 - 1.0), weights[i]))
                .collect(),
        }
    }

    /// All that it is, for hashes.
    pub(super) fn bits(&self) -> Vec<(usize, u64)> {
        let weights = self.weights.iter();
        weights
            .map(|(frame, weight)| (*frame, weight.to_bits()))
            .collect()
    }
}

/// Weights of four frames, of which the second and third are around the moment `t`, 0 … 1. Source: Catmull & Rom, "A class of local
/// interpolating splines", in Computer Aided Geometric Design, 1974, with the tension ½.
fn catmull_rom(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (t3 - t2),
    ]
}

/// The rim of a bounded field: the rectangle of its samples, and the one within which it is as it was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Lower and upper corner (x, z) of the rectangle of the samples, m.
    pub outer_m: [DVec2; 2],
    /// The same of the part that is not blended.
    pub inner_m: [DVec2; 2],
    /// Most that the blending changes a height, m.
    pub changed_m: f64,
}

impl Rim {
    fn recentred(&self, origin_m: DVec2) -> Self {
        Self {
            outer_m: self.outer_m.map(|corner_m| corner_m - origin_m),
            inner_m: self.inner_m.map(|corner_m| corner_m - origin_m),
            ..*self
        }
    }
}

/// What is to be said of a height field beside its heights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldNotes {
    /// The rim, if blending it changes any height.
    pub rim: Option<Rim>,
    /// Share of the mean square slope in the files that no surface has, 0 … 1.
    pub no_gradient: f64,
    /// Second derivative that the steps of the numbers in the files add, root mean square, 1/m.
    pub curvature_of_steps_per_m: f64,
}

impl FieldNotes {
    /// See [`super::Surface::recentred`].
    pub(super) fn recentred(self, origin_m: DVec2) -> Self {
        Self {
            rim: self.rim.map(|rim| rim.recentred(origin_m)),
            ..self
        }
    }
}

/// The surface at a moment, and what is to be said of it.
pub(super) fn heights(
    waves: &HeightField,
    frames: &Arc<FieldFrames>,
    moment: &Moment,
) -> (Heights, FieldNotes) {
    let size = waves.size(frames.file_size());
    let step_m = DVec2::from(waves.sample_m.per_axis_m());
    let count = DVec2::new(size[0] as f64, size[1] as f64);
    let side_m = (count - 1.0) * step_m;
    let corner_m = waves.min_m.map_or(-0.5 * side_m, DVec2::from);
    let is_bounded = waves.edges == FieldEdges::Bounded;
    let mut no_gradient = 0.0;
    let mut heights_m = match waves.holds {
        FieldHolds::Heights => {
            let rest_m = waves.rest_m.unwrap_or_else(|| frames.rest_m(waves.edges));
            let mut heights_m = values(waves, frames, moment, size, 0);
            heights_m
                .iter_mut()
                .for_each(|height_m| *height_m -= rest_m);
            heights_m
        }
        FieldHolds::Slopes => {
            let slopes = [0, 1].map(|channel| values(waves, frames, moment, size, channel));
            let integrate = if is_bounded {
                gradient::integrate_bounded
            } else {
                gradient::integrate_periodic
            };
            let integrated = integrate(slopes, size, step_m);
            no_gradient = integrated.no_gradient;
            integrated.heights_m
        }
    };
    let rim_m = waves.rim_used_m(size);
    let changed_m = if is_bounded {
        blend(&mut heights_m, size, step_m, rim_m)
    } else {
        0.0
    };
    let rim = (changed_m > 0.0).then(|| Rim {
        outer_m: [corner_m, corner_m + side_m],
        inner_m: [corner_m + rim_m, corner_m + side_m - rim_m],
        changed_m,
    });
    // Errors of rounding to a step of 1 are even over it: 1/√12.
    let step_error = frames.resolution() / 12.0_f64.sqrt();
    let per_step = step_m.recip();
    let curvature_of_steps_per_m = step_error
        * match waves.holds {
            FieldHolds::Heights => CURVATURE_OF_NOISE * (per_step * per_step).length(),
            FieldHolds::Slopes => SLOPE_OF_NOISE * per_step.length(),
        };
    let heights = Heights {
        edges: if is_bounded {
            Edges::Flat
        } else {
            Edges::Repeats
        },
        shortest_wave_m: shortest_wave_m(&heights_m, size, step_m),
        heights_m,
        size,
        step_m,
        corner_m,
        // The spline is the surface.
        slope_lost: 0.0,
        description: match frames.count() {
            1 => "a height field".to_owned(),
            count => format!("a height field of {count} frames"),
        },
    };
    let notes = FieldNotes {
        rim,
        no_gradient,
        curvature_of_steps_per_m,
    };
    (heights, notes)
}

/// The values of a channel at a moment, row by row along x.
fn values(
    waves: &HeightField,
    frames: &FieldFrames,
    moment: &Moment,
    [width, height]: [usize; 2],
    channel: usize,
) -> Vec<f64> {
    let rows = frames.file_size()[1];
    let place = |x: usize, z: usize| {
        let (row, column) = match waves.rows_along {
            RowAxis::X => (z, x),
            RowAxis::Z => (x, z),
        };
        match waves.first_row {
            FirstRow::Min => (row, column),
            FirstRow::Max => (rows - 1 - row, column),
        }
    };
    let mut values = vec![0.0; width * height];
    let lines = values.par_chunks_exact_mut(width).enumerate();
    lines.for_each(|(z, line)| {
        for (x, value) in line.iter_mut().enumerate() {
            let (row, column) = place(x, z);
            let weights = moment.weights.iter();
            *value = weights
                .map(|(frame, weight)| weight * frames.value(*frame, channel, row, column))
                .sum();
        }
    });
    values
}

/// Blends heights to 0 within `rim_m` of the edges, with two continuous derivatives. Returns the largest change, m.
fn blend(heights_m: &mut [f64], [width, height]: [usize; 2], step_m: DVec2, rim_m: f64) -> f64 {
    let shares = |count: usize, step_m: f64| -> Vec<f64> {
        (0..count)
            .map(|i| i.min(count - 1 - i) as f64 * step_m / rim_m)
            .map(|t| t.min(1.0))
            .map(|t| t * t * t * (10.0 + t * (6.0 * t - 15.0)))
            .collect()
    };
    let (along_x, along_z) = (shares(width, step_m.x), shares(height, step_m.y));
    let mut changed_m: f64 = 0.0;
    for (row, share_z) in heights_m.chunks_exact_mut(width).zip(along_z) {
        for (height_m, share_x) in row.iter_mut().zip(&along_x) {
            let blended_m = *height_m * share_x * share_z;
            changed_m = changed_m.max((*height_m - blended_m).abs());
            *height_m = blended_m;
        }
    }
    changed_m
}

/// Length of the shortest wave that counts, m; infinite if the water is flat. All but [`UNNOTICED_SLOPE`] of the mean square slope along x
/// is in waves of at most some wave number along x; likewise along z.
fn shortest_wave_m(heights_m: &[f64], [width, height]: [usize; 2], step_m: DVec2) -> f64 {
    let columns: Vec<f64> = (0..width)
        .flat_map(|x| (0..height).map(move |z| heights_m[z * width + x]))
        .collect();
    let k_x = highest_wave_number(heights_m, width, step_m.x);
    let k_z = highest_wave_number(&columns, height, step_m.y);
    TAU / k_x.hypot(k_z)
}

/// See [`shortest_wave_m`]; of lines of `count` samples, rad/m.
fn highest_wave_number(lines: &[f64], count: usize, step_m: f64) -> f64 {
    let fft = FftPlanner::new().plan_fft_forward(count);
    let half = count / 2 + 1;
    let of_lines: Vec<Vec<f64>> = lines
        .par_chunks_exact(count)
        .map(|line| {
            let mut line: Vec<Complex64> = line.iter().map(|h| Complex64::new(*h, 0.0)).collect();
            fft.process(&mut line);
            let frequencies = line[..half].iter().enumerate();
            frequencies
                .map(|(n, h)| (n * n) as f64 * h.norm_sqr())
                .collect()
        })
        .collect();
    let mut slopes = vec![0.0; half];
    for line in &of_lines {
        for (sum, slope) in slopes.iter_mut().zip(line) {
            *sum += slope;
        }
    }
    let all: f64 = slopes.iter().sum();
    let mut beyond = 0.0;
    let is_noticed = |slope: &f64| {
        beyond += slope;
        beyond > UNNOTICED_SLOPE * all
    };
    let highest = slopes.iter().rposition(is_noticed).unwrap_or(0);
    highest as f64 * TAU / (count as f64 * step_m)
}
