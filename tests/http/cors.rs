//! What pages of other origins may do.

use std::collections::BTreeSet;

use axum::body::Body;
use axum::http::{Method, Request};
use caustica::config::CorsOrigin;
use caustica::http::openapi;

use super::support::{Reply, Service, scenes};

const EDITOR: &str = "http://localhost:3000";

async fn allowing(origins: &[&str]) -> Service {
    let mut service = Service::start().await;
    let origins = origins.iter().map(|text| text.parse().unwrap()).collect();
    service.state = service.state.allowing_origins(origins);
    service
}

async fn preflight(service: &Service, path: &str, origin: &str) -> Reply {
    let request = Request::options(path)
        .header("origin", origin)
        .header("access-control-request-method", "POST")
        .header("access-control-request-headers", "content-type");
    service.send(request.body(Body::empty()).unwrap()).await
}

async fn render_from(service: &Service, origin: &str, scene: String) -> Reply {
    let request = Request::post("/v1/render")
        .header("origin", origin)
        .header("content-type", "application/json");
    service.send(request.body(Body::from(scene)).unwrap()).await
}

/// The names in a header that lists some.
fn names(reply: &Reply, header: &str) -> BTreeSet<String> {
    let text = reply.header(header).to_ascii_lowercase();
    text.split(',').map(|name| name.trim().to_owned()).collect()
}

#[tokio::test]
async fn an_allowed_origin_gets_what_the_contract_has() {
    let service = allowing(&["https://other.example", EDITOR]).await;
    let reply = preflight(&service, "/v1/render", EDITOR).await;
    assert_eq!(reply.status, 200);
    assert_eq!(reply.header("access-control-allow-origin"), EDITOR);
    assert!(!reply.header("x-request-id").is_empty());
    let methods = names(&reply, "access-control-allow-methods");
    let sent = names(&reply, "access-control-allow-headers");
    assert!(sent.contains("content-type") && sent.contains("content-encoding"));

    let reply = render_from(&service, EDITOR, scenes::small().to_string()).await;
    assert_eq!(reply.status, 200);
    assert_eq!(reply.header("access-control-allow-origin"), EDITOR);
    let readable = names(&reply, "access-control-expose-headers");
    assert!(readable.contains("x-request-id"));
    let vary: Vec<_> = reply.headers.get_all("vary").iter().collect();
    assert!(
        format!("{vary:?}").contains("accept") && format!("{vary:?}").contains("origin"),
        "{vary:?}"
    );

    // Whatever the contract has, a page can use.
    let contract = serde_json::to_value(openapi()).unwrap();
    for item in contract["paths"].as_object().unwrap().values() {
        for (method, operation) in item.as_object().unwrap() {
            assert!(methods.contains(&method.to_ascii_lowercase()), "{method}");
            for parameter in operation["parameters"].as_array().into_iter().flatten() {
                let name = parameter["name"].as_str().unwrap();
                assert!(parameter["in"] != "header" || sent.contains(name), "{name}");
            }
            for answer in operation["responses"].as_object().unwrap().values() {
                for name in answer["headers"].as_object().into_iter().flatten() {
                    assert!(readable.contains(name.0), "{}", name.0);
                }
            }
        }
    }
}

#[tokio::test]
async fn problems_reach_the_page_too() {
    let service = allowing(&[EDITOR]).await;
    let bad = render_from(&service, EDITOR, "{".to_owned()).await;
    assert_eq!(bad.status, 400);
    assert_eq!(bad.header("access-control-allow-origin"), EDITOR);
    let nowhere = Request::get("/nowhere").header("origin", EDITOR);
    let nowhere = service.send(nowhere.body(Body::empty()).unwrap()).await;
    assert_eq!(nowhere.status, 404);
    assert_eq!(nowhere.header("access-control-allow-origin"), EDITOR);
}

#[tokio::test]
async fn other_origins_are_not_allowed() {
    let service = allowing(&[EDITOR]).await;
    for origin in ["http://localhost:3001", "https://localhost:3000", "null"] {
        let reply = preflight(&service, "/v1/render", origin).await;
        assert_eq!(reply.header("access-control-allow-origin"), "", "{origin}");
    }
    let service = Service::start().await;
    let reply = preflight(&service, "/v1/render", EDITOR).await;
    assert_eq!(reply.status, 405);
    let reply = render_from(&service, EDITOR, scenes::small().to_string()).await;
    assert_eq!(reply.status, 200);
    let spoken = reply
        .headers
        .keys()
        .filter(|name| name.as_str().starts_with("access-control"));
    assert_eq!(spoken.count(), 0);
}

#[tokio::test]
async fn a_star_allows_every_origin() {
    let service = allowing(&[EDITOR, "*"]).await;
    for origin in ["https://any.example", "null"] {
        let reply = preflight(&service, "/v1/meshes", origin).await;
        assert_eq!(reply.status, 200);
        assert_eq!(reply.header("access-control-allow-origin"), "*");
    }
    let head = service.bare(Method::HEAD, "/healthz").await;
    assert_eq!(head.header("access-control-allow-origin"), "*");
}

#[test]
fn origins_are_read_as_browsers_send_them() {
    for (text, read) in [
        ("*", "*"),
        ("http://localhost:3000", "http://localhost:3000"),
        ("HTTPS://Example.ORG", "https://example.org"),
        ("https://example.org:443", "https://example.org"),
        ("http://example.org:80", "http://example.org"),
        ("https://example.org:80", "https://example.org:80"),
        ("http://[::1]:5173", "http://[::1]:5173"),
        ("tauri://localhost", "tauri://localhost"),
    ] {
        let origin: CorsOrigin = text.parse().unwrap();
        assert_eq!(origin.to_string(), read);
    }
    for (text, why) in [
        ("", "scheme is missing"),
        ("localhost:3000", "scheme is missing"),
        ("3://x", "scheme is not valid"),
        ("http://", "host is not valid"),
        ("http://a b", "host is not valid"),
        ("http://[::x]", "host is not valid"),
        ("http://*.example.org", "host is not valid"),
        ("http://example.org/", "no path"),
        ("http://example.org/app", "no path"),
        ("http://example.org:x", "port is not a number"),
        ("http://example.org:99999", "port is not a number"),
    ] {
        let said = text.parse::<CorsOrigin>().unwrap_err();
        assert!(said.contains(why), "{text}: {said}");
        assert!(said.contains("accepted: `*`"), "{said}");
    }
}
