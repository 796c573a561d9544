//! `/`, `/openapi.yaml` and `/docs`. They load nothing from other hosts.

use axum::Router;
use axum::http::header;
use axum::response::{Html, IntoResponse};
use utoipa_swagger_ui::{Config, SwaggerUi};

use super::super::openapi::yaml;
use super::super::problem::CommonProblems;
use super::super::state::AppState;

/// The page, with the contract's example scene.
const PAGE: &str = include_str!("try_it.html");

/// Where the reader of the contract starts. Its page has links relative to this path, so the slash stays.
pub(in super::super) const READER: &str = "/docs/";

/// The placeholder of the example scene in [`PAGE`].
const EXAMPLE_MARK: &str = "{{example_scene}}";

/// Content security policy: the page loads only itself and the pictures it has made.
const PAGE_POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; \
                           img-src blob: data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A page to try the service.
#[utoipa::path(
    get, path = "/", tag = "service",
    responses((status = OK, description = "HTML.", body = String, content_type = "text/html"), CommonProblems)
)]
pub async fn page() -> impl IntoResponse {
    // The scene contains no `<` or `&`, so it needs no escaping in a text area.
    let html = PAGE.replace(EXAMPLE_MARK, super::render::EXAMPLE_SCENE);
    ([(header::CONTENT_SECURITY_POLICY, PAGE_POLICY)], Html(html))
}

/// The contract: this document.
#[utoipa::path(
    get, path = "/openapi.yaml", tag = "service",
    responses((status = OK, description = "OpenAPI.", body = String, content_type = "application/yaml"), CommonProblems)
)]
pub async fn contract() -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/yaml")], yaml())
}

/// An HTML reference of the contract, from files built into the program.
pub(in super::super) fn swagger() -> Router<AppState> {
    SwaggerUi::new("/docs")
        .config(Config::from("/openapi.yaml").validator_url("none"))
        .into()
}
