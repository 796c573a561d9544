//! All errors and their status: the only file with status codes of failures.

use std::any::Any;
use std::error::Error;

use axum::extract::multipart::{MultipartError, MultipartRejection};
use axum::extract::rejection::BytesRejection;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decode::{self, Undecodable};
use super::problem::Problem;
use crate::fields::FieldError;
use crate::gpu::GpuError;
use crate::gpu_queue::JobError;
use crate::image::EncodeError;
use crate::mesh::MeshError;
use crate::render::RenderError;
use crate::scene::{Issue, IssueKind, SceneError};

/// Seconds after which a client may try again when the device or the process is in transition.
const RECOVERY_RETRY_AFTER_S: u64 = 5;

/// Who has to act on a problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The request has to change.
    #[default]
    Request,
    /// Nobody: the service is overloaded at the moment.
    Capacity,
    /// Nobody, or the operator of the service: the GPU or the process is not able to work.
    Device,
    /// The developers: a defect of the program.
    Defect,
}

/// Declares the kinds of problem: name = status, last part of the type, title, who has to act.
macro_rules! problem_kinds {
    ($($(#[$doc:meta])* $name:ident = $status:ident, $slug:literal, $title:literal, $reason:ident;)+) => {
        /// A kind of problem; each has one type and one status.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ProblemKind {
            $($(#[$doc])* $name,)+
        }

        impl ProblemKind {
            /// Every kind.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// HTTP status.
            pub fn status(self) -> StatusCode {
                match self { $(Self::$name => StatusCode::$status,)+ }
            }

            /// Stable type, `urn:caustica:problem:…`.
            pub fn urn(self) -> &'static str {
                match self { $(Self::$name => concat!("urn:caustica:problem:", $slug),)+ }
            }

            /// Short title, the same for every occurrence.
            pub fn title(self) -> &'static str {
                match self { $(Self::$name => $title,)+ }
            }

            /// Who has to act.
            pub fn reason(self) -> Reason {
                match self { $(Self::$name => Reason::$reason,)+ }
            }
        }
    };
}

problem_kinds! {
    /// 400: the body of a scene request is not JSON, or has a number that no 64-bit float holds.
    MalformedJson = BAD_REQUEST, "malformed-json", "The body is not readable JSON", Request;
    /// 400: the body cannot be read (broken multipart, connection trouble).
    MalformedBody = BAD_REQUEST, "malformed-body", "The body cannot be read", Request;
    /// 400: a parameter in the URL's query is not valid.
    InvalidQuery = BAD_REQUEST, "invalid-query", "The query of the URL is not valid", Request;
    /// 404: no such route.
    NotFound = NOT_FOUND, "not-found", "There is nothing at this address", Request;
    /// 404: no mesh of that id.
    UnknownMesh = NOT_FOUND, "unknown-mesh", "There is no such mesh", Request;
    /// 404: no asset of that id.
    UnknownAsset = NOT_FOUND, "unknown-asset", "There is no such asset", Request;
    /// 405: the route does not support the method; `Allow` lists those it supports.
    MethodNotAllowed = METHOD_NOT_ALLOWED, "method-not-allowed", "The method is not supported here", Request;
    /// 406: none of the representations is acceptable.
    NotAcceptable = NOT_ACCEPTABLE, "not-acceptable", "No acceptable representation", Request;
    /// 413: the body is larger than `limits.max_body_bytes`.
    BodyTooLarge = PAYLOAD_TOO_LARGE, "body-too-large", "The body is too large", Request;
    /// 415: the route does not accept the body's media type.
    UnsupportedMediaType = UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", "The body has an unsupported type", Request;
    /// 415: the body's `Content-Encoding` is not decoded here; `Accept-Encoding` lists those that are.
    UnsupportedEncoding = UNSUPPORTED_MEDIA_TYPE, "unsupported-encoding", "The body has an unsupported encoding", Request;
    /// 422: the scene is JSON but not valid.
    InvalidScene = UNPROCESSABLE_ENTITY, "invalid-scene", "The scene is not valid", Request;
    /// 422: the scene exceeds a limit of this installation and has no other error.
    LimitExceeded = UNPROCESSABLE_ENTITY, "limit-exceeded", "The scene exceeds a limit", Request;
    /// 422: the scene names meshes that are not in the store and has no other error.
    MissingMesh = UNPROCESSABLE_ENTITY, "missing-mesh", "The scene names a mesh that is not stored", Request;
    /// 422: the scene names assets that are not in the store and has no other error.
    MissingAsset = UNPROCESSABLE_ENTITY, "missing-asset", "The scene names an asset that is not stored", Request;
    /// 422: the mesh cannot be used.
    InvalidMesh = UNPROCESSABLE_ENTITY, "invalid-mesh", "The mesh is not valid", Request;
    /// 422: the file cannot be used.
    InvalidAsset = UNPROCESSABLE_ENTITY, "invalid-asset", "The asset is not valid", Request;
    /// 422: the float64 reference cannot compute the requested output, or the output is dark, so that no relative error exists.
    NoTruth = UNPROCESSABLE_ENTITY, "no-truth", "There is no reference to compare with", Request;
    /// 422: the plan needs more GPU memory than is allowed.
    OverBudget = UNPROCESSABLE_ENTITY, "over-budget", "The scene needs too much GPU memory", Request;
    /// 429: the queue is full; `Retry-After` says when to try again.
    QueueFull = TOO_MANY_REQUESTS, "queue-full", "Too many requests are waiting", Capacity;
    /// 500: a defect of the program.
    Internal = INTERNAL_SERVER_ERROR, "internal", "Internal error", Defect;
    /// 503: no result before the deadline.
    DeadlinePassed = SERVICE_UNAVAILABLE, "deadline-passed", "No result before the deadline", Capacity;
    /// 503: there is no working GPU device.
    NotReady = SERVICE_UNAVAILABLE, "not-ready", "The service is not ready", Device;
    /// 503: the GPU device was lost twice, or hung, during this request.
    DeviceLost = SERVICE_UNAVAILABLE, "device-lost", "The GPU device was lost", Device;
    /// 503: the GPU has no memory left although the plan was within its budget.
    OutOfGpuMemory = SERVICE_UNAVAILABLE, "out-of-gpu-memory", "The GPU is out of memory", Device;
    /// 503: the service is shutting down.
    ShuttingDown = SERVICE_UNAVAILABLE, "shutting-down", "The service is shutting down", Device;
    /// 507: the mesh store has no room.
    MeshStoreFull = INSUFFICIENT_STORAGE, "mesh-store-full", "The mesh store is full", Capacity;
    /// 507: the asset store has no room.
    AssetStoreFull = INSUFFICIENT_STORAGE, "asset-store-full", "The asset store is full", Capacity;
}

impl ProblemKind {
    /// Whether the same request may succeed later.
    pub fn retryable(self) -> bool {
        matches!(self.reason(), Reason::Capacity | Reason::Device)
    }

    /// Whether `Retry-After` is sent: not for a full store, from which something has to be deleted first.
    pub fn sends_retry_after(self) -> bool {
        self.retryable() && !matches!(self, Self::MeshStoreFull | Self::AssetStoreFull)
    }
}

/// Why a request failed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ApiError {
    /// The body cannot be read.
    #[error("the body cannot be read: {0}")]
    MalformedBody(String),
    /// Parameters of the query are refused; every finding names its parameter.
    #[error("the query is not valid: {}", details(.0))]
    InvalidQuery(Vec<Issue>),
    /// No such route.
    #[error("there is no route {path}; GET /openapi.yaml lists the routes")]
    NotFound {
        /// Path asked for.
        path: String,
    },
    /// No mesh of that id.
    #[error("there is no mesh {id}; GET /v1/meshes lists those that are stored")]
    UnknownMesh {
        /// Id asked for.
        id: String,
    },
    /// No asset of that id.
    #[error("there is no asset {id}; GET /v1/assets lists those that are stored")]
    UnknownAsset {
        /// Id asked for.
        id: String,
    },
    /// The route does not support the method.
    #[error("{method} is not supported at {path}; the Allow header lists the supported methods")]
    MethodNotAllowed {
        /// Method used.
        method: String,
        /// Path asked for.
        path: String,
    },
    /// None of the representations is acceptable.
    #[error("the Accept header excludes all available media types: {offered}")]
    NotAcceptable {
        /// Media types that could be sent.
        offered: String,
    },
    /// The body is too large.
    #[error(
        "the body has more than {limit_bytes} bytes, the limit; an encoded body counts decoded"
    )]
    BodyTooLarge {
        /// The limit, bytes.
        limit_bytes: usize,
    },
    /// The route does not accept the body's media type.
    #[error("Content-Type is {found}; accepted: {accepted}")]
    UnsupportedMediaType {
        /// Media type of the request, or `missing`.
        found: String,
        /// Media types accepted here.
        accepted: &'static str,
    },
    /// The body is in an encoding that is not decoded.
    #[error(
        "Content-Encoding is {found}; accepted: one of {}, or none",
        decode::ACCEPTED
    )]
    UnsupportedEncoding {
        /// Encodings of the request.
        found: String,
    },
    /// The scene is refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The mesh is refused.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The file is refused.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The GPU queue returned an error.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A study of accuracy is running; there is room for one.
    #[error("another study of accuracy is running; one at a time")]
    StudyRunning,
    /// The scene cannot be compared with the float64 reference.
    #[error("no float64 reference: {0}")]
    NoTruth(String),
    /// The service does not take work now.
    #[error("not ready: {}", reasons.join("; "))]
    NotReady {
        /// One sentence each.
        reasons: Vec<String>,
    },
    /// The frame cannot be written as a file: a defect.
    #[error("encoding failed: {0}")]
    Encode(#[from] EncodeError),
    /// A handler panicked: a defect.
    #[error("a handler panicked: {0}")]
    Panic(String),
}

