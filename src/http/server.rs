//! The listening process, from start to graceful shutdown.

use std::io;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio_util::sync::CancellationToken;

use super::connections::{self, ConnectionLimits};
use super::listen::listen;
use super::open_files::connections_within_limit;
use super::router::app;
use super::state::AppState;
use crate::config::{Limits, RenderConfig, ServeConfig};
use crate::gpu::GpuError;
use crate::gpu_queue::{GpuQueue, GpuState, GpuStatus, QueueSettings, RenderBackend};
use crate::render::Renderer;

/// On shutdown, how long to wait for connections beyond the deadline of requests.
const CLOSING_MARGIN: Duration = Duration::from_secs(5);

/// How often recorded metrics are condensed, in case nothing scrapes `/metrics`.
const UPKEEP_PERIOD: Duration = Duration::from_secs(5);

/// Why the service did not start, or ended without a signal.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address cannot be listened on.
    #[error("cannot listen on {address}: {source}")]
    Listen {
        /// The address.
        address: String,
        /// Why.
        source: io::Error,
    },
    /// The name to listen on has no address at the moment.
    #[error("cannot listen on {name}: the name does not resolve: {source}")]
    Resolve {
        /// The name.
        name: String,
        /// Why.
        source: io::Error,
    },
    /// No adapter matches the policy, or its device cannot be opened.
    #[error("cannot start: {0}")]
    NoDevice(String),
    /// The operating system refused a thread, a signal handler or a connection.
    #[error("the service stopped: {0}")]
    Io(#[from] io::Error),
}

impl ServeError {
    /// Whether the same settings will be refused again: the address belongs to another machine, or this user may not open the
    /// port.
    pub fn is_refusal(&self) -> bool {
        match self {
            Self::Listen { source, .. } => matches!(
                source.kind(),
                io::ErrorKind::AddrNotAvailable | io::ErrorKind::PermissionDenied
            ),
            Self::Resolve { .. } | Self::NoDevice(_) | Self::Io(_) => false,
        }
    }
}

/// Runs the service until SIGTERM or SIGINT; a second signal ends it at once.
///
/// It listens before the device is open, so that `/healthz` and `/readyz` answer meanwhile.
///
/// # Errors
/// If the port cannot be opened, if no device can be opened at the start, or if the system refuses a resource. A device lost
/// later is rebuilt; the service goes on.
pub async fn serve(
    render: RenderConfig,
    limits: Limits,
    serve: ServeConfig,
) -> Result<(), ServeError> {
    let listener = listen(&serve.listen).await?;
    let config = render.clone();
    let factory = move || {
        let renderer = Renderer::new(&config)?;
        Ok(Box::new(renderer) as Box<dyn RenderBackend>)
    };
    serve_with(listener, factory, render, limits, &serve).await
}

/// [`serve`] on a bound socket, with backends from `factory`; `serve.listen` is ignored.
///
/// # Errors
/// As [`serve`].
pub async fn serve_with<F>(
    listener: TcpListener,
    factory: F,
    render: RenderConfig,
    limits: Limits,
    serve: &ServeConfig,
) -> Result<(), ServeError>
where
    F: FnMut() -> Result<Box<dyn RenderBackend>, GpuError> + Send + 'static,
{
    let limits_of_connections = ConnectionLimits {
        most: connections_within_limit(serve.max_connections),
        idle: Duration::from_secs(serve.idle_timeout_s),
    };
    tracing::info!(
        address = %listener.local_addr()?,
        max_connections = limits_of_connections.most,
        "listening"
    );
    let mut signals = Signals::new()?;
    let settings = QueueSettings {
        waiting: serve.queue,
        deadline: Duration::from_secs(serve.deadline_s),
    };
    let queue = GpuQueue::start(settings, factory)?;
    let state =
        AppState::new(queue.clone(), limits, render).allowing_origins(serve.cors_origin.clone());
    let stop = CancellationToken::new();
    let drain = Duration::from_secs(serve.drain_s);
    let stopped = stop.clone().cancelled_owned();
    let served = serve_on(listener, state, limits_of_connections, drain, stopped);
    let signalled = async {
        signals.next().await;
        stop.cancel();
        signals.next().await;
        tracing::warn!("second signal: ending at once");
    };
    let result = tokio::select! {
        result = served => result,
        () = signalled => Ok(()),
        reason = failed_at_start(queue.watch()) => Err(ServeError::NoDevice(reason)),
    };
    // Free the device before the process ends.
    let _ = tokio::task::spawn_blocking(move || queue.close()).await;
    result
}

/// Serves on a bound socket until `stop` resolves. Then `/readyz` answers 503, `drain` passes, new connections are refused, idle ones
/// are closed, and running requests are finished.
///
/// # Errors
/// None at present: a socket that fails for a time is tried again.
pub async fn serve_on(
    listener: TcpListener,
    state: AppState,
    connections: ConnectionLimits,
    drain: Duration,
    stop: impl Future<Output = ()> + Send + 'static,
) -> Result<(), ServeError> {
    let closing = CancellationToken::new();
    let patience = state.queue().settings().deadline + CLOSING_MARGIN;
    let shutdown = async {
        stop.await;
        state.start_draining();
        tracing::info!(drain_s = drain.as_secs_f64(), "draining");
        tokio::time::sleep(drain).await;
        tracing::info!("refusing connections, finishing running requests");
        closing.cancel();
        tokio::time::sleep(patience).await;
    };
    let metrics = state.metrics();
    let upkeep = async {
        let mut ticks = tokio::time::interval(UPKEEP_PERIOD);
        loop {
            ticks.tick().await;
            metrics.upkeep();
        }
    };
    let app = app(state.clone());
    tokio::select! {
        () = connections::serve(listener, app, connections, metrics, closing.clone()) => {}
        () = shutdown => tracing::warn!("connections are still open; closing them"),
        () = upkeep => {}
    }
    Ok(())
}

/// Resolves with the reason if the first attempt to open a device fails; otherwise never.
async fn failed_at_start(mut status: watch::Receiver<GpuStatus>) -> String {
    let first = status
        .wait_for(|status| status.state != GpuState::Initializing)
        .await
        .map(|status| status.state.clone());
    match first {
        Ok(GpuState::Failed(reason)) => reason,
        Ok(_) => std::future::pending().await,
        Err(_) => "the GPU thread ended".to_owned(),
    }
}

/// The signals that end the service.
struct Signals {
    #[cfg(unix)]
    terminate: tokio::signal::unix::Signal,
    #[cfg(unix)]
    interrupt: tokio::signal::unix::Signal,
}

impl Signals {
    #[cfg(unix)]
    fn new() -> io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        Ok(Self {
            terminate: signal(SignalKind::terminate())?,
            interrupt: signal(SignalKind::interrupt())?,
        })
    }

    #[cfg(unix)]
    async fn next(&mut self) {
        tokio::select! {
            _ = self.terminate.recv() => {}
            _ = self.interrupt.recv() => {}
        }
    }

    #[cfg(not(unix))]
    fn new() -> io::Result<Self> {
        Ok(Self {})
    }

    #[cfg(not(unix))]
    async fn next(&mut self) {
        // Without a handler there is no signal to wait for.
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    }
}
