//! `caustica serve`: the HTTP service.

use super::error::CliError;
use crate::config::{Limits, RenderConfig, ServeConfig};

/// Serves until the process is told to stop.
///
/// # Errors
///
/// [`CliError::Serve`] when the service cannot start or breaks off.
pub fn run(render: RenderConfig, limits: Limits, serve: ServeConfig) -> Result<(), CliError> {
    tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| CliError::Serve(error.to_string()))?
        .block_on(crate::http::serve(render, limits, serve))
        .map_err(|error| CliError::Serve(error.to_string()))
}
