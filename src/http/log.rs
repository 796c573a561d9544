//! The log of the service: what turns events into its lines.

use tracing::Subscriber;
use tracing_subscriber::EnvFilter;

use crate::log::Log;

/// Turns events into lines of `log`: those at level `info` and above, or as `RUST_LOG` says.
pub fn subscriber(log: &Log, json: bool, colours: bool) -> Box<dyn Subscriber + Send + Sync> {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let log = log.clone();
    let subscriber = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(move || log.clone())
        .log_internal_errors(false)
        .with_ansi(colours);
    if json {
        Box::new(subscriber.json().finish())
    } else {
        Box::new(subscriber.finish())
    }
}
