//! Reads a JSON value into a typed value, exactly as the schema says: only an object is read as an object, and only a string as a
//! word (serde alone would also take an array for an object and `{"png": null}` for `"png"`). An error has its JSON pointer even
//! inside objects whose type is selected by `kind`.

use std::fmt;

use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess,
    SeqAccess, Unexpected, Visitor,
};
use serde_json::{Value, map};

use super::error::Issue;
use super::names;
use super::pointer::{Path, member};

/// Longest piece of the input that is repeated in a message, characters.
const MAX_QUOTED: usize = 60;

/// Separates the parts of a finding that travels as text (see [`carry`]).
const SEPARATOR: char = '\u{1f}';

/// Reads a `T`.
///
/// # Errors
///
/// The first value that has the wrong type, is missing, or is unknown.
pub fn from_value<T: DeserializeOwned>(value: &Value) -> Result<T, Issue> {
    T::deserialize(Strict {
        value,
        path: Path::Root,
    })
    .map_err(|error| Issue::invalid(error.pointer, error.detail, error.accepted))
}

/// Encodes a finding as the text of a serde error, because serde's errors carry text only. [`ReadError`] decodes it.
pub(super) fn carry(issue: &Issue) -> String {
    let Issue {
        pointer,
        detail,
        accepted,
        ..
    } = issue;
    format!("{SEPARATOR}{pointer}{SEPARATOR}{detail}{SEPARATOR}{accepted}")
}

/// Some words as "`a`, `b` or `c`".
pub fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        Some((last, _)) => last.clone(),
        None => "nothing".to_owned(),
    }
}

/// A piece of the input, cut to a readable length.
pub fn quoted(text: &str) -> String {
    if text.chars().count() <= MAX_QUOTED {
        return text.to_owned();
    }
    let start: String = text.chars().take(MAX_QUOTED).collect();
    format!("{start}…")
}

/// The first error.
#[derive(Debug)]
struct ReadError {
    /// From the root if `located`, else from the value that is being read.
    pointer: String,
    located: bool,
    detail: String,
    accepted: String,
}

impl ReadError {
    fn here(detail: String, accepted: String) -> Self {
        Self {
            pointer: String::new(),
            located: false,
            detail,
            accepted,
        }
    }

    /// Prefixes the pointer of an error that was found at or below `path`.
    fn at(mut self, path: &Path<'_>) -> Self {
        if !self.located {
            self.pointer = format!("{path}{}", self.pointer);
            self.located = true;
        }
        self
    }
}

impl std::error::Error for ReadError {}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.pointer, self.detail)
    }
}

impl Error for ReadError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        let text = message.to_string();
        let parts: Vec<&str> = text.split(SEPARATOR).collect();
        match parts[..] {
            ["", pointer, detail, accepted] => Self {
                pointer: pointer.to_owned(),
                ..Self::here(detail.to_owned(), accepted.to_owned())
            },
            _ => Self::here(text, String::new()),
        }
    }

    fn invalid_type(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let detail = format!("{} is of the wrong type", describe(unexpected));
        Self::here(detail, plain(expected))
    }

    fn invalid_value(unexpected: Unexpected<'_>, expected: &dyn Expected) -> Self {
        let detail = format!("{} is not accepted", describe(unexpected));
        Self::here(detail, plain(expected))
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::here(format!("it has {length} values"), plain(expected))
    }

    fn unknown_variant(variant: &str, words: &'static [&'static str]) -> Self {
        let detail = match names::meant(variant, words) {
            Some(word) => format!("unknown word `{}`; did you mean `{word}`?", quoted(variant)),
            None => format!("unknown word `{}`", quoted(variant)),
        };
        Self::here(detail, one_of(words))
    }

    fn unknown_field(field: &str, fields: &'static [&'static str]) -> Self {
        let name = quoted(field);
        let (detail, accepted) = match (names::meant(field, fields), names::moved(field, fields)) {
            (_, Some((why, instead))) => {
                let accepted = format!("{instead}; or the fields {}", one_of(fields));
                (format!("unknown field `{name}`: {why}"), accepted)
            }
            (Some(meant), None) => (
                format!("unknown field `{name}`; did you mean `{meant}`?"),
                format!("the fields {}", one_of(fields)),
            ),
            (None, None) => (
                format!("unknown field `{name}`"),
                format!("the fields {}", one_of(fields)),
            ),
        };
        Self {
            pointer: member(field),
            ..Self::here(detail, accepted)
        }
    }

    fn missing_field(field: &'static str) -> Self {
        let accepted = match names::unit_of(field) {
            Some(unit) => format!("the field `{field}`, in {unit}"),
            None => format!("the field `{field}`"),
        };
        Self {
            pointer: member(field),
            ..Self::here(format!("missing field `{field}`"), accepted)
        }
    }
}

