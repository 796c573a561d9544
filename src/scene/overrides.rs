//! Replaces single fields of a scene from outside, as by command-line flags.
//!
//! The list of fields follows from the types, so a new field of `quality` or `output` gets its flag without a second edit.
//! `methods::fields` adds the dials of methods. Values are put into the JSON before it is read, so an error in them has the same
//! message as in a scene.

use serde_json::{Map, Number, Value, json};
use utoipa::openapi::{RefOr, Schema};
use utoipa::{PartialSchema, ToSchema};

use super::dials;
use super::quality::Quality;
use super::types::{IrradianceMapOutput, Output, ViewOutput};
use super::water_map::WaterMapOutput;

/// A field that may be replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name in the scene.
    pub name: String,
    /// Its flag without the leading dashes: `water-cells`. If `output` has a field of the same name, the section is prefixed:
    /// `quality-layers`.
    pub flag: String,
    /// JSON pointer to it.
    pub pointer: String,
    /// Its description, as in `openapi.yaml`.
    pub help: String,
    /// Accepted words; empty if it takes numbers.
    pub words: Vec<String>,
    /// Whether it takes several values, separated by commas.
    pub is_list: bool,
}

/// Every field of `quality` and of all kinds of `output`, sorted by name. A field that several kinds share is listed once.
pub fn fields() -> Vec<Field> {
    let mut fields = fields_of::<Quality>("/quality");
    fields.sort_by(|a, b| a.name.cmp(&b.name));
    let mut outputs = merged(&outputs());
    outputs.sort_by(|a, b| a.name.cmp(&b.name));
    for field in &mut fields {
        if outputs.iter().any(|output| output.name == field.name) {
            field.flag = format!("quality-{}", field.flag);
        }
    }
    fields.extend(outputs);
    fields
}

