//! `POST /v1/accuracy`: error against time of a scene.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tokio::runtime::Handle;
use tokio_util::sync::CancellationToken;
use utoipa::ToSchema;

use super::super::accept;
use super::super::error::ApiError;
use super::super::extract::{JsonBody, run_blocking};
use super::super::observe::Arrival;
use super::super::problem::AccuracyProblems;
use super::super::state::AppState;
use crate::frame::Frame;
use crate::gpu_queue::JobError;
use crate::lab::study::comparison;
use crate::lab::study::dial::Dial;
use crate::lab::study::equal_time;
use crate::lab::study::error_images::{error_images, method_images};
use crate::lab::study::plot::{convergence, error_against_time};
use crate::lab::study::report::{self, ReportLinks};
use crate::lab::study::study::{Study, StudyImages};
use crate::lab::study::sweep::{self, Refusal, StudyError, SweepSettings, run_study};
use crate::methods;
use crate::reference::{ReferenceError, TruthSettings, truth};
use crate::render::{Prepared, RenderError};
use crate::scene::parse::{from_value, read_json};
use crate::scene::{Issue, ResolvedScene, Scene, SceneError};

/// Media types of the answer; the first one wins among equals.
const OFFERED: [&str; 5] = [
    "application/json",
    "text/markdown",
    "text/csv",
    "image/svg+xml",
    "image/png",
];
/// Most timed runs of a setting.
const MOST_RUNS: u32 = 100;
/// Time between two tries to get a place in a full queue.
const FULL_QUEUE_PAUSE: Duration = Duration::from_millis(20);

/// A scene, and which dials to sweep.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AccuracyRequest {
    /// The scene; its `quality` holds the dials that are not swept.
    pub scene: Scene,
    /// Fields of `quality` and dials of methods, each with the values to sweep, 1 … 32 per dial. Default: the dials that matter
    /// to the scene.
    ///
    /// `method` as the only dial, without `grid`, compares methods: each is rendered at several `settings` of its own, at which its
    /// numbers grow together. Its values are `all` (every method with every word of its dials), a method's name, `name:all` (with every
    /// word of its dials), or a name with dials as `name:dial=value,dial=value`.
    #[serde(default)]
    #[schema(value_type = BTreeMap<String, Vec<Object>>)]
    pub dials: BTreeMap<String, Vec<Value>>,
    /// Whether to sweep all combinations of the dials instead of one dial at a time. Default false. At most 64 settings in all.
    #[serde(default)]
    pub grid: bool,
    /// Settings of each method of a comparison, 2 … 6: of 64, 128 … water cells, other dials in proportion. Default 4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 2, maximum = 6)]
    pub settings: Option<u32>,
    /// Timed runs of each setting, 1 … 100. Default 3.
    #[serde(default = "default_runs")]
    #[schema(minimum = 1, maximum = 100)]
    pub runs: u32,
    /// Largest relative L1 error of the float64 reference, by its own estimate, 0.000001 … 0.1. Default 0.005.
    #[serde(default = "default_truth_error")]
    #[schema(minimum = 0.000001, maximum = 0.1)]
    pub truth_error: f64,
}

fn default_runs() -> u32 {
    3
}

fn default_truth_error() -> f64 {
    5e-3
}

/// The result of a study.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct AccuracyAnswer {
    /// Errors and costs.
    pub study: Study,
    /// Error against time (SVG).
    pub error_against_time_svg: String,
    /// Convergence of each sweep (SVG), in the order of the sweeps. Empty in a comparison of methods.
    pub convergence_svg: Vec<String>,
    /// Renders, reference and errors side by side for each sweep (PNG, base64), in the order of the sweeps. In a comparison of methods one
    /// picture, of each method in about the same time.
    pub error_images_base64: Vec<String>,
}

