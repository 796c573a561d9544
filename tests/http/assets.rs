//! Files of numbers are stored, listed, found, used by scenes, and deleted.

use axum::http::Method;
use caustica::config::Limits;
use caustica::fields::FieldInfo;
use caustica::http::ProblemKind;
use serde_json::{Value, json};

use super::field_support::{npy, npy_f32, png};
use super::support::{Reply, Service, scenes};

fn file() -> Vec<u8> {
    npy_f32(&[8, 8], &[0.25; 64])
}

async fn upload(service: &Service, file: Vec<u8>) -> Reply {
    service
        .post("/v1/assets", "application/octet-stream", file)
        .await
}

fn scene(id: &str) -> Value {
    let mut scene = scenes::small();
    scene["water"] =
        json!({ "waves": [{ "kind": "height_field", "frames": [id], "sample_m": 0.25 }] });
    scene
}

#[tokio::test]
async fn the_same_bytes_have_the_same_id() {
    let service = Service::start().await;
    let first = upload(&service, file()).await;
    assert_eq!(first.status, 201, "{}", first.text());
    let info: FieldInfo = first.json();
    assert_eq!(
        info.id,
        format!("blake3:{}", blake3::hash(&file()).to_hex())
    );
    assert_eq!(first.header("location"), format!("/v1/assets/{}", info.id));
    for media_type in [
        "application/x-npy",
        "image/png",
        "image/x-exr",
        "image/png; x=y",
    ] {
        // The bytes say what it is.
        let again = service.post("/v1/assets", media_type, file()).await;
        assert_eq!(again.status, 200, "{media_type}");
        assert_eq!(again.json::<FieldInfo>(), info);
    }
    let other = upload(&service, npy(&[8, 8], &[0.25; 64])).await;
    assert_ne!(other.json::<FieldInfo>().id, info.id);
}

#[tokio::test]
async fn assets_are_described_listed_and_forgotten() {
    let service = Service::start().await;
    let empty: Value = service.get("/v1/assets").await.json();
    assert_eq!(empty, json!({ "assets": [] }));
    let mut numbers = vec![-0.5; 48];
    numbers[7] = 2.0;
    let info: Value = upload(&service, npy(&[2, 6, 4], &numbers)).await.json();
    let id = info["id"].as_str().unwrap();
    for (name, expected) in [
        ("format", json!("npy")),
        ("width", json!(4)),
        ("height", json!(6)),
        ("frames", json!(2)),
        (
            "channels",
            json!([{ "name": "value", "min": -0.5, "max": 2.0, "not_finite": 0 }]),
        ),
    ] {
        assert_eq!(info[name], expected);
    }
    assert!(info["bytes"].as_u64().unwrap() >= 48 * 8);
    let list: Value = service.get("/v1/assets").await.json();
    assert_eq!(list["assets"], json!([info]));
    let path = format!("/v1/assets/{id}");
    assert_eq!(service.get(&path).await.json::<Value>(), info);
    assert_eq!(service.bare(Method::DELETE, &path).await.status, 204);
    service.get(&path).await.problem(ProblemKind::UnknownAsset);
    let again = service.bare(Method::DELETE, &path).await;
    again.problem(ProblemKind::UnknownAsset);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_scene_uses_an_asset_until_it_is_gone() {
    let service = Service::start().await;
    let info: FieldInfo = upload(&service, file()).await.json();
    let reply = service.post_json("/v1/render", scene(&info.id)).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
    service
        .bare(Method::DELETE, &format!("/v1/assets/{}", info.id))
        .await;
    for route in ["/v1/render", "/v1/plan"] {
        let reply = service.post_json(route, scene(&info.id)).await;
        let problem = reply.problem(ProblemKind::MissingAsset);
        assert_eq!(problem.errors[0].pointer, "/water/waves/0/frames/0");
        assert!(problem.errors[0].accepted.contains("POST /v1/assets"));
    }
    // A mesh is no asset of a height field.
    let mesh: Value = service
        .post("/v1/meshes", "model/obj", scenes::OBJ)
        .await
        .json();
    let reply = service
        .post_json("/v1/render", scene(mesh["id"].as_str().unwrap()))
        .await;
    reply.problem(ProblemKind::MissingAsset);
    service.assert_whole().await;
}

#[tokio::test]
async fn bodies_that_are_no_fields() {
    let service = Service::start().await;
    let truncated = file()[..200].to_vec();
    for (name, body) in [
        ("empty", Vec::new()),
        ("text", b"1 2 3".to_vec()),
        ("truncated", truncated),
        ("one axis", npy(&[64], &[0.0; 64])),
        (
            "8 bits",
            png([8, 8], png::ColorType::Grayscale, 8, &[0; 64]),
        ),
    ] {
        let reply = upload(&service, body).await;
        assert_eq!(reply.status, 422, "{name}: {}", reply.text());
        reply.problem(ProblemKind::InvalidAsset);
    }
    let reply = service.post("/v1/assets", "application/json", "{}").await;
    reply.problem(ProblemKind::UnsupportedMediaType);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_full_store_says_so() {
    let service = Service::start_limited(Limits {
        asset_store_bytes: 16,
        ..Limits::default()
    })
    .await;
    let reply = upload(&service, file()).await;
    let problem = reply.problem(ProblemKind::AssetStoreFull);
    assert!(!reply.headers.contains_key("retry-after"));
    assert_eq!(problem.budget_bytes, Some(16));
    assert!(problem.needed_bytes.unwrap() > 256);
    let metrics = service.get("/metrics").await.text();
    assert!(metrics.contains("caustica_asset_store_bytes"), "{metrics}");
    service.assert_whole().await;
}
