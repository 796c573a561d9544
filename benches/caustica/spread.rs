//! Statistics over several runs.

use std::time::{Duration, Instant};

use crate::Effort;

/// Most runs behind a value.
const MOST_RUNS: usize = 200;

/// The values of several runs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spread {
    /// In order of size.
    sorted: Vec<f64>,
}

impl Spread {
    /// Summarises runs; without any, all statistics are NaN.
    pub(crate) fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self { sorted: values }
    }

    /// The number of runs.
    pub(crate) fn runs(&self) -> usize {
        self.sorted.len()
    }

    /// The median.
    pub(crate) fn median(&self) -> f64 {
        self.percentile(50.0)
    }

    /// The smallest run.
    pub(crate) fn min(&self) -> f64 {
        self.sorted.first().copied().unwrap_or(f64::NAN)
    }

    /// The largest run.
    pub(crate) fn max(&self) -> f64 {
        self.sorted.last().copied().unwrap_or(f64::NAN)
    }

    /// By nearest rank, 0 … 100.
    pub(crate) fn percentile(&self, percentile: f64) -> f64 {
        let rank = (percentile / 100.0 * self.sorted.len() as f64).ceil() as usize;
        let index = rank.clamp(1, self.sorted.len().max(1)) - 1;
        self.sorted.get(index).copied().unwrap_or(f64::NAN)
    }
}

/// Runs `measure` as often as the effort says; what it gives and how long each took, ms.
///
/// # Errors
/// The first of `measure`.
pub(crate) fn repeat<T, E>(
    effort: Effort,
    mut measure: impl FnMut() -> Result<T, E>,
) -> Result<(Vec<T>, Spread), E> {
    let started = Instant::now();
    let (mut results, mut times) = (Vec::new(), Vec::new());
    while results.len() < effort.least_runs
        || (started.elapsed() < effort.row && results.len() < MOST_RUNS)
    {
        let run = Instant::now();
        results.push(measure()?);
        times.push(ms(run.elapsed()));
    }
    Ok((results, Spread::of(times)))
}

/// A duration in milliseconds.
pub(crate) fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
