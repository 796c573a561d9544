//! Which rung of the ladder meets a wanted error or fits a wanted time.

use super::ladder::{FEWEST_CELLS, MOST_CELLS};

/// Cells of the first look.
const FIRST_LOOK: u32 = 64;
/// Order at which a map's error is taken to fall with the cells. It is 2 once the cells know the waves, and 1.75 … 1.95 on the way
/// there (docs/accuracy.md).
const MAP_ORDER: f64 = 1.75;
/// Errors above this say that the cells do not know the waves yet: nothing is foretold from them, neither for more cells nor for fewer.
const TRUSTED_BELOW: f64 = 0.06;
/// The same of a view, whose error is mostly what its map's texels blur, and that is known earlier.
const TRUSTED_BELOW_IN_VIEW: f64 = 0.12;
/// How much larger than its estimate a view's error may be at least: 1.3 times was seen of `teapot_pool` on the rungs of the ladder. Maps,
/// of which calibrations know, are estimated better.
const VIEW_MARGIN: f64 = 1.34;
/// What an error that is not trusted may truly be, times: with 64 cells looks saw down to 0.72 of a map's and 0.57 of
/// a view's (docs/accuracy.md).
const UNTRUSTED: f64 = 2.0;
/// Least and largest order that is believed of a view: its map's texels blur, and what they blur is sharp.
const VIEW_ORDER: (f64, f64) = (0.5, 2.0);
/// Times the cells of a look beyond which its error is not extrapolated: another look comes first.
const FARTHEST: f64 = 3.2;
/// Looks at most.
const MOST_LOOKS: u32 = 5;
/// Share of a time budget that predictions are held to: they scatter.
const BUDGET_SHARE: f64 = 0.8;

/// A choice of water cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Water cells along a side.
    pub cells: u32,
    /// Relative L1 error that they are predicted to give.
    pub predicted_error: f64,
    /// Whether that is what was asked for.
    pub meets: bool,
    /// Looks that were taken.
    pub looks: u32,
}

/// What is known of a scene before any look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prospect {
    /// Most cells that fit the memory.
    pub most_cells: u32,
    /// How much larger than its estimate a true error may be, 1 …: see [`margin`].
    pub margin: f64,
    /// Whether a camera looks at the map: how fast its error falls is then measured, from look to look. A map's own texels fall
    /// with the square of the cells, which is known.
    pub is_view: bool,
}

/// How much larger than its estimate a true error may be, from what a calibration says of maps.
pub fn margin(of_maps: f64, is_view: bool) -> f64 {
    if is_view {
        of_maps.max(VIEW_MARGIN)
    } else {
        of_maps
    }
}

/// The fewest cells that are predicted to stay under `target`.
///
/// `look` renders the light with so many cells and returns its estimate of its own error, `None` where no light lands. From a look
/// the rest follows, but not far: few cells know nothing of the finer waves, and say too little of their error. So they are doubled
/// until the error is small enough to be believed, even where fewer would do.
///
/// # Errors
/// Those of `look`.
pub fn for_error<E>(
    target: f64,
    prospect: &Prospect,
    mut look: impl FnMut(u32) -> Result<Option<f64>, E>,
) -> Result<Choice, E> {
    let most = prospect.most_cells.clamp(FEWEST_CELLS, MOST_CELLS);
    let trusted_below = if prospect.is_view {
        TRUSTED_BELOW_IN_VIEW
    } else {
        TRUSTED_BELOW
    };
    let mut cells = FIRST_LOOK.min(most);
    let mut order = if prospect.is_view {
        VIEW_ORDER.1
    } else {
        MAP_ORDER
    };
    let mut before: Option<(u32, f64)> = None;
    let mut looks = 0;
    loop {
        looks += 1;
        let Some(error) = look(cells)?.map(|error| error * prospect.margin) else {
            return Ok(Choice {
                cells: FEWEST_CELLS,
                predicted_error: 0.0,
                meets: true,
                looks,
            });
        };
        if let (true, Some((cells_before, error_before))) = (prospect.is_view, before) {
            let finer = (f64::from(cells) / f64::from(cells_before)).ln();
            order = ((error_before / error).ln() / finer).clamp(VIEW_ORDER.0, VIEW_ORDER.1);
        }
        // Towards fewer cells the larger order is the cautious one.
        let falls = if error < target {
            order.max(2.0)
        } else {
            order
        };
        let needed = (f64::from(cells) * (error / target).powf(1.0 / falls)).ceil();
        // Towards more cells a view's order has to be measured first.
        let has_order = !prospect.is_view || looks > 1 || needed <= f64::from(cells);
        let trusted = error < trusted_below && has_order;
        let near = needed <= FARTHEST * f64::from(cells);
        let is_last = looks == MOST_LOOKS || cells == most;
        if trusted && (near || is_last || 2 * cells > most) {
            let chosen = needed.clamp(f64::from(FEWEST_CELLS), f64::from(most)) as u32;
            return Ok(Choice {
                cells: chosen,
                predicted_error: error * (f64::from(cells) / f64::from(chosen)).powf(falls),
                meets: needed <= f64::from(most),
                looks,
            });
        }
        if is_last {
            // Nothing to foretell from: what was looked at is enough even at twice the error, or only the most is sure to be nearest. It
            // is no worse than what was looked at; that it is better is not promised.
            let at_worst = UNTRUSTED * error;
            let meets = at_worst <= target;
            return Ok(Choice {
                cells: if meets { cells } else { most },
                predicted_error: at_worst,
                meets,
                looks,
            });
        }
        before = Some((cells, error));
        cells = ((needed / 3.0) as u32).max(2 * cells).min(most);
    }
}

/// Error with `cells` water cells, from that of a look with `look` of them; of a view cautiously.
pub fn foretold(error: f64, look: u32, cells: u32, is_view: bool) -> f64 {
    let order = if is_view { VIEW_ORDER.0 } else { MAP_ORDER };
    error * (f64::from(look) / f64::from(cells)).powf(order)
}

/// The most cells, at most `most_cells`, that are predicted to stay under `budget_ms`, and whether they do; `predict` gives the ms of a frame with so many cells.
///
/// # Errors
/// Those of `predict`.
pub fn for_time<E>(
    budget_ms: f64,
    most_cells: u32,
    mut predict: impl FnMut(u32) -> Result<f64, E>,
) -> Result<(u32, bool), E> {
    let allowed_ms = budget_ms * BUDGET_SHARE;
    if predict(FEWEST_CELLS)? > allowed_ms {
        return Ok((FEWEST_CELLS, false));
    }
    let (mut low, mut high) = (FEWEST_CELLS, most_cells.clamp(FEWEST_CELLS, MOST_CELLS) + 1);
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if predict(middle)? <= allowed_ms {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((low, true))
}
