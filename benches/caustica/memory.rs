//! Memory: by the plan, by the program's own account, and by the system.

use caustica::cli::summary::bytes;
use caustica::stats::MemoryStats;

use crate::report::{Cell, Table};

/// Memory of one stage of the run.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    /// What was rendered.
    pub what: String,
    /// By the program's own account, of one frame.
    pub frame: Option<MemoryStats>,
    /// Largest resident set of the process during the stage, bytes; absent where the system does not report it.
    pub resident_peak: Option<u64>,
}

/// Resets the largest resident set, where the system can.
pub(crate) fn begin_stage() {
    // If this fails, the peaks are those since the start: never too small.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Largest resident set since [`begin_stage`], bytes.
pub(crate) fn resident_peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

/// The table of memory.
pub(crate) fn table(stages: &[Stage]) -> Table {
    let mut table = Table::new(
        "Memory at the peak",
        "Planned: before anything is allocated. Accounted: while it runs. Resident: the whole process with drivers and results, \
        and on a software driver also the GPU's memory.",
        &["scene", "planned", "accounted", "resident"],
    );
    for stage in stages {
        let of_frame = |pick: fn(&MemoryStats) -> u64| stage.frame.as_ref().map(pick);
        table.rows.push(vec![
            Cell::text(&stage.what),
            size(of_frame(|memory| memory.planned_peak_bytes)),
            size(of_frame(|memory| memory.peak_bytes)),
            size(stage.resident_peak),
        ]);
    }
    table
}

fn size(count: Option<u64>) -> Cell {
    count.map_or(Cell::Absent, |count| Cell::Figure {
        value: count as f64,
        text: bytes(count),
    })
}
