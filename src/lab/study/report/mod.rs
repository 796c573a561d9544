//! A study as files.
//!
//! `json` and `csv` are for programs, `markdown` for people. The latter uses `tables`, states `conclusions` and explains its terms
//! in a `glossary`; `methods` has what it says of comparisons. `write` fills a folder with all of them and the pictures. `error` says what went wrong.

mod conclusions;
mod csv;
mod error;
mod glossary;
mod json;
mod markdown;
mod methods;
mod tables;
mod write;

pub use conclusions::conclusions;
pub use csv::to_csv;
pub use error::ReportError;
pub use json::to_json;
pub use markdown::{ReportLinks, SweepLinks, to_markdown};
pub use methods::{method_conclusions, method_orders, method_table, why_not_first};
pub use write::write_study;
