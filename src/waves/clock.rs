//! Phases of waves in whole numbers: exact at any time.

/// Frequencies of a sea that never repeats are multiples of 2⁻³⁰ Hz (about 10⁻⁹ Hz): it does repeat after 34 years.
const UNIT_S: f64 = (1_u64 << 30) as f64;

/// Moments of a sea that repeats are multiples of 2⁻²⁸ of the loop, so that a rounding error of the time does not show, not even after a
/// thousand loops.
const LOOP_BITS: u32 = 28;

/// Share of a multiple above which a moment belongs to the next one: none at which a simple fraction of the loop lies.
const LOOP_BORDER: f64 = 0.618_034;

/// The unit of frequency of a sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// Reciprocal, s.
    unit_s: f64,
    repeats: bool,
}

impl Unit {
    /// `loop_s` is the time after which the sea repeats, if it does.
    pub(super) fn of(loop_s: Option<f64>) -> Self {
        Self {
            unit_s: loop_s.unwrap_or(UNIT_S),
            repeats: loop_s.is_some(),
        }
    }

    /// `frequency_hz` in whole units. A wave that moves has at least one unit: a pair of opposite waves that stood still would have another
    /// height than the spectrum says.
    pub(super) fn count(self, frequency_hz: f64) -> u64 {
        let least = if frequency_hz > 0.0 { 1.0 } else { 0.0 };
        (frequency_hz * self.unit_s).round().max(least) as u64
    }

    /// The moment `time_s`.
    pub(super) fn clock(self, time_s: f64) -> Clock {
        // The remainder is exact.
        let turns = time_s.abs() % self.unit_s / self.unit_s;
        let phase = if self.repeats {
            ((turns * (1_u64 << LOOP_BITS) as f64 + (1.0 - LOOP_BORDER)).floor() as u128)
                << (96 - LOOP_BITS)
        } else {
            // Exact above 2⁻¹³ s, else to 2⁻⁶⁶ s.
            (turns * 2.0_f64.powi(96)) as u128
        };
        Clock {
            phase: if time_s < 0.0 {
                phase.wrapping_neg()
            } else {
                phase
            },
        }
    }
}

/// A moment, as the phase of a wave of the unit of frequency.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    /// In 2⁻⁹⁶ turns; higher bits are whole turns.
    phase: u128,
}

impl Clock {
    /// Phase, −½ … ½ turns, of a wave whose frequency is this many units; it is exact to the last bit.
    pub(super) fn turns(self, units: u64) -> f64 {
        // What the product loses are whole turns.
        let phase = (u128::from(units).wrapping_mul(self.phase) >> 32) as u64;
        phase.cast_signed() as f64 / 2.0_f64.powi(64)
    }
}