impl ApiError {
    /// Its kind, which determines type and status.
    pub fn kind(&self) -> ProblemKind {
        match self {
            Self::MalformedBody(_) => ProblemKind::MalformedBody,
            Self::InvalidQuery(_) => ProblemKind::InvalidQuery,
            Self::NotFound { .. } => ProblemKind::NotFound,
            Self::UnknownMesh { .. } => ProblemKind::UnknownMesh,
            Self::UnknownAsset { .. } => ProblemKind::UnknownAsset,
            Self::MethodNotAllowed { .. } => ProblemKind::MethodNotAllowed,
            Self::NotAcceptable { .. } => ProblemKind::NotAcceptable,
            Self::BodyTooLarge { .. } => ProblemKind::BodyTooLarge,
            Self::UnsupportedMediaType { .. } => ProblemKind::UnsupportedMediaType,
            Self::UnsupportedEncoding { .. } => ProblemKind::UnsupportedEncoding,
            Self::Scene(error) => scene_kind(error),
            Self::Mesh(MeshError::StoreFull { .. }) => ProblemKind::MeshStoreFull,
            Self::Mesh(_) => ProblemKind::InvalidMesh,
            Self::Field(FieldError::StoreFull { .. }) => ProblemKind::AssetStoreFull,
            Self::Field(_) => ProblemKind::InvalidAsset,
            Self::Job(error) => job_kind(error),
            Self::StudyRunning => ProblemKind::QueueFull,
            Self::NoTruth(_) => ProblemKind::NoTruth,
            Self::NotReady { .. } => ProblemKind::NotReady,
            Self::Encode(_) | Self::Panic(_) => ProblemKind::Internal,
        }
    }

