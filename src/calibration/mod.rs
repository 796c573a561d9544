//! The measurements behind predictions: what passes cost on one machine, and how far a frame's estimate of its error may be off;
//! `frontiers` has what each method achieves in a given time.

pub mod frontiers;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

/// Version of the file's format.
const FORM: u32 = 1;
/// The calibration that comes with the program.
const BUILT_IN: &str = include_str!("calibration.json");

/// Why a calibration cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The file cannot be read.
    #[error("cannot read the calibration {file}: {error}")]
    Read {
        /// The file.
        file: String,
        /// Why.
        error: std::io::Error,
    },
    /// The file is not a calibration.
    #[error(
        "{file} is no calibration: {reason}; accepted: what `caustica calibrate` of this version writes"
    )]
    Form {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
}

/// Cost of a pass on one machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PassRate {
    /// Cost of each run, whatever its work, ms.
    pub start_ms: f64,
    /// Cost of each unit of the pass's work (`work` in its description), ns.
    pub unit_ns: f64,
}

/// Measurements of one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Version of the format: 1.
    pub form: u32,
    /// The measured adapter, with its driver.
    pub adapter: String,
    /// What a frame costs besides its passes, ms.
    pub frame_ms: f64,
    /// Cost of each pass.
    pub passes: BTreeMap<String, PassRate>,
    /// Factor by which a frame's true error may exceed its estimate, 1 …: the largest one measured against the float64 reference.
    pub error_margin: f64,
}

impl Default for Calibration {
    /// What comes with the program: software Vulkan on two cores.
    fn default() -> Self {
        Self::read(BUILT_IN, "the built-in calibration").expect("a test reads it")
    }
}

impl Calibration {
    /// Reads a file that `caustica calibrate` wrote.
    ///
    /// # Errors
    /// [`CalibrationError`].
    pub fn load(path: &Path) -> Result<Self, CalibrationError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| CalibrationError::Read {
            file: file.clone(),
            error,
        })?;
        Self::read(&text, &file)
    }

    /// Reads a calibration's text; errors call it `file`.
    ///
    /// # Errors
    /// [`CalibrationError::Form`] unless all figures are finite and in range.
    pub fn read(text: &str, file: &str) -> Result<Self, CalibrationError> {
        let wrong = |reason: String| CalibrationError::Form {
            file: file.to_owned(),
            reason,
        };
        let mut read: Self =
            serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        if read.form != FORM {
            return Err(wrong(format!("its form is {}, not {FORM}", read.form)));
        }
        if !(1.0..=10.0).contains(&read.error_margin) {
            return Err(wrong(format!(
                "error_margin is {}, not 1 … 10",
                read.error_margin
            )));
        }
        let mut figures = read
            .passes
            .values()
            .flat_map(|rate| [rate.start_ms, rate.unit_ns])
            .chain([read.frame_ms]);
        if let Some(figure) = figures.find(|figure| !(0.0..=1e9).contains(figure)) {
            return Err(wrong(format!("{figure} is no time")));
        }
        drop(figures);
        // Older files lack passes that were added since: the built-in figure is better than none.
        let built_in: Self =
            serde_json::from_str(BUILT_IN).map_err(|error| wrong(error.to_string()))?;
        for (pass, rate) in built_in.passes {
            read.passes.entry(pass).or_insert(rate);
        }
        Ok(read)
    }

    /// A calibration from measured figures.
    pub fn new(
        adapter: String,
        frame_ms: f64,
        passes: BTreeMap<String, PassRate>,
        error_margin: f64,
    ) -> Self {
        Self {
            form: FORM,
            adapter,
            frame_ms,
            passes,
            error_margin,
        }
    }
}
