//! JSON in, `Scene` out.
use serde::{Deserialize, Deserializer, de::DeserializeOwned};
use serde_json::Value;

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the scene is not valid")]
pub struct SceneError {
    /// Every finding.
    pub issues: Vec<Issue>,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, utoipa::ToSchema)]
pub struct Issue {
    /// JSON pointer (RFC 6901) to the offending value.
    pub pointer: String,
    /// What is wrong with it.
    pub detail: String,
    /// What would be accepted.
    pub accepted: String,
}

/// Reads an object by its `kind`.
pub(super) fn tagged<'de, D: Deserializer<'de>, T>(
    deserializer: D,
    default_kind: Option<&str>,
    kinds: &[&str],
    read: impl FnOnce(&str, Value) -> Result<T, String>,
) -> Result<T, D::Error> {
    let value = Value::deserialize(deserializer)?;
    let kind = value
        .get("kind")
        .and_then(Value::as_str)
        .or(default_kind)
        .unwrap_or_default()
        .to_owned();
    if !kinds.contains(&kind.as_str()) {
        return Err(serde::de::Error::custom(format!("kind {kind}")));
    }
    read(&kind, value).map_err(serde::de::Error::custom)
}

/// Reads the rest.
pub(super) fn inner<T: DeserializeOwned>(value: Value) -> Result<T, String> {
    serde_json::from_value(value).map_err(|e| e.to_string())
}

/// u32, also written 960.0.
pub(super) fn integral_u32<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    Ok(f64::deserialize(deserializer)? as u32)
}

/// The same, optional.
pub(super) fn optional_integral_u32<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<u32>, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.map(|v| v as u32))
}
