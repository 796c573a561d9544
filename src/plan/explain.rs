//! A plan for people: one line per pass.

use std::fmt;

use super::Plan;

/// Bytes as text, in the largest unit in which the value is at least one.
pub fn human_bytes(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["B", "KiB", "MiB", "GiB"];
    let mut value = bytes as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{bytes} B")
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(chosen) = &self.chosen {
            writeln!(f, "chosen dials")?;
            for (name, value) in [
                ("water_cells", chosen.water_cells),
                ("map_texels", chosen.map_texels),
                ("level_map_texels", chosen.level_map_texels),
                ("split_levels", chosen.split_levels),
            ] {
                writeln!(f, "  {name}: {value}")?;
            }
            writeln!(
                f,
                "  relative L1 error {:.2e} and {:.0} ms predicted: {}",
                chosen.predicted_error, chosen.predicted_ms, chosen.reason
            )?;
        }
        if let Some(choice) = &self.method_choice {
            writeln!(f, "method for this error")?;
            writeln!(
                f,
                "  {}: {}; {:.2e} and {:.0} ms expected from {}",
                choice.method,
                choice.reason,
                choice.expected_error,
                choice.expected_ms,
                choice.source
            )?;
            for other in &choice.others {
                writeln!(f, "  not {}: {}", other.method, other.reason)?;
            }
        }
        writeln!(f, "passes")?;
        for pass in &self.passes {
            let times = if pass.runs == 1 {
                String::new()
            } else {
                format!(" × {}", pass.runs)
            };
            writeln!(f, "  {}{times}: {}", pass.name, pass.reason)?;
        }
        if self.passes.is_empty() {
            writeln!(f, "  none")?;
        }
        writeln!(f, "absent")?;
        for pass in &self.absent {
            writeln!(f, "  {}: {}", pass.name, pass.reason)?;
        }
        writeln!(f, "memory, {} at its peak", human_bytes(self.peak_bytes))?;
        for slot in &self.slots {
            let shares = slot.shares.as_ref();
            let shares =
                shares.map_or(String::new(), |owner| format!(", in the memory of {owner}"));
            writeln!(
                f,
                "  {}: {} ({}){}",
                slot.name,
                human_bytes(slot.bytes),
                slot.holds,
                shares
            )?;
        }
        for warning in &self.warnings {
            writeln!(
                f,
                "warning: {}: {}",
                warning.pointer.as_deref().unwrap_or(&warning.code),
                warning.message
            )?;
        }
        Ok(())
    }
}
