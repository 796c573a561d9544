//! Directional spreading: how the variance of waves of one length is distributed over directions.
//!
//! Angles θ are to the direction of the wind. All distributions are in 1/rad and integrate to 1 over the circle.
//!
//! *Swell*, 0 … 1, narrows them, most below the peak: D is multiplied by cos^2q(θ/2), q = 16 tanh(ω_p/ω) swell², and normalised again.
//! Source: Horvath, "Empirical directional wave spectra for computer graphics", DigiPro 2015. Where the product has no closed
//! integral, the form of D is kept and narrowed as much near θ = 0: cos^2q(θ/2) ≈ exp(−q θ²/4).

use std::f64::consts::PI;

/// The distribution of one wave length.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Factor that makes the integral 1.
    norm: f64,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    /// cos^2n θ, 0 against the wind.
    Cosine { n: f64 },
    /// cos^2s(θ/2).
    HalfAngle { s: f64 },
    /// sech²(β θ).
    Sech { beta: f64 },
    /// (1 + Δ cos 2θ) cos^2q(θ/2).
    TwoSided { delta: f64, q: f64 },
}

impl Spread {
    /// (2/π) cos² θ with the wind and 0 against it; swell: cos^2n θ, n = 1 + q/4. `ratio` = ω/ω_p.
    ///
    /// Source: Pierson, Neumann & James, Practical Methods for Observing and Forecasting Ocean Waves (1955).
    pub fn cos2(ratio: f64, swell: f64) -> Self {
        let n = 1.0 + 0.25 * swell_exponent(ratio, swell);
        Self {
            norm: gamma_ratio(n) / PI.sqrt(),
            shape: Shape::Cosine { n },
        }
    }

    /// cos^2s(θ/2) with s = 6.97 `ratio`^4.06 for `ratio` = ω/ω_p below 1.05, else 9.77 `ratio`^−(2.33 + 1.45 (U/c_p − 1.17)); U/c_p is
    /// `inverse_age`. Swell adds q to s.
    ///
    /// Source: Hasselmann, Dunckel & Ewing, "Directional wave spectra observed during JONSWAP 1973", Journal of Physical Oceanography
    /// 10, 1980.
    pub fn hasselmann(ratio: f64, inverse_age: f64, swell: f64) -> Self {
        let s = if ratio < 1.05 {
            6.97 * ratio.powf(4.06)
        } else {
            9.77 * ratio.powf(-(2.33 + 1.45 * (inverse_age - 1.17)))
        };
        let s = s + swell_exponent(ratio, swell);
        Self {
            norm: half_angle_norm(s),
            shape: Shape::HalfAngle { s },
        }
    }

    /// sech²(β θ) with β = 2.61 `ratio`^1.3 for `ratio` = ω/ω_p from 0.56, 2.28 `ratio`^−1.3 from 0.95, 10^(−0.4 + 0.8393
    /// exp(−0.567 ln `ratio`²)) from 1.6, and 1.24 below 0.56. Swell adds q/4 to β².
    ///
    /// Source: Donelan, Hamilton & Hui, "Directional spectra of wind-generated waves", Philosophical Transactions of the Royal Society A
    /// 315, 1985; from 1.6 on: Banner, "Equilibrium spectra of wind waves", Journal of Physical Oceanography 20, 1990.
    pub fn donelan_banner(ratio: f64, swell: f64) -> Self {
        let beta = if ratio < 0.56 {
            1.24
        } else if ratio < 0.95 {
            2.61 * ratio.powf(1.3)
        } else if ratio < 1.6 {
            2.28 * ratio.powf(-1.3)
        } else {
            10.0_f64.powf(-0.4 + 0.8393 * ratio.powf(-2.0 * 0.567))
        };
        let beta = (beta * beta + 0.25 * swell_exponent(ratio, swell)).sqrt();
        Self {
            norm: 0.5 * beta / (PI * beta).tanh(),
            shape: Shape::Sech { beta },
        }
    }

