//! The fields of waves: each kind, and what can be said of it before it is computed.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::height_field::HeightField;
use super::parse::{inner, integer, tagged};
use super::ranges::{BasinSamples, Seed, SpectrumSamples};
use super::types::{GerstnerKind, RipplesKind, SineKind, SpectrumKind};

/// Waves of one kind; those of all kinds add up. `kind` selects the type.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum Wave {
    /// `kind = "sine"`.
    Sine(SineWave),
    /// `kind = "gerstner"`.
    Gerstner(GerstnerWave),
    /// `kind = "spectrum"`.
    Spectrum(SpectrumWaves),
    /// `kind = "ripples"`.
    Ripples(Ripples),
    /// `kind = "height_field"`.
    HeightField(Box<HeightField>),
}

impl<'de> Deserialize<'de> for Wave {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let kinds = ["sine", "gerstner", "spectrum", "ripples", "height_field"];
        tagged(deserializer, None, &kinds, |kind, value| match kind {
            "gerstner" => inner(value).map(Self::Gerstner),
            "spectrum" => inner(value).map(Self::Spectrum),
            "ripples" => inner(value).map(Self::Ripples),
            "height_field" => inner(value).map(Self::HeightField),
            _ => inner(value).map(Self::Sine),
        })
    }
}

impl Wave {
    /// Number of standing waves that have to be computed for all drops; 0 for other kinds. Waves in open water take as long as sixteen.
    pub fn swings(&self) -> u64 {
        match self {
            Self::Ripples(waves) => u64::from(waves.samples)
                .saturating_pow(2)
                .saturating_mul(waves.drops.len() as u64)
                .saturating_mul(match waves.walls {
                    Walls::Absorbing => 16,
                    Walls::Reflecting | Walls::Periodic => 1,
                }),
            _ => 0,
        }
    }

    /// Samples of the grid on which the waves are computed; 0 for waves with a formula. A basin with reflecting walls has its mirror images
    /// on the grid, one with absorbing walls the water around it. Those of a height field are in its files; see [`super::resolve`].
    pub fn grid_samples(&self) -> u64 {
        match self {
            Self::Sine(_) | Self::Gerstner(_) | Self::HeightField(_) => 0,
            Self::Spectrum(waves) => u64::from(waves.samples).saturating_pow(2),
            Self::Ripples(waves) => {
                let samples = u64::from(waves.samples);
                let side = match waves.walls {
                    Walls::Periodic => samples,
                    Walls::Reflecting => 2 * samples,
                    Walls::Absorbing => samples + 2 * waves.layer_samples() as u64,
                };
                side.saturating_pow(2)
            }
        }
    }
}

/// h(x, z, t) = A sin(2π/λ (x cos θ + z sin θ) − ω t + φ).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SineWave {
    /// Always `sine`.
    pub kind: SineKind,
    /// Amplitude A, m, 0 … 100.
    pub amplitude_m: f64,
    /// Wavelength λ, m, 10⁻³ … 10⁵.
    pub wavelength_m: f64,
    /// Direction θ, degrees from +X towards +Z, −10⁶ … 10⁶. Default 0.
    #[serde(default)]
    pub direction_deg: f64,
    /// Phase φ, degrees, −10⁶ … 10⁶. Default 0.
    #[serde(default)]
    pub phase_deg: f64,
    /// Period 2π/ω, s, 10⁻⁶ … 10¹². Default: from the dispersion relation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
}

/// A Gerstner wave: a trochoid, with crests sharper than troughs. Its height over x is that of the curve
/// x = (α − s sin α)/k, h = A cos α + ½ s A: surface points move on ellipses of radius A up and s/k to the sides, and the mean height is 0.
/// Several waves add up as heights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct GerstnerWave {
    /// Always `gerstner`.
    pub kind: GerstnerKind,
    /// Amplitude A, half the height from trough to crest, m, 0 … 100.
    pub amplitude_m: f64,
    /// Wavelength λ = 2π/k, m, 10⁻³ … 10⁵.
    pub wavelength_m: f64,
    /// Direction, degrees from +X towards +Z, −10⁶ … 10⁶. Default 0.
    #[serde(default)]
    pub direction_deg: f64,
    /// Phase, degrees, −10⁶ … 10⁶; at 0 a crest passes the origin at time 0. Default 0.
    #[serde(default)]
    pub phase_deg: f64,
    /// Period, s, 10⁻⁶ … 10¹². Default: from the dispersion relation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// Steepness s, 0 (a sine) … 0.95; at 1 crests become cusps, beyond they fold over themselves. Default: k A, for which points move
    /// on circles, as in deep water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steepness: Option<f64>,
}

impl GerstnerWave {
    /// The steepness, given or by default.
    pub fn steepness_used(&self) -> f64 {
        let circles = std::f64::consts::TAU * self.amplitude_m / self.wavelength_m;
        self.steepness.unwrap_or(circles)
    }
}

