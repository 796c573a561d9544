//! The choice of a method in a scene, and the dials that only this method has.
//!
//! This module does not know which methods exist. A method declares each of its dials as a [`Dial`]; `methods` checks a scene's
//! choice against them.

use std::collections::BTreeMap;

use serde::de::Error;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Number, Value, json};
use utoipa::openapi::schema::AdditionalProperties;
use utoipa::openapi::{ObjectBuilder, OneOfBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use super::error::Issue;
use super::parse::wrong_type;
use super::pointer::member;
use super::quality::Quality;
use super::ranges::number;
use super::strict::{carry, one_of, quoted};

/// Field that holds the method's name in the object form. No dial may have this name.
pub const KIND: &str = "kind";

/// The accepted forms of `quality.method`, for messages.
const ACCEPTED: &str =
    "a method's name, or an object with the name as `kind` and the method's dials";

/// Whole numbers below this are exact in f64 and in JSON readers of other languages.
const MOST_EXACT: f64 = 9_007_199_254_740_992.0;

/// The method that carries light to the receivers, and its dials that are not at their defaults.
///
/// In JSON: the method's name, or an object with `kind` and dials. It is written in the shortest form, so that equal choices have
/// equal texts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MethodChoice {
    /// The method's name. `None` is the default method.
    pub kind: Option<String>,
    /// The dials by name. An absent dial has its default.
    pub dials: BTreeMap<String, DialValue>,
}

/// The value of a method's dial.
#[derive(Clone, Debug, PartialEq)]
pub enum DialValue {
    /// A finite number (JSON has no others).
    Number(f64),
    /// A word.
    Word(String),
}

impl MethodChoice {
    /// A method with its dials at their defaults.
    pub fn named(kind: impl Into<String>) -> Self {
        Self {
            kind: Some(kind.into()),
            dials: BTreeMap::new(),
        }
    }

    /// The same choice with one dial set.
    #[must_use]
    pub fn with(mut self, dial: &Dial, value: impl Into<DialValue>) -> Self {
        self.dials.insert(dial.name.to_owned(), value.into());
        self
    }

    /// Whether it is the default method with all dials at their defaults. Such a choice is omitted from JSON.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl From<f64> for DialValue {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u32> for DialValue {
    fn from(value: u32) -> Self {
        Self::Number(f64::from(value))
    }
}

impl From<&str> for DialValue {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl std::fmt::Display for DialValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => f.write_str(&number(*value)),
            Self::Word(word) => f.write_str(word),
        }
    }
}

impl From<&DialValue> for Value {
    fn from(value: &DialValue) -> Self {
        match value {
            // A whole number is written as an integer, even if it was read as a float.
            DialValue::Number(value) if value.fract() == 0.0 && value.abs() < MOST_EXACT => {
                Self::from(*value as i64)
            }
            DialValue::Number(value) => Number::from_f64(*value).map_or(Self::Null, Self::Number),
            DialValue::Word(word) => Self::from(word.as_str()),
        }
    }
}

impl Serialize for MethodChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.kind {
            Some(kind) if self.dials.is_empty() => serializer.serialize_str(kind),
            kind => {
                let members = self.dials.len() + usize::from(kind.is_some());
                let mut map = serializer.serialize_map(Some(members))?;
                if let Some(kind) = kind {
                    map.serialize_entry(KIND, kind)?;
                }
                for (name, value) in &self.dials {
                    map.serialize_entry(name, &Value::from(value))?;
                }
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for MethodChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let at = |name: &str, issue: &Issue| {
            let pointer = member(name);
            D::Error::custom(carry(&Issue {
                pointer,
                ..issue.clone()
            }))
        };
        match Value::deserialize(deserializer)? {
            Value::String(kind) => Ok(Self::named(kind)),
            Value::Object(members) => {
                let mut choice = Self::default();
                for (name, value) in members {
                    match value {
                        Value::String(word) if name == KIND => choice.kind = Some(word),
                        other if name == KIND => {
                            return Err(at(KIND, &refused(&other, "a method's name")));
                        }
                        Value::String(word) => {
                            choice.dials.insert(name, DialValue::Word(word));
                        }
                        Value::Number(value) => {
                            let value = value.as_f64().unwrap_or(f64::MAX);
                            choice.dials.insert(name, DialValue::Number(value));
                        }
                        other => return Err(at(&name, &refused(&other, "a number or a word"))),
                    }
                }
                Ok(choice)
            }
            other => Err(wrong_type(&other, ACCEPTED)),
        }
    }
}

