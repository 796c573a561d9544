//! The values that are drawn of each setting, checked, with zeros moved to where a logarithmic axis can show them.

use super::error::PlotError;
use super::palette;
use crate::lab::study::equal_time;
use crate::lab::study::order::dial_number;
use crate::lab::study::study::{SpreadMs, Study, Sweep};
use crate::lab::study::words;

/// How a sweep's marks look. In a comparison the colour is that of the method, and the shape that of the series among the method's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Look {
    pub colour: usize,
    pub shape: usize,
}

/// The look of each sweep.
pub(super) fn looks(study: &Study) -> Vec<Look> {
    let methods = equal_time::methods(study);
    let mut looks: Vec<Look> = Vec::new();
    for (index, sweep) in study.sweeps.iter().enumerate() {
        let name = equal_time::method_of(sweep);
        looks.push(match methods.iter().position(|method| *method == name) {
            Some(colour) => {
                let before = study.sweeps[..index].iter();
                let before = before.filter(|other| equal_time::method_of(other) == name);
                Look {
                    colour,
                    // After all colours the first begins again, with the next shape.
                    shape: before.count() + colour / palette::SWEEPS.len(),
                }
            }
            None => Look {
                colour: index,
                shape: index,
            },
        });
    }
    looks
}

/// A setting, ready to be drawn.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    pub sweep: usize,
    /// Within its sweep.
    pub point: usize,
    /// The dials' values.
    pub label: String,
    /// The dial as a number above 0, where it is one.
    pub dial: Option<f64>,
    /// Above 0.
    pub ms: SpreadMs,
    /// Relative L1 error, above 0.
    pub error: f64,
    /// What the render estimated it to be, above 0.
    pub estimated: Option<f64>,
    pub on_front: bool,
    /// Whether an error of 0 was moved.
    pub moved: bool,
}

/// Shown for an error of 0 when the truth claims no error either and no other error says what is small.
const SMALLEST: f64 = 1e-6;
/// Shown for a time of 0, ms.
const SHORTEST_MS: f64 = 1e-3;

/// The marks of one sweep, or of all.
pub(super) fn marks(study: &Study, only: Option<usize>) -> Result<Vec<Mark>, PlotError> {
    check("error", "the truth", study.truth.relative_error)?;
    let zero = zero_error(study);
    let mut marks = Vec::new();
    for (index, sweep) in study.sweeps.iter().enumerate() {
        if only.is_none_or(|only| only == index) {
            marks.extend(sweep_marks(index, sweep, zero)?);
        }
    }
    Ok(marks)
}

fn sweep_marks(index: usize, sweep: &Sweep, zero: f64) -> Result<Vec<Mark>, PlotError> {
    let mut marks = Vec::new();
    for (at, point) in sweep.points.iter().enumerate() {
        let name = words::named_setting(sweep, point);
        let (error, ms) = (&point.error, point.cost.wall_ms);
        check("relative L1 error", &name, error.relative_l1)?;
        check("estimated error", &name, error.estimated.unwrap_or(0.0))?;
        for time in [ms.median, ms.min, ms.max] {
            check("time", &name, time)?;
        }
        let shown = |error: f64| if error > 0.0 { error } else { zero };
        marks.push(Mark {
            sweep: index,
            point: at,
            label: words::label(sweep, point),
            dial: dial_number(sweep, point),
            ms: SpreadMs {
                median: ms.median.max(SHORTEST_MS),
                min: ms.min.max(SHORTEST_MS),
                max: ms.max.max(SHORTEST_MS),
            },
            error: shown(error.relative_l1),
            estimated: error.estimated.map(shown),
            on_front: point.on_pareto_front,
            moved: error.relative_l1 == 0.0,
        });
    }
    Ok(marks)
}

/// Where an error of 0 is drawn: at a tenth of the truth's own error, or of the smallest error where the truth claims none.
fn zero_error(study: &Study) -> f64 {
    if study.truth.relative_error > 0.0 {
        return 0.1 * study.truth.relative_error;
    }
    let points = study.sweeps.iter().flat_map(|sweep| &sweep.points);
    let smallest = points
        .map(|point| point.error.relative_l1)
        .filter(|error| *error > 0.0)
        .fold(f64::INFINITY, f64::min);
    if smallest.is_finite() {
        0.1 * smallest
    } else {
        SMALLEST
    }
}

fn check(what: &'static str, setting: &str, value: f64) -> Result<(), PlotError> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(PlotError::Figure {
            what,
            setting: setting.to_owned(),
            value,
        })
    }
}

/// The remark for errors of 0 that were moved.
pub(super) fn moved_remark(marks: &[Mark], truth_error: f64) -> Option<String> {
    let moved = marks.iter().any(|mark| mark.moved);
    let of = if truth_error > 0.0 {
        "the truth's own error"
    } else {
        "the smallest other error"
    };
    moved.then(|| {
        format!("An error of 0 has no place on this axis: hollow in the plot, at a tenth of {of}.")
    })
}

/// Scene and machine, for below the title.
pub(super) fn subtitle(study: &Study) -> String {
    let mut parts = Vec::new();
    if !study.scene.is_empty() {
        parts.push(study.scene.clone());
    }
    if !study.adapter.name.is_empty() {
        parts.push(study.adapter.name.clone());
    }
    if !study.truth.what.is_empty() {
        parts.push(study.truth.what.clone());
    }
    parts.join(" · ")
}
