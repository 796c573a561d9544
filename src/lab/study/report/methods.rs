//! A comparison of methods in sentences and tables.

use super::tables::{escaped, table};
use crate::lab::study::equal_time::{self, Standing, dearest_pass};
use crate::lab::study::order::fit_order;
use crate::lab::study::study::{Point, Study, Sweep};
use crate::lab::study::words::{mib, ms, percent, setting, signed_percent, significant, spread};

/// Errors in the same time that differ by less than this factor count as equal: times scatter.
const SAME: f64 = 1.1;

/// Sentences that sum up a comparison: the best method in a time and why the first one is not it, if so; then each other method.
/// Empty if nothing was measured.
pub fn method_conclusions(study: &Study) -> Vec<String> {
    let Some(limit_ms) = equal_time::limit_ms(study) else {
        return Vec::new();
    };
    let standings = equal_time::standings(study, limit_ms);
    let Some((best, least)) = equal_time::best(&standings).and_then(in_time) else {
        return Vec::new();
    };
    let mut sentences = vec![format!(
        "In {} ms (the time of {}), {} is nearest to the truth: {}.",
        ms(limit_ms),
        first_setting(study),
        best.method(),
        percent(least)
    )];
    let why = why_not_first(study);
    // What is said of the first method in that sentence is not said again.
    let others = standings.iter().skip(usize::from(why.is_some()));
    let others = others.filter(|s| s.method() != best.method());
    let others: Vec<String> = others
        .map(|other| match other.twin {
            true => format!(
                "{} does the same here as {}: the same passes and the same light.",
                other.method(),
                standings[0].method()
            ),
            false => beside(other, least),
        })
        .collect();
    sentences.extend(why);
    sentences.extend(others);
    let absent = equal_time::absent(study).into_iter();
    sentences
        .extend(absent.map(|(name, reason)| format!("{name} cannot render this scene: {reason}.")));
    sentences
}

/// Why the first method of a comparison is not the best in the time of its middle setting; `None` if it is, or is as good.
pub fn why_not_first(study: &Study) -> Option<String> {
    let limit_ms = equal_time::limit_ms(study)?;
    let standings = equal_time::standings(study, limit_ms);
    let (best, least) = equal_time::best(&standings).and_then(in_time)?;
    let (first, error) = standings.first().and_then(in_time)?;
    if best.method() == first.method() || error <= SAME * least {
        return None;
    }
    let mut sentence = format!(
        "{} is not the best here: in {} ms its error is {}, that of {} {}.",
        first.method(),
        ms(limit_ms),
        percent(error),
        best.method(),
        percent(least),
    );
    let own = equal_time::method_front(study, best.method());
    if let Some(as_near) = own.iter().find(|standing| standing.error() <= error) {
        sentence.push_str(&format!(
            " {} is as near after {} ms ({}: {}).",
            best.method(),
            ms(as_near.ms()),
            as_near.sweep.dial,
            setting(as_near.sweep, as_near.point)
        ));
    }
    if let Some((pass, share)) = dearest_pass(first.point) {
        let mut there = best.point.cost.passes.iter();
        let other = match there.find(|other| other.name == pass.name) {
            Some(other) => format!("in {} {} ms", best.method(), ms(other.ms.median)),
            None => format!("absent in {}", best.method()),
        };
        sentence.push_str(&format!(
            " {} of the time of {} is its pass {} ({} ms, {other}).",
            percent(share),
            first.method(),
            pass.name,
            ms(pass.ms.median),
        ));
    }
    Some(sentence)
}

/// A standing with its error in the time, if it has one.
fn in_time<'a, 'b>(standing: &'b Standing<'a>) -> Option<(&'b Standing<'a>, f64)> {
    Some((standing, standing.error_in_time?))
}

/// `level_map with water_cells 256`.
fn first_setting(study: &Study) -> String {
    let sweep = &study.sweeps[0];
    let middle = &sweep.points[sweep.points.len() / 2];
    format!("{} with {}", sweep.dial, setting(sweep, middle))
}

/// What a method achieves, beside the least error.
fn beside(standing: &Standing<'_>, least: f64) -> String {
    let name = standing.method();
    let Some(error) = standing.error_in_time else {
        return format!(
            "{name} takes longer at every setting: {} ms with an error of {} ({}: {}).",
            ms(standing.ms()),
            percent(standing.error()),
            standing.sweep.dial,
            setting(standing.sweep, standing.point)
        );
    };
    let factor = error / least;
    let times = if factor.is_finite() && factor > SAME {
        format!(", {} times as much", significant(factor, 2))
    } else {
        String::new()
    };
    format!(
        "{name}: {}{times}; its nearest setting is {}: {} ({}, {} ms).",
        percent(error),
        standing.sweep.dial,
        setting(standing.sweep, standing.point),
        percent(standing.error()),
        ms(standing.ms())
    )
}

/// Error, energy and cost of every setting of every series. The energy balance is the light in excess (+) or missing (−).
pub fn method_table(study: &Study) -> String {
    let header = [
        "method",
        "setting",
        "L1",
        "FLIP",
        "energy balance",
        "time (ms)",
        "peak memory (MiB)",
        "front",
    ];
    let rows = study.sweeps.iter().flat_map(|sweep| {
        let points = sweep.points.iter();
        points.map(move |point| row(sweep, point))
    });
    table(&header.map(str::to_owned), &rows.collect::<Vec<_>>())
}

fn row(sweep: &Sweep, point: &Point) -> Vec<String> {
    let (error, cost) = (&point.error, &point.cost);
    vec![
        escaped(&sweep.dial),
        escaped(&setting(sweep, point)),
        percent(error.relative_l1),
        significant(error.flip, 3),
        signed_percent(error.flux_bias),
        spread(cost.wall_ms),
        mib(cost.peak_bytes),
        if point.on_pareto_front { "★" } else { "" }.to_owned(),
    ]
}

/// The order at which the error of each series falls, where it can be fitted.
pub fn method_orders(study: &Study) -> String {
    let fitted = study.sweeps.iter().filter_map(|sweep| {
        let fit = fit_order(sweep, study.truth.relative_error)?;
        let used = fit.used.iter().filter(|used| **used).count();
        Some(vec![
            escaped(&sweep.dial),
            significant(fit.order, 3),
            used.to_string(),
        ])
    });
    let rows: Vec<Vec<String>> = fitted.collect();
    if rows.is_empty() {
        return String::new();
    }
    let header = ["method", "order", "settings"].map(str::to_owned);
    table(&header, &rows)
}
