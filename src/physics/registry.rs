//! The twins: every function of `shaders/lib/`, with its f64 original, its domain, and how far f32 may be off.
//!
//! A test lists the functions of `shaders/lib/` and fails for one without a row; the GPU tests and the self-check run every
//! row over its domain: zeros of both signs, numbers below the smallest normal one, neighbours of 1, both ends.
//!
//! WGSL lets a GPU take numbers below 2⁻¹²⁶ for 0, as arguments and on the way: a result counts that is right for the arguments as
//! they are or for those with such numbers taken for 0, and bounds have a part for what is lost on the way.
//!
//! - `domain`: what arguments are tried;
//! - `bounds`: how far f32 may be off where that depends on the arguments;
//! - `rows`: the twins.

mod bounds;
mod domain;
mod rows;

pub use domain::{Domain, Spacing, samples};
pub use rows::{CALL_PRELUDE, TWINS};

/// How far the f32 value may be off: |error| ≤ absolute + relative · |true value| + conditioning(arguments).
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Absolute part.
    pub absolute: f64,
    /// Relative part.
    pub relative: f64,
    /// Part that depends on the arguments.
    pub conditioning: fn(&[f64]) -> f64,
    /// Where the figures come from: "derived" from the roundings of each step, or "measured".
    pub reason: &'static str,
}

impl Tolerance {
    /// Most that the result may be off `truth` at these arguments.
    pub fn allowed(&self, arguments: &[f64], truth: f64) -> f64 {
        self.absolute + self.relative * truth.abs() + (self.conditioning)(arguments)
    }
}

/// A function in both languages.
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
    /// The same in f64; `None` where a rounding decides between two right answers: any number is right there.
    pub original: fn(&[f64]) -> Option<[f64; 4]>,
    /// How far off f32 may be.
    pub tolerance: Tolerance,
}

impl Twin {
    /// Error of `found` at these arguments as a share of what is allowed; infinite for what is no number.
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