/// A sea with a wave spectrum: random waves on a square tile that repeats.
///
/// The same seed gives the same sea whatever `samples`. Several spectra whose tiles do not divide each other hide the repetition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SpectrumWaves {
    /// Always `spectrum`.
    pub kind: SpectrumKind,
    /// The spectrum.
    pub model: SpectrumModel,
    /// Wind speed 10 m above the sea, m/s, 0 … 60.
    pub wind_speed_m_s: f64,
    /// Direction in which the wind blows, degrees from +X towards +Z, −10⁶ … 10⁶. Default 0.
    #[serde(default)]
    pub wind_direction_deg: f64,
    /// Distance over which the wind has blown, m, 1 … 10⁷; the measurements behind the models are from g · fetch / wind² = 10² … 10⁴. Default 300 000. `phillips` and `pierson_moskowitz` ignore it: their seas are
    /// fully developed, as is that of `jonswap` and `tma` where g · fetch / wind² exceeds 1.8·10⁴.
    #[serde(default = "default_fetch")]
    pub fetch_m: f64,
    /// Peak enhancement γ of `jonswap` and `tma`, 1 … 10. Default 3.3.
    #[serde(default = "default_gamma")]
    pub gamma: f64,
    /// How waves spread around the direction of the wind. Default `cos2`; `elfouhaily` for the model of that name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spreading: Option<Spreading>,
    /// Swell: narrows the spreading of long waves, 0 … 1. Default 0.
    #[serde(default)]
    pub swell: f64,
    /// Shortest wave, m, 10⁻³ … 10⁵. Default: the shortest that the samples carry, four samples long.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_wavelength_m: Option<f64>,
    /// Longest wave, m, 10⁻³ … 10⁵. Default: the tile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_wavelength_m: Option<f64>,
    /// Significant wave height, four times the standard deviation of the height over tile and time, m, 0 … 100: the sea of this seed is
    /// scaled to it exactly, if the spectrum has any wave in its band. Default: what the spectrum has there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub significant_height_m: Option<f64>,
    /// How far surface points move to the sides, in heights of their waves, 0 (not at all) … 2; at 1 they move on circles, as in deep
    /// water. Crests become sharper than troughs. A sea that folds over itself, or nearly, at the moment of a frame is refused with
    /// the choppiness that it allows there. The mean height stays 0. `significant_height_m`, and the warning `waves_smoothed`,
    /// are about the waves before they are moved to the sides. Default 0.
    #[serde(default)]
    pub choppiness: f64,
    /// Side of the tile, m, 0.01 … 10⁴.
    pub tile_m: f64,
    /// Samples along each side of the tile: a power of two, 64 … 2048. Default 512.
    #[serde(
        default = "default_samples",
        deserialize_with = "integer::<SpectrumSamples, _>"
    )]
    #[schema(minimum = 64, maximum = 2048)]
    pub samples: u32,
    /// Selects one sea of many, 0 … 2³² − 1. Default 0.
    #[serde(default, deserialize_with = "integer::<Seed, _>")]
    pub seed: u32,
    /// Time after which the sea repeats, s, 10⁻³ … 10⁶: frequencies are rounded to multiples of its reciprocal, at least to one. Default:
    /// never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loop_s: Option<f64>,
}

impl SpectrumWaves {
    /// The shortest wave that the samples carry, m: four samples long.
    pub fn shortest_carried_m(&self) -> f64 {
        4.0 * self.tile_m / f64::from(self.samples)
    }

    /// The shortest and the longest wave, m.
    pub fn band_m(&self) -> [f64; 2] {
        let shortest_m = self.min_wavelength_m.unwrap_or(self.shortest_carried_m());
        let longest_m = self.max_wavelength_m.unwrap_or(self.tile_m);
        [shortest_m, longest_m.min(self.tile_m)]
    }
}

fn default_fetch() -> f64 {
    300_000.0
}

fn default_gamma() -> f64 {
    3.3
}

fn default_samples() -> u32 {
    512
}

/// A wave spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpectrumModel {
    /// Phillips (1957) as used by Tessendorf (2001), with the level of Pierson and Moskowitz.
    Phillips,
    /// Pierson and Moskowitz (1964): a fully developed sea.
    PiersonMoskowitz,
    /// JONSWAP (Hasselmann et al. 1973): a sea that grows with the fetch.
    Jonswap,
    /// TMA (Bouws et al. 1985): JONSWAP in water of the floor's depth; without a floor, or with `water.dispersion` = `deep`, as `jonswap`.
    Tma,
    /// Elfouhaily et al. (1997): with the short waves that the wind makes.
    Elfouhaily,
}

/// A distribution of wave directions around the wind's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Spreading {
    /// cos² of the angle to the wind, none against it.
    Cos2,
    /// Hasselmann, Dunckel and Ewing (1980): broader away from the peak.
    Hasselmann,
    /// Donelan, Hamilton and Hui (1985), with Banner's (1990) short waves.
    DonelanBanner,
    /// Elfouhaily et al. (1997).
    Elfouhaily,
}

