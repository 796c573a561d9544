//! `/healthz` and `/readyz`.

use axum::Json;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::super::error::ApiError;
use super::super::problem::{CommonProblems, ReadyProblems};
use super::super::state::AppState;
use crate::render::SelfCheck;
use crate::stats::AdapterStats;

/// The process answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Alive {
    /// Program version.
    pub version: String,
}

/// The service takes work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Ready {
    /// Whether the queue has a place for a request sent now. A full queue does not make the service unready.
    pub would_accept_work: bool,
    /// Jobs that wait or run.
    pub queue_depth: usize,
    /// Jobs that may wait or run.
    pub queue_capacity: usize,
    /// The adapter it runs on.
    pub adapter: Option<AdapterStats>,
    /// Result of the self-check (GPU against float64 physics).
    pub self_check: Option<SelfCheck>,
}

/// Whether the process is alive.
///
/// It does not depend on the GPU: a process that waits for its device must not be restarted.
#[utoipa::path(
    get, path = "/healthz", tag = "service",
    responses((status = OK, description = "Alive.", body = Alive), CommonProblems)
)]
pub async fn alive() -> Json<Alive> {
    Json(Alive {
        version: env!("CARGO_PKG_VERSION").to_owned(),
    })
}

/// Whether work should be sent here.
///
/// 200 when an adapter is open, its self-check passed, and the service is not shutting down. Never waits for the GPU.
#[utoipa::path(
    get, path = "/readyz", tag = "service",
    responses((status = OK, description = "Ready.", body = Ready), ReadyProblems)
)]
pub async fn ready(State(state): State<AppState>) -> Result<Json<Ready>, ApiError> {
    let reasons = state.obstacles();
    if !reasons.is_empty() {
        return Err(ApiError::NotReady { reasons });
    }
    let status = state.queue().status();
    let queue_depth = state.queue().depth();
    let queue_capacity = state.queue().settings().waiting + 1;
    Ok(Json(Ready {
        would_accept_work: queue_depth < queue_capacity,
        queue_depth,
        queue_capacity,
        adapter: status.adapter,
        self_check: status.self_check,
    }))
}
