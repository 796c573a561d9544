//! Describes the results of a sweep in sentences.

use crate::lab::study::order::{TRUTH_MARGIN, dial_number};
use crate::lab::study::study::{Point, SpreadMs, Study, Sweep};
use crate::lab::study::words::{ms, percent, setting, significant};

/// A change by less than this factor counts as no change.
const SAME: f64 = 1.05;

/// Sentences about one sweep: the gain of each step of the dial, where the truth's own error hides the gain, the order, and which
/// settings are worth their time. For words and combinations only the extremes are compared.
pub fn conclusions(study: &Study, sweep: &Sweep) -> Vec<String> {
    if sweep.points.is_empty() {
        return vec!["No setting was measured.".to_owned()];
    }
    let mut sentences = Vec::new();
    let numeric = sweep.points.iter().all(|p| dial_number(sweep, p).is_some());
    if sweep.points.len() == 1 {
        let only = &sweep.points[0];
        sentences.push(format!("Only {} was measured.", described(sweep, only)));
    } else if numeric {
        sentences.extend(steps(study, sweep));
    } else {
        sentences.extend(extremes(sweep));
    }
    if let Some(order) = sweep.order {
        sentences.push(of_order(order));
    }
    if let Some(factor) = sweep.factor_per_level {
        sentences.push(format!("Each further level {}.", effect_of(factor)));
    }
    sentences.push(of_front(sweep));
    sentences
}

/// Whether the truth's own error is too large to say more about this setting.
fn is_hidden(study: &Study, point: &Point) -> bool {
    point.error.relative_l1 < TRUTH_MARGIN * study.truth.relative_error
}

/// The gain of each step, up to the first setting whose gain the truth's own error hides.
fn steps(study: &Study, sweep: &Sweep) -> Vec<String> {
    let mut points: Vec<&Point> = sweep.points.iter().collect();
    let dial = |point: &&Point| dial_number(sweep, point).unwrap_or(0.0);
    points.sort_by(|a, b| dial(a).total_cmp(&dial(b)));
    let mut sentences = Vec::new();
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        if is_hidden(study, from) {
            continue;
        }
        sentences.push(format!(
            "From {} to {} the error {} ({} → {}) and the time {}.",
            setting(sweep, from),
            setting(sweep, to),
            change(from.error.relative_l1, to.error.relative_l1),
            percent(from.error.relative_l1),
            percent(to.error.relative_l1),
            time_change(from.cost.wall_ms, to.cost.wall_ms),
        ));
    }
    if let Some(first) = points.iter().find(|point| is_hidden(study, point)) {
        sentences.push(format!(
            "At {} the error is less than {TRUTH_MARGIN} times the truth's own ({}); beyond, the truth's own error hides the gain.",
            setting(sweep, first),
            percent(study.truth.relative_error),
        ));
    }
    sentences
}

/// The nearest and the fastest setting.
fn extremes(sweep: &Sweep) -> Vec<String> {
    let by = |figure: fn(&Point) -> f64| {
        sweep
            .points
            .iter()
            .min_by(|a, b| figure(a).total_cmp(&figure(b)))
            .expect("there are settings")
    };
    let nearest = by(|point| point.error.relative_l1);
    let fastest = by(|point| point.cost.wall_ms.median);
    if std::ptr::eq(nearest, fastest) {
        return vec![format!(
            "{} is both the fastest and the nearest to the truth.",
            described(sweep, nearest)
        )];
    }
    vec![format!(
        "The fastest is {}, the nearest to the truth {}: from the first to the second the error {} and the time {}.",
        described(sweep, fastest),
        described(sweep, nearest),
        change(fastest.error.relative_l1, nearest.error.relative_l1),
        time_change(fastest.cost.wall_ms, nearest.cost.wall_ms),
    )]
}

fn described(sweep: &Sweep, point: &Point) -> String {
    format!(
        "{} ({}, {} ms)",
        setting(sweep, point),
        percent(point.error.relative_l1),
        ms(point.cost.wall_ms.median)
    )
}

fn of_order(order: f64) -> String {
    format!(
        "Order {}: twice the dial {}.",
        significant(order, 3),
        effect_of(order.exp2())
    )
}

/// Describes a step that divides the error by `factor`.
fn effect_of(factor: f64) -> String {
    if factor > SAME {
        format!("divides the error by {}", significant(factor, 2))
    } else if factor < 1.0 / SAME {
        format!("multiplies the error by {}", significant(1.0 / factor, 2))
    } else {
        "leaves the error unchanged".to_owned()
    }
}

fn of_front(sweep: &Sweep) -> String {
    let front: Vec<String> = sweep
        .points
        .iter()
        .filter(|point| point.on_pareto_front)
        .map(|point| setting(sweep, point))
        .collect();
    if front.is_empty() {
        "No setting of this sweep is worth its time: for each, another sweep has one that is no slower and no farther from the truth."
            .to_owned()
    } else if front.len() == sweep.points.len() {
        "All settings are on the Pareto front: none wastes time.".to_owned()
    } else {
        format!(
            "Worth their time (on the Pareto front): {}.",
            front.join("; ")
        )
    }
}

/// `falls 4.3×`.
fn change(from: f64, to: f64) -> String {
    if from == to {
        return "stays the same".to_owned();
    }
    if to == 0.0 {
        return "falls to 0".to_owned();
    }
    if from == 0.0 {
        return "rises from 0".to_owned();
    }
    let factor = to / from;
    if factor > SAME {
        format!("grows {}×", significant(factor, 2))
    } else if factor < 1.0 / SAME {
        format!("falls {}×", significant(1.0 / factor, 2))
    } else {
        "hardly changes".to_owned()
    }
}

/// Times whose runs overlap count as equal.
fn time_change(from: SpreadMs, to: SpreadMs) -> String {
    if from.min <= to.max && to.min <= from.max {
        "hardly changes (their runs overlap)".to_owned()
    } else {
        change(from.median, to.median)
    }
}
