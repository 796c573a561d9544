//! Every route and layer.

use std::any::Any;

use axum::Router;
use axum::extract::{DefaultBodyLimit, OriginalUri, Request};
use axum::http::uri::PathAndQuery;
use axum::http::{Method, Uri};
use axum::middleware::{from_fn, from_fn_with_state, map_request};
use axum::response::{IntoResponse, Response};
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::request_id::{MakeRequestUuid, PropagateRequestIdLayer, SetRequestIdLayer};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::cors;
use super::decode::decode;
use super::error::ApiError;
use super::observe::observe;
use super::openapi::document;
use super::routes::{accuracy, assets, docs, health, info, meshes, metrics, plan, render};
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
        .routes(routes!(assets::list, assets::upload))
        .routes(routes!(assets::inspect, assets::forget))
        .routes(routes!(plan::plan))
        .routes(routes!(render::render))
        .routes(routes!(accuracy::accuracy))
}

/// The whole service.
pub fn app(state: AppState) -> Router {
    let (routes, _) = api().split_for_parts();
    layered(routes.merge(docs::swagger()), state)
}

/// Adds the layers around all routes: ids, other origins, log, metrics, deadline, encodings and limit of bodies, and problems for
/// paths without a route. A slash at the end of a path finds the route without it.
pub fn layered(routes: Router<AppState>, state: AppState) -> Router {
    let app = routes
        .route_layer(from_fn(decode))
        .fallback(no_route)
        .method_not_allowed_fallback(no_method)
        // The innermost layer comes first.
        .layer(CatchPanicLayer::custom(panicked))
        .layer(DefaultBodyLimit::max(state.limits().max_body_bytes))
        .layer(from_fn_with_state(state.clone(), observe))
        .layer(option_layer(cors::layer(state.origins())))
        .layer(PropagateRequestIdLayer::x_request_id())
        .layer(SetRequestIdLayer::x_request_id(MakeRequestUuid))
        .with_state(state);
    // The path has to be changed before a route is looked up, and layers of a router run after that. So there is a router around it.
    Router::new()
        .fallback_service(app)
        .layer(map_request(without_last_slash))
}

/// Removes slashes at the end of the path.
async fn without_last_slash(mut request: Request) -> Request {
    let uri = request.uri();
    let path = uri.path();
    let shorter = path.trim_end_matches('/');
    if shorter.len() == path.len() || shorter.is_empty() || path == docs::READER {
        return request;
    }
    let target = match uri.query() {
        Some(query) => format!("{shorter}?{query}"),
        None => shorter.to_owned(),
    };
    // A part of a valid path is valid, except that `//host` is not a path.
    if let Ok(path_and_query) = PathAndQuery::try_from(target) {
        let mut parts = uri.clone().into_parts();
        parts.path_and_query = Some(path_and_query);
        if let Ok(uri) = Uri::from_parts(parts) {
            *request.uri_mut() = uri;
        }
    }
    request
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
