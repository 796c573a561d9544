//! `/v1/meshes`: upload, list, inspect, delete.

use std::sync::Arc;
use std::time::Instant;

use axum::body::Bytes;
use axum::extract::{FromRequest, Multipart, Path, Request, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::super::error::ApiError;
use super::super::extract::{bytes, media_type, run_blocking, unsupported};
use super::super::observe::Arrival;
use super::super::problem::{CommonProblems, MeshProblems, Problem, UploadProblems};
use super::super::state::AppState;
use super::super::warm::{WarmParameters, WarmQuery};
use crate::cache::{WarmUp, WarmedMap};
use crate::mesh::{Mesh, MeshInfo};

/// Media types that a mesh is read from.
const MESH_TYPES: &str = "text/plain, model/obj or application/octet-stream with an OBJ, or multipart/form-data with a \
                          part `obj` and a part `mtl` for each file of materials";

/// A small example OBJ.
const EXAMPLE_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n";

/// All stored meshes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeshList {
    /// By id.
    pub meshes: Vec<MeshInfo>,
}

/// A stored mesh, and the level maps built for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Uploaded {
    /// The mesh.
    #[serde(flatten)]
    pub mesh: MeshInfo,
    /// The level maps requested by `warm`, in the order of their suns; empty if they could not be built. Absent if none were
    /// requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warmed: Option<Vec<WarmedMap>>,
    /// Why the level maps could not be built: the problem that a render would answer. The mesh is stored nevertheless, and frames
    /// build the maps they need. The same upload can be repeated to try again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warm_problem: Option<Problem>,
}

/// An upload with materials.
#[derive(ToSchema)]
#[expect(
    dead_code,
    reason = "the shape of a form, for the contract; parts are read one by one"
)]
pub struct MeshForm {
    /// The Wavefront OBJ, in metres.
    #[schema(content_media_type = "model/obj")]
    obj: String,
    /// The MTL files that the OBJ names, each in a part of this name; only `Kd` is used. If several have a material of the same name,
    /// that of the first part counts.
    #[schema(content_media_type = "model/mtl")]
    mtl: Option<Vec<String>>,
}

/// Lists the stored meshes.
#[utoipa::path(
    get, path = "/v1/meshes", tag = "meshes",
    responses((status = OK, description = "All meshes, sorted by id.", body = MeshList), CommonProblems)
)]
pub async fn list(State(state): State<AppState>) -> Json<MeshList> {
    Json(MeshList {
        meshes: state.meshes().list(),
    })
}

/// Stores a mesh.
///
/// The id is a hash of the uploaded bytes, so the same bytes have the same id on every installation. Meshes are kept until they
/// are deleted or the process ends.
///
/// With `warm`, the level maps for the given suns are built before the answer, so that the first frame under one of these suns
/// finds them in the cache. This waits for the GPU like a render. If it fails, the mesh is stored nevertheless, and
/// `warm_problem` in the answer says why (for instance `urn:caustica:problem:queue-full`, `…:over-budget`).
#[utoipa::path(
    post, path = "/v1/meshes", tag = "meshes",
    params(WarmParameters),
    request_body(
        description = "A Wavefront OBJ in metres, alone or with its MTL files.",
        content(
            (String = "text/plain", example = json!(EXAMPLE_OBJ)),
            (String = "model/obj", example = json!(EXAMPLE_OBJ)),
            (String = "application/octet-stream", example = json!(EXAMPLE_OBJ)),
            (MeshForm = "multipart/form-data", example = json!({
                "obj": EXAMPLE_OBJ, "mtl": ["newmtl sand\nKd 0.7 0.65 0.5\n"]
            })),
        )
    ),
    responses(
        (status = CREATED, description = "Stored.", body = Uploaded, headers(("location", description = "Its address."))),
        (status = OK, description = "Stored already.", body = Uploaded, headers(("location", description = "Its address."))),
        UploadProblems,
    )
)]
pub async fn upload(
    State(state): State<AppState>,
    Extension(Arrival(arrival)): Extension<Arrival>,
    WarmQuery(wanted): WarmQuery,
    request: Request,
) -> Result<Response, ApiError> {
    let media_type = media_type(request.headers());
    let files = match media_type.as_deref() {
        Some("text/plain" | "model/obj" | "application/octet-stream") => MeshFiles {
            obj: bytes(request, &state).await?,
            mtls: Vec::new(),
        },
        Some("multipart/form-data") => read_form(request, &state).await?,
        _ => return Err(unsupported(media_type, MESH_TYPES)),
    };
    let store = state.clone();
    let inserted = run_blocking(move || {
        let store = store.meshes();
        let mtls: Vec<&[u8]> = files.mtls.iter().map(|mtl| &**mtl).collect();
        Ok(store.insert_obj(&files.obj, &mtls)?)
    })
    .await?;
    let mut uploaded = Uploaded {
        mesh: inserted.mesh.info(),
        warmed: None,
        warm_problem: None,
    };
    let mut failure = None;
    if let Some(wanted) = wanted {
        match warm(&state, inserted.mesh, wanted, arrival).await {
            Ok(maps) => uploaded.warmed = Some(maps),
            Err(error) => {
                uploaded.warmed = Some(Vec::new());
                uploaded.warm_problem = Some(Problem::of(&error));
                failure = Some(Extension(error));
            }
        }
    }
    let status = if inserted.created {
        StatusCode::CREATED
    } else {
        StatusCode::OK
    };
    let location = [(header::LOCATION, format!("/v1/meshes/{}", uploaded.mesh.id))];
    // The failure is logged and counted where those of whole requests are.
    Ok((status, failure, location, Json(uploaded)).into_response())
}

