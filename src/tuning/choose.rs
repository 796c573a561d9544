//! Which rung of the ladder meets a target error or fits a time budget.

use super::ladder::{FEWEST_CELLS, MOST_CELLS};

/// Cells of the first probe.
const FIRST_PROBE: u32 = 64;
/// Order at which a map's error is assumed to fall with the cells. It is 2 once the cells resolve the waves, and 1.75 … 1.95 before
/// (docs/accuracy.md).
const MAP_ORDER: f64 = 1.75;
/// Above this error the cells do not resolve the waves yet: nothing is predicted from it, neither for more cells nor for fewer.
const TRUSTED_BELOW: f64 = 0.06;
/// Like [`TRUSTED_BELOW`], for views. Most of a view's error is blur by the map's texels, which can be predicted from fewer cells.
const TRUSTED_BELOW_IN_VIEW: f64 = 0.12;
/// Least factor by which a view's error may exceed its estimate: 1.3 was measured for `teapot_pool` on the rungs of the ladder. Estimates
/// for maps, which calibrations measure, are better.
const VIEW_MARGIN: f64 = 1.34;
/// Factor by which the true error may exceed an untrusted one: probes with 64 cells estimated as little as 0.72 of the error of a map
/// and 0.57 of that of a view (docs/accuracy.md).
const UNTRUSTED: f64 = 2.0;
/// Least and largest order that is accepted for a view: its map's texels blur sharp edges.
const VIEW_ORDER: (f64, f64) = (0.5, 2.0);
/// An error is not extrapolated beyond this many times the cells of its probe: a finer probe comes first.
const FARTHEST: f64 = 3.2;
/// Most probes.
const MOST_PROBES: u32 = 5;
/// Share of a time budget that predictions may use, because they scatter.
const BUDGET_SHARE: f64 = 0.8;

/// A choice of water cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Water cells along a side.
    pub cells: u32,
    /// Their predicted relative L1 error.
    pub predicted_error: f64,
    /// Whether the prediction meets the target.
    pub meets: bool,
    /// The number of probes.
    pub probes: u32,
}

/// What is known of a scene before any probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prospect {
    /// Most cells that fit the memory.
    pub most_cells: u32,
    /// Factor by which the true error may exceed its estimate, 1 …: see [`margin`].
    pub margin: f64,
    /// Whether the output is a camera view. The order at which its error falls is measured from probe to probe. The error of a map
    /// is known to fall with the square of the cells.
    pub is_view: bool,
}

/// Factor by which the true error may exceed its estimate, from the calibration's factor for maps.
pub fn margin(of_maps: f64, is_view: bool) -> f64 {
    if is_view {
        of_maps.max(VIEW_MARGIN)
    } else {
        of_maps
    }
}

/// The fewest cells that are predicted to stay under `target`.
///
/// `probe` renders the light with the given number of cells and returns its estimate of its own error, `None` where no light lands. The
/// error of other numbers of cells is extrapolated from a probe, but not far: few cells do not resolve the finer waves and
/// underestimate their error. So the cells are doubled until the error is small enough to be trusted, even where fewer would do.
///
/// # Errors
/// Those of `probe`.
pub fn for_error<E>(
    target: f64,
    prospect: &Prospect,
    mut probe: impl FnMut(u32) -> Result<Option<f64>, E>,
) -> Result<Choice, E> {
    let most = prospect.most_cells.clamp(FEWEST_CELLS, MOST_CELLS);
    let trusted_below = if prospect.is_view {
        TRUSTED_BELOW_IN_VIEW
    } else {
        TRUSTED_BELOW
    };
    let mut cells = FIRST_PROBE.min(most);
    let mut order = if prospect.is_view {
        VIEW_ORDER.1
    } else {
        MAP_ORDER
    };
    let mut before: Option<(u32, f64)> = None;
    let mut probes = 0;
    loop {
        probes += 1;
        let Some(error) = probe(cells)?.map(|error| error * prospect.margin) else {
            return Ok(Choice {
                cells: FEWEST_CELLS,
                predicted_error: 0.0,
                meets: true,
                probes,
            });
        };
        if let (true, Some((cells_before, error_before))) = (prospect.is_view, before) {
            let finer = (f64::from(cells) / f64::from(cells_before)).ln();
            order = ((error_before / error).ln() / finer).clamp(VIEW_ORDER.0, VIEW_ORDER.1);
        }
        // When extrapolating to fewer cells, the larger order is the cautious one.
        let falls = if error < target {
            order.max(2.0)
        } else {
            order
        };
        let needed = (f64::from(cells) * (error / target).powf(1.0 / falls)).ceil();
        // Before extrapolating to more cells, a view's order has to be measured.
        let has_order = !prospect.is_view || probes > 1 || needed <= f64::from(cells);
        let trusted = error < trusted_below && has_order;
        let near = needed <= FARTHEST * f64::from(cells);
        let is_last = probes == MOST_PROBES || cells == most;
        if trusted && (near || is_last || 2 * cells > most) {
            let chosen = needed.clamp(f64::from(FEWEST_CELLS), f64::from(most)) as u32;
            return Ok(Choice {
                cells: chosen,
                predicted_error: error * (f64::from(cells) / f64::from(chosen)).powf(falls),
                meets: needed <= f64::from(most),
                probes,
            });
        }
        if is_last {
            // No error can be trusted. Either the last probe's cells meet the target even at twice their error, or the most cells are
            // chosen. Those are no worse than the last probe's; that they are better is not promised.
            let at_worst = UNTRUSTED * error;
            let meets = at_worst <= target;
            return Ok(Choice {
                cells: if meets { cells } else { most },
                predicted_error: at_worst,
                meets,
                probes,
            });
        }
        before = Some((cells, error));
        cells = ((needed / 3.0) as u32).max(2 * cells).min(most);
    }
}

/// Error with `cells` water cells, extrapolated from `error` with `probed` cells; cautiously for a view.
pub fn extrapolated(error: f64, probed: u32, cells: u32, is_view: bool) -> f64 {
    let order = if is_view { VIEW_ORDER.0 } else { MAP_ORDER };
    error * (f64::from(probed) / f64::from(cells)).powf(order)
}

/// The most cells, at most `most_cells`, that are predicted to stay under `budget_ms`, and whether they do. `predict` gives the time in ms
/// of a frame with a number of cells.
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
