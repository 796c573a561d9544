//! Health, info, metrics, pages.

use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{Method, Request};
use axum::routing::{self, MethodRouter};
use caustica::config::Limits;
use caustica::gpu_queue::QueueSettings;
use caustica::http::routes::health::Ready;
use caustica::http::routes::info::Info;
use caustica::http::{AppState, ProblemKind, layered};
use caustica::stats::CacheStats;
use tower::ServiceExt as _;

use super::support::{Reply, Service, fake};

#[tokio::test]
async fn a_ready_service_says_why() {
    let service = Service::start().await;
    assert_eq!(service.get("/healthz").await.status, 200);
    let reply = service.get("/readyz").await;
    assert_eq!(reply.status, 200);
    let ready: Ready = reply.json();
    assert!(ready.would_accept_work);
    assert_eq!((ready.queue_depth, ready.queue_capacity), (0, 2));
    assert_eq!(ready.adapter, Some(fake::adapter()));
    assert!(ready.self_check.unwrap().passed);
}

#[tokio::test]
async fn a_draining_service_is_not_ready_and_still_serves() {
    let service = Service::start().await;
    service.state.start_draining();
    let problem = service.get("/readyz").await.problem(ProblemKind::NotReady);
    assert_eq!(problem.obstacles, ["the service is shutting down"]);
    service.assert_whole().await;
}

#[tokio::test]
async fn info_has_adapter_limits_and_words() {
    let limits = Limits {
        max_lights: 3,
        ..Limits::default()
    };
    let service = Service::start_limited(limits).await;
    let info: Info = service.get("/v1/info").await.json();
    assert_eq!(info.version, env!("CARGO_PKG_VERSION"));
    assert_eq!(info.adapter, Some(fake::adapter()));
    assert_eq!(info.software, Some(true));
    assert_eq!(info.limits, limits);
    assert_eq!(info.memory_budget_bytes, 2048 << 20);
    assert_eq!(info.queue, 1);
    assert_eq!(info.features["ImageFormat"], ["png", "exr"]);
    assert_eq!(info.features["LayerName"].len(), 7);
    for (name, words) in &info.features {
        assert!(!words.is_empty(), "{name}");
    }
}

#[tokio::test]
async fn metrics_count_what_happened() {
    let service = Service::start().await;
    service.control.set_cache(CacheStats {
        hits: 7,
        misses: 3,
        evictions: 2,
        entries: 1,
        bytes: 4096,
        budget_bytes: 8192,
    });
    service.assert_whole().await;
    service.get("/nowhere").await;
    service.post_json("/v1/render", "{").await;
    // The cache is read after the answer is on its way.
    let mut status = service.state.queue().watch();
    status
        .wait_for(|status| status.level_maps.hits == 7)
        .await
        .unwrap();
    let reply = service.get("/metrics").await;
    assert_eq!(reply.status, 200);
    assert!(
        reply
            .header("content-type")
            .starts_with("text/plain; version=0.0.4")
    );
    let text = reply.text();
    for line in [
        r#"caustica_http_requests_total{method="POST",route="/v1/render",status="200"}"#,
        r#"caustica_http_requests_total{method="POST",route="/v1/render",status="400"}"#,
        r#"caustica_http_requests_total{method="GET",route="unmatched",status="404"}"#,
        r#"caustica_http_problems_total{type="urn:caustica:problem:malformed-json"}"#,
        r#"caustica_render_seconds_bucket{le="0.1"}"#,
        r#"caustica_render_seconds_bucket{le="+Inf"}"#,
        "caustica_connections ",
        r#"caustica_connections_closed_total{reason="evicted"} "#,
        "caustica_log_lines_dropped_total ",
        "caustica_queue_depth 0",
        "caustica_queue_capacity 2",
        "caustica_ready 1",
        "caustica_level_map_cache_bytes 4096",
        "caustica_level_map_cache_entries 1",
        "caustica_level_map_cache_budget_bytes 8192",
        "caustica_field_cache_bytes 2048",
        "caustica_field_cache_entries 1",
        "caustica_field_cache_budget_bytes 8192",
        r#"name="Puppet 3000""#,
    ] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
    // Counters are of the process: other tests may have counted more.
    let of_caches = ["level_map", "field"].into_iter().flat_map(|cache| {
        ["hits", "misses", "evictions"]
            .map(|name| format!("\ncaustica_{cache}_cache_{name}_total "))
    });
    for name in of_caches {
        let value = text.split(&name).nth(1).unwrap().lines().next().unwrap();
        assert!(value.parse::<u64>().unwrap() > 0, "{name}{value}");
    }
}

#[tokio::test]
async fn every_answer_has_an_id() {
    let service = Service::start().await;
    let one = service.get("/healthz").await;
    let other = service.get("/nowhere").await;
    assert!(!one.header("x-request-id").is_empty());
    assert_ne!(one.header("x-request-id"), other.header("x-request-id"));
    let request = Request::get("/healthz")
        .header("x-request-id", "from-the-proxy")
        .body(Body::empty())
        .unwrap();
    let reply = service.send(request).await;
    assert_eq!(reply.header("x-request-id"), "from-the-proxy");
}

