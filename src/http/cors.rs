//! Web pages of other origins (CORS): what browsers let them send and read.

use std::time::Duration;

use axum::http::{HeaderName, HeaderValue, Method, header};
use tower_http::cors::{AllowOrigin, Any, CorsLayer};

use super::observe::REQUEST_ID;
use super::routes::render::{SCENE_HASH, SERVER_TIMING};
use crate::config::CorsOrigin;

/// Methods of the API.
const METHODS: [Method; 4] = [Method::GET, Method::HEAD, Method::POST, Method::DELETE];

/// Headers of requests that the API reads.
const REQUEST_HEADERS: [HeaderName; 5] = [
    header::ACCEPT,
    header::CONTENT_ENCODING,
    header::CONTENT_TYPE,
    header::IF_NONE_MATCH,
    REQUEST_ID,
];

/// Headers of answers that a page may read, beside those that it always may.
const RESPONSE_HEADERS: [HeaderName; 8] = [
    header::ACCEPT_ENCODING,
    header::ALLOW,
    header::ETAG,
    header::LOCATION,
    header::RETRY_AFTER,
    REQUEST_ID,
    SCENE_HASH,
    SERVER_TIMING,
];

/// How long a browser may remember what is allowed.
const MAX_AGE: Duration = Duration::from_secs(3600);

/// The layer for these origins; without any there is none, and browsers refuse pages of other origins.
pub(super) fn layer(origins: &[CorsOrigin]) -> Option<CorsLayer> {
    if origins.is_empty() {
        return None;
    }
    let mut listed = Vec::new();
    for origin in origins {
        match origin {
            CorsOrigin::Any => return Some(layer_for(Any)),
            // The reader of origins lets only characters pass that a header may have.
            CorsOrigin::One(origin) => listed.extend(HeaderValue::from_str(origin).ok()),
        }
    }
    Some(layer_for(AllowOrigin::list(listed)))
}

fn layer_for(origins: impl Into<AllowOrigin>) -> CorsLayer {
    CorsLayer::new()
        .allow_origin(origins)
        .allow_methods(METHODS)
        .allow_headers(REQUEST_HEADERS)
        .expose_headers(RESPONSE_HEADERS)
        .max_age(MAX_AGE)
}
