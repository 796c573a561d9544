//! Sums of waves on a square grid, by fast Fourier transforms.

use rayon::prelude::*;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// Coefficients of e^(i (i x + j z)), x and z in turns of the tile, of a real function that repeats: for i = 0 … `reach`, each with
/// those for j = −`reach` … `reach`. Those for negative i are the complex conjugates of their opposites.
pub(super) type HalfSpectrum = Vec<Vec<Complex64>>;

/// Pairs of rows that are transformed together: columns are read a few cache lines at a time.
const PAIRS: usize = 4;

/// Values of the function on `size` × `size` points, row by row along x (i). Each coefficient is multiplied by `scale` of |i| and of |j|.
/// `size` is a multiple of 8 and above twice the reach.
pub(super) fn values(
    spectrum: &HalfSpectrum,
    size: usize,
    scale: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let reach = spectrum.len() - 1;
    let scales: Vec<f64> = (0..=reach).map(scale).collect();
    let fft = FftPlanner::new().plan_fft_inverse(size);
    let mut columns = vec![Complex64::ZERO; (reach + 1) * size];
    let filled = columns
        .par_chunks_exact_mut(size)
        .zip(spectrum)
        .zip(&scales);
    filled.for_each_init(
        || scratch(&*fft),
        |scratch, ((column, coefficients), scale)| {
            let (negative, others) = coefficients.split_at(reach);
            for (j, coefficient) in others.iter().enumerate() {
                column[j] = coefficient * (scale * scales[j]);
            }
            for (j, coefficient) in (1..=reach).zip(negative.iter().rev()) {
                column[size - j] = coefficient * (scale * scales[j]);
            }
            fft.process_with_scratch(column, scratch);
        },
    );
    let mut values = vec![0.0; size * size];
    // Two rows of real values in one transform: as its real and its imaginary part.
    values
        .par_chunks_mut(2 * PAIRS * size)
        .enumerate()
        .for_each_init(
            || (scratch(&*fft), vec![Complex64::ZERO; PAIRS * size]),
            |(scratch, lines), (block, rows)| {
                lines.fill(Complex64::ZERO);
                for (i, column) in columns.chunks_exact(size).enumerate() {
                    let of_rows = column[2 * PAIRS * block..].chunks_exact(2);
                    for (line, pair) in lines.chunks_exact_mut(size).zip(of_rows) {
                        let (a, b) = (pair[0], pair[1]);
                        if i == 0 {
                            line[0] = Complex64::new(a.re, b.re);
                        } else {
                            line[i] = Complex64::new(a.re - b.im, a.im + b.re);
                            line[size - i] = Complex64::new(a.re + b.im, b.re - a.im);
                        }
                    }
                }
                fft.process_with_scratch(lines, scratch);
                for (rows, line) in rows
                    .chunks_exact_mut(2 * size)
                    .zip(lines.chunks_exact(size))
                {
                    let (first, second) = rows.split_at_mut(size);
                    for ((value, first), second) in line.iter().zip(first).zip(second) {
                        (*first, *second) = (value.re, value.im);
                    }
                }
            },
        );
    values
}

fn scratch(fft: &dyn Fft<f64>) -> Vec<Complex64> {
    vec![Complex64::ZERO; fft.get_inplace_scratch_len()]
}
