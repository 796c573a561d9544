//! `caustica serve`: the HTTP service.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::io::{self, IsTerminal as _};

use super::error::CliError;
use crate::config::{Limits, RenderConfig, ServeConfig};
use crate::http::{self, ServeError, serve};
use crate::log;

/// Serves until a signal ends the process.
///
/// # Errors
///
/// [`CliError::Serve`] if the service cannot start or fails.
pub fn run(render: RenderConfig, limits: Limits, config: ServeConfig) -> Result<(), CliError> {
    start_log(config.log_json);
    let served = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(ServeError::from)
        .and_then(|runtime| runtime.block_on(serve(render, limits, config)));
    Ok(served?)
}

/// Logs to stderr, panics too. Without a thread for it there is no log.
fn start_log(json: bool) {
    let Some(log) = log::stderr() else {
        return;
    };
    let subscriber = http::log::subscriber(log, json, io::stderr().is_terminal());
    // In a process that has a log already, as in tests, the first one stays.
    if tracing::subscriber::set_global_default(subscriber).is_ok() {
        std::panic::set_hook(Box::new(|panic| {
            let trace = Backtrace::capture();
            match trace.status() {
                BacktraceStatus::Captured => tracing::error!(%panic, %trace, "panicked"),
                _ => tracing::error!(%panic, "panicked"),
            }
        }));
    }
}
