//! Wave spectra: the variance of the sea's height per frequency or wave number.
//!
//! All are one-sided: the integral over positive frequencies, or wave numbers, is the variance, m². The spread over directions is in
//! [`super::spreading`].

use std::f64::consts::TAU;

use super::constants::GRAVITY_M_PER_S2;

/// Dimensionless fetch g F/U² from which a JONSWAP sea no longer grows.
const FULLY_DEVELOPED: f64 = 1.8e4;

/// Level α of a fully developed sea. Source: Pierson & Moskowitz, Journal of Geophysical Research 69, 1964, p. 5188.
const DEVELOPED_LEVEL: f64 = 8.1e-3;

/// A frequency spectrum S(ω) = α g² ω⁻⁵ exp(−β (ω_p/ω)⁴) γ^r, r = exp(−(ω − ω_p)²/(2 σ² ω_p²)), σ = 0.07 up to ω_p and 0.09 above.
#[derive(Clone, Copy, Debug)]
pub struct FrequencySpectrum {
    level: f64,
    decay: f64,
    peak_rad_per_s: f64,
    ln_gamma: f64,
}

impl FrequencySpectrum {
    /// A fully developed sea under a wind of `wind_m_per_s` (above 0): α = 8.1·10⁻³, β ω_p⁴ = 0.74 (g/U)⁴, ω_p = 0.87 g/U, γ = 1.
    ///
    /// Source: Pierson & Moskowitz, Journal of Geophysical Research 69, 1964, p. 5188. Their U is the wind at 19.5 m, which is about
    /// 1.03 times that at 10 m. As in EncinoWaves (Horvath, "Empirical directional wave spectra for computer graphics", DigiPro
    /// 2015), the wind at 10 m stands in its place: waves are 5 % lower.
    pub fn pierson_moskowitz(wind_m_per_s: f64) -> Self {
        let unit = GRAVITY_M_PER_S2 / wind_m_per_s;
        Self {
            level: DEVELOPED_LEVEL,
            decay: 0.74 / 0.87_f64.powi(4),
            peak_rad_per_s: 0.87 * unit,
            ln_gamma: 0.0,
        }
    }

    /// A sea that grows with the fetch, under a wind of `wind_m_per_s` (above 0, at 10 m) over `fetch_m` (above 0), with peak
    /// enhancement `gamma` (at least 1): x = g F/U², α = 0.076 x^−0.22, ω_p = 2π · 3.5 (g/U) x^−0.33, β = 1.25.
    ///
    /// Source: Hasselmann et al., "Measurements of wind-wave growth and swell decay during the Joint North Sea Wave Project",
    /// Deutsche Hydrographische Zeitschrift A8(12), 1973. The fits are from x = 10² … 10⁴. From x = 1.8·10⁴ on the sea is fully developed:
    /// a longer fetch changes nothing.
    pub fn jonswap(wind_m_per_s: f64, fetch_m: f64, gamma: f64) -> Self {
        let unit = GRAVITY_M_PER_S2 / wind_m_per_s;
        let x = (unit / wind_m_per_s * fetch_m).min(FULLY_DEVELOPED);
        Self {
            level: 0.076 * x.powf(-0.22),
            decay: 1.25,
            peak_rad_per_s: TAU * 3.5 * unit * x.powf(-0.33),
            ln_gamma: gamma.ln(),
        }
    }

    /// ω_p, rad/s.
    pub fn peak_rad_per_s(&self) -> f64 {
        self.peak_rad_per_s
    }

    /// S(ω), m² s, at `omega_rad_per_s`; 0 at 0 and below.
    pub fn at(&self, omega_rad_per_s: f64) -> f64 {
        if omega_rad_per_s <= 0.0 {
            return 0.0;
        }
        let ratio = omega_rad_per_s / self.peak_rad_per_s;
        let width = if ratio <= 1.0 { 0.07 } else { 0.09 };
        let offset = (ratio - 1.0) / width;
        let enhancement = self.ln_gamma * (-0.5 * offset * offset).exp();
        let cut = (enhancement - self.decay / ratio.powi(4)).exp();
        if cut == 0.0 {
            return 0.0;
        }
        self.level * GRAVITY_M_PER_S2.powi(2) / omega_rad_per_s.powi(5) * cut
    }
}