    /// (1 + Δ cos 2θ)/2π; `delta` from [`elfouhaily_delta`]. As much goes against the wind as with it, except for swell, of waves with
    /// `ratio` = ω/ω_p.
    pub fn elfouhaily(delta: f64, ratio: f64, swell: f64) -> Self {
        let q = swell_exponent(ratio, swell);
        // Mean of cos 2θ under cos^2q(θ/2).
        let mean = q * (q - 1.0) / ((q + 1.0) * (q + 2.0));
        Self {
            norm: half_angle_norm(q) / (1.0 + delta * mean),
            shape: Shape::TwoSided { delta, q },
        }
    }

    /// D, 1/rad, at the angle with this cosine.
    pub fn density(&self, cos_angle: f64) -> f64 {
        let cos = cos_angle.clamp(-1.0, 1.0);
        let half_angle = |exponent: f64| {
            if exponent == 0.0 {
                1.0
            } else {
                (0.5 + 0.5 * cos).powf(exponent)
            }
        };
        let shape = match self.shape {
            Shape::Cosine { .. } if cos <= 0.0 => 0.0,
            Shape::Cosine { n: 1.0 } => cos * cos,
            Shape::Cosine { n } => cos.powf(2.0 * n),
            Shape::HalfAngle { s } => half_angle(s),
            Shape::Sech { beta } => (beta * cos.acos()).cosh().powi(-2),
            Shape::TwoSided { delta, q } => (1.0 + delta * (2.0 * cos * cos - 1.0)) * half_angle(q),
        };
        self.norm * shape
    }
}

/// Δ = tanh(a_0 + a_p (c/c_p)^2.5 + a_m (c_m/c)^2.5), a_0 = ln 2/4, a_p = 4, a_m = 0.13 u*/c_m, for waves of phase speed c; speeds in m/s.
///
/// Source: Elfouhaily et al., Journal of Geophysical Research 102(C7), 1997, eq. 57–59.
pub fn elfouhaily_delta(
    speed_m_per_s: f64,
    peak_speed_m_per_s: f64,
    friction_velocity_m_per_s: f64,
) -> f64 {
    let slowest = super::sea::SLOWEST_WAVE_M_PER_S;
    let power = |x: f64| x * x * x.sqrt();
    let short = 0.13 * friction_velocity_m_per_s / slowest;
    (2.0_f64.ln() / 4.0
        + 4.0 * power(speed_m_per_s / peak_speed_m_per_s)
        + short * power(slowest / speed_m_per_s))
    .tanh()
}

/// q of swell, see the head of this file.
fn swell_exponent(ratio: f64, swell: f64) -> f64 {
    if swell == 0.0 {
        return 0.0;
    }
    16.0 * ratio.recip().tanh() * swell * swell
}

/// 1 over the integral of cos^2s(θ/2) over the circle: Γ(s + 1)/(2 √π Γ(s + ½)).
fn half_angle_norm(s: f64) -> f64 {
    0.5 * gamma_ratio(s) / PI.sqrt()
}

/// Γ(s + 1)/Γ(s + ½) for s ≥ 0, to 10⁻¹².
///
/// With x = s + ¼: √x exp(Σ −E_2m/(m 4^(2m+1)) x^−2m), E the Euler numbers, from s = 10 on; below through r(s) = r(s + 1) (s + ½)/(s + 1).
/// Source: difference of two series NIST DLMF 5.11.8.
fn gamma_ratio(s: f64) -> f64 {
    let (mut s, mut factor) = (s, 1.0);
    while s < 10.0 {
        factor *= (s + 0.5) / (s + 1.0);
        s += 1.0;
    }
    let x = s + 0.25;
    let y = 1.0 / (x * x);
    let series = y
        * (1.0 / 64.0 + y * (-5.0 / 2048.0 + y * (61.0 / 49_152.0 + y * (-1385.0 / 1_048_576.0))));
    factor * x.sqrt() * series.exp()
}
