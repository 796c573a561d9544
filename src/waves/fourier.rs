//! Sums of waves on a square grid, by fast Fourier transforms.

use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// Coefficients of e^(i (i x + j z)), x and z in turns of the tile, of a real function that repeats: for i = 0 … `reach`, each with
/// those for j = −`reach` … `reach`. Those for negative i are the complex conjugates of their opposites.
pub(super) type HalfSpectrum = Vec<Vec<Complex64>>;

/// Values of the function on `size` × `size` points, row by row along x (i). `size` is even and above twice the reach.
pub(super) fn values(spectrum: &HalfSpectrum, size: usize) -> Vec<f64> {
    let reach = spectrum.len() - 1;
    let fft = FftPlanner::new().plan_fft_inverse(size);
    let columns: Vec<Vec<Complex64>> = spectrum
        .par_iter()
        .map_init(
            || scratch(&*fft),
            |scratch, coefficients| {
                let mut column = vec![Complex64::ZERO; size];
                let (negative, others) = coefficients.split_at(reach);
                column[size - reach..].copy_from_slice(negative);
                column[..=reach].copy_from_slice(others);
                fft.process_with_scratch(&mut column, scratch);
                column
            },
        )
        .collect();
    let mut values = vec![0.0; size * size];
    // Two rows of real values in one transform: as its real and its imaginary part.
    values
        .par_chunks_exact_mut(2 * size)
        .enumerate()
        .for_each_init(
            || (scratch(&*fft), vec![Complex64::ZERO; size]),
            |(scratch, line), (pair, rows)| {
                line.fill(Complex64::ZERO);
                for (i, column) in columns.iter().enumerate() {
                    let (a, b) = (column[2 * pair], column[2 * pair + 1]);
                    if i == 0 {
                        line[0] = Complex64::new(a.re, b.re);
                    } else {
                        line[i] = Complex64::new(a.re - b.im, a.im + b.re);
                        line[size - i] = Complex64::new(a.re + b.im, b.re - a.im);
                    }
                }
                fft.process_with_scratch(line, scratch);
                let (first, second) = rows.split_at_mut(size);
                for ((value, first), second) in line.iter().zip(first).zip(second) {
                    (*first, *second) = (value.re, value.im);
                }
            },
        );
    values
}

fn scratch(fft: &dyn Fft<f64>) -> Vec<Complex64> {
    vec![Complex64::ZERO; fft.get_inplace_scratch_len()]
}
