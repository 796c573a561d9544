//! Uploads that request level maps: what is built, what is refused, and that the mesh is kept if the warm-up fails.

use std::collections::BTreeSet;
use std::time::Duration;

use axum::http::Method;
use caustica::cache::{WarmSun, WarmUp};
use caustica::config::Limits;
use caustica::gpu::GpuError;
use caustica::gpu_queue::{GpuState, QueueSettings};
use caustica::http::routes::meshes::Uploaded;
use caustica::http::{Problem, ProblemKind, openapi};
use caustica::mesh::MeshInfo;
use caustica::render::RenderError;
use serde_json::{Value, json};

use super::support::scenes::OBJ;
use super::support::service::settings;
use super::support::{Behaviour, Control, Reply, Service, scenes};

/// Uploads the usual mesh with a query.
async fn upload(service: &Service, query: &str) -> Reply {
    let address = format!("/v1/meshes{query}");
    service.post(&address, "model/obj", OBJ).await
}

/// What the answer to an upload whose warm-up has failed says of it; the mesh is stored.
async fn failed(service: &Service, reply: &Reply, kind: ProblemKind) -> Problem {
    assert_eq!(reply.status, 201, "{}", reply.text());
    assert_eq!(reply.header("content-type"), "application/json");
    let uploaded: Uploaded = reply.json();
    assert_eq!(uploaded.warmed, Some(Vec::new()));
    let problem = uploaded.warm_problem.expect("it says why");
    assert_eq!(problem.kind, kind.urn(), "{}", problem.detail);
    assert_eq!(problem.status, kind.status().as_u16());
    let stored = service
        .get(&format!("/v1/meshes/{}", uploaded.mesh.id))
        .await;
    assert_eq!(stored.json::<MeshInfo>(), uploaded.mesh);
    problem
}

#[tokio::test]
async fn an_upload_without_warm_gets_the_mesh_only() {
    let service = Service::start().await;
    let reply = upload(&service, "").await;
    assert_eq!(reply.status, 201);
    let fields =
        |value: &Value| -> Vec<String> { value.as_object().unwrap().keys().cloned().collect() };
    let info = serde_json::to_value(reply.json::<MeshInfo>()).unwrap();
    assert_eq!(fields(&reply.json()), fields(&info));
    assert_eq!(service.control.count("warm"), 0);
}

#[tokio::test]
async fn one_sun_is_warmed_with_the_defaults_of_a_scene() {
    let service = Service::start().await;
    let reply = upload(&service, "?warm=60,30").await;
    assert_eq!(reply.status, 201, "{}", reply.text());
    let uploaded: Uploaded = reply.json();
    let id = uploaded.mesh.id;
    assert_eq!(reply.header("location"), format!("/v1/meshes/{id}"));
    assert_eq!(
        reply.json::<Value>()["warmed"],
        json!([{
            "elevation_deg": 60.0, "azimuth_deg": 30.0, "texels": 256, "layers": 1, "bytes": 4096, "cached": false
        }])
    );
    assert_eq!(reply.json::<Value>().get("warm_problem"), None);
    let wanted = WarmUp {
        suns: vec![WarmSun {
            elevation_deg: 60.0,
            azimuth_deg: 30.0,
        }],
        texels: 256,
        layers: 1,
        ior: 1.333,
    };
    assert_eq!(service.control.warmed(), [(id.clone(), wanted.clone())]);
    // Stored already, but warmed again: the maps may have been evicted meanwhile.
    let again = upload(&service, "?warm=60,30").await;
    assert_eq!(again.status, 200);
    assert_eq!(again.json::<Uploaded>().warmed.unwrap().len(), 1);
    assert_eq!(service.control.warmed()[1], (id, wanted));
}

