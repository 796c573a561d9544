//! Why a light field cannot be computed.

use thiserror::Error;

/// Why a light field cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FrontError {
    /// A grid without cells, with too many, or with steps that are no positive numbers.
    #[error("a grid of {size:?} cells with steps of {step_m:?} m: {reason}")]
    Grid {
        /// Cells along x, z and depth.
        size: [usize; 3],
        /// Steps, m.
        step_m: [f64; 3],
        /// What is accepted.
        reason: &'static str,
    },
    /// Light that does not go down, or an index of refraction that does not bend it.
    #[error("light that travels along {travel:?} into water of index {ior}: {reason}")]
    Light {
        /// Direction of the light in the air.
        travel: [f64; 3],
        /// Index of refraction.
        ior: f64,
        /// What is accepted.
        reason: &'static str,
    },
    /// A height or slope that is no number.
    #[error(
        "the water has height {height_m} m and slope {slope:?} at ({x_m}, {z_m}) m; both have to be finite"
    )]
    Water {
        /// Where.
        x_m: f64,
        /// Where.
        z_m: f64,
        /// Height, m.
        height_m: f64,
        /// Slope along x and z.
        slope: [f64; 2],
    },
    /// The water's surface leaves the grid at its top.
    #[error(
        "the water stands {above_m} m above the top of the grid at ({x_m}, {z_m}) m (model coordinates); the grid has to begin above the crests"
    )]
    AboveGrid {
        /// Where.
        x_m: f64,
        /// Where.
        z_m: f64,
        /// How far, m.
        above_m: f64,
    },
    /// Setting out of range.
    #[error("{setting} is {value}; accepted: {accepted}")]
    Setting {
        /// Its name.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What is accepted.
        accepted: &'static str,
    },
    /// A wave simulation that needs more than it may use.
    #[error(
        "the wave simulation needs {bytes} bytes and {steps} steps of {cells} cells ({cell_steps:.3e} cell updates if all are active); \
         at most {most_bytes} bytes and {most_cell_steps:.3e} cell updates are allowed"
    )]
    TooLarge {
        /// Bytes of its arrays.
        bytes: u64,
        /// Cells with the damping band.
        cells: u64,
        /// Steps of time.
        steps: u64,
        /// Cells × steps.
        cell_steps: f64,
        /// The budget of bytes.
        most_bytes: u64,
        /// The budget of cell updates.
        most_cell_steps: f64,
    },
    /// Nothing to fit, or values that are no numbers.
    #[error("a power law cannot be fitted to {points} points: {reason}")]
    Fit {
        /// Number of points.
        points: usize,
        /// What is missing.
        reason: &'static str,
    },
}
