//! Errors of a scene. Every finding states where (JSON pointer), what is wrong, and what is accepted.

use std::fmt;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Every finding; never empty.
    pub issues: Vec<Issue>,
}

/// The kind of a finding, from the most basic to the most specific.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum IssueKind {
    /// The text is not JSON.
    Syntax,
    /// A value that can never be accepted.
    #[default]
    Invalid,
    /// A value above a limit of this installation (`GET /v1/info`).
    LimitExceeded,
    /// A mesh id that is not in the store. Once the mesh is uploaded, the same scene is accepted.
    UnknownMesh,
    /// An asset id that is not in the store. Once the file is uploaded, the same scene is accepted.
    UnknownAsset,
}

/// One finding.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Issue {
    /// The kind of finding.
    #[serde(default)]
    pub kind: IssueKind,
    /// JSON pointer (RFC 6901) to the wrong value, or to the place of a missing one.
    pub pointer: String,
    /// What is wrong with it.
    pub detail: String,
    /// What is accepted there.
    pub accepted: String,
}

impl Issue {
    /// A value that can never be accepted.
    pub fn invalid(
        pointer: impl Into<String>,
        detail: impl Into<String>,
        accepted: impl Into<String>,
    ) -> Self {
        Self {
            kind: IssueKind::Invalid,
            pointer: pointer.into(),
            detail: detail.into(),
            accepted: accepted.into(),
        }
    }

    /// The same finding with another kind.
    #[must_use]
    pub fn of_kind(self, kind: IssueKind) -> Self {
        Self { kind, ..self }
    }
}

impl SceneError {
    /// The most basic kind among the findings: `UnknownMesh` only if nothing else is wrong.
    pub fn kind(&self) -> IssueKind {
        self.issues
            .iter()
            .map(|issue| issue.kind)
            .min()
            .unwrap_or_default()
    }
}

impl From<Issue> for SceneError {
    fn from(issue: Issue) -> Self {
        Self {
            issues: vec![issue],
        }
    }
}

impl std::error::Error for SceneError {}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the scene is not valid")?;
        for issue in &self.issues {
            write!(f, "\n  {issue}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Issue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = match self.pointer.as_str() {
            "" => "the whole text",
            pointer => pointer,
        };
        write!(f, "{place}: {}", self.detail)?;
        if self.accepted.is_empty() {
            return Ok(());
        }
        write!(f, "\n    accepted: {}", self.accepted)
    }
}