#[tokio::test]
async fn several_suns_and_all_parameters() {
    let service = Service::start().await;
    let query =
        "?warm=90%2C0&warm_texels=64&warm=12.5,-170&warm_ior=1.5&warm_layers=3&warm=1e-9,1e6";
    let reply = upload(&service, query).await;
    assert_eq!(reply.status, 201, "{}", reply.text());
    let warmed = reply.json::<Uploaded>().warmed.unwrap();
    let suns: Vec<(f64, f64)> = warmed
        .iter()
        .map(|map| (map.elevation_deg, map.azimuth_deg))
        .collect();
    assert_eq!(suns, [(90.0, 0.0), (12.5, -170.0), (1e-9, 1e6)]);
    let (_, wanted) = &service.control.warmed()[0];
    assert_eq!((wanted.texels, wanted.layers, wanted.ior), (64, 3, 1.5));
}

#[tokio::test]
async fn bad_parameters_are_refused_before_anything_is_stored() {
    let service = Service::start().await;
    // Query, the reported name, and a word of what is accepted.
    let cases = [
        ("?warm=0,30", "warm", "above 0"),
        ("?warm=-5,30", "warm", "above 0"),
        ("?warm=90.001,30", "warm", "90"),
        ("?warm=60", "warm", "ELEVATION,AZIMUTH"),
        ("?warm=", "warm", "ELEVATION,AZIMUTH"),
        ("?warm", "warm", "ELEVATION,AZIMUTH"),
        ("?warm=60,30,1", "warm", "ELEVATION,AZIMUTH"),
        ("?warm=high,30", "warm", "ELEVATION,AZIMUTH"),
        ("?warm=NaN,30", "warm", "ELEVATION,AZIMUTH"),
        ("?warm=60,inf", "warm", "1e6"),
        ("?warm=60,1e400", "warm", "1e6"),
        ("?warm=60,30&warm=-1,0", "warm", "above 0"),
        ("?warm=60,30&warm_texels=100", "warm_texels", "power of two"),
        ("?warm=60,30&warm_texels=4096", "warm_texels", "2048"),
        (
            "?warm=60,30&warm_texels=64.0",
            "warm_texels",
            "power of two",
        ),
        ("?warm=60,30&warm_layers=0", "warm_layers", "1 … 4"),
        ("?warm=60,30&warm_layers=5", "warm_layers", "1 … 4"),
        ("?warm=60,30&warm_ior=0.9", "warm_ior", "1 … 4"),
        ("?warm=60,30&warm_ior=water", "warm_ior", "1 … 4"),
        ("?warm=60,30&warm_ior=1.3&warm_ior=1.4", "warm_ior", "once"),
        ("?warm_texels=64", "warm", "warm_texels"),
        ("?worm=60,30", "worm", "warm_texels"),
    ];
    for (query, name, accepted) in cases {
        let problem = upload(&service, query)
            .await
            .problem(ProblemKind::InvalidQuery);
        let named = format!("parameter `{name}`");
        let found = problem
            .errors
            .iter()
            .any(|issue| issue.detail.contains(&named) && issue.accepted.contains(accepted));
        assert!(found, "{query}: {problem:?}");
        assert!(problem.detail.contains('`'), "{query}: {}", problem.detail);
    }
    let list: Value = service.get("/v1/meshes").await.json();
    assert_eq!(list, json!({ "meshes": [] }));
    assert_eq!(service.control.count("warm"), 0);
    service.assert_whole().await;
}

#[tokio::test]
async fn every_bad_parameter_is_reported() {
    let service = Service::start().await;
    let query = "?warm=-1,0&warm_texels=3&warm_ior=9&sun=1";
    let problem = upload(&service, query)
        .await
        .problem(ProblemKind::InvalidQuery);
    for name in ["warm", "warm_texels", "warm_ior", "sun"] {
        let named = format!("parameter `{name}`");
        assert!(
            problem.errors.iter().any(|e| e.detail.contains(&named)),
            "{name}: {problem:?}"
        );
    }
    // A long value is not repeated in full.
    let query = format!("?warm={}", "9".repeat(5000));
    let reply = upload(&service, &query).await;
    reply.problem(ProblemKind::InvalidQuery);
    assert!(reply.body.len() < 2000, "{}", reply.text());
}

