//! Flashes: how often, and for how long, detectors see more than a threshold.

use super::study::{Estimate, FlashFigures};

/// The threshold of a flash, over the mean irradiance, as in the publications.
pub(super) const THRESHOLD: f64 = 1.5;

/// Counts of time series of the same length and step, one for each detector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flashes {
    threshold: f64,
    last: Vec<bool>,
    /// Number of times that a detector went from at most the threshold to above it.
    pub upward: u64,
    /// Steps of all detectors in which that could happen.
    pub steps: u64,
    /// Samples above the threshold.
    pub above: u64,
    /// All samples.
    pub samples: u64,
}

impl Flashes {
    /// Nothing counted yet.
    pub fn over(threshold: f64) -> Self {
        Self {
            threshold,
            ..Self::default()
        }
    }

    /// The next frame: a value for each detector, always the same number and order.
    pub fn push(&mut self, values: &[f64]) {
        let now: Vec<bool> = values.iter().map(|v| *v > self.threshold).collect();
        if !self.last.is_empty() {
            let pairs = self.last.iter().zip(&now);
            self.upward += pairs.filter(|(before, now)| !**before && **now).count() as u64;
            self.steps += now.len() as u64;
        }
        self.above += now.iter().filter(|above| **above).count() as u64;
        self.samples += now.len() as u64;
        self.last = now;
    }

    fn joined<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            upward: sum.upward + one.upward,
            steps: sum.steps + one.steps,
            above: sum.above + one.above,
            samples: sum.samples + one.samples,
            ..sum
        })
    }

    /// Flashes per minute and detector.
    fn per_minute(&self, step_s: f64) -> f64 {
        60.0 * self.upward as f64 / (self.steps as f64 * step_s)
    }

    /// Mean length of a flash, ms: the share of time above the threshold over the flashes in a time. So flashes that are cut by the ends
    /// of a series count right. `None` without flashes.
    fn length_ms(&self, step_s: f64) -> Option<f64> {
        let share = self.above as f64 / self.samples as f64;
        let per_ms = self.per_minute(step_s) / 60e3;
        (self.upward > 0).then(|| share / per_ms)
    }
}

/// The figures of series of several seas, with a frame every `step_s`. `None` without two frames of any.
pub fn flashes(seas: &[Flashes], step_s: f64) -> Option<FlashFigures> {
    let all = Flashes::joined(seas.iter());
    if all.steps == 0 {
        return None;
    }
    let without = |index: usize| {
        let others = seas.iter().enumerate().filter(|(i, _)| *i != index);
        Flashes::joined(others.map(|(_, sea)| sea))
    };
    let others: Vec<Flashes> = (0..seas.len()).map(without).collect();
    let others: Vec<&Flashes> = others.iter().filter(|other| other.steps > 0).collect();
    let rates: Vec<f64> = others.iter().map(|o| o.per_minute(step_s)).collect();
    let lengths: Option<Vec<f64>> = others.iter().map(|o| o.length_ms(step_s)).collect();
    Some(FlashFigures {
        per_minute: Estimate::jackknife(all.per_minute(step_s), &rates),
        length_ms: all.length_ms(step_s).map(|length_ms| match lengths {
            Some(lengths) => Estimate::jackknife(length_ms, &lengths),
            None => Estimate::exact(length_ms),
        }),
        counted: all.upward,
    })
}