/// The value that was found, in JSON's terms.
fn describe(unexpected: Unexpected<'_>) -> String {
    match unexpected {
        Unexpected::Bool(value) => format!("the boolean {value}"),
        Unexpected::Unsigned(value) => format!("the number {value}"),
        Unexpected::Signed(value) => format!("the number {value}"),
        Unexpected::Float(value) => format!("the number {value}"),
        Unexpected::Str(text) => format!("the string \"{}\"", quoted(text)),
        Unexpected::Unit | Unexpected::Option => "null".to_owned(),
        Unexpected::Seq => "an array".to_owned(),
        Unexpected::Map | Unexpected::StructVariant => "an object".to_owned(),
        other => other.to_string(),
    }
}

/// What serde expects, in JSON's terms.
fn plain(expected: &dyn Expected) -> String {
    match expected.to_string().as_str() {
        "f64" => "a number".to_owned(),
        "u32" | "u64" | "usize" => "an integer, 0 or more".to_owned(),
        "a sequence" => "an array".to_owned(),
        "a boolean" => "true or false".to_owned(),
        other => other.to_owned(),
    }
}

/// Reads `value`, which is at `path`.
#[derive(Clone, Copy)]
struct Strict<'a, 'p> {
    value: &'a Value,
    path: Path<'p>,
}

impl<'a> Strict<'a, '_> {
    fn unexpected(&self) -> Unexpected<'a> {
        match self.value {
            Value::Null => Unexpected::Unit,
            Value::Bool(value) => Unexpected::Bool(*value),
            Value::Number(number) => match (number.as_u64(), number.as_i64()) {
                (Some(value), _) => Unexpected::Unsigned(value),
                (_, Some(value)) => Unexpected::Signed(value),
                _ => Unexpected::Float(number.as_f64().unwrap_or(f64::NAN)),
            },
            Value::String(text) => Unexpected::Str(text),
            Value::Array(_) => Unexpected::Seq,
            Value::Object(_) => Unexpected::Map,
        }
    }

    fn visit_array<'de, V: Visitor<'de>>(
        &self,
        values: &'de [Value],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let mut items = Items {
            values,
            next: 0,
            path: &self.path,
        };
        let read = visitor.visit_seq(&mut items)?;
        if items.next < values.len() {
            let accepted = format!("an array of length {}", items.next);
            return Err(Error::invalid_length(values.len(), &accepted.as_str()));
        }
        Ok(read)
    }
}

impl<'de> Deserializer<'de> for Strict<'de, '_> {
    type Error = ReadError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match self.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Number(number) => match (number.as_u64(), number.as_i64(), number.as_f64()) {
                (Some(value), _, _) => visitor.visit_u64(value),
                (_, Some(value), _) => visitor.visit_i64(value),
                (_, _, Some(value)) => visitor.visit_f64(value),
                _ => Err(Error::custom("the number does not fit a 64-bit float")),
            },
            Value::String(text) => visitor.visit_borrowed_str(text),
            Value::Array(values) => self.visit_array(values, visitor),
            Value::Object(members) => visitor.visit_map(Members {
                members: members.iter(),
                current: None,
                path: &self.path,
            }),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, ReadError> {
        match self.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        if self.value.is_object() {
            return self.deserialize_any(visitor);
        }
        let accepted = format!("an object with the fields {}", one_of(fields));
        Err(Error::invalid_type(self.unexpected(), &accepted.as_str()))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, ReadError> {
        let word: Result<StrDeserializer<'_, ReadError>, ReadError> = match self.value {
            Value::String(word) => Ok(word.as_str().into_deserializer()),
            _ => Err(Error::invalid_type(
                self.unexpected(),
                &one_of(words).as_str(),
            )),
        };
        visitor.visit_enum(word?)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple
        tuple_struct map identifier ignored_any
    }
}

/// The elements of an array.
struct Items<'de, 'p> {
    values: &'de [Value],
    next: usize,
    path: &'p Path<'p>,
}

impl<'de> SeqAccess<'de> for Items<'de, '_> {
    type Error = ReadError;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, ReadError> {
        let Some(value) = self.values.get(self.next) else {
            return Ok(None);
        };
        let path = Path::Index(self.path, self.next);
        self.next += 1;
        // The path is added here, not in `Strict`, because a value may be refused after `Strict` has read it and is gone.
        seed.deserialize(Strict { value, path })
            .map(Some)
            .map_err(|error| error.at(&path))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.values.len() - self.next)
    }
}

/// The members of an object.
struct Members<'de, 'p> {
    members: map::Iter<'de>,
    current: Option<(&'de str, &'de Value)>,
    path: &'p Path<'p>,
}

impl<'de> MapAccess<'de> for Members<'de, '_> {
    type Error = ReadError;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, ReadError> {
        self.current = self
            .members
            .next()
            .map(|(key, value)| (key.as_str(), value));
        match self.current {
            Some((key, _)) => {
                let key: StrDeserializer<'_, ReadError> = key.into_deserializer();
                seed.deserialize(key).map(Some)
            }
            None => Ok(None),
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, ReadError> {
        let (key, value) = self
            .current
            .take()
            .ok_or_else(|| ReadError::custom("a value was read before its key"))?;
        let path = Path::Key(self.path, key);
        seed.deserialize(Strict { value, path })
            .map_err(|error| error.at(&path))
    }
}