#[tokio::test]
async fn more_suns_than_lights_in_a_scene() {
    let limits = Limits {
        max_lights: 2,
        ..Limits::default()
    };
    let service = Service::start_limited(limits).await;
    let reply = upload(&service, "?warm=60,0&warm=61,0").await;
    assert_eq!(reply.status, 201);
    let reply = upload(&service, "?warm=60,0&warm=61,0&warm=62,0").await;
    let problem = reply.problem(ProblemKind::InvalidQuery);
    assert_eq!(problem.errors[0].accepted, "at most 2");
}

#[tokio::test]
async fn a_bad_mesh_is_refused_as_ever() {
    let service = Service::start().await;
    let reply = service
        .post("/v1/meshes?warm=60,30", "model/obj", "no mesh")
        .await;
    reply.problem(ProblemKind::InvalidMesh);
    assert_eq!(service.control.count("warm"), 0);
}

#[tokio::test]
async fn the_contract_has_the_parameters_that_are_read() {
    let contract = serde_json::to_value(openapi()).unwrap();
    let parameters = contract["paths"]["/v1/meshes"]["post"]["parameters"]
        .as_array()
        .unwrap();
    let documented: BTreeSet<&str> = parameters
        .iter()
        .map(|parameter| {
            assert_eq!(parameter["in"], "query");
            assert_eq!(parameter["required"], json!(false), "{parameter}");
            parameter["name"].as_str().unwrap()
        })
        .collect();
    let service = Service::start().await;
    let problem = upload(&service, "?other=1")
        .await
        .problem(ProblemKind::InvalidQuery);
    let read: BTreeSet<&str> = problem.errors[0].accepted.split(", ").collect();
    assert_eq!(documented, read);
}

#[tokio::test]
async fn answers_fit_the_schema() {
    let contract = serde_json::to_value(openapi()).unwrap();
    let document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$ref": "#/components/schemas/Uploaded",
        "components": contract["components"],
    });
    let validator = jsonschema::validator_for(&document).unwrap();
    let service = Service::start().await;
    for query in ["", "?warm=60,30"] {
        let answer: Value = upload(&service, query).await.json();
        assert!(validator.is_valid(&answer), "{answer}");
    }
    service.control.script([Behaviour::Panic]);
    let answer: Value = upload(&service, "?warm=60,30").await.json();
    assert!(answer["warm_problem"].is_object() && validator.is_valid(&answer));
    assert!(!validator.is_valid(&json!({ "id": "blake3:00" })));
}

#[tokio::test]
async fn a_full_queue_costs_the_warm_up_and_not_the_mesh() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let occupy = |service: &Service| {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
    };
    let running = occupy(&service);
    service.control.wait_for("render", 1).await;
    let waiting = occupy(&service);
    service.until_depth(2).await;

    let reply = upload(&service, "?warm=60,30").await;
    let problem = failed(&service, &reply, ProblemKind::QueueFull).await;
    assert!(problem.retryable);
    service.control.open_gate();
    assert_eq!(running.await.unwrap().status, 200);
    assert_eq!(waiting.await.unwrap().status, 200);
    // The same upload again tries once more.
    service.until_depth(0).await;
    let again = upload(&service, "?warm=60,30").await;
    assert_eq!(again.status, 200);
    assert_eq!(again.json::<Uploaded>().warmed.unwrap().len(), 1);
    // It was counted as what it was.
    let metrics = service.get("/metrics").await.text();
    assert!(
        metrics.contains(r#"caustica_http_problems_total{type="urn:caustica:problem:queue-full"}"#),
        "{metrics}"
    );
}

#[tokio::test]
async fn a_warm_up_that_is_late_costs_no_mesh() {
    let service = Service::start_queued(QueueSettings {
        waiting: 4,
        deadline: Duration::from_millis(500),
    })
    .await;
    // In the queue, behind a render that does not end …
    service.control.script([Behaviour::BlockDeaf]);
    let running = {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scenes::small()).await })
    };
    service.control.wait_for("render", 1).await;
    let reply = upload(&service, "?warm=60,30").await;
    failed(&service, &reply, ProblemKind::DeadlinePassed).await;
    running.await.unwrap().problem(ProblemKind::DeadlinePassed);
    service.control.open_gate();
    service.until_depth(0).await;
    assert_eq!(service.control.count("warm"), 0);
}

