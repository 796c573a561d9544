//! Problem documents (RFC 9457): how errors are answered, and how the contract documents them.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::openapi::{ContentBuilder, Header, Ref, RefOr, Response, ResponseBuilder};
use utoipa::{IntoResponses, PartialSchema as _, ToSchema};

use super::error::{ApiError, ProblemKind, Reason};
use crate::fields::FieldError;
use crate::gpu_queue::JobError;
use crate::mesh::MeshError;
use crate::render::RenderError;
use crate::scene::Issue;

/// Media type of a problem.
pub const MEDIA_TYPE: &str = "application/problem+json";

/// Why a request failed (RFC 9457).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Stable identifier of the kind, `urn:caustica:problem:…`.
    #[serde(rename = "type")]
    pub kind: String,
    /// Title of the kind; the same for every occurrence.
    pub title: String,
    /// HTTP status.
    pub status: u16,
    /// What is wrong in this request, and what is accepted.
    pub detail: String,
    /// Who has to act.
    pub reason: Reason,
    /// Whether the same request may succeed later.
    pub retryable: bool,
    /// All findings about the scene, each with its place, or about the query, each with its parameter.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<Issue>,
    /// Reasons why the service does not work, one sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<String>,
    /// Bytes needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub needed_bytes: Option<u64>,
    /// Bytes allowed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget_bytes: Option<u64>,
}

impl Problem {
    /// The problem document of an error.
    pub fn of(error: &ApiError) -> Self {
        let kind = error.kind();
        let mut problem = Self {
            kind: kind.urn().to_owned(),
            title: kind.title().to_owned(),
            status: kind.status().as_u16(),
            detail: error.to_string(),
            reason: kind.reason(),
            retryable: kind.retryable(),
            ..Self::default()
        };
        match error {
            ApiError::Scene(error) | ApiError::Job(JobError::Render(RenderError::Scene(error))) => {
                problem.detail = summary(&error.issues);
                problem.errors.clone_from(&error.issues);
            }
            ApiError::InvalidQuery(issues) => {
                problem.detail = summary(issues);
                problem.errors.clone_from(issues);
            }
            ApiError::Job(JobError::Render(RenderError::OverBudget {
                needed_bytes,
                budget_bytes,
                ..
            }))
            | ApiError::Mesh(MeshError::StoreFull {
                needed_bytes,
                budget_bytes,
                ..
            })
            | ApiError::Field(FieldError::StoreFull {
                needed_bytes,
                budget_bytes,
                ..
            }) => {
                problem.needed_bytes = Some(*needed_bytes);
                problem.budget_bytes = Some(*budget_bytes);
            }
            ApiError::Job(JobError::Unavailable(why)) => problem.obstacles.push(why.clone()),
            ApiError::NotReady { reasons } => problem.obstacles.clone_from(reasons),
            _ => {}
        }
        if kind == ProblemKind::Internal {
            // Details of a defect are for the log only.
            problem.detail =
                "a defect of the program; the log has the details under the x-request-id"
                    .to_owned();
        }
        problem
    }
}

/// The first finding and the number of further ones, in one line.
fn summary(issues: &[Issue]) -> String {
    match issues {
        [] => "the scene is not valid".to_owned(),
        [only] => in_place(only),
        [first, rest @ ..] => format!("{} (and {} more)", in_place(first), rest.len()),
    }
}

fn in_place(issue: &Issue) -> String {
    match issue.pointer.as_str() {
        "" => issue.detail.clone(),
        pointer => format!("{pointer}: {}", issue.detail),
    }
}

/// Declares the sets of problems that groups of routes can answer, for the contract.
macro_rules! problem_sets {
    ($($(#[$doc:meta])* $name:ident = [$($kind:ident),+ $(,)?];)+) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl IntoResponses for $name {
            fn responses() -> BTreeMap<String, RefOr<Response>> {
                documented(&[$(ProblemKind::$kind),+])
            }
        }
    )+};
}

problem_sets! {
    /// Of routes that only read available data.
    CommonProblems = [Internal, DeadlinePassed];
    /// Of routes about one mesh.
    MeshProblems = [UnknownMesh, Internal, DeadlinePassed];
    /// Of the upload of a mesh.
    UploadProblems = [
        InvalidQuery, MalformedBody, BodyTooLarge, UnsupportedMediaType, UnsupportedEncoding, InvalidMesh, Internal, DeadlinePassed, MeshStoreFull,
    ];
    /// Of routes about one asset.
    AssetProblems = [UnknownAsset, Internal, DeadlinePassed];
    /// Of the upload of an asset.
    AssetUploadProblems = [
        MalformedBody, BodyTooLarge, UnsupportedMediaType, UnsupportedEncoding, InvalidAsset, Internal, DeadlinePassed, AssetStoreFull,
    ];
    /// Of the plan.
    PlanProblems = [
        MalformedJson, MalformedBody, BodyTooLarge, UnsupportedMediaType, UnsupportedEncoding, InvalidScene, LimitExceeded, MissingMesh,
        MissingAsset, OverBudget, QueueFull, Internal, DeadlinePassed, NotReady, DeviceLost, OutOfGpuMemory, ShuttingDown,
    ];
    /// Of the render.
    RenderProblems = [
        MalformedJson, MalformedBody, NotAcceptable, BodyTooLarge, UnsupportedMediaType, UnsupportedEncoding, InvalidScene, LimitExceeded,
        MissingMesh, MissingAsset, OverBudget, QueueFull, Internal, DeadlinePassed, NotReady, DeviceLost, OutOfGpuMemory, ShuttingDown,
    ];
    /// Of the study of accuracy.
    AccuracyProblems = [
        MalformedJson, MalformedBody, NotAcceptable, BodyTooLarge, UnsupportedMediaType, UnsupportedEncoding, InvalidScene, LimitExceeded,
        MissingMesh, MissingAsset, NoTruth, OverBudget, QueueFull, Internal, DeadlinePassed, NotReady, DeviceLost, OutOfGpuMemory,
        ShuttingDown,
    ];
    /// Of the readiness probe.
    ReadyProblems = [Internal, DeadlinePassed, NotReady];
}

/// One response per status, listing the types behind it.
fn documented(kinds: &[ProblemKind]) -> BTreeMap<String, RefOr<Response>> {
    let mut by_status: BTreeMap<String, Vec<ProblemKind>> = BTreeMap::new();
    for kind in kinds {
        let status = kind.status().as_str().to_owned();
        by_status.entry(status).or_default().push(*kind);
    }
    by_status
        .into_iter()
        .map(|(status, kinds)| (status, RefOr::T(response(&kinds))))
        .collect()
}

/// The kinds of one status.
fn response(kinds: &[ProblemKind]) -> Response {
    let lines: Vec<String> = kinds
        .iter()
        .map(|kind| format!("`{}`: {}.", kind.urn(), kind.title()))
        .collect();
    let content = ContentBuilder::new()
        .schema(Some(Ref::from_schema_name("Problem")))
        .build();
    let mut response = ResponseBuilder::new()
        .description(lines.join("\n\n"))
        .content(MEDIA_TYPE, content);
    if kinds.iter().any(|kind| kind.sends_retry_after()) {
        let mut header = Header::new(u64::schema());
        header.description = Some("Seconds after which to try again.".to_owned());
        response = response.header("retry-after", header);
    }
    if kinds.contains(&ProblemKind::UnsupportedEncoding) {
        let mut header = Header::new(String::schema());
        header.description =
            Some("Encodings of a body that are decoded, if its encoding is not.".to_owned());
        response = response.header("accept-encoding", header);
    }
    response.build()
}
