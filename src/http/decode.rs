//! Encodings of request bodies (`Content-Encoding`).

use std::convert::Infallible;

use axum::BoxError;
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt as _;
use http_body_util::combinators::MapErr;
use tower::ServiceExt as _;
use tower_http::decompression::{DecompressionBody, RequestDecompression};

use super::error::ApiError;

/// Encodings that are decoded, as `Accept-Encoding` lists them.
pub(super) const ACCEPTED: &str = "gzip, deflate";

/// A body that is not in the encoding that its header names.
#[derive(Debug, thiserror::Error)]
#[error("Content-Encoding is {encoding}, but the body is not valid {encoding}: {reason}")]
pub(super) struct Undecodable {
    /// The encoding that the header names.
    encoding: &'static str,
    reason: BoxError,
}

/// A body that did not arrive, whatever its encoding.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
struct Broken(axum::Error);

/// A body whose own errors are marked, so that they are not taken for those of its decoder.
type Arriving = MapErr<Body, fn(axum::Error) -> Broken>;

/// The middleware: hands bodies on decoded. Nothing is held: the limit of a body's size is applied to the decoded bytes as they are
/// read.
pub(super) async fn decode(mut request: Request, next: Next) -> Response {
    let encoding = match encoding(request.headers()) {
        Ok(Some(encoding)) => encoding,
        Ok(None) => {
            request.headers_mut().remove(header::CONTENT_ENCODING);
            return next.run(request).await;
        }
        Err(error) => return error.into_response(),
    };
    let headers = request.headers_mut();
    headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static(encoding));
    let handler = tower::service_fn(
        |request: axum::http::Request<DecompressionBody<Arriving>>| {
            let (parts, body) = request.into_parts();
            let body = body.map_err(move |error: BoxError| match error.downcast::<Broken>() {
                Ok(broken) => BoxError::from(broken.0),
                Err(reason) => Undecodable { encoding, reason }.into(),
            });
            let next = next.clone();
            let request = Request::from_parts(parts, Body::new(body));
            async move { Ok::<_, Infallible>(next.run(request).await) }
        },
    );
    let answered = RequestDecompression::new(handler)
        .oneshot(request.map(|body| -> Arriving { body.map_err(Broken) }))
        .await;
    let response = answered.unwrap_or_else(|never| match never {});
    response.map(Body::new)
}

/// The encoding of a body, if it has one that is decoded.
fn encoding(headers: &HeaderMap) -> Result<Option<&'static str>, ApiError> {
    let lines = headers.get_all(header::CONTENT_ENCODING).iter();
    let text: Vec<_> = lines
        .map(|line| String::from_utf8_lossy(line.as_bytes()).to_ascii_lowercase())
        .collect();
    let text = text.join(", ");
    let named: Vec<&str> = text
        .split(',')
        .map(str::trim)
        .filter(|name| !matches!(*name, "" | "identity"))
        .collect();
    match named.as_slice() {
        [] => Ok(None),
        ["gzip" | "x-gzip"] => Ok(Some("gzip")),
        ["deflate"] => Ok(Some("deflate")),
        _ => Err(ApiError::UnsupportedEncoding {
            found: named.join(", ").chars().take(60).collect(),
        }),
    }
}
