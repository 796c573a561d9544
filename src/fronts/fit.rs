//! Irradiance from field values: a v^b, with a and b fitted to a reference.
//!
//! The paper chooses both by hand, so that pictures look alike. Here they minimise the distance to reference values over a set of points.
//! For a given b the best a is known, so only b is searched: on an even grid of exponents first, because the distance can have
//! several minima, then by golden sections around the best.
//!
//! Source: Mercier, §4.1 (the power law).

use super::FrontError;

/// Exponents that are tried.
const EXPONENTS: [f64; 2] = [0.05, 6.0];

/// Exponents on the even grid.
const TRIED: usize = 120;

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// Σ |a v^b − r|: the project's error.
    Absolute,
    /// Σ (a v^b − r)².
    Squares,
}

/// A power law a v^b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// Factor.
    pub a: f64,
    /// Exponent.
    pub b: f64,
}

/// A fitted power law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The law.
    pub law: PowerLaw,
    /// Σ |a v^b − r| / Σ r.
    pub relative_l1: f64,
    /// Whether the exponent lies at an end of the range that is searched, so that the best may lie outside.
    pub at_end: bool,
}

impl PowerLaw {
    /// Values as they are.
    pub const NONE: Self = Self { a: 1.0, b: 1.0 };

    /// a v^b for a value ≥ 0; a negative value counts as 0.
    pub fn of(self, value: f64) -> f64 {
        self.a * value.max(0.0).powf(self.b)
    }

    /// Turns the values of each slice into irradiance with the mean `mean` (flux is kept); a slice without light stays dark.
    /// `slice` is the number of values of a slice. The law's factor has no effect here.
    pub fn keep_flux(self, values: &mut [f32], slice: usize, mean: f64) {
        for slice in values.chunks_mut(slice) {
            let mut sum = 0.0;
            for value in slice.iter_mut() {
                let lit = f64::from(value.max(0.0)).powf(self.b);
                sum += lit;
                *value = lit as f32;
            }
            if sum > 0.0 {
                let factor = mean * slice.len() as f64 / sum;
                for value in slice.iter_mut() {
                    *value = (f64::from(*value) * factor) as f32;
                }
            }
        }
    }
}

/// Fits a v^b to pairs (v, r) of field values v ≥ 0 and reference values r ≥ 0.
///
/// # Errors
/// Fewer than 3 points, values that are negative or not finite, or no light on either side.
pub fn fit(points: &[(f64, f64)], distance: Distance) -> Result<Fit, FrontError> {
    let refuse = |reason| FrontError::Fit {
        points: points.len(),
        reason,
    };
    if points.len() < 3 {
        return Err(refuse("at least 3 are needed"));
    }
    let is_fine = |value: f64| value.is_finite() && value >= 0.0;
    if !points.iter().all(|(v, r)| is_fine(*v) && is_fine(*r)) {
        return Err(refuse("values have to be finite and not negative"));
    }
    let total: f64 = points.iter().map(|(_, r)| r).sum();
    if total <= 0.0 || points.iter().all(|(v, _)| *v <= 0.0) {
        return Err(refuse("field and reference need some light"));
    }
    // Relative to the brightest, so that no power overflows.
    let most = points.iter().map(|(v, _)| *v).fold(0.0, f64::max);
    let scaled: Vec<(f64, f64)> = points.iter().map(|(v, r)| (v / most, *r)).collect();
    let mut work = Vec::with_capacity(points.len());
    let mut cost = |b: f64| best_factor(&scaled, b, distance, &mut work).1;
    let [low, high] = EXPONENTS;
    let step = (high - low) / (TRIED - 1) as f64;
    let mut best = (f64::INFINITY, 0);
    for tried in 0..TRIED {
        let here = cost(low + tried as f64 * step);
        if here < best.0 {
            best = (here, tried);
        }
    }
    let (mut from, mut to) = (
        (low + (best.1 as f64 - 1.0) * step).max(low),
        (low + (best.1 as f64 + 1.0) * step).min(high),
    );
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..40 {
        let (left, right) = (to - golden * (to - from), from + golden * (to - from));
        if cost(left) <= cost(right) {
            to = right;
        } else {
            from = left;
        }
    }
    let b = 0.5 * (from + to);
    let law = PowerLaw {
        a: best_factor(&scaled, b, distance, &mut work).0 / most.powf(b),
        b,
    };
    let off: f64 = points.iter().map(|(v, r)| (law.of(*v) - r).abs()).sum();
    Ok(Fit {
        law,
        relative_l1: off / total,
        at_end: b - low < 1e-3 || high - b < 1e-3,
    })
}

/// The best factor for an exponent, and the distance that is left.
fn best_factor(
    points: &[(f64, f64)],
    b: f64,
    distance: Distance,
    work: &mut Vec<(f64, f64)>,
) -> (f64, f64) {
    let powers = points.iter().map(|(v, r)| (v.powf(b), *r));
    match distance {
        Distance::Squares => {
            let [pr, pp] = powers
                .clone()
                .fold([0.0, 0.0], |[pr, pp], (p, r)| [pr + p * r, pp + p * p]);
            let a = pr / pp;
            (a, powers.map(|(p, r)| (a * p - r).powi(2)).sum())
        }
        Distance::Absolute => {
            // The median of r / p, weighted by p.
            work.clear();
            work.extend(
                powers
                    .clone()
                    .filter(|(p, _)| *p > 0.0)
                    .map(|(p, r)| (r / p, p)),
            );
            work.sort_by(|x, y| x.0.total_cmp(&y.0));
            let half: f64 = 0.5 * work.iter().map(|(_, p)| p).sum::<f64>();
            let mut below = 0.0;
            let median = work.iter().find(|(_, p)| {
                below += p;
                below >= half
            });
            let a = median.map_or(0.0, |(a, _)| *a);
            (a, powers.map(|(p, r)| (a * p - r).abs()).sum())
        }
    }
}