/// Ratio of the spectrum in water of a finite depth d to that in deep water, at `kd` = k d (above 0): tanh²(kd) / (1 + 2 kd/sinh(2 kd)).
///
/// It keeps k⁻³ (∂k/∂ω) S the same at all depths. Source: Kitaigorodskii, Krasitskii & Zaslavskii, Journal of Physical Oceanography 5,
/// 1975; Bouws et al., "Similarity of the wind wave spectrum in finite depth water", Journal of Geophysical Research 90(C1), 1985,
/// with the dispersion relation of gravity waves put in.
pub fn depth_factor(kd: f64) -> f64 {
    let factor = kd.tanh();
    if factor == 0.0 {
        return 0.0;
    }
    factor * factor / (1.0 + 2.0 * kd / (2.0 * kd).sinh())
}

/// Wave number spectrum, m³, at `k_per_m` (above 0) under a wind of `wind_m_per_s` (above 0): ½ α k⁻³ exp(−1/(k L)²), L = U²/g.
///
/// Source: Tessendorf, "Simulating ocean water", SIGGRAPH course notes 2001, whose level is free: the level here gives short
/// waves the heights of Pierson and Moskowitz, whose spectrum is ½ α k⁻³ for ω ≫ ω_p in deep water. Peak: see [`phillips_peak`].
pub fn phillips(k_per_m: f64, wind_m_per_s: f64) -> f64 {
    let kl = k_per_m * (wind_m_per_s * wind_m_per_s / GRAVITY_M_PER_S2);
    let cut = (-1.0 / (kl * kl)).exp();
    if cut == 0.0 {
        return 0.0;
    }
    0.5 * DEVELOPED_LEVEL / k_per_m.powi(3) * cut
}

/// Frequency of the largest waves of [`phillips`] in deep water, rad/s: 0.8^¼ g/U, since it is S = α g² ω⁻⁵ exp(−(g/(U ω))⁴) there.
pub fn phillips_peak(wind_m_per_s: f64) -> f64 {
    0.8_f64.powf(0.25) * GRAVITY_M_PER_S2 / wind_m_per_s
}

/// Friction velocity, m/s, of a wind of `wind_m_per_s` at 10 m: √C U, C = (0.8 + 0.065 U)·10⁻³ with U in m/s.
///
/// Source: Wu, "Wind-stress coefficients over sea surface from breeze to hurricane", Journal of Geophysical Research 87(C12), 1982.
pub fn friction_velocity(wind_m_per_s: f64) -> f64 {
    (0.8e-3 + 0.065e-3 * wind_m_per_s).sqrt() * wind_m_per_s
}

/// Phase speed of the slowest waves, c_m, m/s. Source: Elfouhaily et al. (see [`Elfouhaily`]), after eq. 40.
pub const SLOWEST_WAVE_M_PER_S: f64 = 0.23;

/// The unified spectrum, from long waves to those that surface tension drives.
///
/// Source: Elfouhaily, Chapron, Katsaros & Vandemark, "A unified directional spectrum for long and short wind-driven waves", Journal of
/// Geophysical Research 102(C7), 1997.
#[derive(Clone, Copy, Debug)]
pub struct Elfouhaily {
    /// Ω, wind speed over the phase speed at the peak.
    inverse_age: f64,
    peak_per_m: f64,
    peak_speed_m_per_s: f64,
    ln_gamma: f64,
    /// δ of the peak enhancement.
    peak_width: f64,
    short_level: f64,
}