/// Ripples in a rectangular basin.
///
/// Without obstacles the solution is exact at any time: between reflecting walls and in a periodic basin by its modes, with absorbing walls
/// as part of open water. Beyond reflecting walls the surface continues as a mirror image, and a periodic basin repeats. Beyond absorbing
/// walls it fades to flat water within an eighth of the longer side (at least 8 samples); further out the water is at rest.
///
/// With obstacles the waves are computed in steps of time, each 0.9 of the longest stable one, on the grid of the samples: h_tt + 2γ h_t =
/// ∇·(c² ∇h) by finite differences of second order. Absorbing walls are then a perfectly matched layer where the surface fades.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Ripples {
    /// Always `ripples`.
    pub kind: RipplesKind,
    /// Lower corner (x, z) of the basin, m, −10⁸ … 10⁸.
    #[schema(min_items = 2, max_items = 2)]
    pub min_m: [f64; 2],
    /// Upper corner (x, z), m, −10⁸ … 10⁸; each side is 10⁻² … 10⁴ m long.
    #[schema(min_items = 2, max_items = 2)]
    pub max_m: [f64; 2],
    /// Samples along the longer side, 16 … 1024. Default 256.
    #[serde(
        default = "default_basin_samples",
        deserialize_with = "integer::<BasinSamples, _>"
    )]
    #[schema(minimum = 16, maximum = 1024)]
    pub samples: u32,
    /// What waves meet at the sides. Default `reflecting`.
    #[serde(default)]
    pub walls: Walls,
    /// The drops that make the ripples, at most 256.
    pub drops: Vec<RippleDrop>,
    /// Rate γ at which amplitudes fall, as e^(−γ t), 1/s, 0 … 10³. Waves that swing slower than γ creep back without swinging, the more
    /// slowly the larger γ is. Default 0.
    #[serde(default)]
    pub damping_per_s: f64,
    /// How fast waves run. Default `finite_depth`.
    #[serde(default)]
    pub dispersion: RippleDispersion,
    /// Objects that reflect the ripples, as indices into `objects`. Default none. They need `dispersion` = `shallow` and a floor: where
    /// speed depends on the wavelength, the motion at a point depends on water further away, also behind the obstacle, and finite
    /// differences do not hold.
    ///
    /// An obstacle is the cut of its mesh with the water at rest, taken down to the floor. Samples inside of a closed cut are not water, and
    /// no water flows between samples that the cut separates, so that walls thinner than a sample reflect too. If the cut is open, nothing
    /// is inside of it. The slope across the obstacle's rim is 0. Inside, hidden by the object, the surface is continued smoothly. Across
    /// a wall thinner than about four samples it is steep.
    ///
    /// Samples × steps from the first drop to `time_s` are at most 4·10⁹ for all such basins together. The states are kept, so that a later
    /// frame goes on from an earlier one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<u32>,
}

fn default_basin_samples() -> u32 {
    256
}

/// A drop: at its time, a mound at rest is added to the surface, h = height · exp(−r²/(2 radius²)). What of it lies beyond a wall is folded
/// back into the basin (periodic: enters at the opposite side). The water that it would add to the basin is taken from all of it, so that
/// the mean height stays 0. Through absorbing walls the water leaves, and nothing is folded or taken. What lies over an obstacle is left out.
/// A drop narrower than about two samples is not carried by them (with obstacles it is widened to two, with the same water);
/// `waves_smoothed` says how much is missing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct RippleDrop {
    /// Middle (x, z), m, within the basin.
    #[schema(min_items = 2, max_items = 2)]
    pub position_m: [f64; 2],
    /// Standard deviation of the mound, m, 10⁻⁴ … 10⁴, and at most the shorter side of the basin.
    pub radius_m: f64,
    /// Height of the mound, m, −100 … 100.
    pub height_m: f64,
    /// Time of the drop, s, −10¹² … 10¹². Before it there is nothing. Default 0.
    #[serde(default)]
    pub at_s: f64,
}

/// The sides of a basin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Walls {
    /// Waves are reflected.
    #[default]
    Reflecting,
    /// What leaves at a side enters at the opposite one.
    Periodic,
    /// What reaches a side leaves: the basin is a part of wider water. Without obstacles nothing comes back; of a wave number's waves that
    /// have run four times as far as the basin's farthest corner, nothing is left. With obstacles less than 1 % of the energy comes
    /// back, of drops whose radius is at most 0.15 of the side; wider ones were not measured.
    Absorbing,
}

/// Dispersion relation of ripples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum RippleDispersion {
    /// All waves run at √(g d), d = `floor.depth_m`; without a floor as `finite_depth`.
    Shallow,
    /// ω² = (g k + σ k³/ρ) tanh(k d): gravity and surface tension; without a floor d is infinite.
    #[default]
    FiniteDepth,
}