fn refused(value: &Value, accepted: &str) -> Issue {
    let detail = format!("{} is of the wrong type", super::parse::json_type(value));
    Issue::invalid("", detail, accepted)
}

impl PartialSchema for MethodChoice {
    fn schema() -> RefOr<Schema> {
        let kind = || ObjectBuilder::new().schema_type(Type::String);
        let dials = ObjectBuilder::new()
            .schema_type(Type::Object)
            .property(KIND, kind().description(Some("The method's name.")))
            .additional_properties(Some(AdditionalProperties::FreeForm(true)));
        let choice = OneOfBuilder::new()
            .item(kind())
            .item(dials)
            .description(Some("A method, by its name or with its dials."));
        RefOr::T(Schema::OneOf(choice.build()))
    }
}

/// Called `Method` in `openapi.yaml`. The CLI and the HTTP service replace this generic schema by the one generated from the list
/// of methods.
impl ToSchema for MethodChoice {
    fn name() -> std::borrow::Cow<'static, str> {
        "Method".into()
    }
}

/// A dial of a method: a field of the object `quality.method`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dial {
    /// Its name in JSON, in snake case, with its unit where it has one.
    pub name: &'static str,
    /// Unit, effect, and what the dial does not do. Range and default are added by [`Dial::documentation`].
    pub help: &'static str,
    /// Values it takes.
    pub kind: DialKind,
}

/// The values that a dial takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DialKind {
    /// A whole number.
    Integer {
        /// Smallest accepted value.
        least: u32,
        /// Largest accepted value.
        most: u32,
        /// Value if the scene sets none.
        default: u32,
    },
    /// A number.
    Number {
        /// Smallest accepted value.
        least: f64,
        /// Largest accepted value.
        most: f64,
        /// Value if the scene sets none.
        default: f64,
    },
    /// One of some words.
    Word {
        /// The words; never empty.
        words: &'static [DialWord],
        /// Value if the scene sets none.
        default: &'static str,
    },
}

/// A word that a dial takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DialWord {
    /// The word.
    pub name: &'static str,
    /// What it means.
    pub help: &'static str,
}

impl Dial {
    /// The integer that `quality` sets, or the default if it sets none or one that is not accepted. 0 if the dial is not
    /// [`DialKind::Integer`].
    pub fn integer(&self, quality: &Quality) -> u32 {
        let DialKind::Integer { default, .. } = self.kind else {
            return 0;
        };
        match self.set_by(quality) {
            Some(DialValue::Number(value)) => *value as u32,
            _ => default,
        }
    }

    /// The number that `quality` sets, or the default if it sets none or one that is not accepted. 0 if the dial takes words.
    pub fn number(&self, quality: &Quality) -> f64 {
        match (self.set_by(quality), self.kind) {
            (Some(DialValue::Number(value)), _) => *value,
            (_, DialKind::Integer { default, .. }) => f64::from(default),
            (_, DialKind::Number { default, .. }) => default,
            (_, DialKind::Word { .. }) => 0.0,
        }
    }