/// Plots error against time of a scene.
///
/// The float64 reference is computed on the CPU. Then each setting of the dials is rendered, compared and timed. Other requests
/// are served in between, so the times vary more on a busy service. Only one study runs at a time. `Accept` selects the answer:
/// JSON with tables and plots, the report as Markdown, the table as CSV, or the plot of error against time as SVG or PNG. The
/// whole study has to finish before the deadline of requests.
#[utoipa::path(
    post, path = "/v1/accuracy", tag = "render",
    request_body(content = AccuracyRequest, description = "Scene and dials.", example = example_request),
    responses(
        (
            status = OK, description = "Error against time.",
            content(
                (AccuracyAnswer = "application/json"), (String = "text/markdown"), (String = "text/csv"),
                (String = "image/svg+xml"), (super::render::ImageFile = "image/png"),
            ),
        ),
        AccuracyProblems,
    )
)]
pub async fn accuracy(
    State(state): State<AppState>,
    Extension(Arrival(arrival)): Extension<Arrival>,
    headers: HeaderMap,
    JsonBody(body): JsonBody,
) -> Result<Response, ApiError> {
    let media_type = accept::best(&headers, &OFFERED)?;
    let reading = state.clone();
    let (resolved, settings, truth_error) = run_blocking(move || read(&body, &reading)).await?;
    state.require_trusted_device()?;
    let place = Arc::clone(state.studies())
        .try_acquire_owned()
        .map_err(|_| ApiError::StudyRunning)?;
    // Dropped with this future when the client leaves or the deadline passes.
    let cancel = CancellationToken::new();
    let guard = cancel.clone().drop_guard();
    let handle = Handle::current();
    let answer = run_blocking(move || {
        // Released when the work has ended, not when the client has left: the thread runs on for a short time after that.
        let _place = place;
        let found = study(
            &state,
            &resolved,
            &settings,
            truth_error,
            &cancel,
            &handle,
            arrival,
        )?;
        respond(media_type, &found.0, &found.1)
    })
    .await;
    drop(guard);
    answer
}

/// Reads the body into scene, sweep and error of the reference.
fn read(body: &Bytes, state: &AppState) -> Result<(ResolvedScene, SweepSettings, f64), ApiError> {
    let request: AccuracyRequest = from_value(&read_json(body)?).map_err(|issue| SceneError {
        issues: vec![issue],
    })?;
    let mut issues = Vec::new();
    if !(1..=MOST_RUNS).contains(&request.runs) {
        let detail = format!("{} is out of range", request.runs);
        issues.push(Issue::invalid(
            "/runs",
            detail,
            format!("an integer, 1 … {MOST_RUNS}"),
        ));
    }
    if let Some(settings) = request.settings
        && !comparison::RUNGS.contains(&settings)
    {
        issues.push(Issue::invalid(
            "/settings",
            format!("{settings} is out of range"),
            format!(
                "an integer, {} … {}",
                comparison::RUNGS.start(),
                comparison::RUNGS.end()
            ),
        ));
    }
    if !(1e-6..=0.1).contains(&request.truth_error) {
        let detail = format!("{} is out of range", request.truth_error);
        issues.push(Issue::invalid(
            "/truth_error",
            detail,
            "a number, 0.000001 … 0.1",
        ));
    }
    let mut dials = Vec::new();
    for (name, values) in &request.dials {
        let values = values.iter().map(|value| match value {
            Value::String(word) => word.clone(),
            other => other.to_string(),
        });
        match Dial::new(name, values.collect()) {
            Ok(dial) => dials.push(dial),
            Err(error) => issues.push(Issue::invalid(
                format!("/dials/{name}"),
                error.to_string(),
                "fields of `quality` and dials of methods, each with 1 … 32 values",
            )),
        }
    }
    let resolved = methods::resolve(request.scene, state.limits(), state);
    match resolved {
        Ok(resolved) if issues.is_empty() => {
            if dials.is_empty() {
                dials = Dial::for_scene(&resolved);
            }
            let settings = SweepSettings {
                dials,
                grid: request.grid,
                rungs: request.settings.unwrap_or(comparison::DEFAULT_RUNGS),
                runs: request.runs,
            };
            if request.settings.is_some() && !settings.is_comparison() {
                let issue = Issue::invalid(
                    "/settings",
                    "settings are those of a comparison of methods",
                    "no `settings`, or `method` as the only dial and no `grid`",
                );
                return Err(SceneError::from(issue).into());
            }
            // Check this before the reference is computed, which may take minutes.
            sweep::check(&resolved, &settings, state.limits()).map_err(refused)?;
            Ok((resolved, settings, request.truth_error))
        }
        Ok(_) => Err(SceneError { issues }.into()),
        Err(error) => {
            issues.extend(error.issues.into_iter().map(in_scene));
            Err(SceneError { issues }.into())
        }
    }
}

/// The place of a finding within the request.
fn in_scene(mut issue: Issue) -> Issue {
    issue.pointer = format!("/scene{}", issue.pointer);
    issue
}

