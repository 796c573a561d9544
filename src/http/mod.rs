//! STUB for the merge: the service's own file replaces this one.

use crate::config::{Limits, RenderConfig, ServeConfig};

/// Why the service stopped.
#[derive(Debug, thiserror::Error)]
#[error("the service is not here yet")]
pub struct ServeError;

/// Serves until a signal.
pub async fn serve(
    _render: RenderConfig,
    _limits: Limits,
    _serve: ServeConfig,
) -> Result<(), ServeError> {
    Err(ServeError)
}