    /// The word that `quality` sets, or the default if it sets none or one that is not accepted. Empty if the dial takes numbers.
    pub fn word(&self, quality: &Quality) -> &'static str {
        let DialKind::Word { words, default } = self.kind else {
            return "";
        };
        match self.set_by(quality) {
            Some(DialValue::Word(set)) => words
                .iter()
                .find(|word| word.name == set)
                .map_or(default, |word| word.name),
            _ => default,
        }
    }

    fn set_by<'a>(&self, quality: &'a Quality) -> Option<&'a DialValue> {
        let value = quality.method.dials.get(self.name)?;
        self.accepts(value).then_some(value)
    }

    /// Whether `value` is of the right type and in range.
    pub fn accepts(&self, value: &DialValue) -> bool {
        match (self.kind, value) {
            (DialKind::Integer { least, most, .. }, DialValue::Number(value)) => {
                let range = f64::from(least)..=f64::from(most);
                value.fract() == 0.0 && range.contains(value)
            }
            (DialKind::Number { least, most, .. }, DialValue::Number(value)) => {
                (least..=most).contains(value)
            }
            (DialKind::Word { words, .. }, DialValue::Word(value)) => {
                words.iter().any(|word| word.name == value)
            }
            _ => false,
        }
    }

    /// The accepted values, for messages.
    pub fn accepted(&self) -> String {
        match self.kind {
            DialKind::Integer { least, most, .. } => format!("an integer, {least} … {most}"),
            DialKind::Number { least, most, .. } => {
                format!("a number, {} … {}", number(least), number(most))
            }
            DialKind::Word { .. } => one_of(&self.words()),
        }
    }

    /// The accepted words; empty if the dial takes numbers.
    pub fn words(&self) -> Vec<&'static str> {
        match self.kind {
            DialKind::Word { words, .. } => words.iter().map(|word| word.name).collect(),
            DialKind::Integer { .. } | DialKind::Number { .. } => Vec::new(),
        }
    }

    /// Its value if the scene sets none.
    pub fn default_value(&self) -> DialValue {
        match self.kind {
            DialKind::Integer { default, .. } => default.into(),
            DialKind::Number { default, .. } => default.into(),
            DialKind::Word { default, .. } => default.into(),
        }
    }

    /// The finding about `value` if it is not accepted, with an empty pointer (the value itself).
    pub fn issue_with(&self, value: &DialValue) -> Option<Issue> {
        if self.accepts(value) {
            return None;
        }
        let detail = match (self.kind, value) {
            (DialKind::Word { .. }, DialValue::Word(word)) => {
                match super::names::meant(word, &self.words()) {
                    Some(meant) => {
                        format!("unknown word `{}`; did you mean `{meant}`?", quoted(word))
                    }
                    None => format!("unknown word `{}`", quoted(word)),
                }
            }
            (DialKind::Word { .. }, DialValue::Number(value)) => {
                format!("the number {} is of the wrong type", number(*value))
            }
            (_, DialValue::Word(word)) => {
                format!("the string \"{}\" is of the wrong type", quoted(word))
            }
            (DialKind::Integer { .. }, DialValue::Number(value)) if value.fract() != 0.0 => {
                format!("the number {} is not whole", number(*value))
            }
            (_, DialValue::Number(value)) => format!("{} is out of range", number(*value)),
        };
        Some(Issue::invalid("", detail, self.accepted()))
    }

    /// Help text, meaning of each word, range and default, in one line.
    pub fn documentation(&self) -> String {
        let mut text = self.help.to_owned();
        match self.kind {
            DialKind::Integer { least, most, .. } => {
                text.push_str(&format!(" {least} … {most}."));
            }
            DialKind::Number { least, most, .. } => {
                text.push_str(&format!(" {} … {}.", number(least), number(most)));
            }
            DialKind::Word { words, .. } => {
                let each: Vec<String> = words
                    .iter()
                    .map(|word| format!("`{}`: {}", word.name, word.help))
                    .collect();
                text.push_str(&format!(" {}.", each.join("; ")));
            }
        }
        let default = self.default_value();
        match self.kind {
            DialKind::Word { .. } => text.push_str(&format!(" Default `{default}`.")),
            _ => text.push_str(&format!(" Default {default}.")),
        }
        text
    }

    /// The JSON schema of its values.
    pub fn schema(&self) -> Schema {
        let base = ObjectBuilder::new()
            .description(Some(self.documentation()))
            .default(Some(Value::from(&self.default_value())));
        let schema = match self.kind {
            DialKind::Integer { least, most, .. } => base
                .schema_type(Type::Integer)
                .minimum(Some(least))
                .maximum(Some(most)),
            DialKind::Number { least, most, .. } => base
                .schema_type(Type::Number)
                .minimum(Some(least))
                .maximum(Some(most)),
            DialKind::Word { .. } => base
                .schema_type(Type::String)
                .enum_values(Some(self.words())),
        };
        Schema::Object(schema.build())
    }
}

/// Turns the value of `quality.method` into an object, so that a dial can be set in it: a name becomes an object of that `kind`.
pub(super) fn as_object(method: &mut Value) {
    match method {
        Value::String(kind) => *method = json!({ KIND: std::mem::take(kind) }),
        Value::Null => *method = Value::Object(Map::new()),
        _ => {}
    }
}

/// Whether `method` is an object of this kind.
pub(super) fn is_of_kind(method: &Value, kind: &Value) -> bool {
    method.is_object() && method.get(KIND) == Some(kind)
}
