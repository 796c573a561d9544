//! The twins: every function of `shaders/lib/`, with its f64 original, its domain and the tolerance of f32.
//!
//! A test lists the functions of `shaders/lib/` and fails for one without a row. The GPU tests and the self-check run every row
//! over its domain, including zeros of both signs, subnormal numbers, neighbours of 1, and both ends.
//!
//! WGSL lets a GPU flush numbers below 2⁻¹²⁶ to 0, in arguments and in intermediate results. So a result is accepted if it is
//! right for the arguments as given or with such arguments flushed to 0, and the bounds include what is lost in intermediate
//! results.
//!
//! - `domain`: the arguments to test with;
//! - `bounds`: the tolerances that depend on the arguments;
//! - `rows`: the twins.

mod bounds;
mod domain;
mod rows;

pub use domain::{Domain, Spacing, samples};
pub use rows::{CALL_PRELUDE, TWINS};

/// Tolerance of the f32 value: |error| ≤ absolute + relative · |true value| + conditioning(arguments).
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Absolute part.
    pub absolute: f64,
    /// Relative part.
    pub relative: f64,
    /// Part that depends on the arguments.
    pub conditioning: fn(&[f64]) -> f64,
    /// Origin of the figures: "derived" from the roundings of each step, or "measured".
    pub reason: &'static str,
}

impl Tolerance {
    /// Largest accepted difference of the result from `truth` at these arguments.
    pub fn allowed(&self, arguments: &[f64], truth: f64) -> f64 {
        self.absolute + self.relative * truth.abs() + (self.conditioning)(arguments)
    }
}

/// A function in Rust and in WGSL.
#[derive(Clone, Copy, Debug)]
pub struct Twin {
    /// Its name in Rust and WGSL.
    pub name: &'static str,
    /// File below `shaders/`.
    pub file: &'static str,
    /// Its arguments, at most eight.
    pub domain: &'static [Domain],
    /// WGSL expression of type vec4f over `a: array<f32, 8>`.
    pub call: &'static str,
    /// The same in f64; `None` where rounding decides between two right answers, so that any number is accepted.
    pub original: fn(&[f64]) -> Option<[f64; 4]>,
    /// Tolerance of the f32 value.
    pub tolerance: Tolerance,
}

impl Twin {
    /// Error of `found` at these arguments as a share of the tolerance; infinite for NaN.
    pub fn error(&self, arguments: &[f64], found: [f32; 4]) -> f64 {
        if found.iter().any(|value| !value.is_finite()) {
            return f64::INFINITY;
        }
        let flushed: Vec<f64> = arguments
            .iter()
            .map(|&a| {
                if a.abs() < bounds::SMALLEST_NORMAL {
                    0.0
                } else {
                    a
                }
            })
            .collect();
        let against = |arguments: &[f64]| {
            let Some(truth) = (self.original)(arguments) else {
                return 0.0;
            };
            let shares = truth.iter().zip(found).map(|(truth, found)| {
                (f64::from(found) - truth).abs() / self.tolerance.allowed(arguments, *truth)
            });
            // NaN never passes.
            shares.fold(0.0, |worst: f64, share| {
                if share.is_nan() {
                    f64::INFINITY
                } else {
                    worst.max(share)
                }
            })
        };
        against(arguments).min(against(&flushed))
    }
}

/// All twins.
pub fn all() -> impl Iterator<Item = &'static Twin> {
    TWINS.iter()
}
