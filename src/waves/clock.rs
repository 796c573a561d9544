//! Phases of waves in whole numbers: exact at any time.

/// Frequencies of a sea that never repeats are multiples of 2⁻³⁰ Hz (about 10⁻⁹ Hz): it does repeat after 34 years.
const UNIT_S: f64 = (1_u64 << 30) as f64;

/// Moments of a sea that repeats are multiples of 2⁻⁴⁰ of the loop, so that a rounding error of the time does not show.
const LOOP_BITS: u32 = 40;

/// A moment, as the phase of a wave of the unit of frequency.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    /// Reciprocal of the unit of frequency, s.
    unit_s: f64,
    /// Phase of a wave of one unit, in 2⁻⁹⁶ turns; higher bits are whole turns.
    phase: u128,
}

impl Clock {
    /// `loop_s` is the time after which the sea repeats, if it does.
    pub(super) fn at(time_s: f64, loop_s: Option<f64>) -> Self {
        let unit_s = loop_s.unwrap_or(UNIT_S);
        // The remainder is exact.
        let turns = time_s.abs() % unit_s / unit_s;
        let phase = if loop_s.is_some() {
            ((turns * (1_u64 << LOOP_BITS) as f64).round() as u128) << (96 - LOOP_BITS)
        } else {
            // Exact above 2⁻¹³ s, else to 2⁻⁶⁶ s.
            (turns * 2.0_f64.powi(96)) as u128
        };
        Self {
            unit_s,
            phase: if time_s < 0.0 {
                phase.wrapping_neg()
            } else {
                phase
            },
        }
    }

    /// Phase of a wave of `frequency_hz`, rounded to whole units, in 2⁻⁶⁴ turns. A wave that moves has at least one unit: a pair of opposite
    /// waves that stood still would have another height than the spectrum says.
    pub(super) fn phase(&self, frequency_hz: f64) -> u64 {
        let least = if frequency_hz > 0.0 { 1.0 } else { 0.0 };
        let units = (frequency_hz * self.unit_s).round().max(least) as u128;
        // What the product loses are whole turns.
        (units.wrapping_mul(self.phase) >> 32) as u64
    }
}
