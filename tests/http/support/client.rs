//! Answers, and checks that hold for every problem.

use axum::body::to_bytes;
use axum::http::{HeaderMap, Method, Response};
use caustica::http::{Problem, ProblemKind, openapi};
use serde::de::DeserializeOwned;

/// An answer, read in full.
#[derive(Debug)]
pub(crate) struct Reply {
    method: Method,
    path: String,
    pub(crate) status: u16,
    pub(crate) headers: HeaderMap,
    pub(crate) body: Vec<u8>,
}

impl Reply {
    pub(crate) async fn read(
        method: Method,
        path: String,
        response: Response<axum::body::Body>,
    ) -> Self {
        let (parts, body) = response.into_parts();
        Self {
            method,
            path,
            status: parts.status.as_u16(),
            headers: parts.headers,
            body: to_bytes(body, usize::MAX).await.unwrap().to_vec(),
        }
    }

    /// A header, or nothing.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers
            .get(name)
            .map_or("", |value| value.to_str().unwrap())
    }

    /// The body as text.
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The body as JSON.
    pub(crate) fn json<T: DeserializeOwned>(&self) -> T {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|error| panic!("{error} in {}", self.text()))
    }

    /// The body as a problem of this kind, complete, with all that goes with it, and documented for its route.
    pub(crate) fn problem(&self, kind: ProblemKind) -> Problem {
        assert_eq!(self.header("content-type"), "application/problem+json");
        assert!(!self.header("x-request-id").is_empty());
        let problem: Problem = self.json();
        assert_eq!(problem.kind, kind.urn(), "{}", self.text());
        assert_eq!(self.status, kind.status().as_u16());
        assert_eq!(problem.status, self.status);
        assert_eq!(problem.title, kind.title());
        assert_eq!(problem.retryable, kind.retryable());
        assert!(!problem.detail.is_empty());
        for issue in &problem.errors {
            assert!(
                issue.pointer.is_empty() || issue.pointer.starts_with('/'),
                "{issue:?}"
            );
            assert!(
                !issue.detail.is_empty() && !issue.accepted.is_empty(),
                "{issue:?}"
            );
        }
        let everywhere = [ProblemKind::NotFound, ProblemKind::MethodNotAllowed];
        if !everywhere.contains(&kind) {
            self.assert_documented(kind);
        }
        problem
    }

    fn assert_documented(&self, kind: ProblemKind) {
        let contract = serde_json::to_value(openapi()).unwrap();
        let route = match &*self.path {
            path if path.starts_with("/v1/meshes/") => "/v1/meshes/{id}",
            path if path.starts_with("/v1/assets/") => "/v1/assets/{id}",
            path => path,
        };
        let method = self.method.as_str().to_ascii_lowercase();
        let response = &contract["paths"][route][&method]["responses"][self.status.to_string()];
        let described = response["description"].as_str().unwrap_or_default();
        assert!(
            described.contains(kind.urn()),
            "{method} {route} does not document {} {}",
            self.status,
            kind.urn()
        );
    }
}