impl Elfouhaily {
    /// The sea under a wind of `wind_m_per_s` (above 0, at 10 m) over `fetch_m` (above 0).
    ///
    /// k_0 = g/U², X = k_0 F, Ω = 0.84 tanh((X/2.2·10⁴)^0.4)^−0.75 (eq. 37), k_p = k_0 Ω², γ = 1.7 + 6 log₁₀ Ω for Ω above 1, else 1.7,
    /// δ = 0.08 (1 + 4 Ω⁻³) (eq. 3). Level of short waves: α_m = 0.01 (1 + ln(u*/c_m)), with 3 ln for u* above c_m (eq. 44), here at least
    /// 0 (it is below under winds of less than 2.8 m/s); u* from [`friction_velocity`].
    pub fn of(wind_m_per_s: f64, fetch_m: f64) -> Self {
        let k_0 = GRAVITY_M_PER_S2 / (wind_m_per_s * wind_m_per_s);
        let inverse_age = 0.84 * (k_0 * fetch_m / 2.2e4).powf(0.4).tanh().powf(-0.75);
        let gamma = 1.7 + 6.0 * inverse_age.log10().max(0.0);
        let peak_per_m = k_0 * inverse_age * inverse_age;
        let gain = (friction_velocity(wind_m_per_s) / SLOWEST_WAVE_M_PER_S).ln();
        Self {
            inverse_age,
            peak_per_m,
            peak_speed_m_per_s: phase_speed(peak_per_m),
            ln_gamma: gamma.ln(),
            peak_width: 0.08 * (1.0 + 4.0 / inverse_age.powi(3)),
            short_level: 0.01 * (1.0 + if gain > 0.0 { 3.0 * gain } else { gain }).max(0.0),
        }
    }

    /// Frequency at the peak, rad/s.
    pub fn peak_rad_per_s(&self) -> f64 {
        self.peak_per_m * self.peak_speed_m_per_s
    }

    /// Phase speed at the peak, m/s.
    pub fn peak_speed_m_per_s(&self) -> f64 {
        self.peak_speed_m_per_s
    }

    /// Wave number spectrum k⁻³ (B_l + B_h), m³, at `k_per_m` (above 0).
    ///
    /// B_l = ½ α_p (c_p/c) L J exp(−Ω/√10 (√(k/k_p) − 1)), α_p = 0.006 √Ω (eq. 31, 32, 34); B_h = ½ α_m (c_m/c) L J exp(−¼ (k/k_m − 1)²)
    /// (eq. 40, 41); L = exp(−1.25 (k_p/k)²) and J = γ^exp(−(√(k/k_p) − 1)²/(2 δ²)) (eq. 2, 3). Eq. 41 as printed lacks L J, without which
    /// B_h has infinite variance at small k; Mobley, Ocean Optics Web Book, "Wave variance spectra: examples", puts it in.
    pub fn at(&self, k_per_m: f64) -> f64 {
        let ratio = k_per_m / self.peak_per_m;
        let root = ratio.sqrt() - 1.0;
        let enhancement =
            self.ln_gamma * (-0.5 * root * root / (self.peak_width * self.peak_width)).exp();
        let at_peak = (enhancement - 1.25 / (ratio * ratio)).exp();
        if at_peak == 0.0 {
            return 0.0;
        }
        let long = 0.006
            * self.inverse_age.sqrt()
            * self.peak_speed_m_per_s
            * (-self.inverse_age / 10.0_f64.sqrt() * root).exp();
        let from_slowest = k_per_m / slowest_wave_per_m() - 1.0;
        let short =
            self.short_level * SLOWEST_WAVE_M_PER_S * (-0.25 * from_slowest * from_slowest).exp();
        0.5 * (long + short) / phase_speed(k_per_m) * at_peak / k_per_m.powi(3)
    }
}

/// Wave number of the slowest waves, k_m = 2 g/c_m², 1/m. Source: Elfouhaily et al. (see [`Elfouhaily`]), eq. 24.
fn slowest_wave_per_m() -> f64 {
    2.0 * GRAVITY_M_PER_S2 / (SLOWEST_WAVE_M_PER_S * SLOWEST_WAVE_M_PER_S)
}

/// Phase speed in deep water, c = √(g/k (1 + (k/k_m)²)), m/s, as the unified spectrum has it. Source: Elfouhaily et al. (see
/// [`Elfouhaily`]), eq. 24.
pub fn phase_speed(k_per_m: f64) -> f64 {
    let ratio = k_per_m / slowest_wave_per_m();
    (GRAVITY_M_PER_S2 / k_per_m * (1.0 + ratio * ratio)).sqrt()
}
