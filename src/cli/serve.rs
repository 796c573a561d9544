//! `caustica serve`: the HTTP service.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::io::{self, IsTerminal as _};
use std::time::Duration;

use super::error::CliError;
use crate::config::{Limits, RenderConfig, ServeConfig};
use crate::http::log::Log;
use crate::http::{ServeError, serve};

/// At the end, how long to wait for the last lines of the log.
const LAST_LINES_LIMIT: Duration = Duration::from_secs(1);

/// Serves until a signal ends the process.
///
/// # Errors
///
/// [`CliError::Serve`] if the service cannot start or fails.
pub fn run(render: RenderConfig, limits: Limits, config: ServeConfig) -> Result<(), CliError> {
    let log = start_log(config.log_json).map_err(ServeError::from)?;
    let result = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(ServeError::from)
        .and_then(|runtime| runtime.block_on(serve(render, limits, config)))
        .map_err(CliError::from);
    let written = log.flush(LAST_LINES_LIMIT);
    match result {
        // The reader of stderr has stalled: writing the error there would never end.
        Err(error) if !written => std::process::exit(error.exit_code().into()),
        result => result,
    }
}

/// Logs to stderr, panics too.
fn start_log(json: bool) -> io::Result<Log> {
    let log = Log::start(io::stderr())?;
    let subscriber = log.subscriber(json, io::stderr().is_terminal());
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
    Ok(log)
}
