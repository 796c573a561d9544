//! Accuracy over HTTP with the real renderer: studies, and targets for an error or a time.

use std::sync::Arc;
use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::scene_files;
use super::service::{Reply, Service, assert_refused, default_service};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The sine pool with few texels, with values replaced or added.
fn scene(changes: &[(&str, Value)]) -> Value {
    let text = std::fs::read_to_string(scene_files::folder().join("sine_pool.json")).unwrap();
    let scene = serde_json::from_str(&text).unwrap();
    let small = [("/output/width", json!(32)), ("/output/height", json!(32))];
    changed(changed(scene, &small), changes)
}

/// A study that takes moments, with values replaced or added.
fn study(changes: &[(&str, Value)]) -> Value {
    let request = json!({ "scene": scene(&[]), "dials": { "water_cells": [16, 32] }, "truth_error": 0.05, "runs": 1 });
    changed(request, changes)
}

fn changed(mut value: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, new) in changes {
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        value.pointer_mut(parent).unwrap()[key] = new.clone();
    }
    value
}

async fn ask(service: &Service, request: &Value, accept: &str) -> Reply {
    let body = request.to_string();
    service
        .post("/v1/accuracy", "application/json", accept, body)
        .await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_study_has_figures_plots_and_pictures() {
    let service = default_service().await;
    let reply = ask(&service, &study(&[]), "application/json").await;
    let answer = reply.json();
    assert_eq!(reply.status, 200, "{answer}");
    assert_eq!(reply.media_type, "application/json");
    let sweeps = answer["study"]["sweeps"].as_array().unwrap();
    assert_eq!(sweeps.len(), 1);
    assert_eq!(sweeps[0]["dial"], "water_cells");
    let points = sweeps[0]["points"].as_array().unwrap();
    let cells: Vec<&Value> = points.iter().map(|p| &p["dials"]["water_cells"]).collect();
    assert_eq!(cells, [16, 32]);
    let errors: Vec<f64> = points
        .iter()
        .map(|p| p["error"]["relative_l1"].as_f64().unwrap())
        .collect();
    println!("errors {errors:?}");
    assert!(0.0 < errors[1] && errors[1] < errors[0], "{errors:?}");
    let truth = &answer["study"]["truth"];
    assert!(truth["relative_error"].as_f64().unwrap() <= 0.05, "{truth}");
    assert_eq!(truth["from_disk"], false, "a service keeps none by itself");
    assert!(
        answer["error_against_time_svg"]
            .as_str()
            .unwrap()
            .starts_with("<svg")
    );
    for (list, starts_as) in [
        ("convergence_svg", b"<svg".as_slice()),
        ("error_images_base64", PNG),
    ] {
        let each = answer[list].as_array().unwrap();
        assert_eq!(each.len(), 1, "one for each sweep: {list}");
        let text = each[0].as_str().unwrap();
        let bytes = if list.ends_with("base64") {
            STANDARD.decode(text).unwrap()
        } else {
            text.as_bytes().to_vec()
        };
        assert!(bytes.starts_with(starts_as), "{list}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_dial_method_compares_methods() {
    let service = default_service().await;
    let methods = json!({ "method": ["level_map", "photon:photons=64,iterations=2"] });
    let compared = [("/dials", methods), ("/settings", json!(2))];
    let reply = ask(&service, &study(&compared), "application/json").await;
    let answer = reply.json();
    assert_eq!(reply.status, 200, "{answer}");
    let sweeps = answer["study"]["sweeps"].as_array().unwrap();
    let names: Vec<&Value> = sweeps.iter().map(|sweep| &sweep["dial"]).collect();
    assert_eq!(names, ["level_map", "photon, photons 64, iterations 2"]);
    for sweep in sweeps {
        assert_eq!(sweep["points"].as_array().unwrap().len(), 2, "{sweep}");
    }
    assert_eq!(sweeps[0]["series"]["method"], "level_map");
    let plot = answer["error_against_time_svg"].as_str().unwrap();
    assert!(plot.contains("photons 64"), "the plot names the series");
    assert_eq!(answer["convergence_svg"], json!([]));
    let sheets = answer["error_images_base64"].as_array().unwrap();
    assert_eq!(sheets.len(), 1, "one sheet of all");
    let sheet = STANDARD.decode(sheets[0].as_str().unwrap()).unwrap();
    assert!(sheet.starts_with(PNG));
    for (dials, settings, pointer) in [
        (
            json!({ "method": ["magic"] }),
            json!(2),
            "/scene/quality/method",
        ),
        (json!({ "method": ["level_map"] }), json!(7), "/settings"),
        (json!({ "water_cells": [16] }), json!(2), "/settings"),
    ] {
        let changes = [("/dials", dials), ("/settings", settings)];
        let reply = ask(&service, &study(&changes), "*/*").await;
        assert_refused(&reply, 422, "invalid-scene", pointer);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_accept_header_selects_the_format_of_a_study() {
    let service = default_service().await;
    for (media_type, starts_as) in [
        ("text/markdown", b"#".as_slice()),
        ("text/csv", b""),
        ("image/svg+xml", b"<svg"),
        ("image/png", PNG),
    ] {
        let reply = ask(&service, &study(&[]), media_type).await;
        assert_eq!(reply.status, 200, "{media_type}");
        assert_eq!(reply.media_type, media_type);
        assert!(reply.body.starts_with(starts_as), "{media_type}");
        if media_type == "text/csv" {
            let table = String::from_utf8(reply.body).unwrap();
            assert_eq!(table.lines().count(), 3, "a head and two settings: {table}");
        }
    }
    let reply = ask(&service, &study(&[]), "image/webp").await;
    assert_refused(&reply, 406, "not-acceptable", "");
}

#[tokio::test(flavor = "multi_thread")]
async fn invalid_requests_are_refused_with_their_place() {
    let service = default_service().await;
    let many: Vec<u32> = (16..49).collect();
    let grid = json!({ "water_cells": many[..9], "map_texels": many[..9] });
    let cases = [
        ("/dials", json!({ "water_cell": [16] }), "/dials/water_cell"),
        ("/dials", json!({ "water_cells": [] }), "/dials/water_cells"),
        (
            "/dials",
            json!({ "water_cells": many }),
            "/dials/water_cells",
        ),
        (
            "/dials",
            json!({ "water_cells": [16, 1] }),
            "/scene/quality/water_cells",
        ),
        (
            "/dials",
            json!({ "water_cells": ["many"] }),
            "/scene/quality/water_cells",
        ),
        ("/dials", json!({ "water_cells": 16 }), "/dials/water_cells"),
        (
            "/scene/quality/target_error",
            json!(0.1),
            "/scene/quality/target_error",
        ),
        (
            "/scene/quality/time_budget_ms",
            json!(100),
            "/scene/quality/time_budget_ms",
        ),
        ("/runs", json!(0), "/runs"),
        ("/runs", json!(101), "/runs"),
        ("/runs", json!("three"), "/runs"),
        ("/truth_error", json!(0), "/truth_error"),
        ("/truth_error", json!(0.2), "/truth_error"),
        ("/run", json!(3), "/run"),
        ("/scene/floor/dept_m", json!(1), "/scene/floor/dept_m"),
        ("/scene/floor/depth_m", json!(-1), "/scene/floor/depth_m"),
        ("/scene/floor/depth_m", json!("2"), "/scene/floor/depth_m"),
    ];
    for (place, value, pointer) in cases {
        let reply = ask(&service, &study(&[(place, value.clone())]), "*/*").await;
        println!("{place} {value}: {}", String::from_utf8_lossy(&reply.body));
        let problem = assert_refused(&reply, 422, "invalid-scene", pointer);
        for issue in problem["errors"].as_array().unwrap() {
            assert!(!issue["accepted"].as_str().unwrap().is_empty(), "{issue}");
        }
    }
    let too_many = study(&[("/dials", grid), ("/grid", json!(true))]);
    let reply = ask(&service, &too_many, "*/*").await;
    assert_refused(&reply, 422, "invalid-scene", "/dials");
    // All that is wrong is said at once.
    let reply = ask(
        &service,
        &study(&[
            ("/runs", json!(0)),
            ("/dials", json!({ "nothing": [1] })),
            ("/scene/floor/depth_m", json!(-1)),
        ]),
        "*/*",
    )
    .await;
    for pointer in ["/runs", "/dials/nothing", "/scene/floor/depth_m"] {
        assert_refused(&reply, 422, "invalid-scene", pointer);
    }
    let no_scene = json!({ "runs": 1 });
    assert_refused(
        &ask(&service, &no_scene, "*/*").await,
        422,
        "invalid-scene",
        "/scene",
    );
    let reply = service
        .post("/v1/accuracy", "text/plain", "*/*", study(&[]).to_string())
        .await;
    assert_refused(&reply, 415, "unsupported-media-type", "");
    let reply = service
        .post("/v1/accuracy", "application/json", "*/*", "{ \"scene\": ")
        .await;
    assert_refused(&reply, 400, "malformed-json", "");
}

/// Refused before the truth: one this exact would take hours.
#[tokio::test(flavor = "multi_thread")]
async fn bad_settings_are_refused_before_any_time_is_spent() {
    let service = default_service().await;
    let exact = ("/truth_error", json!(1e-6));
    let grid = json!({ "water_cells": (16..32).collect::<Vec<u32>>(), "map_texels": (16..32).collect::<Vec<u32>>() });
    for (changes, pointer) in [
        (
            vec![exact.clone(), ("/dials", json!({ "water_cells": [16, 1] }))],
            "/scene/quality/water_cells",
        ),
        (
            vec![exact, ("/dials", grid), ("/grid", json!(true))],
            "/dials",
        ),
    ] {
        let request = study(&changes);
        let asked = ask(&service, &request, "*/*");
        let reply = tokio::time::timeout(Duration::from_secs(10), asked)
            .await
            .expect("an answer without a truth");
        assert_refused(&reply, 422, "invalid-scene", pointer);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn darkness_has_no_truth_to_be_relative_to() {
    let service = default_service().await;
    let reply = ask(&service, &study(&[("/scene/lights", json!([]))]), "*/*").await;
    let problem = assert_refused(&reply, 422, "no-truth", "");
    assert!(
        problem["detail"].as_str().unwrap().contains("light"),
        "{problem}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn one_study_at_a_time() {
    let service = default_service().await;
    let place = Arc::clone(service.0.studies())
        .try_acquire_owned()
        .expect("nobody makes a study");
    let reply = ask(&service, &study(&[]), "*/*").await;
    let problem = assert_refused(&reply, 429, "queue-full", "");
    assert_eq!(problem["retryable"], true);
    // Other work goes on.
    assert_eq!(service.render(scene(&[])).await.status, 200);
    drop(place);
    assert_eq!(ask(&service, &study(&[]), "*/*").await.status, 200);
    assert_eq!(ask(&service, &study(&[]), "*/*").await.status, 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_leaves_makes_room_for_the_next() {
    let service = default_service().await;
    // Hours, if anybody waited for it.
    let endless = study(&[("/truth_error", json!(1e-6))]);
    let asking = ask(&service, &endless, "*/*");
    // The client has gone once this future is dropped.
    let gone = tokio::time::timeout(Duration::from_secs(1), asking).await;
    assert!(gone.is_err(), "{}", gone.unwrap().json());
    let room = Arc::clone(service.0.studies()).acquire_owned();
    let room = tokio::time::timeout(Duration::from_secs(30), room).await;
    drop(room.expect("the study ends soon after its client has left"));
    assert_eq!(ask(&service, &study(&[]), "*/*").await.status, 200);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_target_error_is_turned_into_dials_by_render_and_plan() {
    let service = default_service().await;
    let wanted = scene(&[("/quality", json!({ "target_error": 0.1 }))]);
    let (_, stats) = service.render_json(&wanted).await;
    let chosen = &stats["accuracy"]["chosen"];
    println!("{chosen}");
    assert_eq!(chosen["meets"], true, "{chosen}");
    assert!(chosen["predicted_error"].as_f64().unwrap() <= 0.1);
    assert!(chosen["water_cells"].as_u64().unwrap() >= 2);
    let reply = service
        .post("/v1/plan", "application/json", "*/*", wanted.to_string())
        .await;
    let plan = reply.json();
    assert_eq!(reply.status, 200, "{plan}");
    assert_eq!(
        plan["chosen"]["water_cells"], chosen["water_cells"],
        "plan and render choose alike"
    );
    let choice = &plan["method_choice"];
    let named = choice["others"].as_array().unwrap().len();
    assert_eq!(named + 1, caustica::methods::ALL.len(), "{choice}");
    assert!(
        choice["expected_error"].as_f64().unwrap() <= 0.1,
        "{choice}"
    );
    // Without a request for accuracy, nothing about it is reported.
    let plain = scene(&[]).to_string();
    let reply = service
        .post("/v1/plan", "application/json", "*/*", plain)
        .await;
    let plan = reply.json();
    assert!(plan["chosen"].is_null() && plan["method_choice"].is_null());
}

#[tokio::test(flavor = "multi_thread")]
async fn targets_without_sense_are_refused() {
    let service = default_service().await;
    for (quality, pointer) in [
        (
            json!({ "target_error": 0.1, "time_budget_ms": 100 }),
            "/quality/time_budget_ms",
        ),
        (json!({ "target_error": 0 }), "/quality/target_error"),
        (json!({ "target_error": 0.6 }), "/quality/target_error"),
        (json!({ "target_error": "low" }), "/quality/target_error"),
        (json!({ "time_budget_ms": 0 }), "/quality/time_budget_ms"),
        (json!({ "time_budget_ms": -1 }), "/quality/time_budget_ms"),
        (json!({ "estimate_error": 1 }), "/quality/estimate_error"),
    ] {
        let reply = service.render(scene(&[("/quality", quality)])).await;
        assert_refused(&reply, 422, "invalid-scene", pointer);
    }
}
