//! Reads JSON into a [`Scene`], and has the helpers with which `types` reads its irregular values.

use serde::de::{DeserializeOwned, Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::Value;

pub use super::error::{Issue, IssueKind, SceneError};
pub use super::json::{MAX_JSON_BYTES, read as read_json};
pub use super::strict::{from_value, one_of, quoted};

use super::ranges::Integer;
use super::strict::carry;
use super::types::Scene;

/// A rotation whose length is closer to 1 than this is left unchanged, so that writing and reading a scene changes nothing.
const UNIT_LENGTH_EPSILON: f64 = 4.0 * f64::EPSILON;

/// How far the length of a rotation may be from 1.
pub const ROTATION_LENGTH_TOLERANCE: f64 = 1e-3;

impl Scene {
    /// Reads a scene. Ranges and references are checked by [`Scene::validate`].
    ///
    /// # Errors
    ///
    /// Text that is not JSON, duplicate keys, and the first value that is unknown, missing or of the wrong type.
    pub fn from_json(bytes: &[u8]) -> Result<Self, SceneError> {
        Self::from_value(read_json(bytes)?)
    }

    /// Reads a scene from a JSON value, as [`Scene::from_json`] does.
    ///
    /// # Errors
    ///
    /// The first value that is unknown, missing or of the wrong type.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a request's value is not needed afterwards"
    )]
    pub fn from_value(value: Value) -> Result<Self, SceneError> {
        Ok(from_value(&value)?)
    }
}

/// Reads an object whose type is selected by its `kind`.
pub(super) fn tagged<'de, D: Deserializer<'de>, T>(
    deserializer: D,
    default_kind: Option<&str>,
    kinds: &[&str],
    read: impl FnOnce(&str, &Value) -> Result<T, String>,
) -> Result<T, D::Error> {
    let value = Value::deserialize(deserializer)?;
    let refused = |pointer: &str, detail: String, accepted: String| {
        D::Error::custom(carry(&Issue::invalid(pointer, detail, accepted)))
    };
    let Value::Object(members) = &value else {
        let detail = format!("{} is of the wrong type", json_type(&value));
        let accepted = format!("an object with the field `kind`: {}", one_of(kinds));
        return Err(refused("", detail, accepted));
    };
    let kind = match (members.get("kind"), default_kind) {
        (Some(Value::String(kind)), _) if kinds.contains(&kind.as_str()) => kind.clone(),
        (Some(Value::String(kind)), _) => {
            let detail = format!("unknown kind `{}`", quoted(kind));
            return Err(refused("/kind", detail, one_of(kinds)));
        }
        (Some(other), _) => {
            let detail = format!("{} is of the wrong type", json_type(other));
            return Err(refused("/kind", detail, one_of(kinds)));
        }
        (None, Some(kind)) => kind.to_owned(),
        (None, None) => {
            return Err(refused(
                "/kind",
                "missing field `kind`".to_owned(),
                one_of(kinds),
            ));
        }
    };
    read(&kind, &value).map_err(D::Error::custom)
}

/// Reads the object whose `kind` [`tagged`] has read; the error is a finding as text.
pub(super) fn inner<T: DeserializeOwned>(value: &Value) -> Result<T, String> {
    from_value(value).map_err(|issue| carry(&issue))
}

/// Reads an integer; 960.0 is accepted too.
pub(super) fn integer<'de, I: Integer, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<u32, D::Error> {
    struct Integral<I>(std::marker::PhantomData<I>);

    impl<I: Integer> Visitor<'_> for Integral<I> {
        type Value = u32;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(&I::accepted())
        }

        fn visit_u64<E: Error>(self, value: u64) -> Result<u32, E> {
            u32::try_from(value).map_err(|_| E::invalid_value(Unexpected::Unsigned(value), &self))
        }

        fn visit_f64<E: Error>(self, value: f64) -> Result<u32, E> {
            if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
                Ok(value as u32)
            } else {
                Err(E::invalid_value(Unexpected::Float(value), &self))
            }
        }

        fn visit_i64<E: Error>(self, value: i64) -> Result<u32, E> {
            u32::try_from(value).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))
        }
    }

    deserializer.deserialize_any(Integral::<I>(std::marker::PhantomData))
}

/// Like [`integer`], for a field that may be absent or null.
pub(super) fn optional_integer<'de, I: Integer, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<u32>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::Null => Ok(None),
        value => integer_of::<I>(&value)
            .map(Some)
            .map_err(|issue| D::Error::custom(carry(&issue))),
    }
}

/// Reads an integer from a value that is already there.
pub(super) fn integer_of<I: Integer>(value: &Value) -> Result<u32, Issue> {
    struct Read<I>(u32, std::marker::PhantomData<I>);

    impl<'de, I: Integer> Deserialize<'de> for Read<I> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            integer::<I, D>(deserializer).map(|value| Self(value, std::marker::PhantomData))
        }
    }

    from_value::<Read<I>>(value).map(|read| read.0)
}

/// Reads a quaternion and normalises it if its length is nearly 1. Any other length is left for [`Scene::validate`] to refuse.
pub(super) fn rotation<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 4], D::Error> {
    let read = <[f64; 4]>::deserialize(deserializer)?;
    let length = read.iter().map(|v| v * v).sum::<f64>().sqrt();
    let off = (length - 1.0).abs();
    if off > UNIT_LENGTH_EPSILON && off <= ROTATION_LENGTH_TOLERANCE {
        Ok(read.map(|v| v / length))
    } else {
        Ok(read)
    }
}

/// The error for a value of the wrong JSON type.
pub(super) fn wrong_type<E: Error>(value: &Value, accepted: &str) -> E {
    let detail = format!("{} is of the wrong type", json_type(value));
    E::custom(carry(&Issue::invalid("", detail, accepted)))
}

/// The type of a value and, if it is short, the value itself, for messages.
pub(super) fn json_type(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => format!("the boolean {value}"),
        Value::Number(number) => format!("the number {number}"),
        Value::String(text) => format!("the string \"{}\"", quoted(text)),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
    }
}
