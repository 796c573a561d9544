//! `openapi.yaml`, routes, schemas and examples agree.

use std::collections::BTreeSet;
use std::path::Path;

use axum::http::Method;
use caustica::http::{ProblemKind, openapi};
use serde_json::{Value, json};

use super::support::{Service, scenes};

const METHODS: [Method; 5] = [
    Method::GET,
    Method::POST,
    Method::PUT,
    Method::PATCH,
    Method::DELETE,
];

fn contract() -> Value {
    serde_json::to_value(openapi()).unwrap()
}

fn committed() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("openapi.yaml")
}

#[test]
fn the_committed_file_is_the_generated_one() {
    let generated = openapi().to_yaml().unwrap();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(committed(), &generated).unwrap();
    }
    let file = std::fs::read_to_string(committed()).expect("openapi.yaml exists");
    assert!(
        file == generated,
        "openapi.yaml is not what the code says; BLESS=1 rewrites it"
    );
    assert!(file.starts_with("openapi: 3.1.0"));
}

#[tokio::test]
async fn every_documented_operation_exists_and_no_other() {
    let service = Service::start().await;
    let contract = contract();
    let mut operations = 0;
    for (path, item) in contract["paths"].as_object().unwrap() {
        let documented: BTreeSet<String> = item
            .as_object()
            .unwrap()
            .keys()
            .map(|method| method.to_ascii_uppercase())
            .collect();
        let address = path.replace("{id}", "blake3:00");
        for method in METHODS {
            let reply = service.bare(method.clone(), &address).await;
            if documented.contains(method.as_str()) {
                operations += 1;
                assert_ne!(reply.status, 405, "{method} {path}");
                assert!(
                    !reply.text().contains(ProblemKind::NotFound.urn()),
                    "{path}"
                );
            } else {
                reply.problem(ProblemKind::MethodNotAllowed);
                let mut allowed: BTreeSet<String> = reply
                    .header("allow")
                    .split(',')
                    .map(str::to_owned)
                    .collect();
                allowed.remove("HEAD");
                assert_eq!(allowed, documented, "{path}");
            }
        }
    }
    assert_eq!(operations, 17);
}

#[test]
fn the_router_has_only_documented_routes() {
    // `routes!` documents what it routes; only the reader of the contract comes in by another door.
    let source = include_str!("../../src/http/router.rs");
    assert!(source.contains("routes!("));
    assert_eq!(source.matches(".merge(").count(), 1);
    for undocumented in [".route(", ".nest(", "route_service", "nest_service"] {
        assert!(!source.contains(undocumented), "{undocumented}");
    }
}

#[test]
fn every_problem_is_documented() {
    let text = contract().to_string();
    for kind in ProblemKind::ALL {
        let everywhere = [ProblemKind::NotFound, ProblemKind::MethodNotAllowed];
        assert!(
            everywhere.contains(kind) || text.contains(&format!("`{}`", kind.urn())),
            "{kind:?}"
        );
    }
    let urns: BTreeSet<_> = ProblemKind::ALL.iter().map(|kind| kind.urn()).collect();
    assert_eq!(urns.len(), ProblemKind::ALL.len());
}

#[test]
fn every_operation_and_schema_says_what_it_is() {
    let contract = contract();
    for (path, item) in contract["paths"].as_object().unwrap() {
        for (method, operation) in item.as_object().unwrap() {
            let name = format!("{method} {path}");
            assert!(operation["summary"].is_string(), "{name}");
            assert!(operation["responses"]["500"].is_object(), "{name}");
            let Some(body) = operation.get("requestBody") else {
                continue;
            };
            assert!(body["description"].is_string(), "{name}");
            for (media_type, content) in body["content"].as_object().unwrap() {
                assert!(content["example"] != Value::Null, "{name} {media_type}");
            }
        }
    }
    for (name, schema) in contract["components"]["schemas"].as_object().unwrap() {
        // The one word of a `kind` explains itself.
        let is_word = schema["enum"]
            .as_array()
            .is_some_and(|words| words.len() == 1);
        assert!(
            is_word || schema["description"].is_string(),
            "schema {name}"
        );
        for (field, property) in schema["properties"].as_object().into_iter().flatten() {
            // A reference without words of its own has those of its schema; an optional one has them one level down.
            let text = property.to_string();
            assert!(
                text.contains("\"$ref\"") || text.contains("\"description\""),
                "{name}.{field} has no description"
            );
        }
    }
}

#[test]
fn clients_are_told_of_ids_not_of_files() {
    let contract = contract();
    let mesh = &contract["components"]["schemas"]["Object"]["properties"]["mesh"];
    let text = mesh["description"].as_str().unwrap();
    assert!(text.contains("POST /v1/meshes"), "{text}");
    assert!(!text.contains("file"), "{text}");
    for (words, why) in [
        ("Content-Encoding", "encodings"),
        ("CORS", "pages of other origins"),
        ("slash at the end", "paths"),
    ] {
        let text = contract["info"]["description"].as_str().unwrap();
        assert!(text.contains(words), "{why}");
    }
}

