//! Each bad request gets its status and problem, and does not affect the next good one.

use axum::http::Method;
use caustica::config::Limits;
use caustica::gpu::GpuError;
use caustica::http::ProblemKind;
use caustica::render::RenderError;
use caustica::scene::SceneError;
use serde_json::{Value, json};

use super::support::service::post;
use super::support::{Behaviour, Service, scenes};

/// A scene request that must be refused, on both routes that read scenes.
async fn refused(body: impl ToString, kind: ProblemKind, pointer: &str) {
    let service = Service::start().await;
    let body = body.to_string();
    for route in ["/v1/render", "/v1/plan"] {
        let reply = service.post_json(route, &body).await;
        let problem = reply.problem(kind);
        assert!(
            problem.errors.iter().any(|issue| issue.pointer == pointer),
            "{pointer} is not among {:?}",
            problem.errors
        );
    }
    assert_eq!(service.control.count("render"), 0);
    service.assert_whole().await;
}

#[tokio::test]
async fn text_that_is_not_json() {
    refused("{\"floor\": ", ProblemKind::MalformedJson, "").await;
    refused("{\"time_s\": NaN}", ProblemKind::MalformedJson, "").await;
}

#[tokio::test]
async fn an_empty_body() {
    refused("", ProblemKind::MalformedJson, "").await;
}

#[tokio::test]
async fn a_scene_that_is_not_an_object() {
    refused("[]", ProblemKind::InvalidScene, "").await;
}

#[tokio::test]
async fn unknown_fields() {
    let mut scene = scenes::small();
    scene["flor"] = json!({});
    refused(scene, ProblemKind::InvalidScene, "/flor").await;
    let mut scene = scenes::small();
    scene["floor"]["depth"] = json!(1);
    refused(scene, ProblemKind::InvalidScene, "/floor/depth").await;
}

#[tokio::test]
async fn values_that_are_not_numbers() {
    let scene = scenes::small_with("/floor/depth_m", json!("NaN"));
    refused(scene, ProblemKind::InvalidScene, "/floor/depth_m").await;
    let scene = scenes::small().to_string().replace("60", "1e400");
    refused(scene, ProblemKind::MalformedJson, "/lights/0/elevation_deg").await;
}

#[tokio::test]
async fn numbers_out_of_range() {
    let scene = scenes::small_with("/floor/depth_m", json!(-2));
    refused(scene, ProblemKind::InvalidScene, "/floor/depth_m").await;
    let scene = scenes::small_with("/output/width", json!(0));
    refused(scene, ProblemKind::InvalidScene, "/output/width").await;
    let scene = scenes::small_with("/output/height", json!(1.5));
    refused(scene, ProblemKind::InvalidScene, "/output/height").await;
}

#[tokio::test]
async fn a_picture_of_ten_thousand_million_pixels() {
    let mut scene = scenes::small();
    scene["output"] = json!({ "kind": "view", "width": 100_000, "height": 100_000 });
    refused(scene, ProblemKind::InvalidScene, "/output/width").await;
}

#[tokio::test]
async fn above_a_limit_of_the_installation() {
    let limits = Limits {
        max_lights: 1,
        ..Limits::default()
    };
    let service = Service::start_limited(limits).await;
    let sky = json!({ "kind": "sky", "radiance_w_m2_sr": [1, 1, 1] });
    let scene = scenes::small_with("/lights", json!([sky, sky]));
    let reply = service.post_json("/v1/render", scene).await;
    let problem = reply.problem(ProblemKind::LimitExceeded);
    assert_eq!(problem.errors[0].pointer, "/lights");
    service.assert_whole().await;
}

#[tokio::test]
async fn a_mesh_that_is_not_stored() {
    let scene = scenes::small_with_mesh("blake3:00");
    refused(scene, ProblemKind::MissingMesh, "/objects/0/mesh").await;
}

#[tokio::test]
async fn several_findings_are_reported_together() {
    let service = Service::start().await;
    let mut scene = scenes::small_with("/floor/depth_m", json!(-2));
    scene["time_s"] = json!(1e300);
    let problem = service
        .post_json("/v1/render", scene)
        .await
        .problem(ProblemKind::InvalidScene);
    assert!(problem.errors.len() >= 2, "{:?}", problem.errors);
    assert!(problem.detail.contains("more"), "{}", problem.detail);
}

#[tokio::test]
async fn the_wrong_content_type() {
    let service = Service::start().await;
    for route in ["/v1/render", "/v1/plan"] {
        let body = scenes::small().to_string();
        let reply = service
            .post(route, "application/x-www-form-urlencoded", body)
            .await;
        let problem = reply.problem(ProblemKind::UnsupportedMediaType);
        assert!(
            problem.detail.contains("application/json"),
            "{}",
            problem.detail
        );
    }
    let reply = service.bare(Method::POST, "/v1/render").await;
    let problem = reply.problem(ProblemKind::UnsupportedMediaType);
    assert!(problem.detail.contains("missing"), "{}", problem.detail);
    let reply = service.post("/v1/meshes", "application/json", "{}").await;
    reply.problem(ProblemKind::UnsupportedMediaType);
    service.assert_whole().await;
}

#[tokio::test]
async fn json_with_parameters_is_json() {
    let service = Service::start().await;
    for media_type in [
        "application/json; charset=utf-8",
        "Application/JSON",
        "application/scene+json",
    ] {
        let body = scenes::small().to_string();
        let reply = service.post("/v1/render", media_type, body).await;
        assert_eq!(reply.status, 200, "{media_type}: {}", reply.text());
    }
}

