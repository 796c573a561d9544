//! The results.

use serde::{Deserialize, Serialize};

use super::fluctuation::Fluctuation;
use super::scene::Place;
use crate::stats::AdapterStats;

/// A value and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard error; absent where it cannot be told, with fewer than two independent parts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
}

impl Estimate {
    /// A value without a standard error.
    pub(super) fn exact(value: f64) -> Self {
        Self { value, error: None }
    }

    /// A value of all parts, with its values where one part after the other is left out. Source: Quenouille (1956) and Tukey (1958).
    pub(super) fn jackknife(value: f64, without_one: &[f64]) -> Self {
        let n = without_one.len() as f64;
        let mean = without_one.iter().sum::<f64>() / n;
        let spread: f64 = without_one.iter().map(|v| (v - mean).powi(2)).sum();
        Self {
            value,
            error: (without_one.len() > 1).then(|| (spread * (n - 1.0) / n).sqrt()),
        }
    }

    /// The mean of independent values.
    pub(super) fn of_mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self {
            value: mean,
            error: (values.len() > 1).then(|| (spread / (n - 1.0) / n).sqrt()),
        }
    }
}

/// Flashes at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlashFigures {
    /// Flashes per minute and detector.
    pub per_minute: Estimate,
    /// Mean length of a flash, ms; absent without flashes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_ms: Option<Estimate>,
    /// Flashes counted.
    pub counted: u64,
}

/// The figures of a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlaceResult {
    /// Wind and depth.
    pub place: Place,
    /// Side of a detector, mm.
    pub texel_mm: f64,
    /// Light of the sun's disc; its mean is over that under flat water.
    pub sun: Fluctuation,
    /// Light of a sun without a size, as in scenes; likewise.
    pub point_sun: Fluctuation,
    /// Flashes above 1.5 times the mean, of the sun's disc; absent at depths where they were not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flashes: Option<FlashFigures>,
    /// Water cells along each side of the light's window, for the maps.
    pub water_cells: u32,
    /// Whether the cells were coarse for the shortest wave in any frame (warning `waves_undersampled`).
    pub undersampled: bool,
}

/// Slopes of the sea under a wind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SlopeResult {
    /// Wind, m/s.
    pub wind_m_s: f64,
    /// Mean square slope, both directions together.
    pub mean_square: f64,
}

/// A place with other settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checks {
    /// The place.
    pub place: Place,
    /// The first is as in the study.
    pub rows: Vec<Check>,
}

/// One of the settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What is different.
    pub what: String,
    /// Coefficient of variation under the sun's disc; absent where maps do not depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cv: Option<Estimate>,
    /// The value that one in a thousand exceeds, over the mean; likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak: Option<Estimate>,
    /// Flashes; absent where they were not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flashes: Option<FlashFigures>,
}

/// The whole study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SeaStudy {
    /// Program version.
    pub version: String,
    /// Where it ran.
    pub adapter: AdapterStats,
    /// Maps for each place, each of a sea of its own.
    pub moments: u32,
    /// Length of all time series of a place together, s.
    pub seconds: f64,
    /// Seas that these are taken from.
    pub series: u32,
    /// Time from frame to frame of a series, s.
    pub step_s: f64,
    /// Texels along each side of a map.
    pub texels: u32,
    /// Texels along each side of a map of a time series.
    pub series_texels: u32,
    /// Most water cells along each side of the light's window.
    pub water_cells: u32,
    /// Slopes, wind by wind.
    pub slopes: Vec<SlopeResult>,
    /// All places, wind by wind.
    pub places: Vec<PlaceResult>,
    /// Some places with other settings.
    pub checks: Vec<Checks>,
    /// Largest share of a frame's flux that its energy account misses.
    pub closure: f64,
}

impl SeaStudy {
    /// The winds, in order.
    pub(super) fn winds(&self) -> Vec<f64> {
        self.slopes.iter().map(|slope| slope.wind_m_s).collect()
    }

    /// The depths, in order.
    pub(super) fn depths(&self) -> Vec<f64> {
        let first = self.places.first().map(|place| place.place.wind_m_s);
        let of_first = self
            .places
            .iter()
            .filter(|p| Some(p.place.wind_m_s) == first);
        of_first.map(|place| place.place.depth_m).collect()
    }

    /// Whether flashes were measured at any place.
    pub(super) fn has_flashes(&self) -> bool {
        self.places.iter().any(|place| place.flashes.is_some())
    }

    /// The figures under a wind at a depth.
    pub(super) fn at(&self, wind_m_s: f64, depth_m: f64) -> Option<&PlaceResult> {
        let wanted = Place { wind_m_s, depth_m };
        self.places.iter().find(|place| place.place == wanted)
    }
}
