//! A frame's estimate of its own error, from the same light done with half the water cells.

/// What a frame knows of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameComparison {
    /// Σ|fine − coarse| / Σ fine over the frame's maps.
    pub difference: f64,
    /// Water cells along a side, fine over coarse: 2, or nearly.
    pub cells_ratio: f64,
}

/// Order at which beams with exact coverage converge in the size of a water cell.
const ORDER: f64 = 2.0;

/// The comparison is of texels twice as long, on which errors of the size of a texel cancel: the true error is this much larger.
/// Measured against the float64 reference; see docs/accuracy.md.
const HIDDEN: f64 = 1.6;

/// What single precision and whole counts leave even where the water is flat.
const ROUNDING: f64 = 1e-6;

/// Relative L1 error of the finer of the two: Richardson's extrapolation at second order.
pub fn estimate_error(frame: &FrameComparison) -> f64 {
    ROUNDING + HIDDEN * frame.difference / (frame.cells_ratio.powf(ORDER) - 1.0)
}
