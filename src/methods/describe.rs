//! Descriptions of the methods for users: the schema of `quality.method`, and the fields that flags and sweeps set.

use serde_json::Value;
use utoipa::openapi::schema::AdditionalProperties;
use utoipa::openapi::{ObjectBuilder, OneOfBuilder, Schema, Type};

use super::{ALL, Method};
use crate::scene::Dial;
use crate::scene::dials::KIND;
use crate::scene::overrides::{self, Field, METHOD};

/// The schema of `quality.method`: a method's name, or an object per method.
pub fn schema() -> Schema {
    let names = ALL.map(|method| method.name);
    let word = ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some(names))
        .default(Some(Value::from(ALL[0].name)))
        .description(Some("A method with its dials at their defaults."));
    let each = ALL.into_iter().map(|method| {
        format!(
            "- `{}`{}: {}. Source: {}.",
            method.name,
            if is_default(method) { " (default)" } else { "" },
            method.summary,
            method.paper
        )
    });
    let each: Vec<String> = each.collect();
    let description = format!(
        "How light is carried to the receivers: the name of a method, or an object of its name and its own dials.\n\n{}",
        each.join("\n")
    );
    let mut choice = OneOfBuilder::new()
        .description(Some(description))
        .item(word);
    for method in ALL {
        choice = choice.item(object_schema(method));
    }
    Schema::OneOf(choice.build())
}

fn object_schema(method: &Method) -> ObjectBuilder {
    let kind = ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some([method.name]))
        .description(Some(format!("Always `{}`.", method.name)));
    let mut object = ObjectBuilder::new()
        .schema_type(Type::Object)
        .title(Some(method.name))
        .description(Some(format!(
            "{}. Source: {}. {}.",
            capitalised(method.summary),
            method.paper,
            match method.shared_dials {
                [] => "No other field of `quality` trades its accuracy for time".to_owned(),
                shared => format!(
                    "Of the other fields of `quality` these trade its accuracy for time: {}",
                    shared.join(", ")
                ),
            }
        )))
        .property(KIND, kind)
        .additional_properties(Some(AdditionalProperties::FreeForm(false)));
    if !is_default(method) {
        object = object.required(KIND);
    }
    for dial in method.dials {
        object = object.property(dial.name, dial.schema());
    }
    object
}

fn is_default(method: &Method) -> bool {
    method.name == ALL[0].name
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.chain(letters).collect()
}

/// Every field of a scene that flags and sweeps may set: [`overrides::fields`], and after those of `quality` the dials of all methods. A
/// dial that several methods have is listed once.
pub fn fields() -> Vec<Field> {
    let (mut fields, outputs): (Vec<Field>, Vec<Field>) = overrides::fields()
        .into_iter()
        .partition(|field| field.pointer.starts_with("/quality"));
    for field in &mut fields {
        if field.pointer == METHOD {
            field.words = ALL.map(|method| method.name.to_owned()).into();
            let each = ALL.map(|method| format!("{}: {}", method.name, method.summary));
            field.help = format!("{} {}.", field.help, each.join("; "));
        }
    }
    let taken = |flag: &str| {
        let mut known = fields.iter().chain(&outputs);
        known.any(|field| field.flag == flag)
    };
    let mut dials: Vec<Field> = Vec::new();
    for method in ALL {
        for dial in method.dials {
            if dials.iter().all(|known| known.name != dial.name) {
                let mut field = field_of(dial);
                if taken(&field.flag) {
                    field.flag = format!("method-{}", field.flag);
                }
                dials.push(field);
            }
        }
    }
    fields.extend(dials);
    fields.extend(outputs);
    fields
}

/// A dial with the methods that have it. Methods that document it differently are listed separately.
fn field_of(dial: &Dial) -> Field {
    let mut texts: Vec<(String, Vec<&str>)> = Vec::new();
    let mut words: Vec<String> = Vec::new();
    for method in ALL {
        let Some(own) = method.dial(dial.name) else {
            continue;
        };
        let text = own.documentation();
        match texts.iter_mut().find(|(known, _)| *known == text) {
            Some((_, methods)) => methods.push(method.name),
            None => texts.push((text, vec![method.name])),
        }
        for word in own.words() {
            if words.iter().all(|known| known != word) {
                words.push(word.to_owned());
            }
        }
    }
    let texts: Vec<String> = texts
        .into_iter()
        .map(|(text, methods)| match methods.as_slice() {
            [one] => format!("Method {one}: {text}"),
            several => format!("Methods {}: {text}", several.join(", ")),
        })
        .collect();
    Field {
        name: dial.name.to_owned(),
        flag: dial.name.replace('_', "-"),
        pointer: format!("{METHOD}/{}", dial.name),
        help: texts.join(" "),
        words,
        is_list: false,
    }
}
