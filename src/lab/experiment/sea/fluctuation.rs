//! Figures of maps: mean, coefficient of variation, peaks.

use serde::{Deserialize, Serialize};

use super::study::Estimate;

/// The rank of the value that stands for the peaks: one detector in a thousand, at any moment, sees more.
const PEAK_RANK: f64 = 0.999;

/// Values in rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row.
    pub values: Vec<f64>,
}

impl Grid {
    /// The means of blocks of 2 × 2 values; an odd last row or column is left out.
    #[must_use]
    pub fn halved(&self) -> Self {
        let [width, height] = [self.width / 2, self.height / 2];
        let values = (0..height).flat_map(|z| (0..width).map(move |x| (x, z)));
        let mean = |(x, z): (usize, usize)| {
            let at = |i: usize, j: usize| self.values[(2 * z + j) * self.width + 2 * x + i];
            0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
        };
        Self {
            width,
            height,
            values: values.map(mean).collect(),
        }
    }
}

/// Figures of several maps of the same place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fluctuation {
    /// Mean over all values.
    pub mean: Estimate,
    /// Standard deviation over mean.
    pub cv: Estimate,
    /// The value that one in a thousand exceeds, over the mean.
    pub peak: Estimate,
    /// The largest value, over the mean.
    pub highest: f64,
}

/// Sums over a map.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Sums {
    fn of(map: &Grid) -> Self {
        Self {
            count: map.values.len() as f64,
            sum: map.values.iter().sum(),
            squares: map.values.iter().map(|v| v * v).sum(),
        }
    }

    fn without(self, other: Self) -> Self {
        Self {
            count: self.count - other.count,
            sum: self.sum - other.sum,
            squares: self.squares - other.squares,
        }
    }

    fn mean(self) -> f64 {
        self.sum / self.count
    }

    fn cv(self) -> f64 {
        let mean = self.mean();
        (self.squares / self.count / (mean * mean) - 1.0)
            .max(0.0)
            .sqrt()
    }
}

/// The figures of maps that do not depend on each other, with standard errors by leaving out one map after the other (jackknife; of the
/// peak: from the spread of the maps' own). `None` without values.
pub fn fluctuation(maps: &[Grid]) -> Option<Fluctuation> {
    let each: Vec<Sums> = maps.iter().map(Sums::of).collect();
    let all = each.iter().fold(Sums::default(), |a, b| Sums {
        count: a.count + b.count,
        sum: a.sum + b.sum,
        squares: a.squares + b.squares,
    });
    if all.count == 0.0 || all.sum <= 0.0 {
        return None;
    }
    let jackknife = |of: fn(Sums) -> f64| {
        let without: Vec<f64> = each.iter().map(|one| of(all.without(*one))).collect();
        Estimate::jackknife(of(all), &without)
    };
    let mean = all.mean();
    let peaks: Vec<f64> = maps
        .iter()
        .map(|map| ranked(&mut map.values.clone(), PEAK_RANK) / mean)
        .collect();
    let mut values: Vec<f64> = maps.iter().flat_map(|map| &map.values).copied().collect();
    let highest = values.iter().copied().fold(0.0, f64::max) / mean;
    Some(Fluctuation {
        mean: jackknife(Sums::mean),
        cv: jackknife(Sums::cv),
        peak: Estimate {
            value: ranked(&mut values, PEAK_RANK) / mean,
            error: Estimate::of_mean(&peaks).error,
        },
        highest,
    })
}

/// The value below which this share of the values lies.
fn ranked(values: &mut [f64], rank: f64) -> f64 {
    let at = ((values.len() as f64 * rank) as usize).min(values.len().saturating_sub(1));
    match values.get(at) {
        Some(_) => *values.select_nth_unstable_by(at, f64::total_cmp).1,
        None => 0.0,
    }
}