#[tokio::test]
async fn a_warm_up_that_takes_too_long_is_cancelled() {
    let service = Service::start_queued(QueueSettings {
        waiting: 4,
        deadline: Duration::from_millis(500),
    })
    .await;
    service.control.script([Behaviour::Block]);
    let reply = upload(&service, "?warm=60,30").await;
    failed(&service, &reply, ProblemKind::DeadlinePassed).await;
    service.control.wait_for("warm cancelled", 1).await;
    service.until_depth(0).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn a_client_that_leaves_cancels_its_warm_up() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let client = {
        let service = service.clone();
        tokio::spawn(async move { upload(&service, "?warm=60,30").await })
    };
    service.control.wait_for("warm", 1).await;
    client.abort();
    service.control.wait_for("warm cancelled", 1).await;
    service.until_depth(0).await;
    let list: Value = service.get("/v1/meshes").await.json();
    assert_eq!(list["meshes"].as_array().unwrap().len(), 1);
    service.assert_whole().await;
}

#[tokio::test]
async fn maps_that_do_not_fit_are_reported_with_figures() {
    let service = Service::start().await;
    service
        .control
        .script([Behaviour::Fail(RenderError::OverBudget {
            what: "holding the maps (CAUSTICA_LEVEL_MAP_BUDGET_MIB)".to_owned(),
            needed_bytes: 4_000_000,
            budget_bytes: 1_000_000,
        })]);
    let reply = upload(&service, "?warm=60,30").await;
    let problem = failed(&service, &reply, ProblemKind::OverBudget).await;
    assert_eq!(problem.needed_bytes, Some(4_000_000));
    assert_eq!(problem.budget_bytes, Some(1_000_000));
    assert!(problem.detail.contains("CAUSTICA_LEVEL_MAP_BUDGET_MIB"));
    assert!(!problem.retryable);
}

#[tokio::test]
async fn after_a_loss_the_warm_up_runs_again() {
    let lost = || {
        Behaviour::Fail(RenderError::Gpu(GpuError::DeviceLost(
            "unplugged".to_owned(),
        )))
    };
    let service = Service::start().await;
    service.control.script([lost()]);
    let reply = upload(&service, "?warm=60,30").await;
    assert_eq!(reply.status, 201);
    assert_eq!(reply.json::<Uploaded>().warmed.unwrap().len(), 1);
    assert_eq!(service.control.count("warm"), 2);

    let service = Service::start().await;
    service.control.script([lost(), lost()]);
    let reply = upload(&service, "?warm=60,30").await;
    failed(&service, &reply, ProblemKind::DeviceLost).await;
    service.until(|state| *state == GpuState::Ready).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn a_device_that_is_not_trusted_warms_nothing() {
    let control = Control::default();
    control.fail_self_check("fresnel at 80 degrees");
    let service = Service::with(control, settings(), Limits::default());
    service.until(|state| *state == GpuState::Ready).await;
    let reply = upload(&service, "?warm=60,30").await;
    failed(&service, &reply, ProblemKind::NotReady).await;
    assert_eq!(service.control.count("warm"), 0);
}

#[tokio::test]
async fn a_mesh_that_is_deleted_meanwhile_leaves_nothing_behind() {
    let service = Service::start().await;
    service.control.script([Behaviour::Block]);
    let client = {
        let service = service.clone();
        tokio::spawn(async move { upload(&service, "?warm=60,30").await })
    };
    service.control.wait_for("warm", 1).await;
    let list: Value = service.get("/v1/meshes").await.json();
    let id = list["meshes"][0]["id"].as_str().unwrap().to_owned();
    let deleted = service
        .bare(Method::DELETE, &format!("/v1/meshes/{id}"))
        .await;
    assert_eq!(deleted.status, 204);
    service.control.open_gate();
    assert_eq!(client.await.unwrap().status, 201);
    service.control.wait_for(&format!("forget {id}"), 1).await;
    let diary = service.control.diary();
    let place = |event: &str| diary.iter().rposition(|entry| entry == event).unwrap();
    assert!(place(&format!("forget {id}")) > place("warm"), "{diary:?}");
}