/// Addresses that a page loads from other hosts.
fn foreign(text: &str) -> Vec<&str> {
    text.split(['"', '\'', '(', ' '])
        .filter(|word| word.starts_with("http://") || word.starts_with("https://"))
        .collect()
}

#[tokio::test]
async fn the_page_holds_all_it_needs() {
    let service = Service::start().await;
    let reply = service.get("/").await;
    assert_eq!(reply.status, 200);
    assert!(reply.header("content-type").starts_with("text/html"));
    assert!(
        reply
            .header("content-security-policy")
            .contains("default-src 'none'")
    );
    let html = reply.text();
    assert_eq!(foreign(&html), Vec::<&str>::new());
    assert!(!html.contains("{{"));
    let scene = html.split("<textarea").nth(1).unwrap();
    let scene = scene
        .split_once('>')
        .unwrap()
        .1
        .split("</textarea>")
        .next()
        .unwrap();
    let reply = service.post_json("/v1/render", scene).await;
    assert_eq!(reply.status, 200, "{}", reply.text());
}

#[tokio::test]
async fn the_reader_of_the_contract_works_offline() {
    let service = Service::start().await;
    let moved = service.get("/docs").await;
    assert_eq!((moved.status, moved.header("location")), (303, "/docs/"));
    let page = service.get("/docs/").await;
    assert_eq!(page.status, 200);
    assert_eq!(foreign(&page.text()), Vec::<&str>::new());
    let setup = service.get("/docs/swagger-initializer.js").await;
    assert_eq!(setup.status, 200);
    assert!(setup.text().contains("/openapi.yaml"), "{}", setup.text());
    for file in ["swagger-ui-bundle.js", "swagger-ui.css"] {
        assert_eq!(service.get(&format!("/docs/{file}")).await.status, 200);
    }
}

#[tokio::test]
async fn a_slash_at_the_end_finds_the_route() {
    let service = Service::start().await;
    for (with, without) in [
        ("/healthz/", "/healthz"),
        ("/readyz///", "/readyz"),
        ("/v1/info/?x=1", "/v1/info"),
        ("/v1/meshes/", "/v1/meshes"),
        ("/openapi.yaml/", "/openapi.yaml"),
    ] {
        let reply = service.get(with).await;
        assert_eq!(reply.status, 200, "{with}");
        assert_eq!(reply.text(), service.get(without).await.text(), "{with}");
    }
    let plan = service
        .post_json("/v1/plan/", super::support::scenes::small())
        .await;
    assert_eq!(plan.status, 200, "{}", plan.text());
    let bad = service
        .post("/v1/meshes/?warm=x", "model/obj", "v 0 0 0")
        .await;
    assert_eq!(bad.status, 400, "the query is kept: {}", bad.text());
    let wrong = service.get("/v1/render/").await;
    wrong.problem(ProblemKind::MethodNotAllowed);
    let nowhere = service
        .get("/nowhere/")
        .await
        .problem(ProblemKind::NotFound);
    assert!(nowhere.detail.contains("/nowhere/"), "{}", nowhere.detail);
    for path in ["/", "//", "//example.org/", "/%2F/"] {
        let status = service.get(path).await.status;
        assert!(status == 200 || status == 404, "{path}: {status}");
    }
    let metrics = service.get("/metrics").await.text();
    let label = r#"caustica_http_requests_total{method="POST",route="/v1/plan",status="200"}"#;
    assert!(metrics.contains(label), "{metrics}");
    assert!(!metrics.contains(r#"route="/v1/plan/""#), "{metrics}");
}

/// A service with one more route, inside the same layers.
async fn with_route(service: &Service, handler: MethodRouter<AppState>) -> Reply {
    let routes = Router::new().route("/", handler);
    let request = Request::get("/").body(Body::empty()).unwrap();
    let response = layered(routes, service.state.clone())
        .oneshot(request)
        .await
        .unwrap();
    Reply::read(Method::GET, "/".to_owned(), response).await
}

#[tokio::test]
async fn a_panic_in_a_handler_is_an_answer() {
    async fn panics() -> &'static str {
        panic!("a private cause")
    }
    let service = Service::start().await;
    let reply = with_route(&service, routing::get(panics)).await;
    let problem = reply.problem(ProblemKind::Internal);
    assert!(!problem.detail.contains("a private cause"));
    service.assert_whole().await;
}

#[tokio::test]
async fn a_handler_that_does_not_end_meets_the_deadline() {
    let service = Service::start_queued(QueueSettings {
        waiting: 1,
        deadline: Duration::from_millis(100),
    })
    .await;
    let reply = with_route(&service, routing::get(std::future::pending::<()>)).await;
    reply.problem(ProblemKind::DeadlinePassed);
    assert!(!reply.header("retry-after").is_empty());
}
