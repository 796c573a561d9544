//! A frame's estimate of its own error, from the same light done with two fifths of the water cells or somewhat fewer.

/// What a frame knows of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameComparison {
    /// Σ|fine − coarse| / Σ fine over the frame's maps.
    pub difference: f64,
    /// Water cells along a side, fine over coarse: 2.5 … 3, of fewer than 16 cells 2 … 4.
    pub cells_ratio: f64,
    /// How the maps were compared.
    pub texels: Compared,
}

/// How fine texels were compared with coarse ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compared {
    /// Block by block of so many fine texels along a side.
    Blocks(u32),
    /// With the coarse map between its texels, as a camera looks it up.
    Between,
}

/// Order at which beams with exact coverage converge in the size of a water cell.
const ORDER: f64 = 2.0;

/// The comparison is of texels twice as long, on which errors of the size of a texel cancel: the true error is this much larger.
/// Measured against the float64 reference; see docs/accuracy.md.
const HIDDEN: f64 = 1.6;
/// The same of texels four times as long, which are as long as the water cells or shorter. At 64 cells and 256 texels the difference
/// is 1.20 (reef) … 1.39 (teapot_floor) times larger of texels twice as long than of these.
const HIDDEN_BY_QUARTERS: f64 = 2.1;
/// The same of a view, whose map has half the texels too: what they blur falls more slowly than second order has it.
const HIDDEN_IN_VIEW: f64 = 1.36;

/// What single precision and whole counts leave even where the water is flat.
const ROUNDING: f64 = 1e-6;

/// Most that two maps of equal flux can differ by: where one has light the other has none.
const MOST: f64 = 2.0;

/// Relative L1 error of the finer of the two: Richardson's extrapolation at second order.
///
/// Cells too large for what the water does stop getting worse by second order long before that: no relative L1 exceeds [`MOST`]. If
/// e = t / (1 + t / 2) is the error where t grows by second order for ever, and a coarse cell is r fine ones long, the extrapolation lacks
/// ½ r² e² to leading order, which is added here. Without it a thirtieth of an error of 0.01 would be missing, a quarter of one of 0.1 and
/// more than half of one of 0.3; with it a third of that one still is. What a view's texels blur does not follow this.
pub fn estimate_error(frame: &FrameComparison) -> f64 {
    let second_order =
        |hidden: f64, finer: f64| hidden * frame.difference / (f64::powf(finer, ORDER) - 1.0);
    // Of a view the halved texels decide, of a map the cells.
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
