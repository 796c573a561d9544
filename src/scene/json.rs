//! Reads bytes into a JSON value, more strictly than `serde_json::from_slice`: a duplicate key is an error, and every error has a
//! position.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use super::error::{Issue, IssueKind, SceneError};
use super::pointer::Path;

/// Largest JSON text, bytes. A scene at all its limits is far smaller. (A parsed value takes many times the memory of its text.)
pub const MAX_JSON_BYTES: usize = 4 << 20;

/// Maximum number of listed findings.
pub(super) const MAX_ISSUES: usize = 100;

/// Reads one JSON document.
///
/// # Errors
///
/// Text that is empty, in another encoding than UTF-8, longer than [`MAX_JSON_BYTES`] or not JSON; numbers beyond f64; nesting deeper than 127 levels; text after
/// the document; and duplicate keys in an object (all of them are listed).
pub fn read(bytes: &[u8]) -> Result<Value, SceneError> {
    // Some editors begin UTF-8 with a byte order mark, which a reader may ignore (RFC 8259, 8.1).
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [_, 0, ..] | [0, ..] = bytes {
        let accepted = "JSON in UTF-8 (RFC 8259); in Windows PowerShell, `Out-File -Encoding utf8` instead of `>`";
        return Err(Issue::invalid("", "the text is UTF-16 or UTF-32", accepted)
            .of_kind(IssueKind::Syntax)
            .into());
    }
    if bytes.len() > MAX_JSON_BYTES {
        let detail = format!("the text has {} bytes", bytes.len());
        let accepted = format!("at most {MAX_JSON_BYTES} bytes");
        return Err(Issue::invalid("", detail, accepted)
            .of_kind(IssueKind::LimitExceeded)
            .into());
    }
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(Issue::invalid("", "the text is empty", "a JSON object")
            .of_kind(IssueKind::Syntax)
            .into());
    }
    let notes = Notes::default();
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = Seed {
        path: &Path::Root,
        notes: &notes,
    }
    .deserialize(&mut deserializer)
    .and_then(|value| deserializer.end().map(|()| value))
    .map_err(|error| syntax_issue(&error, notes.failed_at.take()))?;
    let duplicates = notes.duplicates.take();
    if duplicates.is_empty() {
        Ok(value)
    } else {
        Err(SceneError { issues: duplicates })
    }
}

/// Translates serde_json's message into a finding.
fn syntax_issue(error: &serde_json::Error, failed_at: Option<String>) -> SceneError {
    let (line, column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message
        .split_once(" at line ")
        .map_or(message.as_str(), |(before, _)| before);
    let (pointer, detail, accepted) = match message {
        "number out of range" => (
            failed_at.unwrap_or_default(),
            "the number does not fit a 64-bit float",
            "a number between -1.7e308 and 1.7e308",
        ),
        "recursion limit exceeded" => (
            String::new(),
            "the text is nested too deeply",
            "at most 127 levels",
        ),
        "trailing characters" => (
            String::new(),
            "there is text after the JSON document",
            "one JSON document and nothing after it",
        ),
        other => (String::new(), other, "well-formed JSON (RFC 8259)"),
    };
    let detail = format!("{detail} (line {line}, column {column})");
    Issue::invalid(pointer, detail, accepted)
        .of_kind(IssueKind::Syntax)
        .into()
}

/// Notes taken while reading.
#[derive(Default)]
struct Notes {
    duplicates: RefCell<Vec<Issue>>,
    failed_at: RefCell<Option<String>>,
}

/// Reads the value at `path`.
#[derive(Clone, Copy)]
struct Seed<'a> {
    path: &'a Path<'a>,
    notes: &'a Notes,
}

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self).inspect_err(|_| {
            // The innermost value fails first; its path is the one to report.
            self.notes
                .failed_at
                .borrow_mut()
                .get_or_insert_with(|| self.path.to_string());
        })
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value)
            .map(Value::Number)
            .ok_or_else(|| E::custom("number out of range"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = items.next_element_seed(Seed {
            path: &Path::Index(self.path, values.len()),
            notes: self.notes,
        })? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = members.next_key::<String>()? {
            let path = Path::Key(self.path, &key);
            let value = members.next_value_seed(Seed {
                path: &path,
                notes: self.notes,
            })?;
            let pointer = path.to_string();
            if object.insert(key, value).is_some() {
                let mut duplicates = self.notes.duplicates.borrow_mut();
                if duplicates.len() < MAX_ISSUES {
                    duplicates.push(Issue::invalid(
                        pointer,
                        "the key occurs twice in its object",
                        "each key once",
                    ));
                }
            }
        }
        Ok(Value::Object(object))
    }
}
