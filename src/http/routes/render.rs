//! `POST /v1/render`: renders a scene to a picture.

use std::fmt::Write as _;
use std::time::Instant;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::super::accept::{Representation, choose};
use super::super::error::ApiError;
use super::super::extract::{SceneBody, prepare, run_blocking};
use super::super::observe::Arrival;
use super::super::problem::RenderProblems;
use super::super::state::AppState;
use crate::frame::Frame;
use crate::gpu_queue::GpuStatus;
use crate::image::{Encoded, Metadata, encode};
use crate::scene::{Encoding, Scene};
use crate::stats::{AdapterStats, Stats};
use crate::tuning::chooses_dials;

/// Header with the hash of the canonical scene.
pub const SCENE_HASH: HeaderName = HeaderName::from_static("x-caustica-scene-hash");

/// Header with the time of each stage and pass.
pub const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");

/// The bytes of an image file.
#[derive(Clone, Debug, ToSchema)]
#[schema(value_type = String, format = Binary)]
pub struct ImageFile(pub Vec<u8>);

/// A render as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RenderAnswer {
    /// The file.
    pub image: InlineImage,
    /// Cost, energy, estimated accuracy and warnings.
    pub stats: Stats,
}

/// A file inside JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct InlineImage {
    /// `image/png` or `image/x-exr`.
    pub media_type: String,
    /// The bytes.
    #[schema(content_encoding = "base64")]
    pub base64: String,
}

/// Renders a scene.
///
/// Equal scenes give equal bytes on the same adapter and version, so the image has a strong `ETag`. If `If-None-Match` lists it,
/// the answer is 304 and nothing runs. With `Accept: application/json`, one answer has both image and stats. A render is
/// cancelled when its client disconnects.
#[utoipa::path(
    post, path = "/v1/render", tag = "render",
    params(
        ("if-none-match" = Option<String>, Header, description = "`ETag` of an image that the client has."),
    ),
    request_body(content = Scene, description = "The scene.", example = example_scene),
    responses(
        (
            status = OK, description = "The picture.",
            headers(
                ("etag", description = "Hash of the canonical scene, the program's version and the adapter; if `quality` requests an error or a time, also of what determines the chosen dials (calibration, memory and level-map budget). Images only."),
                ("server-timing", description = "ms: queue, plan, upload, gpu, readback, encode, total, and `pass-…` for each pass."),
                ("x-caustica-scene-hash", description = "`blake3:…` of the canonical scene."),
            ),
            content((ImageFile = "image/png"), (ImageFile = "image/x-exr"), (RenderAnswer = "application/json")),
        ),
        (
            status = NOT_MODIFIED, description = "The client's image is that of this scene.",
            headers(("etag", description = "Of the client's image.")),
        ),
        RenderProblems,
    )
)]
pub async fn render(
    State(state): State<AppState>,
    Extension(Arrival(arrival)): Extension<Arrival>,
    headers: HeaderMap,
    SceneBody(resolved): SceneBody,
) -> Result<Response, ApiError> {
    let encoding = resolved.scene.output.encoding();
    let representation = choose(&headers, encoding.format)?;
    let scene_hash = resolved.hash();
    let are_chosen = chooses_dials(&resolved.scene);
    let tag_on = |adapter: &AdapterStats, status: &GpuStatus| {
        let basis = are_chosen.then_some(status.dial_basis.as_str());
        entity_tag(&scene_hash, adapter, basis)
    };
    let status = state.queue().status();
    if representation == Representation::Image
        && let Some(tag) = status
            .adapter
            .as_ref()
            .map(|adapter| tag_on(adapter, &status))
        && has_tag(&headers, &tag)
    {
        let headers = [(header::ETAG, tag), (SCENE_HASH, scene_hash)];
        return Ok((StatusCode::NOT_MODIFIED, headers).into_response());
    }
    state.require_trusted_device()?;

    let place = state.queue().place(arrival)?;
    let prepared = prepare(resolved).await?;
    let mut frame = state.queue().render(place, prepared).await?;
    env!("CARGO_PKG_VERSION").clone_into(&mut frame.stats.version);
    frame.stats.scene_hash.clone_from(&scene_hash);
    let (encoded, stats) = run_blocking(move || encode_frame(frame, &encoding, arrival)).await?;
    state.metrics().rendered(arrival.elapsed());

    let tag = tag_on(&stats.adapter, &state.queue().status());
    let common = [
        (SERVER_TIMING, server_timing(&stats)),
        (SCENE_HASH, scene_hash),
        (header::VARY, "accept".to_owned()),
    ];
    Ok(match representation {
        Representation::Image => (
            common,
            [
                (header::ETAG, tag),
                (header::CONTENT_TYPE, encoded.media_type.to_owned()),
            ],
            encoded.bytes,
        )
            .into_response(),
        Representation::Json => {
            let answer = run_blocking(move || Ok(Json(inline(&encoded, stats)))).await?;
            (common, answer).into_response()
        }
    })
}