    /// Seconds after which the same request may succeed, if known.
    pub fn retry_after_s(&self) -> Option<u64> {
        match self {
            Self::Job(JobError::QueueFull { retry_after_s, .. }) => Some(*retry_after_s),
            _ => self
                .kind()
                .sends_retry_after()
                .then_some(RECOVERY_RETRY_AFTER_S),
        }
    }

    /// From a body that was not read in full; `limit_bytes` is the limit it was read under.
    pub(super) fn from_bytes_rejection(rejection: &BytesRejection, limit_bytes: usize) -> Self {
        Self::from_body_status(rejection.status(), rejection, limit_bytes)
    }

    /// From a multipart body that is incomplete or malformed.
    pub(super) fn from_multipart(error: &MultipartError, limit_bytes: usize) -> Self {
        Self::from_body_status(error.status(), error, limit_bytes)
    }

    /// From a request that claims to be multipart and is not.
    pub(super) fn from_multipart_rejection(_: &MultipartRejection) -> Self {
        Self::MalformedBody(
            "Content-Type has no valid boundary; accepted: multipart/form-data; boundary=…"
                .to_owned(),
        )
    }

    /// From a caught panic.
    pub(super) fn from_panic(panic: &(dyn Any + Send)) -> Self {
        let message = panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned());
        Self::Panic(message.unwrap_or_else(|| "no message".to_owned()))
    }

    fn from_body_status(
        status: StatusCode,
        error: &(dyn Error + 'static),
        limit_bytes: usize,
    ) -> Self {
        if status == StatusCode::PAYLOAD_TOO_LARGE {
            return Self::BodyTooLarge { limit_bytes };
        }
        // The deepest cause says what happened; those around it only say that the body was being read.
        let mut cause = error;
        while let Some(deeper) = cause.source()
            && !cause.is::<Undecodable>()
        {
            cause = deeper;
        }
        Self::MalformedBody(cause.to_string())
    }
}

