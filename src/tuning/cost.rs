//! Predicts the time of a plan: each pass has a cost per run and a cost per unit of its work.

use std::collections::BTreeMap;

use crate::calibration::PassRate;
use crate::facts::SceneFacts;
use crate::graph::plan::Phase;
use crate::plan::FramePlan;

/// The time of a plan with compiled pipelines, ms. Passes without a rate count as 0.
pub fn predicted_ms(
    plan: &FramePlan,
    facts: &SceneFacts,
    frame_ms: f64,
    rates: &BTreeMap<String, PassRate>,
) -> f64 {
    let samples = f64::from(facts.quality.pixel_samples).powi(2) * f64::from(facts.legs().count());
    let runs = plan.report.passes.iter().map(|pass| f64::from(pass.runs));
    let passes: f64 = (plan.graph.passes.iter().zip(runs))
        .filter_map(|((pass, _), runs)| {
            let rate = rates.get(pass.name)?;
            let rounds = match Phase::of(pass.steps.scope()) {
                Phase::Picture => samples,
                Phase::Preparation | Phase::Light => 1.0,
            };
            let once = rate.start_ms + rate.unit_ns * 1e-6 * (pass.work)(facts);
            Some(runs * rounds * once)
        })
        .sum();
    frame_ms + passes
}

/// The rate that fits measured pairs (work, ms of one run) best in relative terms. Both parts are 0 or more.
pub fn fit_rate(measured: &[(f64, f64)]) -> PassRate {
    // Least squares of (start + unit·work)/ms − 1: small and large measurements have the same weight.
    let (mut a, mut b, mut c, mut d, mut e) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &(work, ms) in measured.iter().filter(|(_, ms)| *ms > 0.0) {
        let (x, y) = (1.0 / ms, work / ms);
        a += x * x;
        b += x * y;
        c += y * y;
        d += x;
        e += y;
    }
    let determinant = a * c - b * b;
    let (start, unit) = if determinant > 1e-12 * a * c {
        ((d * c - e * b) / determinant, (a * e - b * d) / determinant)
    } else if c > 0.0 {
        (0.0, e / c)
    } else {
        (0.0, 0.0)
    };
    let (start, unit) = if start < 0.0 && c > 0.0 {
        (0.0, e / c)
    } else if unit < 0.0 && a > 0.0 {
        (d / a, 0.0)
    } else {
        (start, unit)
    };
    PassRate {
        start_ms: start,
        unit_ns: unit * 1e6,
    }
}
