//! Every route and layer.

use std::any::Any;

use axum::Router;
use axum::extract::{DefaultBodyLimit, OriginalUri};
use axum::http::Method;
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::request_id::{MakeRequestUuid, PropagateRequestIdLayer, SetRequestIdLayer};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::error::ApiError;
use super::observe::observe;
use super::openapi::document;
use super::routes::{accuracy, docs, health, info, meshes, metrics, plan, render};
use super::state::AppState;

/// The documented routes: the list from which both the router and the contract are made.
pub(super) fn api() -> OpenApiRouter<AppState> {
    OpenApiRouter::with_openapi(document())
        .routes(routes!(docs::page))
        .routes(routes!(docs::contract))
        .routes(routes!(health::alive))
        .routes(routes!(health::ready))
        .routes(routes!(metrics::metrics))
        .routes(routes!(info::info))
        .routes(routes!(meshes::list, meshes::upload))
        .routes(routes!(meshes::inspect, meshes::forget))
        .routes(routes!(plan::plan))
        .routes(routes!(render::render))
        .routes(routes!(accuracy::accuracy))
}

/// The whole service.
pub fn app(state: AppState) -> Router {
    let (routes, _) = api().split_for_parts();
    layered(routes.merge(docs::swagger()), state)
}

/// Adds the layers around all routes: ids, log, metrics, deadline, body limit, and problems for paths without a route.
pub fn layered(routes: Router<AppState>, state: AppState) -> Router {
    routes
        .fallback(no_route)
        .method_not_allowed_fallback(no_method)
        // The innermost layer comes first.
        .layer(CatchPanicLayer::custom(panicked))
        .layer(DefaultBodyLimit::max(state.limits().max_body_bytes))
        .layer(from_fn_with_state(state.clone(), observe))
        .layer(PropagateRequestIdLayer::x_request_id())
        .layer(SetRequestIdLayer::x_request_id(MakeRequestUuid))
        .with_state(state)
}

async fn no_route(OriginalUri(uri): OriginalUri) -> ApiError {
    ApiError::NotFound {
        path: uri.path().to_owned(),
    }
}

async fn no_method(method: Method, OriginalUri(uri): OriginalUri) -> ApiError {
    ApiError::MethodNotAllowed {
        method: method.to_string(),
        path: uri.path().to_owned(),
    }
}

#[expect(
    clippy::needless_pass_by_value,
    reason = "the catcher of panics hands them over"
)]
fn panicked(panic: Box<dyn Any + Send>) -> Response {
    ApiError::from_panic(&*panic).into_response()
}
