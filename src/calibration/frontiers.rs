//! What each method achieved in a given time, scene by scene: the measurements behind the advice which method to use.
//!
//! `make docs` measures it with the page of methods and writes `frontiers.json`. Only settings on a method's own front are kept.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::CalibrationError;

/// Version of the file's format.
const FORM: u32 = 1;
/// The measurements that come with the program.
const BUILT_IN: &str = include_str!("frontiers.json");
/// The same, read.
static READ: LazyLock<Frontiers> =
    LazyLock::new(|| Frontiers::read(BUILT_IN, "the built-in frontiers").expect("a test reads it"));

/// Scenes of one kind are expected to rank methods alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Kind {
    /// Whether light is compared at what a camera sees, and not at texels of a map of the floor.
    pub view: bool,
    /// Whether objects are under water.
    pub objects: bool,
    /// Whether there are point lights.
    pub lamps: bool,
}

/// A setting of a method on its front.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredSetting {
    /// The dials.
    pub dials: BTreeMap<String, Value>,
    /// Relative L1 error against the float64 reference.
    pub error: f64,
    /// Median time of a warm frame, ms.
    pub ms: f64,
}

/// A method's front on a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredMethod {
    /// Its name.
    pub method: String,
    /// The settings, fastest first, errors falling.
    pub settings: Vec<MeasuredSetting>,
}

/// A measured scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredScene {
    /// Its name.
    pub scene: String,
    /// Its kind.
    pub kind: Kind,
    /// Methods that can render it.
    pub methods: Vec<MeasuredMethod>,
}

/// All measurements of one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frontiers {
    /// Version of the format: 1.
    pub form: u32,
    /// The measured adapter.
    pub adapter: String,
    /// The scenes.
    pub scenes: Vec<MeasuredScene>,
}

impl Frontiers {
    /// Those that come with the program.
    pub fn built_in() -> &'static Self {
        &READ
    }

    /// Measurements of this program.
    pub fn new(adapter: String, scenes: Vec<MeasuredScene>) -> Self {
        Self {
            form: FORM,
            adapter,
            scenes,
        }
    }

    /// Reads a file's text; errors call it `file`.
    ///
    /// # Errors
    /// [`CalibrationError::Form`] unless all errors and times are finite and above 0, and fall and rise along each front.
    pub fn read(text: &str, file: &str) -> Result<Self, CalibrationError> {
        let wrong = |reason: String| CalibrationError::Form {
            file: file.to_owned(),
            reason,
        };
        let read: Self = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        if read.form != FORM {
            return Err(wrong(format!("its form is {}, not {FORM}", read.form)));
        }
        for scene in &read.scenes {
            for method in &scene.methods {
                let at = format!("{} on {}", method.method, scene.scene);
                let is_figure = |value: f64| value.is_finite() && value > 0.0;
                let each = method.settings.iter();
                if let Some(bad) = each
                    .clone()
                    .find(|s| !is_figure(s.error) || !is_figure(s.ms))
                {
                    return Err(wrong(format!("{at}: {bad:?} has no figures above 0")));
                }
                let is_front = |pair: &[MeasuredSetting]| {
                    pair[0].ms <= pair[1].ms && pair[0].error >= pair[1].error
                };
                if method.settings.is_empty() || !method.settings.windows(2).all(is_front) {
                    return Err(wrong(format!("{at}: its settings are no front")));
                }
            }
        }
        Ok(read)
    }
}

impl MeasuredScene {
    /// The front of a method.
    pub fn of(&self, method: &str) -> Option<&MeasuredMethod> {
        self.methods
            .iter()
            .find(|measured| measured.method == method)
    }
}

impl MeasuredMethod {
    /// The time at which it reaches an error, ms: interpolated between its settings as a power law, and never beyond them. `None` where
    /// no measured setting is that near to the truth.
    pub fn ms_at(&self, error: f64) -> Option<f64> {
        let first = self.settings.first()?;
        if first.error <= error {
            return Some(first.ms);
        }
        let pair = self
            .settings
            .windows(2)
            .find(|pair| pair[0].error > error && error >= pair[1].error)?;
        let [coarse, fine] = [&pair[0], &pair[1]];
        let share = (coarse.error / error).ln() / (coarse.error / fine.error).ln();
        Some(coarse.ms * (fine.ms / coarse.ms).powf(share))
    }

    /// The fastest measured setting with at most this error.
    pub fn setting_at(&self, error: f64) -> Option<&MeasuredSetting> {
        self.settings.iter().find(|setting| setting.error <= error)
    }

    /// The smallest measured error.
    pub fn least_error(&self) -> f64 {
        self.settings
            .iter()
            .map(|setting| setting.error)
            .fold(f64::INFINITY, f64::min)
    }
}
