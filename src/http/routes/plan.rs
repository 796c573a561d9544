//! `POST /v1/plan`: the passes that a scene would run, and why.

use axum::extract::State;
use axum::{Extension, Json};

use super::super::error::ApiError;
use super::super::extract::{SceneBody, prepare};
use super::super::observe::Arrival;
use super::super::problem::PlanProblems;
use super::super::state::AppState;
use super::render::example_scene;
use crate::plan::Plan;
use crate::scene::Scene;

/// Plans a scene.
///
/// The plan takes into account what is cached now, so a plan after a render may be shorter. If `quality` requests an error or a
/// time, trial renders of the light run to choose the dials; otherwise nothing runs.
#[utoipa::path(
    post, path = "/v1/plan", tag = "render",
    request_body(content = Scene, description = "The scene.", example = example_scene),
    responses((status = OK, description = "Passes, reasons, bytes.", body = Plan), PlanProblems)
)]
pub async fn plan(
    State(state): State<AppState>,
    Extension(Arrival(arrival)): Extension<Arrival>,
    SceneBody(resolved): SceneBody,
) -> Result<Json<Plan>, ApiError> {
    let place = state.queue().place(arrival)?;
    let prepared = prepare(resolved).await?;
    Ok(Json(state.queue().plan(place, prepared).await?))
}
