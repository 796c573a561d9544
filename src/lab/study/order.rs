//! Order of convergence of a sweep, or factor per level: how fast the error falls with a dial.

use serde_json::Value;

use super::study::{Point, Study, Sweep};
use crate::accuracy::metrics::convergence_order;

/// A setting takes part in the fit when its error is at least this many times the truth's own: below, the noise of the truth
/// bends the curve.
pub const TRUTH_MARGIN: f64 = 3.0;

/// A power law: error = `error_at_one` · dial^−`order`.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderFit {
    /// Order of convergence, above 0 when the error falls.
    pub order: f64,
    /// Natural logarithm of the relative L1 error that the law gives for a dial of 1.
    pub ln_error_at_one: f64,
    /// Whether each setting of the sweep took part.
    pub used: Vec<bool>,
}

impl OrderFit {
    /// Relative L1 error that the law gives for a dial (above 0).
    pub fn error_at(&self, dial: f64) -> f64 {
        (self.ln_error_at_one - self.order * dial.ln()).exp()
    }
}

/// The dial that counts halvings: each level cuts the beams' sides in two, so the error may fall by a factor per level, not with a
/// power of the level.
const COUNTS_HALVINGS: &str = "split_levels";

/// A geometric law: error = `error_at_zero` · `factor`^−level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelFit {
    /// Factor by which the error falls per level, above 1 when it does.
    pub factor: f64,
    /// Natural logarithm of the relative L1 error that the law gives for level 0.
    pub ln_error_at_zero: f64,
    /// Whether each setting of the sweep took part.
    pub used: Vec<bool>,
}

impl LevelFit {
    /// Relative L1 error that the law gives for a level.
    pub fn error_at(&self, level: f64) -> f64 {
        (self.ln_error_at_zero - level * self.factor.ln()).exp()
    }
}

/// Level of a point of a sweep whose one dial counts halvings, 0 …; nothing for other dials.
pub fn level_number(sweep: &Sweep, point: &Point) -> Option<f64> {
    if sweep.dial != COUNTS_HALVINGS || point.dials.len() != 1 {
        return None;
    }
    point.dials.get(&sweep.dial).and_then(Value::as_f64)
}

/// Value of the sweep's one dial at a point, as a number above 0; nothing for several dials, words, switches and 0. In a comparison,
/// the point's scale.
pub fn dial_number(sweep: &Sweep, point: &Point) -> Option<f64> {
    if sweep.series.is_some() {
        return point.scale.filter(|scale| *scale > 0.0);
    }
    let value = point.dials.get(&sweep.dial).and_then(Value::as_f64)?;
    (point.dials.len() == 1 && value > 0.0).then_some(value)
}

/// Errors from single precision: below this they do not converge.
const ROUNDING: f64 = 1e-5;

/// Fits a power law by least squares of the logarithms, to the settings whose error is at least [`TRUTH_MARGIN`] times the
/// truth's own. Nothing when fewer than two different ones remain, and for a dial that counts halvings.
pub fn fit_order(sweep: &Sweep, truth_relative_error: f64) -> Option<OrderFit> {
    if sweep.dial == COUNTS_HALVINGS {
        return None;
    }
    power_law(sweep, truth_relative_error, dial_number)
}

/// Fits a geometric law to a dial that counts halvings, level 0 included, otherwise as [`fit_order`].
pub fn fit_levels(sweep: &Sweep, truth_relative_error: f64) -> Option<LevelFit> {
    // A factor per level is a power of the pieces along a beam's side.
    let pieces = |sweep: &Sweep, point: &Point| level_number(sweep, point).map(f64::exp2);
    let fit = power_law(sweep, truth_relative_error, pieces)?;
    Some(LevelFit {
        factor: fit.order.exp2(),
        ln_error_at_zero: fit.ln_error_at_one,
        used: fit.used,
    })
}

/// Fits the law to a number, above 0, for each point.
fn power_law(
    sweep: &Sweep,
    truth_relative_error: f64,
    number: impl Fn(&Sweep, &Point) -> Option<f64>,
) -> Option<OrderFit> {
    let candidates: Vec<Option<(f64, f64)>> = sweep
        .points
        .iter()
        .map(|point| {
            let error = point.error.relative_l1;
            let clear = error > ROUNDING && error >= TRUTH_MARGIN * truth_relative_error;
            number(sweep, point)
                .filter(|_| clear)
                .map(|number| (number, error))
        })
        .collect();
    let points: Vec<(f64, f64)> = candidates.iter().copied().flatten().collect();
    let order = convergence_order(&points);
    if !order.is_finite() {
        return None;
    }
    // The line of least squares passes through the mean.
    let sum: f64 = points.iter().map(|(n, e)| e.ln() + order * n.ln()).sum();
    Some(OrderFit {
        order,
        ln_error_at_one: sum / points.len() as f64,
        used: candidates.iter().map(Option::is_some).collect(),
    })
}

/// Fills [`Sweep::order`] and [`Sweep::factor_per_level`] of every sweep.
pub fn fit_orders(study: &mut Study) {
    let floor = study.truth.relative_error;
    for sweep in &mut study.sweeps {
        sweep.order = fit_order(sweep, floor).map(|fit| fit.order);
        sweep.factor_per_level = fit_levels(sweep, floor).map(|fit| fit.factor);
    }
}
