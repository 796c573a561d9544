//! A damped oscillator that is released at rest, at any time after its release.
//!
//! a″ + 2γ a′ + ω² a = 0 with a(0) = 1, a′(0) = 0. Source: Landau and Lifshitz, Mechanics, 3rd ed., §25.

use super::turns::{fraction_of_product, sin_cos_turns};

/// A time that has passed, as the sum of two numbers: the difference of two times, exact however large they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elapsed {
    /// The difference, rounded, s.
    s: f64,
    /// What rounding took from it, s.
    rest_s: f64,
}

impl Elapsed {
    /// The time from `start_s` to `end_s`. Source: Knuth, The Art of Computer Programming, vol. 2, 3rd ed., §4.2.2, theorem B.
    pub fn between(start_s: f64, end_s: f64) -> Self {
        let s = end_s - start_s;
        let back = s - end_s;
        let rest_s = (end_s - (s - back)) - (start_s + back);
        Self { s, rest_s }
    }

    /// The time, rounded, s; below 0 if and only if the end comes before the start.
    pub fn seconds(self) -> f64 {
        self.s
    }
}

/// Where a released oscillator is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// a; 1 at the release.
    pub amplitude: f64,
    /// a′, 1/s; 0 at the release.
    pub rate_per_s: f64,
}

/// An oscillator by its frequency and damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator {
    angular_frequency_per_s: f64,
    damping_per_s: f64,
    motion: Motion,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// γ < ω, with Ω = √(ω² − γ²).
    Swinging { omega_per_s: f64, turns_per_s: f64 },
    /// γ ≥ ω, with κ = √(γ² − ω²): the slower rate γ − κ, and 2κ, by which the faster one exceeds it.
    Creeping { slow_per_s: f64, gap_per_s: f64 },
}

impl Oscillator {
    /// The oscillator with the undamped angular frequency ω, rad/s, and the damping γ, 1/s, both at least 0.
    pub fn of(angular_frequency_per_s: f64, damping_per_s: f64) -> Self {
        let (omega, gamma) = (angular_frequency_per_s, damping_per_s);
        // √|ω² − γ²| by ratios: without damping it is ω to the last digit, and squares of small numbers do not become 0.
        let larger = omega.max(gamma);
        let root = if larger > 0.0 {
            larger * ((omega - gamma).abs() / larger * ((omega + gamma) / larger)).sqrt()
        } else {
            0.0
        };
        let motion = if omega > gamma {
            Motion::Swinging {
                omega_per_s: root,
                turns_per_s: root / std::f64::consts::TAU,
            }
        } else {
            // γ − κ without cancellation; without a restoring force, ω = 0, nothing moves.
            let share = if omega > 0.0 {
                omega / (gamma + root)
            } else {
                0.0
            };
            Motion::Creeping {
                slow_per_s: omega * share,
                gap_per_s: 2.0 * root,
            }
        };
        Self {
            angular_frequency_per_s,
            damping_per_s,
            motion,
        }
    }

    /// Amplitude and rate when `elapsed`, at least 0, has passed since the release:
    /// a = e^(−γτ) (cos Ωτ + γ/Ω sin Ωτ), a′ = −ω²/Ω e^(−γτ) sin Ωτ.
    ///
    /// With γ ≥ ω the same functions of κ = iΩ, written as a = e^(−(γ−κ)τ) (1 + (γ−κ) τ φ) with φ = (1 − e^(−2κτ))/(2κτ): a sum of
    /// terms above 0, which loses no digits near γ = ω.
    ///
    /// The product of the frequency and τ is reduced to a turn with all its digits. So the phase is as accurate as ω, whose relative
    /// error of some 3·10⁻¹⁶ counts τ times: at 1 Hz and τ = 10⁹ s it is right to 10⁻⁶ turns.
    pub fn swing(&self, elapsed: Elapsed) -> Swing {
        let (tau, gamma) = (elapsed.s, self.damping_per_s);
        let omega = self.angular_frequency_per_s;
        match self.motion {
            Motion::Swinging {
                omega_per_s,
                turns_per_s,
            } => {
                let fraction = fraction_of_product(turns_per_s, tau);
                let (sin, cos) = sin_cos_turns(fraction + turns_per_s * elapsed.rest_s);
                let fall = (-gamma * tau).exp();
                Swing {
                    amplitude: fall * (cos + gamma / omega_per_s * sin),
                    rate_per_s: -fall * omega * (omega / omega_per_s) * sin,
                }
            }
            Motion::Creeping {
                slow_per_s,
                gap_per_s,
            } => {
                let exponent = gap_per_s * tau;
                let phi = if exponent > 0.0 {
                    -(-exponent).exp_m1() / exponent
                } else {
                    1.0
                };
                let fall = (-slow_per_s * tau).exp();
                Swing {
                    amplitude: fall * (1.0 + slow_per_s * tau * phi),
                    rate_per_s: -fall * omega * omega * tau * phi,
                }
            }
        }
    }
}
