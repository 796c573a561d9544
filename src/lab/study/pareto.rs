//! The Pareto front: the settings that no other setting beats.

use super::study::{Point, Study};

/// Marks the points of all sweeps that no other point beats: none is at least as fast and at least as near to the truth and
/// better in one of the two. Points that tie in both (the same setting in two sweeps) are on the front together.
///
/// Time is the median of [`super::study::CostFigures::wall_ms`], the error [`super::study::ErrorFigures::relative_l1`]; a point
/// without finite figures is never on the front.
pub fn mark_pareto_front(study: &mut Study) {
    let points = study.sweeps.iter().flat_map(|sweep| &sweep.points);
    let front = front(&points.map(figures).collect::<Vec<_>>());
    let points = study.sweeps.iter_mut().flat_map(|s| s.points.iter_mut());
    for (point, on_front) in points.zip(front) {
        point.on_pareto_front = on_front;
    }
}

/// Whether each of some settings, given as time and error, is on their front.
pub fn front(all: &[(f64, f64)]) -> Vec<bool> {
    all.iter()
        .map(|own| {
            let finite = own.0.is_finite() && own.1.is_finite();
            finite && !all.iter().any(|other| beats(*other, *own))
        })
        .collect()
}

/// Time and error.
pub fn figures(point: &Point) -> (f64, f64) {
    (point.cost.wall_ms.median, point.error.relative_l1)
}

fn beats(other: (f64, f64), own: (f64, f64)) -> bool {
    other.0 <= own.0 && other.1 <= own.1 && other != own
}