/// Encodes the file, not on the GPU thread, and completes the stats.
fn encode_frame(
    mut frame: Frame,
    encoding: &Encoding,
    arrival: Instant,
) -> Result<(Encoded, Stats), ApiError> {
    let started = Instant::now();
    let encoded = encode(&frame, encoding, &Metadata::of(&frame.stats))?;
    let stats = &mut frame.stats;
    stats.time_ms.encode = started.elapsed().as_secs_f64() * 1e3;
    stats.time_ms.total = arrival.elapsed().as_secs_f64() * 1e3;
    stats.warnings.extend(encoded.warnings.iter().cloned());
    Ok((encoded, frame.stats))
}

fn inline(encoded: &Encoded, stats: Stats) -> RenderAnswer {
    RenderAnswer {
        image: InlineImage {
            media_type: encoded.media_type.to_owned(),
            base64: STANDARD.encode(&encoded.bytes),
        },
        stats,
    }
}

/// A strong entity tag: a hash of everything that can change the bytes. `dial_basis` is given if the dials are chosen by the
/// program.
fn entity_tag(scene_hash: &str, adapter: &AdapterStats, dial_basis: Option<&str>) -> String {
    let parts = [
        scene_hash,
        env!("CARGO_PKG_VERSION"),
        &adapter.name,
        &adapter.backend,
        &adapter.driver,
    ];
    let mut hasher = blake3::Hasher::new();
    for part in parts.into_iter().chain(dial_basis) {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part.as_bytes());
    }
    format!("\"{}\"", hasher.finalize().to_hex())
}

/// Whether `If-None-Match` lists the tag (weak comparison, as RFC 9110 has it).
fn has_tag(headers: &HeaderMap, tag: &str) -> bool {
    headers
        .get_all(header::IF_NONE_MATCH)
        .iter()
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .map(|listed| listed.trim().trim_start_matches("W/"))
        .any(|listed| listed == tag)
}

/// The `Server-Timing` header: the stages in order, then every pass with a GPU time.
fn server_timing(stats: &Stats) -> String {
    let time = &stats.time_ms;
    let mut text = String::new();
    let stages = [
        ("queue", time.queue),
        ("plan", time.plan),
        ("upload", time.upload),
        ("gpu", time.gpu),
        ("readback", time.readback),
        ("encode", time.encode),
        ("total", time.total),
    ];
    for (name, ms) in stages {
        // Writing to a string cannot fail.
        let _ = write!(text, "{name};dur={ms:.3}, ");
    }
    for pass in &stats.passes {
        if let Some(ms) = pass.gpu_ms {
            let _ = write!(text, "pass-{};dur={ms:.3}, ", pass.name);
        }
    }
    text.truncate(text.len() - 2);
    text
}

/// The example scene, as its author wrote it.
pub const EXAMPLE_SCENE: &str = include_str!("../../../scenes/pool.json");

/// [`EXAMPLE_SCENE`] for the contract.
pub fn example_scene() -> serde_json::Value {
    serde_json::from_str(EXAMPLE_SCENE).expect("a scene of the repository is JSON")
}