/// Schemas that a scene can reach.
fn scene_schemas(contract: &Value) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut open = vec!["Scene".to_owned()];
    while let Some(name) = open.pop() {
        if !reached.insert(name.clone()) {
            continue;
        }
        let text = contract["components"]["schemas"][&name].to_string();
        let references = text.split("#/components/schemas/").skip(1);
        open.extend(references.map(|rest| rest.split('"').next().unwrap().to_owned()));
    }
    reached
}

#[test]
fn unknown_fields_are_excluded_by_every_object_of_a_scene() {
    let contract = contract();
    let reached = scene_schemas(&contract);
    for name in ["Object", "Sun", "PerspectiveCamera", "IrradianceMapOutput"] {
        assert!(reached.contains(name), "{name} is not in {reached:?}");
    }
    for name in reached {
        let schema = &contract["components"]["schemas"][&name];
        assert!(schema.is_object(), "{name} is referred to and missing");
        assert_closed(&name, schema);
    }
}

/// No object inside, however deep, takes unknown fields.
fn assert_closed(name: &str, schema: &Value) {
    if schema["type"] == "object" {
        assert_eq!(schema["additionalProperties"], json!(false), "{name}");
    }
    let inside: Vec<&Value> = match schema {
        Value::Object(fields) => fields.values().collect(),
        Value::Array(items) => items.iter().collect(),
        _ => Vec::new(),
    };
    for value in inside {
        assert_closed(name, value);
    }
}

fn validator() -> jsonschema::Validator {
    let contract = contract();
    let document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$ref": "#/components/schemas/Scene",
        "components": contract["components"],
    });
    jsonschema::validator_for(&document).unwrap()
}

#[test]
fn good_scenes_fit_the_schema() {
    let validator = validator();
    let contract = contract();
    let mut good = vec![
        ("small".to_owned(), scenes::small()),
        ("empty".to_owned(), json!({})),
        (
            "integral float".to_owned(),
            scenes::small_with("/output/width", json!(960.0)),
        ),
        ("with mesh".to_owned(), scenes::small_with_mesh("blake3:00")),
    ];
    for route in ["/v1/render", "/v1/plan"] {
        let content = &contract["paths"][route]["post"]["requestBody"]["content"];
        good.push((
            route.to_owned(),
            content["application/json"]["example"].clone(),
        ));
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path
            .extension()
            .is_some_and(|extension| extension == "json")
        {
            let scene = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
            good.push((path.display().to_string(), scene));
        }
    }
    for (name, scene) in good {
        let errors: Vec<String> = validator
            .iter_errors(&scene)
            .map(|error| format!("{}: {error}", error.instance_path()))
            .collect();
        assert!(errors.is_empty(), "{name}: {errors:#?}");
    }
}

#[test]
fn bad_scenes_do_not_fit_the_schema() {
    let validator = validator();
    let mut unknown = scenes::small();
    unknown["flor"] = json!({});
    let mut unknown_in_object = scenes::small_with_mesh("blake3:00");
    unknown_in_object["objects"][0]["translation"] = json!([0, 0, 0]);
    let mut unknown_inside = scenes::small();
    unknown_inside["lights"][0]["elevation"] = json!(3);
    let bad = [
        ("unknown field", unknown),
        (
            "two channels",
            scenes::small_with("/lights/0/irradiance_w_m2", json!([1, 2])),
        ),
        ("unknown field of a light", unknown_inside),
        ("unknown field of an object", unknown_in_object),
        (
            "text for a number",
            scenes::small_with("/floor/depth_m", json!("NaN")),
        ),
        ("zero width", scenes::small_with("/output/width", json!(0))),
        (
            "fractional width",
            scenes::small_with("/output/width", json!(8.5)),
        ),
        (
            "unknown light",
            scenes::small_with("/lights/0/kind", json!("moon")),
        ),
    ];
    for (name, scene) in bad {
        assert!(!validator.is_valid(&scene), "{name}");
    }
}

#[tokio::test]
async fn the_served_contract_is_the_committed_one() {
    let service = Service::start().await;
    let reply = service.get("/openapi.yaml").await;
    assert_eq!(reply.status, 200);
    assert_eq!(reply.header("content-type"), "application/yaml");
    assert_eq!(reply.text(), std::fs::read_to_string(committed()).unwrap());
}

#[tokio::test]
async fn the_examples_of_the_contract_are_accepted() {
    let service = Service::start().await;
    let contract = contract();
    for route in ["/v1/render", "/v1/plan"] {
        let content = &contract["paths"][route]["post"]["requestBody"]["content"];
        let reply = service
            .post_json(route, &content["application/json"]["example"])
            .await;
        assert_eq!(reply.status, 200, "{}", reply.text());
    }
    let content = &contract["paths"]["/v1/meshes"]["post"]["requestBody"]["content"];
    let obj = content["model/obj"]["example"].as_str().unwrap().to_owned();
    assert_eq!(
        service.post("/v1/meshes", "model/obj", obj).await.status,
        201
    );
}
