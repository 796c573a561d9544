//! Tables in Markdown.

use super::csv::passes;
use crate::lab::study::study::{Point, Study, Sweep};
use crate::lab::study::words::{
    mib, ms, named_setting, percent, setting, signed_percent, significant, spread,
};

/// Escapes text for Markdown.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::new();
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '\n' | '\r' => out.push(' '),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' | '~' | '$' => {
                out.push('\\');
                out.push(character);
            }
            _ => out.push(character),
        }
    }
    out
}

/// A table; the first column is left-aligned, the others right-aligned. Cells are Markdown already.
pub(super) fn table(header: &[String], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule: Vec<String> = (0..header.len())
        .map(|index| if index == 0 { "---" } else { "---:" }.to_owned())
        .collect();
    let body: String = rows.iter().map(|row| line(row)).collect();
    line(header) + &line(&rule) + &body
}

/// Error and cost of each setting of a sweep. Empty columns are omitted.
pub(super) fn figures(sweep: &Sweep) -> String {
    let any = |filled: fn(&Point) -> bool| sweep.points.iter().any(filled);
    let edges = any(|point| point.error.shadow_edge_share.is_some());
    let estimates = any(|point| point.error.estimated.is_some());
    let mut header = vec![escaped(&sweep.dial)];
    header.extend(["L1", "p99", "FLIP", "Luv", "RMSE (W/m²)", "bias"].map(str::to_owned));
    if edges {
        header.push("at shadow edges".to_owned());
    }
    if estimates {
        header.push("estimate".to_owned());
    }
    header.extend(["time (ms)", "peak memory (MiB)", "front"].map(str::to_owned));
    let rows: Vec<Vec<String>> = sweep
        .points
        .iter()
        .map(|point| {
            let (error, cost) = (&point.error, &point.cost);
            let optional = |value: Option<f64>| value.map_or("–".to_owned(), percent);
            let mut row = vec![
                escaped(&setting(sweep, point)),
                percent(error.relative_l1),
                percent(error.p99),
                significant(error.flip, 3),
                significant(error.luv_distance, 3),
                significant(error.rmse_w_m2, 3),
                signed_percent(error.flux_bias),
            ];
            if edges {
                row.push(optional(error.shadow_edge_share));
            }
            if estimates {
                row.push(optional(error.estimated));
            }
            row.extend([
                spread(cost.wall_ms),
                mib(cost.peak_bytes),
                if point.on_pareto_front { "★" } else { "" }.to_owned(),
            ]);
            row
        })
        .collect();
    table(&header, &rows)
}

/// Median time of each pass at each setting, ms.
pub(super) fn pass_times(study: &Study) -> String {
    let names = passes(study);
    let mut header = vec!["setting".to_owned()];
    header.extend(names.iter().map(|name| escaped(name)));
    header.push("GPU in all".to_owned());
    let mut rows = Vec::new();
    for sweep in &study.sweeps {
        for point in &sweep.points {
            let mut row = vec![escaped(&named_setting(sweep, point))];
            for name in &names {
                let pass = point.cost.passes.iter().find(|pass| pass.name == *name);
                row.push(pass.map_or("–".to_owned(), |pass| ms(pass.ms.median)));
            }
            row.push(ms(point.cost.gpu_ms.median));
            rows.push(row);
        }
    }
    table(&header, &rows)
}
