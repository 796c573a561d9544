//! Sums of standing waves on an even grid, by fast Fourier transforms.

use std::f64::consts::TAU;
use std::sync::Arc;

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// Amplitudes of a mode (m, n), m: the factors of cos·cos, cos·sin, sin·cos and sin·sin, with the function of x first.
pub(super) type Parts = [f64; 4];

/// A grid along one axis, on a tile after whose length everything repeats. The mode number m is cos and sin of m turns per tile.
pub(super) struct Line {
    fft: Arc<dyn Fft<f64>>,
    /// e^(2πi m s), where s is the place of the first sample as a share of the tile, for each mode.
    shifts: Vec<Complex<f64>>,
}

impl Line {
    /// `samples` samples of a tile, the first at the share `first` of its length, that carry the modes 0 … `highest`, below half the
    /// number of samples.
    pub(super) fn of(samples: usize, first: f64, highest: usize) -> Self {
        Self {
            fft: FftPlanner::new().plan_fft_inverse(samples),
            shifts: (0..=highest)
                .map(|mode| Complex::cis(TAU * (first * mode as f64)))
                .collect(),
        }
    }

    /// The sums of two real series at all samples, the first as real and the second as imaginary part. `series` gives for each mode
    /// the two pairs of cos − i sin.
    fn sums(&self, series: impl Fn(usize) -> [Complex<f64>; 2], scratch: &mut Scratch) {
        let (count, i) = (self.fft.len(), Complex::<f64>::I);
        scratch.values.clear();
        scratch.values.resize(count, Complex::ZERO);
        scratch
            .inner
            .resize(self.fft.get_inplace_scratch_len(), Complex::ZERO);
        for (mode, shift) in self.shifts.iter().enumerate() {
            let [one, other] = series(mode).map(|pair| pair * shift);
            if mode == 0 {
                scratch.values[0] = Complex::new(one.re, other.re);
            } else {
                // A real series: half at the mode, its conjugate at the opposite one.
                scratch.values[mode] = (one + i * other) * 0.5;
                scratch.values[count - mode] = (one.conj() + i * other.conj()) * 0.5;
            }
        }
        self.fft
            .process_with_scratch(&mut scratch.values, &mut scratch.inner);
    }

    /// For one m, the modes (m, n) added up along z: at each sample of the line its cos, real, and sin, imaginary, along x.
    pub(super) fn column(&self, modes: &[Parts]) -> Vec<Complex<f64>> {
        let mut scratch = Scratch::default();
        let series = |n: usize| {
            let [cos_cos, cos_sin, sin_cos, sin_sin] = modes[n];
            [
                Complex::new(cos_cos, -cos_sin),
                Complex::new(sin_cos, -sin_sin),
            ]
        };
        self.sums(series, &mut scratch);
        scratch.values
    }

    /// The rows of the grid along x from the columns of all m.
    pub(super) fn rows(&self, columns: &[Vec<Complex<f64>>]) -> Vec<f64> {
        let (width, height) = (self.fft.len(), columns[0].len());
        let mut grid = vec![0.0; width * height];
        // Two rows at a time; the second of the last pair may be missing.
        grid.par_chunks_mut(2 * width).enumerate().for_each_init(
            Scratch::default,
            |scratch, (pair, rows)| {
                let series = |m: usize| {
                    let column = &columns[m];
                    let other = column.get(2 * pair + 1).copied().unwrap_or_default();
                    [column[2 * pair].conj(), other.conj()]
                };
                self.sums(series, scratch);
                let (one, other) = rows.split_at_mut(width);
                for (height, sum) in one.iter_mut().zip(&scratch.values) {
                    *height = sum.re;
                }
                for (height, sum) in other.iter_mut().zip(&scratch.values) {
                    *height = sum.im;
                }
            },
        );
        grid
    }
}

/// Memory of the transforms.
#[derive(Default)]
struct Scratch {
    values: Vec<Complex<f64>>,
    inner: Vec<Complex<f64>>,
}
