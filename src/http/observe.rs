//! Around every route: arrival, deadline, request span, request log, request metrics.

use std::time::{Duration, Instant};

use axum::extract::{MatchedPath, Request, State};
use axum::http::{Extensions, HeaderName};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tracing::Instrument;

use super::error::{ApiError, Reason};
use super::metrics::Metrics;
use super::state::AppState;
use crate::gpu_queue::JobError;

/// Header with the request's id, which is the client's or a generated one.
pub const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Status under which requests of clients that left are counted; never sent.
const CLIENT_GONE: u16 = 499;

/// When a request arrived; deadlines count from here.
#[derive(Clone, Copy, Debug)]
pub struct Arrival(pub Instant);

/// The middleware.
pub async fn observe(State(state): State<AppState>, mut request: Request, next: Next) -> Response {
    let arrival = Instant::now();
    request.extensions_mut().insert(Arrival(arrival));
    let mut account = Account {
        metrics: state.metrics(),
        method: request.method().as_str().to_owned(),
        route: route(request.extensions()),
        arrival,
        settled: false,
    };
    let span = tracing::info_span!(
        "request",
        id = request
            .headers()
            .get(REQUEST_ID)
            .and_then(|id| id.to_str().ok())
            .unwrap_or_default(),
        method = account.method,
        route = account.route,
    );
    let deadline = state.queue().settings().deadline;
    async move {
        // The queue's deadline also applies to a body that arrives slowly and to an answer that takes long to encode.
        let answer = tokio::time::timeout(deadline, next.run(request)).await;
        let response = answer.unwrap_or_else(|_| {
            ApiError::from(JobError::DeadlinePassed {
                deadline_s: deadline.as_secs_f64(),
            })
            .into_response()
        });
        account.settle(&response);
        response
    }
    .instrument(span)
    .await
}

/// The route's pattern, so that ids in paths do not become labels.
fn route(extensions: &Extensions) -> String {
    extensions
        .get::<MatchedPath>()
        .map_or("unmatched", MatchedPath::as_str)
        .to_owned()
}

/// Counts each request once, whether it is answered or abandoned.
struct Account {
    metrics: Metrics,
    method: String,
    route: String,
    arrival: Instant,
    settled: bool,
}

impl Account {
    fn settle(&mut self, response: &Response) {
        self.settled = true;
        let status = response.status().as_u16();
        self.metrics.request(&self.method, &self.route, status);
        let took = self.arrival.elapsed();
        match response.extensions().get::<ApiError>() {
            Some(error) => {
                self.metrics.problem(error.kind().urn());
                log_error(error, status, took);
            }
            None if matches!(self.route.as_str(), "/healthz" | "/readyz" | "/metrics") => {
                tracing::debug!(status, ms = milliseconds(took), "answered");
            }
            None => tracing::info!(status, ms = milliseconds(took), "answered"),
        }
    }
}

impl Drop for Account {
    fn drop(&mut self) {
        if !self.settled {
            self.metrics.request(&self.method, &self.route, CLIENT_GONE);
            tracing::info!(ms = milliseconds(self.arrival.elapsed()), "the client left");
        }
    }
}

/// Logs a failed request; no other place does.
fn log_error(error: &ApiError, status: u16, took: Duration) {
    let ms = milliseconds(took);
    match error.kind().reason() {
        Reason::Defect => tracing::error!(status, ms, %error, "failed"),
        Reason::Device => tracing::warn!(status, ms, %error, "failed"),
        Reason::Request | Reason::Capacity => tracing::info!(status, ms, %error, "refused"),
    }
}

/// Milliseconds, rounded to the microsecond.
fn milliseconds(duration: Duration) -> f64 {
    (duration.as_secs_f64() * 1e6).round() / 1e3
}