impl From<RenderError> for ApiError {
    fn from(error: RenderError) -> Self {
        Self::Job(JobError::Render(error))
    }
}

/// All findings in one line.
fn details(issues: &[Issue]) -> String {
    let all: Vec<&str> = issues.iter().map(|issue| issue.detail.as_str()).collect();
    all.join("; ")
}

fn scene_kind(error: &SceneError) -> ProblemKind {
    match error.kind() {
        IssueKind::Syntax => ProblemKind::MalformedJson,
        IssueKind::Invalid => ProblemKind::InvalidScene,
        IssueKind::LimitExceeded => ProblemKind::LimitExceeded,
        IssueKind::UnknownMesh => ProblemKind::MissingMesh,
        IssueKind::UnknownAsset => ProblemKind::MissingAsset,
    }
}

fn job_kind(error: &JobError) -> ProblemKind {
    match error {
        JobError::QueueFull { .. } => ProblemKind::QueueFull,
        JobError::DeadlinePassed { .. } => ProblemKind::DeadlinePassed,
        JobError::Cancelled => ProblemKind::ShuttingDown,
        JobError::Unavailable(_) => ProblemKind::NotReady,
        JobError::Panicked(_) => ProblemKind::Internal,
        JobError::Render(error) => match error {
            RenderError::Scene(error) => scene_kind(error),
            RenderError::OverBudget { .. } => ProblemKind::OverBudget,
            RenderError::NotFinite { .. } => ProblemKind::Internal,
            RenderError::Cancelled => ProblemKind::ShuttingDown,
            RenderError::Gpu(error) => match error {
                GpuError::NoAdapter(_) => ProblemKind::NotReady,
                GpuError::DeviceLost(_) | GpuError::Timeout(_) => ProblemKind::DeviceLost,
                GpuError::OutOfMemory(_) => ProblemKind::OutOfGpuMemory,
                GpuError::Validation(_) | GpuError::Shader { .. } => ProblemKind::Internal,
            },
        },
    }
}

/// The problem as `application/problem+json`. Nothing is logged here: the error travels in the response's extensions to
/// [`super::observe`].
impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let body = serde_json::to_vec(&Problem::of(&self)).expect("a problem always serialises");
        let mut response = (self.kind().status(), body).into_response();
        response.headers_mut().insert(
            header::CONTENT_TYPE,
            HeaderValue::from_static(super::problem::MEDIA_TYPE),
        );
        if let Some(seconds) = self.retry_after_s() {
            response
                .headers_mut()
                .insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if matches!(self, Self::UnsupportedEncoding { .. }) {
            response.headers_mut().insert(
                header::ACCEPT_ENCODING,
                HeaderValue::from_static(decode::ACCEPTED),
            );
        }
        response.extensions_mut().insert(self);
        response
    }
}
