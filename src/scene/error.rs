//! What is wrong with a scene: every finding says where (JSON pointer), what, and what would be accepted.

use std::fmt;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Every finding; never empty.
    pub issues: Vec<Issue>,
}

/// The sort of a finding, from the most basic to the most particular.
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
    /// A mesh id that is not in the store: after uploading the mesh the same scene is accepted.
    UnknownMesh,
}

/// One finding.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Issue {
    /// The sort of finding.
    #[serde(default)]
    pub kind: IssueKind,
    /// JSON pointer (RFC 6901) to the offending value, or to where a missing value belongs.
    pub pointer: String,
    /// What is wrong with it.
    pub detail: String,
    /// What would be accepted.
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

    /// The same finding as another sort.
    #[must_use]
    pub fn of_kind(self, kind: IssueKind) -> Self {
        Self { kind, ..self }
    }
}

impl SceneError {
    /// The most basic sort among the findings: `UnknownMesh` only when nothing else is wrong.
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
