//! The study as JSON.

use serde_json::Value;

use super::error::ReportError;
use crate::lab::study::study::Study;

/// Indented JSON with a line end; it reads back as the same study.
///
/// # Errors
///
/// [`ReportError::NotFinite`].
pub fn to_json(study: &Study) -> Result<String, ReportError> {
    let value = serde_json::to_value(study).expect("a study always serialises");
    if let Some(pointer) = null_in(&value, "") {
        return Err(ReportError::NotFinite { pointer });
    }
    let text = serde_json::to_string_pretty(study).expect("a study always serialises");
    Ok(text + "\n")
}

/// Where a number became `null`: absent values are omitted, so only a dial's own value can be `null`.
fn null_in(value: &Value, pointer: &str) -> Option<String> {
    match value {
        Value::Null => Some(pointer.to_owned()),
        Value::Array(items) => items
            .iter()
            .enumerate()
            .find_map(|(index, item)| null_in(item, &format!("{pointer}/{index}"))),
        Value::Object(fields) => fields
            .iter()
            .filter(|(name, _)| *name != "dials")
            .find_map(|(name, field)| null_in(field, &format!("{pointer}/{name}"))),
        _ => None,
    }
}
