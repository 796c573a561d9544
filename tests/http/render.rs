//! Images, JSON, entity tags, timings.

use axum::http::Request;
use base64::Engine as _;
use caustica::gpu::GpuError;
use caustica::http::ProblemKind;
use caustica::http::routes::render::RenderAnswer;
use caustica::image::{decode_exr, decode_png};
use caustica::render::RenderError;
use serde_json::{Value, json};

use super::support::service::post;
use super::support::{Behaviour, Reply, Service, scenes};

async fn render_with(service: &Service, header: (&'static str, &str), scene: &Value) -> Reply {
    let mut request: Request<_> = post("/v1/render", "application/json", scene.to_string());
    request
        .headers_mut()
        .insert(header.0, header.1.parse().unwrap());
    service.send(request).await
}

#[tokio::test]
async fn a_scene_becomes_a_png() {
    let service = Service::start().await;
    let reply = service.post_json("/v1/render", scenes::small()).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    assert_eq!(reply.header("content-type"), "image/png");
    assert_eq!(reply.header("vary"), "accept");
    assert!(reply.header("x-caustica-scene-hash").starts_with("blake3:"));
    let picture = decode_png(&reply.body).unwrap();
    assert_eq!((picture.width, picture.height), (8, 6));
}

#[tokio::test]
async fn a_map_becomes_an_exr() {
    let service = Service::start().await;
    let mut scene = scenes::small();
    scene["output"] =
        json!({ "kind": "irradiance_map", "receiver": "floor", "width": 16, "height": 4 });
    let reply = service.post_json("/v1/render", scene).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    assert_eq!(reply.header("content-type"), "image/x-exr");
    let map = decode_exr(&reply.body).unwrap();
    assert_eq!((map.width, map.height), (16, 4));
}

#[tokio::test]
async fn a_map_of_the_water_becomes_an_exr_or_a_normal_map() {
    let service = Service::start().await;
    let mut scene = json!({
        "output": { "kind": "water_map", "min_m": [-1, 2], "max_m": [1, 3], "width": 16, "height": 4 }
    });
    let reply = service.post_json("/v1/render", &scene).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    assert_eq!(reply.header("content-type"), "image/x-exr");
    let map = decode_exr(&reply.body).unwrap();
    assert_eq!((map.width, map.height), (16, 4));
    assert!(map.channels.contains_key("slope.x"));
    scene["output"]["format"] = json!("png");
    let reply = service.post_json("/v1/render", &scene).await;
    assert_eq!(reply.header("content-type"), "image/png");
    assert_eq!(decode_png(&reply.body).unwrap().bits, 16);
    // Without light there is nothing that a study could compare.
    let reply = service
        .post_json("/v1/accuracy", json!({ "scene": scene }))
        .await;
    let problem = reply.problem(ProblemKind::InvalidScene);
    assert_eq!(problem.errors[0].pointer, "/scene/output/kind");
    assert_eq!(problem.errors[0].accepted, "`view` or `irradiance_map`");
}

#[tokio::test]
async fn json_holds_the_same_file_and_the_stats() {
    let service = Service::start().await;
    let image = service.post_json("/v1/render", scenes::small()).await;
    let reply = render_with(&service, ("accept", "application/json"), &scenes::small()).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    assert_eq!(reply.header("content-type"), "application/json");
    let answer: RenderAnswer = reply.json();
    assert_eq!(answer.image.media_type, "image/png");
    let bytes = base64::engine::general_purpose::STANDARD
        .decode(&answer.image.base64)
        .unwrap();
    assert_eq!(bytes, image.body);
    let stats = answer.stats;
    assert_eq!(stats.version, env!("CARGO_PKG_VERSION"));
    assert_eq!(stats.scene_hash, image.header("x-caustica-scene-hash"));
    assert_eq!(stats.adapter.name, "Puppet 3000");
    assert_eq!(stats.passes[0].name, "surface");
    assert!(stats.time_ms.total >= stats.time_ms.encode && stats.time_ms.encode > 0.0);
    // Times differ from run to run: there is nothing to compare the JSON by.
    assert!(!reply.headers.contains_key("etag"));
}

#[tokio::test]
async fn the_accept_header_decides() {
    let service = Service::start().await;
    for (accept, media_type) in [
        ("*/*", "image/png"),
        ("image/*", "image/png"),
        ("image/png, application/json", "image/png"),
        ("application/json, image/png;q=0.5", "application/json"),
        ("image/png;q=0.5, */*;q=0.8", "application/json"),
        ("image/x-exr, */*;q=0.1", "image/png"),
        ("application/*", "application/json"),
        ("image/png;q=0, */*", "application/json"),
        ("APPLICATION/JSON", "application/json"),
    ] {
        let reply = render_with(&service, ("accept", accept), &scenes::small()).await;
        assert_eq!(reply.status, 200, "{accept}");
        assert_eq!(reply.header("content-type"), media_type, "{accept}");
    }
    for accept in [
        "text/html",
        "image/x-exr",
        "application/json;q=0",
        "*/*;q=0",
    ] {
        let reply = render_with(&service, ("accept", accept), &scenes::small()).await;
        assert_eq!(reply.status, 406, "{accept}");
    }
}

#[tokio::test]
async fn server_timing_has_every_stage_and_pass() {
    let service = Service::start().await;
    let reply = service.post_json("/v1/render", scenes::small()).await;
    let timing = reply.header("server-timing");
    let names: Vec<&str> = timing
        .split(", ")
        .map(|entry| {
            let (name, duration) = entry.split_once(";dur=").unwrap();
            assert!(duration.parse::<f64>().unwrap() >= 0.0);
            name
        })
        .collect();
    assert_eq!(
        names,
        [
            "queue",
            "plan",
            "upload",
            "gpu",
            "readback",
            "encode",
            "total",
            "pass-surface"
        ]
    );
    assert!(timing.contains("gpu;dur=2.500"), "{timing}");
    assert!(timing.ends_with("pass-surface;dur=1.250"), "{timing}");
}

#[tokio::test]
async fn a_known_image_is_not_rendered_again() {
    let service = Service::start().await;
    let first = service.post_json("/v1/render", scenes::small()).await;
    let tag = first.header("etag").to_owned();
    assert!(
        tag.starts_with('"') && tag.ends_with('"') && tag.len() > 20,
        "{tag}"
    );
    for listed in [tag.clone(), format!("\"other\", W/{tag}")] {
        let reply = render_with(&service, ("if-none-match", &listed), &scenes::small()).await;
        assert_eq!(reply.status, 304, "{listed}");
        assert!(reply.body.is_empty());
        assert_eq!(reply.header("etag"), tag);
        assert!(!reply.header("x-request-id").is_empty());
    }
    assert_eq!(service.control.count("render"), 1);
}

#[tokio::test]
async fn an_entity_tag_is_of_one_scene_and_one_form() {
    let service = Service::start().await;
    let first = service.post_json("/v1/render", scenes::small()).await;
    let tag = first.header("etag").to_owned();
    let again = service.post_json("/v1/render", scenes::small()).await;
    assert_eq!(again.header("etag"), tag);
    assert_eq!(again.body, first.body);

    // The same scene, said differently.
    let said = scenes::small_with("/output/width", json!(8.0));
    let reply = render_with(&service, ("if-none-match", &tag), &said).await;
    assert_eq!(reply.status, 304);
    // Another scene.
    let deeper = scenes::small_with("/floor/depth_m", json!(2.5));
    let reply = render_with(&service, ("if-none-match", &tag), &deeper).await;
    assert_eq!(reply.status, 200);
    assert_ne!(reply.header("etag"), tag);
    // Another form of the same scene.
    let mut request = post(
        "/v1/render",
        "application/json",
        scenes::small().to_string(),
    );
    request
        .headers_mut()
        .insert("if-none-match", tag.parse().unwrap());
    request
        .headers_mut()
        .insert("accept", "application/json".parse().unwrap());
    assert_eq!(service.send(request).await.status, 200);
    // No tag of ours.
    for listed in ["*", "\"\"", tag.trim_matches('"')] {
        let reply = render_with(&service, ("if-none-match", listed), &scenes::small()).await;
        assert_eq!(reply.status, 200, "{listed}");
    }
}

#[tokio::test]
async fn an_entity_tag_knows_what_dials_are_chosen_by_where_they_are_chosen() {
    let quality = |quality: Value| {
        let mut scene = scenes::small();
        scene["quality"] = quality;
        scene
    };
    let own = [scenes::small(), quality(json!({ "water_cells": 64 }))];
    let chosen = [
        quality(json!({ "target_error": 0.02 })),
        quality(json!({ "time_budget_ms": 50 })),
    ];
    let service = Service::start().await;
    let mut tags = Vec::new();
    for scene in own.iter().chain(&chosen) {
        let reply = service.post_json("/v1/render", scene).await;
        assert_eq!(reply.status, 200, "{}", reply.text());
        tags.push(reply.header("etag").to_owned());
    }
    let status_of = async |index: usize| {
        let scene = own.iter().chain(&chosen).nth(index).unwrap();
        let header = ("if-none-match", tags[index].as_str());
        let reply = render_with(&service, header, scene).await;
        assert_eq!(reply.header("etag") == tags[index], reply.status == 304);
        reply.status
    };
    for index in 0..4 {
        assert_eq!(status_of(index).await, 304, "{index}");
    }

    // The next device comes with another calibration, or less memory.
    service.control.choose_dials_by("another calibration");
    let lost = GpuError::DeviceLost("unplugged".to_owned());
    service
        .control
        .script([Behaviour::Fail(RenderError::Gpu(lost))]);
    service.assert_whole().await;
    assert_eq!(service.state.queue().status().losses, 1);
    for (index, expected) in [304, 304, 200, 200].into_iter().enumerate() {
        assert_eq!(status_of(index).await, expected, "{index}");
    }
}

#[tokio::test]
async fn an_invalid_scene_is_never_unchanged() {
    let service = Service::start().await;
    let first = service.post_json("/v1/render", scenes::small()).await;
    let tag = first.header("etag").to_owned();
    let bad = scenes::small_with("/floor/depth_m", json!(-1));
    let reply = render_with(&service, ("if-none-match", &tag), &bad).await;
    assert_eq!(reply.status, 422);
}

#[tokio::test]
async fn a_plan_runs_nothing() {
    let service = Service::start().await;
    let reply = service.post_json("/v1/plan", scenes::small()).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    let plan: caustica::plan::Plan = reply.json();
    assert_eq!(plan.passes[0].name, "surface");
    assert_eq!(plan.peak_bytes, 4096);
    assert_eq!(service.control.count("plan"), 1);
    assert_eq!(service.control.count("render"), 0);
}