#[tokio::test]
async fn a_body_above_the_limit() {
    let limits = Limits {
        max_body_bytes: 2000,
        ..Limits::default()
    };
    let service = Service::start_limited(limits).await;
    let long = " ".repeat(2001);
    let form =
        format!("--x\r\ncontent-disposition: form-data; name=\"obj\"\r\n\r\n{long}\r\n--x--\r\n");
    for (path, media_type, body) in [
        ("/v1/render", "application/json", long.clone()),
        ("/v1/plan", "application/json", long.clone()),
        ("/v1/meshes", "text/plain", long),
        ("/v1/meshes", "multipart/form-data; boundary=x", form),
    ] {
        let reply = service.post(path, media_type, body).await;
        let problem = reply.problem(ProblemKind::BodyTooLarge);
        assert!(problem.detail.contains("2000"), "{}", problem.detail);
    }
    service.assert_whole().await;
}

#[tokio::test]
async fn nothing_there() {
    let service = Service::start().await;
    for path in ["/v2/render", "/v1", "/index.html", "/v1/rendering/"] {
        let problem = service.get(path).await.problem(ProblemKind::NotFound);
        assert!(problem.detail.contains(path), "{}", problem.detail);
    }
    service.assert_whole().await;
}

#[tokio::test]
async fn the_wrong_method() {
    let service = Service::start().await;
    let reply = service.get("/v1/render").await;
    reply.problem(ProblemKind::MethodNotAllowed);
    assert_eq!(reply.header("allow"), "POST");
    service.assert_whole().await;
}

#[tokio::test]
async fn no_acceptable_representation() {
    let service = Service::start().await;
    let mut request = post(
        "/v1/render",
        "application/json",
        scenes::small().to_string(),
    );
    request
        .headers_mut()
        .insert("accept", "text/html".parse().unwrap());
    let problem = service
        .send(request)
        .await
        .problem(ProblemKind::NotAcceptable);
    assert!(problem.detail.contains("image/png"), "{}", problem.detail);
    assert_eq!(service.control.count("render"), 0);
}

/// An error of the backend and what becomes of it.
async fn answered(error: RenderError, kind: ProblemKind) -> caustica::http::Problem {
    let service = Service::start().await;
    service.control.script([Behaviour::Fail(error)]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    let problem = reply.problem(kind);
    assert_eq!(
        reply.headers.contains_key("retry-after"),
        kind.sends_retry_after()
    );
    service.assert_whole().await;
    problem
}

#[tokio::test]
async fn scenes_refused_by_their_facts_never_reach_the_gpu_thread() {
    let service = Service::start().await;
    let mut scene = scenes::small();
    scene["quality"] = json!({ "method": "planes", "target_error": 0.01 });
    for path in ["/v1/render", "/v1/plan"] {
        let reply = service.post_json(path, &scene).await;
        let problem = reply.problem(ProblemKind::InvalidScene);
        assert_eq!(problem.errors[0].pointer, "/quality/method");
    }
    assert_eq!(service.control.count("render"), 0);
    assert_eq!(service.control.count("plan"), 0);
    service.until_depth(0).await;
    service.assert_whole().await;
}

#[tokio::test]
async fn over_budget_names_both_figures() {
    let error = RenderError::OverBudget {
        what: "the frame at its peak".to_owned(),
        needed_bytes: 5000,
        budget_bytes: 4000,
    };
    let problem = answered(error, ProblemKind::OverBudget).await;
    assert_eq!(problem.needed_bytes, Some(5000));
    assert_eq!(problem.budget_bytes, Some(4000));
}

#[tokio::test]
async fn errors_of_the_backend() {
    let gpu = |error| RenderError::Gpu(error);
    let out_of_memory = gpu(GpuError::OutOfMemory("map".to_owned()));
    answered(out_of_memory, ProblemKind::OutOfGpuMemory).await;
    answered(gpu(GpuError::Timeout(30)), ProblemKind::DeviceLost).await;
    let issue = caustica::scene::Issue::invalid("/camera", "is under water", "a camera above it");
    let scene = RenderError::Scene(SceneError::from(issue));
    let problem = answered(scene, ProblemKind::InvalidScene).await;
    assert_eq!(problem.errors[0].pointer, "/camera");
}

#[tokio::test]
async fn details_of_a_defect_are_not_reported() {
    let error = RenderError::Gpu(GpuError::Validation("secret label".to_owned()));
    let problem = answered(error, ProblemKind::Internal).await;
    assert!(!problem.detail.contains("secret"));
}

#[tokio::test]
async fn a_frame_that_cannot_be_encoded() {
    let service = Service::start().await;
    service.control.script([Behaviour::DrawNan]);
    let reply = service.post_json("/v1/render", scenes::small()).await;
    reply.problem(ProblemKind::Internal);
    service.assert_whole().await;
}

#[tokio::test]
async fn deep_nesting_is_refused_and_not_fatal() {
    let depth = 100_000;
    let scene = format!("{}{}", "[".repeat(depth), "]".repeat(depth));
    let service = Service::start().await;
    let reply = service.post_json("/v1/render", scene).await;
    assert!([400, 422].contains(&reply.status), "{}", reply.status);
    let _: Value = reply.json();
    service.assert_whole().await;
}
