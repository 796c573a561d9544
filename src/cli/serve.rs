//! `caustica serve`: the HTTP service.

use std::io::IsTerminal as _;

use tracing_subscriber::EnvFilter;

use super::error::CliError;
use crate::config::{Limits, RenderConfig, ServeConfig};

/// Serves until a signal ends the process.
///
/// # Errors
///
/// [`CliError::Serve`] if the service cannot start or fails.
pub fn run(render: RenderConfig, limits: Limits, serve: ServeConfig) -> Result<(), CliError> {
    start_log(serve.log_json);
    tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| CliError::Serve(error.to_string()))?
        .block_on(crate::http::serve(render, limits, serve))
        .map_err(|error| CliError::Serve(error.to_string()))
}

/// Logs to stderr at level `info` and above, or as `RUST_LOG` says.
fn start_log(json: bool) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal());
    // In a process that has a log already, as in tests, the first one's format stays.
    let _ = if json {
        log.json().try_init()
    } else {
        log.try_init()
    };
}