/// The name of each kind of output, and its fields.
fn outputs() -> [(&'static str, Vec<Field>); 3] {
    [
        ("View", fields_of::<ViewOutput>("/output")),
        (
            "Irradiance map",
            fields_of::<IrradianceMapOutput>("/output"),
        ),
        ("Water map", fields_of::<WaterMapOutput>("/output")),
    ]
}

/// The fields of several kinds of output, each with its name. Those of the same name become one; where their descriptions differ, it has
/// each of them after the names of its kinds.
fn merged(kinds: &[(&str, Vec<Field>)]) -> Vec<Field> {
    let mut all: Vec<Field> = Vec::new();
    for (_, fields) in kinds {
        for field in fields {
            match all.iter_mut().find(|known| known.name == field.name) {
                None => all.push(field.clone()),
                Some(known) => {
                    let more = field.words.iter();
                    let more = more.filter(|word| !known.words.contains(word)).cloned();
                    let more: Vec<String> = more.collect();
                    known.words.extend(more);
                }
            }
        }
    }
    for field in &mut all {
        let mut texts: Vec<(Vec<&str>, &str)> = Vec::new();
        for (kind, fields) in kinds {
            let Some(own) = fields.iter().find(|own| own.name == field.name) else {
                continue;
            };
            match texts.iter_mut().find(|(_, help)| *help == own.help) {
                Some((names, _)) => names.push(kind),
                None => texts.push((vec![kind], &own.help)),
            }
        }
        if texts.len() > 1 {
            let texts = texts.iter();
            let texts = texts.map(|(names, help)| format!("{}: {help}", names.join(", ")));
            field.help = texts.collect::<Vec<_>>().join(" ");
        }
    }
    all
}

/// Pointer to the kind of the output.
const KIND: &str = "/output/kind";

/// Pointer to the choice of the method.
pub const METHOD: &str = "/quality/method";

/// Replaces the values at the given pointers, in order; later ones win.
///
/// A missing `output` becomes a view. Another kind of output drops the fields that it does not have. Another method drops the dials of the previous one. Setting a dial turns a method given by
/// name into an object. A place that cannot be reached, because a value on the path is not an object, is left unchanged: reading
/// the scene will refuse it.
pub fn apply(value: &mut Value, overrides: &[(String, String)]) {
    let known = fields();
    // Kinds first: they decide which other fields are accepted, and a missing output needs one.
    let is_kind = |pointer: &str| pointer == KIND || pointer == METHOD;
    let (kinds, others): (Vec<_>, Vec<_>) =
        overrides.iter().partition(|(pointer, _)| is_kind(pointer));
    for (pointer, text) in kinds.into_iter().chain(others) {
        let is_list = known
            .iter()
            .any(|field| field.pointer == *pointer && field.is_list);
        let replacement = if is_list { list(text) } else { single(text) };
        match value.pointer_mut(METHOD) {
            Some(method) if pointer == METHOD && dials::is_of_kind(method, &replacement) => {
                continue;
            }
            Some(method) if is_dial(pointer) => dials::as_object(method),
            _ => {}
        }
        if pointer == KIND {
            leave_fields_of(value, &replacement);
        }
        replace(value, pointer, replacement);
    }
}

/// Drops the fields of `output` that another kind of output than its own does not have. An unknown kind leaves all.
fn leave_fields_of(value: &mut Value, kind: &Value) {
    let Some(Value::Object(output)) = value.get_mut("output") else {
        return;
    };
    if output.get("kind") == Some(kind) {
        return;
    }
    let is_of_kind = |(_, fields): &(&str, Vec<Field>)| {
        let mut words = fields.iter().filter(|field| field.name == "kind");
        words.any(|field| field.words.iter().any(|word| kind == word))
    };
    if let Some((_, fields)) = outputs().into_iter().find(is_of_kind) {
        output.retain(|name, _| fields.iter().any(|field| field.name == *name));
    }
}

/// Whether the pointer is that of a method's dial.
pub fn is_dial(pointer: &str) -> bool {
    pointer
        .strip_prefix(METHOD)
        .is_some_and(|rest| rest.starts_with('/'))
}

fn replace(value: &mut Value, pointer: &str, replacement: Value) {
    let Some((parent, name)) = pointer.rsplit_once('/') else {
        return;
    };
    let mut place = value;
    for key in parent.split('/').skip(1) {
        let Value::Object(members) = place else {
            return;
        };
        place = members
            .entry(key)
            .and_modify(|there| {
                if there.is_null() {
                    *there = fresh(key);
                }
            })
            .or_insert_with(|| fresh(key));
    }
    if let Value::Object(members) = place {
        members.insert(name.to_owned(), replacement);
    }
}

/// The initial value of a missing object.
fn fresh(key: &str) -> Value {
    let default_output = || serde_json::to_value(Output::default()).unwrap_or_default();
    match key {
        "output" => json!({ "kind": default_output()["kind"] }),
        _ => Value::Object(Map::new()),
    }
}

fn list(text: &str) -> Value {
    let items = text.split(',').map(str::trim);
    Value::Array(items.filter(|item| !item.is_empty()).map(single).collect())
}

/// A number, `true` or `false`; anything else is a word.
fn single(text: &str) -> Value {
    let text = text.trim();
    match serde_json::from_str(text) {
        Ok(value @ (Value::Number(_) | Value::Bool(_))) => value,
        // Rust also reads `.5` and `+1`, which are not JSON.
        _ => text
            .parse()
            .ok()
            .and_then(Number::from_f64)
            .map_or_else(|| Value::String(text.to_owned()), Value::Number),
    }
}

fn fields_of<T: PartialSchema + ToSchema>(section: &str) -> Vec<Field> {
    let mut components: Vec<(String, RefOr<Schema>)> = Vec::new();
    T::schemas(&mut components);
    let words_of = |reference: &str| {
        components
            .iter()
            .find(|(name, _)| reference.ends_with(&format!("/{name}")))
            .map(|(_, schema)| words(&as_json(schema)))
            .unwrap_or_default()
    };
    let schema = as_json(&T::schema());
    let Some(properties) = schema["properties"].as_object() else {
        return Vec::new();
    };
    properties
        .iter()
        .map(|(name, property)| Field {
            name: name.clone(),
            flag: name.replace('_', "-"),
            pointer: format!("{section}/{name}"),
            help: help(property),
            words: references(property)
                .iter()
                .flat_map(|reference| words_of(reference))
                .collect(),
            is_list: is_array(property),
        })
        .collect()
}

fn as_json(schema: &RefOr<Schema>) -> Value {
    serde_json::to_value(schema).unwrap_or_default()
}

/// The documentation of a property, as one line.
fn help(property: &Value) -> String {
    let text = property["description"].as_str().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Whether a property is an array, or an array or null.
fn is_array(property: &Value) -> bool {
    match &property["type"] {
        Value::String(name) => name == "array",
        Value::Array(names) => names.iter().any(|name| name == "array"),
        _ => false,
    }
}

/// The words of an enumeration: `enum`, or `const`s of a `oneOf`.
fn words(schema: &Value) -> Vec<String> {
    let named = schema["enum"].as_array().into_iter().flatten();
    let alternatives = schema["oneOf"].as_array().into_iter().flatten();
    named
        .cloned()
        .chain(alternatives.flat_map(|one| one["enum"].as_array().cloned().unwrap_or_default()))
        .filter_map(|word| word.as_str().map(str::to_owned))
        .collect()
}

/// All `$ref`s in a property.
fn references(property: &Value) -> Vec<String> {
    match property {
        Value::Object(members) => members
            .iter()
            .flat_map(|(key, value)| match (key.as_str(), value) {
                ("$ref", Value::String(target)) => vec![target.clone()],
                _ => references(value),
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(references).collect(),
        _ => Vec::new(),
    }
}
