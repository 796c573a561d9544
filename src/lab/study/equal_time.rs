//! Which method is nearest to the truth in a given time.

use super::pareto::{figures, front};
use super::study::{LeftOut, PassCost, Point, Study, Sweep};

/// Times within this factor of the limit are within it: medians scatter.
const ROUND: f64 = 1.05;

/// What a method achieves in a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing<'a> {
    /// The series of the setting.
    pub sweep: &'a Sweep,
    /// Index of the series.
    pub sweep_index: usize,
    /// The setting on the method's own front whose time is nearest (as a ratio).
    pub point: &'a Point,
    /// Index of the setting in its series.
    pub point_index: usize,
    /// Relative L1 error in just this time: a power law between the two settings of the front around it, the last one's error beyond
    /// them. `None` if the method takes longer at every setting. A twin has that of the first method.
    pub error_in_time: Option<f64>,
    /// Whether the method does the same as the first one here ([`is_twin`]).
    pub twin: bool,
}

impl Standing<'_> {
    /// The method's name.
    pub fn method(&self) -> &str {
        method_of(self.sweep)
    }

    /// Relative L1 error.
    pub fn error(&self) -> f64 {
        self.point.error.relative_l1
    }

    /// Median time of a frame, ms.
    pub fn ms(&self) -> f64 {
        self.point.cost.wall_ms.median
    }
}

/// The method of a series; empty outside comparisons.
pub fn method_of(sweep: &Sweep) -> &str {
    sweep.series.as_ref().map_or("", |of| &of.method)
}

/// Names of the methods of a comparison, each once, in the order of their series.
pub fn methods(study: &Study) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for sweep in study.sweeps.iter().filter(|sweep| sweep.series.is_some()) {
        let name = method_of(sweep);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Who cannot render the scene, and why: a method where all its series have the same reason, else a series.
pub fn absent(study: &Study) -> Vec<(&str, &str)> {
    let mut found: Vec<(&str, &str)> = Vec::new();
    for left in &study.left_out {
        let is_other = |other: &LeftOut| other.method == left.method && other.reason != left.reason;
        let whole =
            !study.left_out.iter().any(is_other) && !methods(study).contains(&left.method.as_str());
        let name = if whole { &left.method } else { &left.series };
        let entry = (name.as_str(), left.reason.as_str());
        if !found.contains(&entry) {
            found.push(entry);
        }
    }
    found
}

/// The time at which a comparison is summed up, ms: that of the first series in the middle of its settings (of four, the third).
pub fn limit_ms(study: &Study) -> Option<f64> {
    let points = &study.sweeps.first()?.points;
    let middle = points.get(points.len() / 2)?;
    Some(middle.cost.wall_ms.median)
}

/// Whether a method does the same on this scene as the first one: the same passes and, to the bit, the same error at each setting of equal
/// scale. (Methods that differ in how they light meshes are the same where there are none.) Their times then differ by chance only.
pub fn is_twin(study: &Study, method: &str) -> bool {
    let Some(first) = study.sweeps.first() else {
        return false;
    };
    let is_same = |a: &Point, b: &Point| {
        let names = |point: &Point| -> Vec<String> {
            let passes = point.cost.passes.iter();
            passes.map(|pass| pass.name.clone()).collect()
        };
        a.error.relative_l1 == b.error.relative_l1 && names(a) == names(b)
    };
    let mut own = study.sweeps.iter().filter(|s| method_of(s) == method);
    method_of(first) != method
        && own.any(|sweep| {
            let mut pairs = sweep.points.iter().filter_map(|point| {
                let other = first.points.iter().find(|p| p.scale == point.scale)?;
                Some(is_same(point, other))
            });
            pairs.next() == Some(true) && pairs.all(|same| same)
        })
}

/// What each method achieves in `limit_ms`, in the order of [`methods`].
pub fn standings(study: &Study, limit_ms: f64) -> Vec<Standing<'_>> {
    let names = methods(study);
    let of_first = names.first().map(|first| method_front(study, first));
    let of_method = |name: &str| {
        let own = method_front(study, name);
        let twin = is_twin(study, name);
        let timed = match &of_first {
            Some(first) if twin => first,
            _ => &own,
        };
        let off = |standing: &Standing<'_>| (standing.ms() / limit_ms).ln().abs();
        let nearest = own.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some(Standing {
            error_in_time: error_in(timed, limit_ms),
            twin,
            ..*nearest
        })
    };
    names.iter().copied().filter_map(of_method).collect()
}

/// The error of a front in a time.
fn error_in(front: &[Standing<'_>], limit_ms: f64) -> Option<f64> {
    let within = front.iter().rposition(|s| s.ms() <= ROUND * limit_ms)?;
    let coarse = &front[within];
    let Some(fine) = front.get(within + 1) else {
        return Some(coarse.error());
    };
    let share = (limit_ms / coarse.ms()).ln() / (fine.ms() / coarse.ms()).ln();
    let share = share.clamp(0.0, 1.0);
    let usable = coarse.error() > 0.0 && fine.error() > 0.0 && share.is_finite();
    Some(match usable {
        true => coarse.error() * (fine.error() / coarse.error()).powf(share),
        false => coarse.error(),
    })
}

/// The method that is nearest to the truth in the time; of equals the first.
pub fn best<'a, 'b>(standings: &'b [Standing<'a>]) -> Option<&'b Standing<'a>> {
    let within = standings.iter().filter(|s| s.error_in_time.is_some());
    let error = |standing: &Standing<'_>| standing.error_in_time.unwrap_or(f64::INFINITY);
    within.min_by(|a, b| error(a).total_cmp(&error(b)))
}

fn all_points(study: &Study) -> impl Iterator<Item = Standing<'_>> {
    let sweeps = study.sweeps.iter().enumerate();
    sweeps.flat_map(|(sweep_index, sweep)| {
        let points = sweep.points.iter().enumerate();
        points.map(move |(point_index, point)| Standing {
            sweep,
            sweep_index,
            point,
            point_index,
            error_in_time: None,
            twin: false,
        })
    })
}

/// The settings of a method that none of its own settings beats, fastest first.
pub fn method_front<'a>(study: &'a Study, method: &str) -> Vec<Standing<'a>> {
    let own: Vec<Standing<'_>> = all_points(study)
        .filter(|standing| standing.method() == method)
        .collect();
    let on_front = front(&own.iter().map(|s| figures(s.point)).collect::<Vec<_>>());
    let mut kept: Vec<Standing<'_>> = own
        .into_iter()
        .zip(on_front)
        .filter_map(|(standing, on_front)| on_front.then_some(standing))
        .collect();
    kept.sort_by(|a, b| {
        let by_time = a.ms().total_cmp(&b.ms());
        by_time.then(b.error().total_cmp(&a.error()))
    });
    // Settings that tie in time and error are one.
    kept.dedup_by(|a, b| a.ms() == b.ms() && a.error() == b.error());
    kept
}

/// The pass that takes most of a setting's time, with its share.
pub fn dearest_pass(point: &Point) -> Option<(&PassCost, f64)> {
    let passes = &point.cost.passes;
    let dearest = passes
        .iter()
        .max_by(|a, b| a.ms.median.total_cmp(&b.ms.median))?;
    let all = point.cost.wall_ms.median;
    (all > 0.0).then(|| (dearest, dearest.ms.median / all))
}
