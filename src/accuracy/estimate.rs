//! A frame's estimate of its own error, from the same light at two fifths of the water cells along a side or somewhat fewer.

/// How a frame's maps differ from those of its coarse light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameComparison {
    /// Σ|fine − coarse| / Σ fine over the frame's maps.
    pub difference: f64,
    /// Water cells along a side, fine over coarse: 2.5 … 3; with fewer than 16 cells 2 … 4.
    pub cells_ratio: f64,
    /// How the maps were compared.
    pub texels: Compared,
}

/// How fine texels are compared with coarse ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compared {
    /// Each coarse texel with a block of fine texels; the number along a side.
    Blocks(u32),
    /// Each fine texel with the coarse map interpolated between its texels, as for a camera.
    Between,
}

/// Order at which beams with exact coverage converge in the size of a water cell.
const ORDER: f64 = 2.0;

/// Factor by which the true error is larger than the comparison: it uses texels twice as long, on which errors of the size of a texel
/// cancel. Measured against the float64 reference; see docs/accuracy.md.
const HIDDEN: f64 = 1.6;
/// Like [`HIDDEN`], for texels four times as long, which are as long as the water cells or shorter. At 64 cells and 256 texels the
/// difference with texels twice as long is 1.20 (reef) … 1.39 (teapot_floor) times larger than with these.
const HIDDEN_BY_QUARTERS: f64 = 2.1;
/// Like [`HIDDEN`], for a view, whose coarse map has half the texels too: their blur falls more slowly than at second order.
const HIDDEN_IN_VIEW: f64 = 1.36;

/// Error from single precision and integer sums, present even with flat water.
const ROUNDING: f64 = 1e-6;

/// Largest difference of two maps of equal flux: one is dark wherever the other is lit.
const MOST: f64 = 2.0;

/// Relative L1 error of the finer of the two: Richardson's extrapolation at second order.
///
/// No relative L1 error exceeds [`MOST`], so with ever larger cells the error grows more slowly than at second order. Let t grow at second
/// order without limit, e = t / (1 + t / 2) be the error, and a coarse cell be r fine ones long. Then the extrapolation lacks
/// ½ r² e² to leading order, which is added here. Without it a thirtieth of an error of 0.01 would be missing, a quarter of one of 0.1 and
/// more than half of one of 0.3; with it a third of the last is still missing. The blur of a view's texels does not follow this.
pub fn estimate_error(frame: &FrameComparison) -> f64 {
    let second_order =
        |hidden: f64, finer: f64| hidden * frame.difference / (f64::powf(finer, ORDER) - 1.0);
    // The halved texels decide the order for a view, the cells for a map.
    let error = match frame.texels {
        Compared::Between => second_order(HIDDEN_IN_VIEW, 2.0),
        Compared::Blocks(side) => {
            let hidden = if side >= 4 {
                HIDDEN_BY_QUARTERS
            } else {
                HIDDEN
            };
            let error = second_order(hidden, frame.cells_ratio);
            error * (1.0 + frame.cells_ratio.powf(ORDER) / MOST * error)
        }
    };
    ROUNDING + error.min(MOST)
}
