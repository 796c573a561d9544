//! Logarithmic axes: range, ticks and where a value lies.

/// A logarithmic axis between two logical pixels.
#[derive(Clone, Debug)]
pub(super) struct LogAxis {
    /// Natural logarithms of the ends.
    range: (f64, f64),
    /// Logical pixels of the ends.
    pixels: (f64, f64),
}

/// A line of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tick {
    pub value: f64,
    /// Whether it has a label.
    pub labelled: bool,
}

/// Labels that an axis has room for.
const MOST_LABELS: usize = 9;

impl LogAxis {
    /// An axis that holds all values (each above 0), with a factor of `margin` beyond them, and at least a factor of `least`
    /// from end to end.
    pub(super) fn new(values: &[f64], margin: f64, least: f64, pixels: (f64, f64)) -> Self {
        let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = values.iter().copied().fold(0.0, f64::max);
        let (mut low, mut high) = (lowest.ln() - margin.ln(), highest.ln() + margin.ln());
        let lacking = least.ln() - (high - low);
        if lacking > 0.0 {
            low -= 0.5 * lacking;
            high += 0.5 * lacking;
        }
        Self {
            range: (low, high),
            pixels,
        }
    }

    /// Logical pixel of a value above 0.
    pub(super) fn at(&self, value: f64) -> f64 {
        let share = (value.ln() - self.range.0) / (self.range.1 - self.range.0);
        self.pixels.0 + share * (self.pixels.1 - self.pixels.0)
    }

    /// The values at the ends.
    pub(super) fn ends(&self) -> (f64, f64) {
        (self.range.0.exp(), self.range.1.exp())
    }

    /// 1 … 9 of each power of ten. Labelled are the powers of ten, with 2 and 5 where there are few of them, and every second
    /// or third where there are many.
    pub(super) fn decimal_ticks(&self) -> Vec<Tick> {
        let (low, high) = self.ends();
        let first = low.log10().floor() as i32;
        let last = high.log10().ceil() as i32;
        let all: Vec<(i32, i32, f64)> = (first..=last)
            .flat_map(|power| (1..10).map(move |digit| (power, digit)))
            .map(|(power, digit)| (power, digit, power_of_ten(power) * f64::from(digit)))
            .filter(|(_, _, value)| (low..=high).contains(value))
            .collect();
        let decades = all.iter().filter(|(_, digit, _)| *digit == 1).count();
        let step = decades.div_ceil(MOST_LABELS).max(1) as i32;
        let dense = decades <= 2;
        all.iter()
            .map(|(power, digit, value)| Tick {
                value: *value,
                labelled: match digit {
                    1 => power.rem_euclid(step) == 0,
                    2 | 5 => dense,
                    _ => false,
                },
            })
            .collect()
    }
}

/// Exact where it can be: 0.1 and not 0.100…01.
fn power_of_ten(power: i32) -> f64 {
    if power < 0 {
        1.0 / 10f64.powi(-power)
    } else {
        10f64.powi(power)
    }
}