/// Builds level maps of a stored mesh.
async fn warm(
    state: &AppState,
    mesh: Arc<Mesh>,
    wanted: WarmUp,
    arrival: Instant,
) -> Result<Vec<WarmedMap>, ApiError> {
    state.require_trusted_device()?;
    Ok(state.queue().warm(mesh, wanted, arrival).await?)
}

/// Describes one mesh.
#[utoipa::path(
    get, path = "/v1/meshes/{id}", tag = "meshes",
    params(("id" = String, Path, description = "`blake3:…`, from the upload.")),
    responses((status = OK, description = "The mesh, without its triangles.", body = MeshInfo), MeshProblems)
)]
pub async fn inspect(
    State(state): State<AppState>,
    Path(id): Path<String>,
) -> Result<Json<MeshInfo>, ApiError> {
    match state.meshes().get(&id) {
        Some(mesh) => Ok(Json(mesh.info())),
        None => Err(ApiError::UnknownMesh { id }),
    }
}

/// Deletes a mesh and what is cached for it.
///
/// Renders requested before keep it until they end.
#[utoipa::path(
    delete, path = "/v1/meshes/{id}", tag = "meshes",
    params(("id" = String, Path, description = "`blake3:…`, from the upload.")),
    responses((status = NO_CONTENT, description = "Forgotten."), MeshProblems)
)]
pub async fn forget(
    State(state): State<AppState>,
    Path(id): Path<String>,
) -> Result<StatusCode, ApiError> {
    if !state.meshes().remove(&id) {
        return Err(ApiError::UnknownMesh { id });
    }
    state.queue().forget_mesh(&id);
    Ok(StatusCode::NO_CONTENT)
}

/// The files of an upload.
struct MeshFiles {
    obj: Bytes,
    mtls: Vec<Bytes>,
}

async fn read_form(request: Request, state: &AppState) -> Result<MeshFiles, ApiError> {
    let limit = state.limits().max_body_bytes;
    let broken = |error| ApiError::from_multipart(&error, limit);
    let mut form = Multipart::from_request(request, state)
        .await
        .map_err(|rejection| ApiError::from_multipart_rejection(&rejection))?;
    let (mut obj, mut mtls) = (None, Vec::new());
    while let Some(part) = form.next_field().await.map_err(broken)? {
        let name = part.name().unwrap_or_default().to_owned();
        let bytes = part.bytes().await.map_err(broken)?;
        match name.as_str() {
            "obj" if obj.is_none() => obj = Some(bytes),
            "mtl" => mtls.push(bytes),
            "obj" => {
                return Err(ApiError::MalformedBody(
                    "the form has the part `obj` twice; once is accepted".to_owned(),
                ));
            }
            _ => {
                return Err(ApiError::MalformedBody(format!(
                    "the form has a part `{name}`; accepted are `obj` and `mtl`"
                )));
            }
        }
    }
    let obj = obj.ok_or_else(|| {
        ApiError::MalformedBody("the form has no part `obj`; it is needed".to_owned())
    })?;
    Ok(MeshFiles { obj, mtls })
}
