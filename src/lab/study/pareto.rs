//! The Pareto front: the settings that no other setting beats.

use super::study::{Point, Study};

/// Marks the points of all sweeps that no other point beats: none is at least as fast and at least as near to the truth and
/// better in one of the two. Points that tie in both (the same setting in two sweeps) are on the front together.
///
/// Time is the median of [`super::study::CostFigures::wall_ms`], the error [`super::study::ErrorFigures::relative_l1`]; a point
/// without finite figures is never on the front.
pub fn mark_pareto_front(study: &mut Study) {
    let all: Vec<(f64, f64)> = study
        .sweeps
        .iter()
        .flat_map(|sweep| sweep.points.iter().map(figures))
        .collect();
    for point in study.sweeps.iter_mut().flat_map(|s| s.points.iter_mut()) {
        let own = figures(point);
        let finite = own.0.is_finite() && own.1.is_finite();
        point.on_pareto_front = finite && !all.iter().any(|other| beats(*other, own));
    }
}

/// Time and error.
fn figures(point: &Point) -> (f64, f64) {
    (point.cost.wall_ms.median, point.error.relative_l1)
}

fn beats(other: (f64, f64), own: (f64, f64)) -> bool {
    other.0 <= own.0 && other.1 <= own.1 && other != own
}
