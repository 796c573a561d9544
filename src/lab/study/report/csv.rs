//! CSV (RFC 4180): one row per setting.

use serde_json::Value;

use crate::lab::study::study::{Point, SpreadMs, Study, Sweep};
use crate::lab::study::words;

/// Columns before those of the passes.
const COLUMNS: [&str; 25] = [
    "scene",
    "scene_hash",
    "adapter",
    "sweep",
    "setting",
    "dials_json",
    "relative_l1",
    "rmse_w_m2",
    "flux_bias",
    "p99",
    "flip",
    "luv_distance",
    "shadow_edge_share",
    "estimated_relative_l1",
    "truth_relative_l1",
    "runs",
    "wall_median_ms",
    "wall_min_ms",
    "wall_max_ms",
    "gpu_median_ms",
    "gpu_min_ms",
    "gpu_max_ms",
    "peak_bytes",
    "on_pareto_front",
    "warnings",
];

/// A header that names units, then one row per setting; lines end with CR LF. Errors are shares, not per cent. A column per pass
/// follows, median in ms, empty where the pass did not run.
pub fn to_csv(study: &Study) -> String {
    let passes = passes(study);
    let mut header: Vec<String> = COLUMNS.map(str::to_owned).to_vec();
    header.extend(passes.iter().map(|pass| format!("pass_{pass}_median_ms")));
    let mut text = line(&header);
    for sweep in &study.sweeps {
        for point in &sweep.points {
            text += &line(&row(study, sweep, point, &passes));
        }
    }
    text
}

/// Names of all passes, in the order in which they first appear.
pub(super) fn passes(study: &Study) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for point in study.sweeps.iter().flat_map(|sweep| &sweep.points) {
        for pass in &point.cost.passes {
            if !names.contains(&pass.name.as_str()) {
                names.push(&pass.name);
            }
        }
    }
    names
}

fn row(study: &Study, sweep: &Sweep, point: &Point, passes: &[&str]) -> Vec<String> {
    let (error, cost) = (&point.error, &point.cost);
    let optional = |value: Option<f64>| value.map_or(String::new(), number);
    let dials = Value::Object(point.dials.clone().into_iter().collect());
    let warnings: Vec<&str> = point.warnings.iter().map(|w| w.code.as_str()).collect();
    let mut row = vec![
        study.scene.clone(),
        study.scene_hash.clone(),
        study.adapter.name.clone(),
        sweep.dial.clone(),
        words::setting(sweep, point),
        dials.to_string(),
        number(error.relative_l1),
        number(error.rmse_w_m2),
        number(error.flux_bias),
        number(error.p99),
        number(error.flip),
        number(error.luv_distance),
        optional(error.shadow_edge_share),
        optional(error.estimated),
        number(study.truth.relative_error),
        cost.runs.to_string(),
    ];
    row.extend(spread(cost.wall_ms));
    row.extend(spread(cost.gpu_ms));
    row.push(cost.peak_bytes.to_string());
    row.push(point.on_pareto_front.to_string());
    row.push(warnings.join(" "));
    for name in passes {
        let pass = cost.passes.iter().find(|pass| pass.name == *name);
        row.push(optional(pass.map(|pass| pass.ms.median)));
    }
    row
}

fn spread(ms: SpreadMs) -> [String; 3] {
    [ms.median, ms.min, ms.max].map(number)
}

/// The shortest text that reads back as the same number.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn line(fields: &[String]) -> String {
    let fields: Vec<String> = fields.iter().map(|field| quoted(field)).collect();
    fields.join(",") + "\r\n"
}

fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
