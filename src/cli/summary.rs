//! Summaries of frames for a terminal.

use std::fmt::Write;
use std::time::Duration;

use super::picture::Picture;
use crate::stats::{AccuracyStats, AdapterStats, ChosenDials, Stats};

/// Where the picture is, and its cost.
pub fn of_picture(picture: &Picture, place: &str, notes: &[String]) -> String {
    let [width, height] = picture.size;
    let stats = &picture.stats;
    let file_bytes = bytes(picture.bytes.len() as u64);
    let mut rows = vec![
        row(
            "picture",
            format!("{place}, {width} × {height}, {file_bytes}"),
        ),
        row("adapter", adapter(&stats.adapter)),
    ];
    rows.extend(passes(stats));
    rows.push(row("time", times(stats)));
    let memory = &stats.memory;
    rows.push(row(
        "memory",
        format!(
            "{} at the peak, {} planned, {} allowed",
            bytes(memory.peak_bytes),
            bytes(memory.planned_peak_bytes),
            bytes(memory.budget_bytes)
        ),
    ));
    if let Some(accuracy) = &stats.accuracy {
        rows.extend(accuracy_rows(accuracy));
    }
    for account in &stats.energy {
        let light = format!("light {}: closed to {:.1e}", account.light, account.closure);
        rows.push(row("energy", light));
    }
    for warning in &stats.warnings {
        let place = warning
            .pointer
            .as_ref()
            .map_or_else(String::new, |pointer| format!(" ({pointer})"));
        rows.push(row("warning", format!("{}{place}", warning.message)));
    }
    rows.extend(notes.iter().map(|note| row("note", note.clone())));
    columns(&rows, "")
}

/// The number of frames rendered and skipped.
pub fn of_animation(rendered: usize, skipped: usize, elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64();
    let frames = if rendered == 1 { "frame" } else { "frames" };
    format!(
        "{rendered} {frames} rendered, {skipped} skipped because their files exist, in {seconds:.1} s"
    )
}

fn row(name: &str, text: String) -> Vec<String> {
    vec![name.to_owned(), text]
}

/// An adapter in one line.
pub fn adapter(adapter: &AdapterStats) -> String {
    let AdapterStats {
        name,
        backend,
        driver,
        software,
    } = adapter;
    let software = if *software {
        ", a software driver on the CPU"
    } else {
        ""
    };
    format!("{name} ({backend}, {driver}{software})")
}

/// Chosen dials, and the estimated error of the frame.
fn accuracy_rows(accuracy: &AccuracyStats) -> Vec<Vec<String>> {
    let chosen = accuracy.chosen.as_ref().map(|chosen| {
        let cells = chosen.water_cells;
        format!(
            "{cells} water cells chosen: predicted {}",
            predicted(chosen)
        )
    });
    let estimated = accuracy
        .estimated_error
        .map(|error| format!("estimated error {}", percent(error)));
    let lines = chosen.into_iter().chain(estimated);
    lines.map(|line| row("accuracy", line)).collect()
}

/// Predicted error and time of chosen dials.
pub fn predicted(chosen: &ChosenDials) -> String {
    format!(
        "error {}, {:.0} ms",
        percent(chosen.predicted_error),
        chosen.predicted_ms
    )
}

/// A share in percent, with three significant digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let digits = match percent {
        p if p >= 10.0 => 1,
        p if p >= 1.0 => 2,
        p if p >= 0.1 => 3,
        _ => 4,
    };
    format!("{percent:.digits$} %")
}

fn passes(stats: &Stats) -> Vec<Vec<String>> {
    let names: Vec<Vec<String>> = stats
        .passes
        .iter()
        .map(|pass| {
            let time = match pass.gpu_ms {
                Some(gpu_ms) => format!("{gpu_ms:.2} ms"),
                None => "not timed".to_owned(),
            };
            vec![pass.name.clone(), format!("{} ×", pass.runs), time]
        })
        .collect();
    columns(&names, "")
        .lines()
        .map(|line| row("pass", line.to_owned()))
        .collect()
}

fn times(stats: &Stats) -> String {
    let time = &stats.time_ms;
    format!(
        "{:.0} ms: plan {:.1}, upload {:.1}, gpu {:.1}, readback {:.1}, encode {:.1}",
        time.total, time.plan, time.upload, time.gpu, time.readback, time.encode
    )
}

/// A size in a suitable unit.
pub fn bytes(count: u64) -> String {
    const UNITS: [(&str, u64); 3] = [("GiB", 1 << 30), ("MiB", 1 << 20), ("KiB", 1 << 10)];
    for (unit, size) in UNITS {
        if count >= size {
            return format!("{:.1} {unit}", count as f64 / size as f64);
        }
    }
    format!("{count} B")
}

/// Widest column that shorter cells are padded to. A longer cell, such as a long name, moves only its own row.
const MAX_WIDTH: usize = 200;

/// Rows with aligned columns, each indented by `indent`.
pub fn columns(rows: &[Vec<String>], indent: &str) -> String {
    let most = rows.iter().map(Vec::len).max().unwrap_or_default();
    let mut widths = vec![0_usize; most];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().min(MAX_WIDTH).max(*width);
        }
    }
    let mut text = String::new();
    for row in rows {
        let mut line = indent.to_owned();
        if let Some((last, cells)) = row.split_last() {
            for (cell, &width) in cells.iter().zip(&widths) {
                let _ = write!(line, "{cell:width$}  ");
            }
            line.push_str(last);
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}
