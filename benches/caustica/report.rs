//! The tables: in Markdown that is aligned for a terminal, and in JSON for programs.

use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use crate::spread::Spread;

/// All that was measured.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    /// Where and what, by name.
    facts: Vec<(String, String)>,
    /// One per topic.
    pub tables: Vec<Table>,
}

/// One topic.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    title: String,
    note: String,
    columns: Vec<String>,
    /// Rows; each has one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug)]
pub(crate) enum Cell {
    /// Words.
    Text(String),
    /// One figure, and how it is written.
    Figure {
        /// In the unit of the column; bytes for sizes.
        value: f64,
        /// With its unit where it needs one.
        text: String,
    },
    /// Several runs: median and range.
    Runs(Spread),
    /// Several runs of which only the median is shown.
    Median(Spread),
    /// Does not apply.
    Absent,
}

impl Cell {
    /// Words.
    pub(crate) fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    /// A whole number.
    pub(crate) fn count(value: usize) -> Self {
        Self::Figure {
            value: value as f64,
            text: value.to_string(),
        }
    }

    /// A value with three significant digits.
    pub(crate) fn figure(value: f64) -> Self {
        Self::Figure {
            value,
            text: digits(value),
        }
    }

    /// A part of the whole, shown in percent.
    pub(crate) fn percent(value: f64) -> Self {
        Self::Figure {
            value,
            text: format!("{} %", digits(value * 100.0)),
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::Text(text) | Self::Figure { text, .. } => text.clone(),
            Self::Runs(spread) => format!(
                "{} ({}..{})",
                digits(spread.median()),
                digits(spread.min()),
                digits(spread.max())
            ),
            Self::Median(spread) => digits(spread.median()),
            Self::Absent => "–".to_owned(),
        }
    }

    fn value(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Figure { value, .. } => json!(value),
            Self::Runs(spread) | Self::Median(spread) => json!({
                "median": spread.median(),
                "min": spread.min(),
                "max": spread.max(),
                "runs": spread.runs(),
            }),
            Self::Absent => Value::Null,
        }
    }
}

impl Table {
    /// A table without rows.
    pub(crate) fn new(title: &str, note: &str, columns: &[&str]) -> Self {
        Self {
            title: title.to_owned(),
            note: note.to_owned(),
            columns: columns.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    fn markdown(&self) -> String {
        let shown: Vec<Vec<String>> = self
            .rows
            .iter()
            .map(|row| row.iter().map(Cell::shown).collect())
            .collect();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|column| {
                let cells = shown.iter().filter_map(|row| row.get(column));
                let head = &self.columns[column];
                cells
                    .chain([head])
                    .map(|cell| cell.chars().count())
                    .max()
                    .unwrap_or_default()
            })
            .collect();
        let mut text = format!("## {}\n\n{}\n\n", self.title, self.note);
        let rule: Vec<String> = widths
            .iter()
            .enumerate()
            .map(|(column, &width)| match column {
                0 => "-".repeat(width),
                _ => format!("{}:", "-".repeat(width.saturating_sub(1))),
            })
            .collect();
        for row in [&self.columns, &rule].into_iter().chain(&shown) {
            text.push('|');
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                // Writing to a string cannot fail.
                let _ = match column {
                    0 => write!(text, " {cell:width$} |"),
                    _ => write!(text, " {cell:>width$} |"),
                };
            }
            text.push('\n');
        }
        text
    }

    fn json(&self) -> Value {
        let rows: Vec<Value> = self
            .rows
            .iter()
            .map(|row| {
                let cells = self
                    .columns
                    .iter()
                    .cloned()
                    .zip(row.iter().map(Cell::value));
                Value::Object(cells.collect::<Map<_, _>>())
            })
            .collect();
        json!({ "title": self.title, "note": self.note, "rows": rows })
    }
}

impl Report {
    /// Says something about the machine or the run.
    pub(crate) fn fact(&mut self, name: &str, value: &str) {
        self.facts.push((name.to_owned(), value.to_owned()));
    }

    /// The whole report as text.
    pub(crate) fn markdown(&self) -> String {
        let mut text = "# Caustica, measured\n\n".to_owned();
        for (name, value) in &self.facts {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "- {name}: {value}");
        }
        for table in &self.tables {
            text.push('\n');
            text.push_str(&table.markdown());
        }
        text
    }

    /// Writes `bench.md` and `bench.json` into a folder, which is made if it is missing.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(crate) fn write(&self, folder: &str) -> io::Result<[PathBuf; 2]> {
        let folder = Path::new(folder);
        std::fs::create_dir_all(folder)?;
        let facts: Map<String, Value> = self
            .facts
            .iter()
            .map(|(name, value)| (name.clone(), json!(value)))
            .collect();
        let tables: Vec<Value> = self.tables.iter().map(Table::json).collect();
        let document = json!({ "facts": facts, "tables": tables });
        let paths = [folder.join("bench.md"), folder.join("bench.json")];
        std::fs::write(&paths[0], self.markdown())?;
        std::fs::write(&paths[1], format!("{document:#}\n"))?;
        Ok(paths)
    }
}

/// Three digits that count, and no exponent.
fn digits(value: f64) -> String {
    let decimals = match value.abs() {
        size if size >= 100.0 => 0,
        size if size >= 10.0 => 1,
        size if size >= 1.0 => 2,
        _ => 3,
    };
    format!("{value:.decimals$}")
}
