//! Which rung of the ladder meets a wanted error or fits a wanted time.

use super::ladder::{FEWEST_CELLS, MOST_CELLS};

/// Cells of the first look.
const FIRST_LOOK: u32 = 64;
/// Times the cells of a look beyond which its error is not extrapolated: another look comes first.
const FARTHEST: f64 = 2.5;
/// Looks at most.
const MOST_LOOKS: u32 = 4;
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

/// The fewest cells that are predicted to stay under `target`.
///
/// `look` renders the light with so many cells and returns its estimate of its own error, `None` where no light lands; `margin`
/// (1 …) is how much larger the true error may be. The error falls with the square of the cells (measured, see docs/accuracy.md),
/// so from one look the rest follows, but not far: a look with too few cells knows nothing of the finer waves.
///
/// # Errors
/// Those of `look`.
pub fn for_error<E>(
    target: f64,
    margin: f64,
    mut look: impl FnMut(u32) -> Result<Option<f64>, E>,
) -> Result<Choice, E> {
    let mut cells = FIRST_LOOK;
    let mut looks = 0;
    loop {
        looks += 1;
        let Some(error) = look(cells)?.map(|error| error * margin) else {
            return Ok(Choice {
                cells: FEWEST_CELLS,
                predicted_error: 0.0,
                meets: true,
                looks,
            });
        };
        let needed = (f64::from(cells) * (error / target).sqrt()).ceil();
        let far = needed > FARTHEST * f64::from(cells);
        if far && looks < MOST_LOOKS && cells < MOST_CELLS / 2 {
            cells = ((needed / 2.0) as u32).clamp(2 * cells, MOST_CELLS / 2);
            continue;
        }
        let chosen = needed.clamp(f64::from(FEWEST_CELLS), f64::from(MOST_CELLS)) as u32;
        return Ok(Choice {
            cells: chosen,
            predicted_error: error * (f64::from(cells) / f64::from(chosen)).powi(2),
            meets: needed <= f64::from(MOST_CELLS),
            looks,
        });
    }
}

/// The most cells that are predicted to stay under `budget_ms`; `predict` gives the ms of a frame with so many cells.
///
/// # Errors
/// Those of `predict`.
pub fn for_time<E>(
    budget_ms: f64,
    mut predict: impl FnMut(u32) -> Result<f64, E>,
) -> Result<(u32, bool), E> {
    let allowed_ms = budget_ms * BUDGET_SHARE;
    if predict(FEWEST_CELLS)? > allowed_ms {
        return Ok((FEWEST_CELLS, false));
    }
    let (mut low, mut high) = (FEWEST_CELLS, MOST_CELLS + 1);
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