fn study(
    state: &AppState,
    resolved: &ResolvedScene,
    settings: &SweepSettings,
    truth_error: f64,
    cancel: &CancellationToken,
    handle: &Handle,
    arrival: Instant,
) -> Result<(Study, StudyImages), ApiError> {
    let truth_settings = TruthSettings {
        target_error: Some(truth_error),
        disk: state.truth_cache().cloned(),
        ..TruthSettings::default()
    };
    let truth = truth(resolved, &truth_settings, &|_| {}, &|| {
        cancel.is_cancelled()
    })
    .map_err(|error| match error {
        ReferenceError::Cancelled => JobError::Cancelled.into(),
        other => ApiError::NoTruth(other.to_string()),
    })?;
    let mut render = |scene: ResolvedScene| {
        handle
            .block_on(one_frame(state, scene, cancel, arrival))
            .map_err(|error| match error {
                JobError::Render(RenderError::OverBudget { .. }) => Refusal::Setting(error),
                _ => Refusal::All(error),
            })
    };
    run_study(
        resolved,
        "",
        &truth,
        settings,
        state.limits(),
        &mut render,
        &mut |_, _, _| !cancel.is_cancelled(),
    )
    .map_err(refused)
}

/// The finding for a refusal of a study, at its place within the request.
fn refused(error: StudyError<JobError>) -> ApiError {
    match error {
        StudyError::Render(error) => error.into(),
        StudyError::Cancelled => JobError::Cancelled.into(),
        StudyError::Scene(error) => SceneError {
            issues: error.issues.into_iter().map(in_scene).collect(),
        }
        .into(),
        StudyError::TooMany { .. } | StudyError::TooLarge(_) => SceneError {
            issues: vec![Issue::invalid(
                "/dials",
                error.to_string(),
                "at most 64 settings",
            )],
        }
        .into(),
        StudyError::Metric(_) | StudyError::Edges(_) | StudyError::NothingLeft(_) => {
            ApiError::NoTruth(error.to_string())
        }
    }
}

/// Renders in between other requests; if the queue is full, the study waits. The scene is prepared on the study's own thread.
async fn one_frame(
    state: &AppState,
    scene: ResolvedScene,
    cancel: &CancellationToken,
    arrival: Instant,
) -> Result<Frame, JobError> {
    let turn = async {
        let place = loop {
            match state.queue().place(arrival) {
                Err(JobError::QueueFull { .. }) => tokio::time::sleep(FULL_QUEUE_PAUSE).await,
                place => break place?,
            }
        };
        let prepared = Prepared::new(scene).map_err(RenderError::from)?;
        state.queue().render(place, prepared).await
    };
    let answer = cancel.run_until_cancelled(turn).await;
    answer.unwrap_or(Err(JobError::Cancelled))
}

fn respond(
    media_type: &'static str,
    study: &Study,
    images: &StudyImages,
) -> Result<Response, ApiError> {
    let defect = |error: &dyn std::fmt::Display| ApiError::Panic(error.to_string());
    let typed = |body: String| ([(header::CONTENT_TYPE, media_type)], body).into_response();
    Ok(match media_type {
        "text/markdown" => typed(report::to_markdown(study, &ReportLinks::default())),
        "text/csv" => typed(report::to_csv(study)),
        "image/svg+xml" => typed(error_against_time(study).map_err(|e| defect(&e))?.svg),
        "image/png" => {
            let plot = error_against_time(study).map_err(|e| defect(&e))?;
            ([(header::CONTENT_TYPE, media_type)], plot.png).into_response()
        }
        _ => {
            let mut answer = AccuracyAnswer {
                study: study.clone(),
                error_against_time_svg: error_against_time(study).map_err(|e| defect(&e))?.svg,
                convergence_svg: Vec::new(),
                error_images_base64: Vec::new(),
            };
            if let Some(limit_ms) = equal_time::limit_ms(study).filter(|_| study.is_comparison()) {
                let sheet = method_images(study, images, limit_ms).map_err(|e| defect(&e))?;
                answer.error_images_base64.push(STANDARD.encode(sheet));
                return Ok(Json(answer).into_response());
            }
            for sweep in 0..study.sweeps.len() {
                let plot = convergence(study, sweep).map_err(|e| defect(&e))?;
                answer.convergence_svg.push(plot.svg);
                let sheet = error_images(study, images, sweep).map_err(|e| defect(&e))?;
                answer.error_images_base64.push(STANDARD.encode(sheet));
            }
            Json(answer).into_response()
        }
    })
}

/// The example request of the contract.
fn example_request() -> Value {
    let scene: Value = serde_json::from_str(include_str!("../../../scenes/sine_pool.json"))
        .expect("a scene of the repository is JSON");
    json!({ "scene": scene, "dials": { "water_cells": [64, 128, 256] } })
}
