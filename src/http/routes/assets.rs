//! `/v1/assets`: upload, list, inspect, delete.

use axum::Json;
use axum::extract::{Path, Request, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::super::error::ApiError;
use super::super::extract::{bytes, media_type, run_blocking, unsupported};
use super::super::problem::{AssetProblems, AssetUploadProblems, CommonProblems};
use super::super::state::AppState;
use crate::fields::FieldInfo;

/// Media types that a file is read from.
const ASSET_TYPES: &str = "application/octet-stream, application/x-npy, image/png, image/x-exr or image/exr with an NPY, PNG or EXR; its first bytes say which";

/// What stands for the bytes of a file in the contract.
const EXAMPLE: &str = "(the bytes of the file)";

/// All stored assets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AssetList {
    /// By id.
    pub assets: Vec<FieldInfo>,
}

/// The bytes of a file.
#[derive(ToSchema)]
#[schema(value_type = String, format = Binary)]
#[expect(dead_code, reason = "the shape of a body, for the contract")]
pub struct AssetFile(Vec<u8>);

/// Lists the stored assets.
#[utoipa::path(
    get, path = "/v1/assets", tag = "assets",
    responses((status = OK, description = "All assets, sorted by id.", body = AssetList), CommonProblems)
)]
pub async fn list(State(state): State<AppState>) -> Json<AssetList> {
    Json(AssetList {
        assets: state.fields().list(),
    })
}

/// Stores a file of numbers: NPY, EXR, or PNG of 16 bits.
///
/// A `height_field` among `water.waves` names it by its id. The id is a hash of the uploaded bytes, so the same bytes have the same id on
/// every installation. Assets are kept until they are deleted or the process ends.
#[utoipa::path(
    post, path = "/v1/assets", tag = "assets",
    request_body(
        description = "The file. Its format is found from its first bytes, whatever the type says.",
        content(
            (AssetFile = "application/octet-stream", example = json!(EXAMPLE)),
            (AssetFile = "application/x-npy", example = json!(EXAMPLE)),
            (AssetFile = "image/png", example = json!(EXAMPLE)),
            (AssetFile = "image/x-exr", example = json!(EXAMPLE)),
            (AssetFile = "image/exr", example = json!(EXAMPLE)),
        )
    ),
    responses(
        (status = CREATED, description = "Stored.", body = FieldInfo, headers(("location", description = "Its address."))),
        (status = OK, description = "Stored already.", body = FieldInfo, headers(("location", description = "Its address."))),
        AssetUploadProblems,
    )
)]
pub async fn upload(State(state): State<AppState>, request: Request) -> Result<Response, ApiError> {
    let media_type = media_type(request.headers());
    match media_type.as_deref() {
        Some(
            "application/octet-stream"
            | "application/x-npy"
            | "image/png"
            | "image/x-exr"
            | "image/exr",
        ) => {}
        _ => return Err(unsupported(media_type, ASSET_TYPES)),
    }
    let file = bytes(request, &state).await?;
    let inserted = run_blocking(move || Ok(state.fields().insert(&file)?)).await?;
    let status = if inserted.created {
        StatusCode::CREATED
    } else {
        StatusCode::OK
    };
    let info = inserted.field.info();
    let location = [(header::LOCATION, format!("/v1/assets/{}", info.id))];
    Ok((status, location, Json(info)).into_response())
}

/// Describes one asset.
#[utoipa::path(
    get, path = "/v1/assets/{id}", tag = "assets",
    params(("id" = String, Path, description = "`blake3:…`, from the upload.")),
    responses((status = OK, description = "The asset, without its numbers.", body = FieldInfo), AssetProblems)
)]
pub async fn inspect(
    State(state): State<AppState>,
    Path(id): Path<String>,
) -> Result<Json<FieldInfo>, ApiError> {
    match state.fields().get(&id) {
        Some(field) => Ok(Json(field.info())),
        None => Err(ApiError::UnknownAsset { id }),
    }
}

/// Deletes an asset.
///
/// Renders requested before keep it until they end.
#[utoipa::path(
    delete, path = "/v1/assets/{id}", tag = "assets",
    params(("id" = String, Path, description = "`blake3:…`, from the upload.")),
    responses((status = NO_CONTENT, description = "Forgotten."), AssetProblems)
)]
pub async fn forget(
    State(state): State<AppState>,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    if state.fields().remove(&id) {
        Ok(StatusCode::NO_CONTENT)
    } else {
        Err(ApiError::UnknownAsset { id })
    }
}
