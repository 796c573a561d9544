//! `/v1/info`: version, adapter, limits, features.

use std::collections::BTreeMap;

use axum::Json;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::super::problem::CommonProblems;
use super::super::state::AppState;
use crate::config::Limits;
use crate::methods;
use crate::scene::{Dispersion, ExrPixel, ImageFormat, LayerName, MethodChoice, ToneCurve};
use crate::stats::AdapterStats;

/// Version, adapter and limits of the service.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Info {
    /// Program version.
    pub version: String,
    /// The adapter; absent until one is open.
    pub adapter: Option<AdapterStats>,
    /// Whether the adapter is a software driver on the CPU; absent until one is open.
    pub software: Option<bool>,
    /// Limits of a request.
    pub limits: Limits,
    /// GPU memory that one frame may hold, bytes.
    pub memory_budget_bytes: u64,
    /// GPU memory for cached level maps, bytes.
    pub level_map_budget_bytes: u64,
    /// GPU memory for kept fields of light, bytes.
    pub field_budget_bytes: u64,
    /// Requests that may wait for the GPU.
    pub queue: usize,
    /// Time from arrival after which a request is answered 503, s.
    pub deadline_s: f64,
    /// Accepted words of the scene's fields, by the name of their schema in `/openapi.yaml`.
    pub features: BTreeMap<String, Vec<String>>,
}

/// Version, adapter, limits and accepted words.
#[utoipa::path(
    get, path = "/v1/info", tag = "service",
    responses((status = OK, description = "Version, adapter, limits, features.", body = Info), CommonProblems)
)]
pub async fn info(State(state): State<AppState>) -> Json<Info> {
    let adapter = state.queue().status().adapter;
    let settings = state.queue().settings();
    let config = state.render_config();
    Json(Info {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        software: adapter.as_ref().map(|adapter| adapter.software),
        adapter,
        limits: *state.limits(),
        memory_budget_bytes: config.memory_budget_bytes(),
        level_map_budget_bytes: config.level_map_budget_bytes(),
        field_budget_bytes: config.field_budget_bytes(),
        queue: settings.waiting,
        deadline_s: settings.deadline.as_secs_f64(),
        features: features(),
    })
}

/// The words of the scene's enumerations, read from their schemas so that they are always up to date.
fn features() -> BTreeMap<String, Vec<String>> {
    [
        words::<Dispersion>(),
        words::<ExrPixel>(),
        words::<ImageFormat>(),
        words::<LayerName>(),
        (
            MethodChoice::name().into_owned(),
            methods::ALL.map(|method| method.name.to_owned()).into(),
        ),
        words::<ToneCurve>(),
    ]
    .into()
}

fn words<T: ToSchema>() -> (String, Vec<String>) {
    let schema = serde_json::to_value(T::schema()).unwrap_or_default();
    let words = schema["enum"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|word| word.as_str().map(str::to_owned))
        .collect();
    (T::name().into_owned(), words)
}
