//! Request bodies.

use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};

use super::error::ApiError;
use super::state::AppState;
use crate::methods;
use crate::render::{Prepared, RenderError};
use crate::scene::{ResolvedScene, Scene};

/// Media types that a scene is read from.
const SCENE_TYPES: &str = "application/json";

/// A scene in the body: read, validated, with its meshes.
#[derive(Clone, Debug)]
pub struct SceneBody(pub ResolvedScene);

impl FromRequest<AppState> for SceneBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        json_type(request.headers())?;
        let body = bytes(request, state).await?;
        let state = state.clone();
        // A scene may be as large as the body limit, so it is read on a blocking thread.
        run_blocking(move || {
            let scene = Scene::from_json(&body)?;
            let resolved = methods::resolve(scene, state.limits(), &state)?;
            Ok(Self(resolved))
        })
        .await
    }
}

/// A body with a JSON content type, not parsed yet.
#[derive(Clone, Debug)]
pub struct JsonBody(pub Bytes);

impl FromRequest<AppState> for JsonBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &AppState) -> Result<Self, ApiError> {
        json_type(request.headers())?;
        Ok(Self(bytes(request, state).await?))
    }
}

/// Refuses bodies without a JSON content type.
fn json_type(headers: &HeaderMap) -> Result<(), ApiError> {
    let media_type = media_type(headers);
    if media_type
        .as_deref()
        .is_some_and(|found| found == SCENE_TYPES || found.ends_with("+json"))
    {
        return Ok(());
    }
    Err(unsupported(media_type, SCENE_TYPES))
}

/// The whole body, up to `limits.max_body_bytes`.
pub(super) async fn bytes(request: Request, state: &AppState) -> Result<Bytes, ApiError> {
    Bytes::from_request(request, state)
        .await
        .map_err(|rejection| {
            ApiError::from_bytes_rejection(&rejection, state.limits().max_body_bytes)
        })
}

/// `Content-Type` in lower case, without parameters.
pub(super) fn media_type(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::CONTENT_TYPE)?.to_str().ok()?;
    let essence = value.split(';').next().unwrap_or_default();
    Some(essence.trim().to_ascii_lowercase())
}

/// The error of a wrong or missing `Content-Type`.
pub(super) fn unsupported(found: Option<String>, accepted: &'static str) -> ApiError {
    ApiError::UnsupportedMediaType {
        found: found.unwrap_or_else(|| "missing".to_owned()),
        accepted,
    }
}

/// Finds facts and warnings of a scene. This traces rays through its meshes, so it runs neither on a request thread nor on the
/// GPU thread.
pub(super) async fn prepare(resolved: ResolvedScene) -> Result<Prepared, ApiError> {
    run_blocking(move || Ok(Prepared::new(resolved).map_err(RenderError::from)?)).await
}

/// Runs work that would delay other requests on a blocking thread. A panic there becomes an error.
pub(super) async fn run_blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, ApiError> + Send + 'static,
) -> Result<T, ApiError> {
    match tokio::task::spawn_blocking(work).await {
        Ok(result) => result,
        Err(error) => Err(match error.try_into_panic() {
            Ok(panic) => ApiError::from_panic(&*panic),
            Err(_) => crate::gpu_queue::JobError::Cancelled.into(),
        }),
    }
}
