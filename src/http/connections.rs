//! The connections of the service: how many there are, and how long one may do nothing.
//!
//! A connection is *busy* from the end of a request's header until the answer has been sent, unless the service needs more of the
//! request's body and the client sends none. Otherwise it is *waiting*; such a connection is closed after a time, or to make room for
//! another.

mod watch;
mod wire;

use std::convert::Infallible;
use std::io;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{Request, Response};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::TokioIo;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::OwnedSemaphorePermit;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt as _;

pub(super) use self::watch::CloseReason;
use self::watch::{Open, Watch};
use self::wire::{Answer, Arriving, End, Socket};
use super::metrics::Metrics;

/// The header of a request has to be complete within this time, if not earlier.
const HEADER_LIMIT: Duration = Duration::from_secs(30);

/// On shutdown, how long a request that is arriving may take to complete its header.
const LAST_HEADER_LIMIT: Duration = Duration::from_secs(1);

/// Pause after the operating system has refused a connection, usually for lack of files or memory.
const REFUSED_PAUSE: Duration = Duration::from_millis(100);

/// How often this is logged at most.
const WARNING_PERIOD: Duration = Duration::from_secs(10);

/// Bounds of all connections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConnectionLimits {
    /// Most connections; one more takes the place of the one that has waited longest.
    pub most: u32,
    /// How long a connection may wait for a request or for more of its body, and how long a client may not read its answer.
    pub idle: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        Self {
            most: 1024,
            idle: Duration::from_secs(75),
        }
    }
}

/// Serves connections until `closing`. Then refuses new ones, closes those that wait, and ends when the busy ones have ended.
///
/// When this future is dropped, all connections are closed.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    limits: ConnectionLimits,
    metrics: Metrics,
    closing: CancellationToken,
) {
    let abandoned = CancellationToken::new();
    let _abandons = abandoned.clone().drop_guard();
    let open = Arc::new(Open::new(limits.most));
    let mut warned: Option<Instant> = None;
    loop {
        let accepted = tokio::select! {
            biased;
            () = closing.cancelled() => break,
            accepted = listener.accept() => accepted,
        };
        let stream = match accepted {
            Ok((stream, _)) => stream,
            Err(error) if concerns_one_connection(&error) => continue,
            Err(error) => {
                if warned.is_none_or(|then| then.elapsed() > WARNING_PERIOD) {
                    tracing::warn!(%error, "the system refuses connections; closing those that wait");
                    warned = Some(Instant::now());
                }
                open.evict_longest_waiting();
                tokio::time::sleep(REFUSED_PAUSE).await;
                continue;
            }
        };
        let place = tokio::select! {
            biased;
            () = closing.cancelled() => break,
            place = open.place() => place,
        };
        let connection = Connection {
            watch: open.enter(),
            open: Arc::clone(&open),
            metrics,
            limits,
            _place: place,
        };
        metrics.connected();
        let (app, closing, abandoned) = (app.clone(), closing.clone(), abandoned.clone());
        let serving = connection.serve(stream, app, closing);
        tokio::spawn(abandoned.run_until_cancelled_owned(serving));
    }
    drop(listener);
    open.emptied(limits.most).await;
}

/// Whether an error of `accept` is about the connection that was to be accepted, not about accepting.
fn concerns_one_connection(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ConnectionAborted
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionRefused
            | io::ErrorKind::Interrupted
    )
}

/// A connection that is being served.
struct Connection {
    watch: Arc<Watch>,
    open: Arc<Open>,
    metrics: Metrics,
    limits: ConnectionLimits,
    _place: OwnedSemaphorePermit,
}

impl Connection {
    async fn serve(self, stream: TcpStream, app: Router, closing: CancellationToken) {
        let watch = Arc::clone(&self.watch);
        let socket = Socket {
            stream,
            watch: Arc::clone(&watch),
        };
        let service = service_fn(|request| answer(app.clone(), Arc::clone(&watch), request));
        let http = http1::Builder::new().serve_connection(TokioIo::new(socket), service);
        let mut http = pin!(http);
        let idle = self.limits.idle;
        let (mut silent, mut header) = (idle, HEADER_LIMIT.min(idle));
        let mut ends = false;
        loop {
            let deadline = watch.deadline(silent, header, idle);
            let now = Instant::now();
            // The phase may change without a notice; no phase that begins now ends before this time.
            let mut next = now + header;
            match deadline {
                Some((deadline, reason)) if deadline <= now => {
                    // Counted before the client can notice.
                    self.metrics.closed(reason);
                    return;
                }
                Some((deadline, _)) => next = next.min(deadline),
                None => {}
            }
            tokio::select! {
                biased;
                // An error concerns this client only, who sees it: a broken header is answered, the rest are breaks of the line.
                _ = http.as_mut() => {
                    if watch.is_evicted() {
                        self.metrics.closed(CloseReason::Evicted);
                    }
                    return;
                }
                () = watch.evicted.notified() => {}
                () = closing.cancelled(), if !ends => {
                    ends = true;
                    http.as_mut().graceful_shutdown();
                    silent = silent.min(LAST_HEADER_LIMIT);
                    header = header.min(LAST_HEADER_LIMIT);
                }
                () = tokio::time::sleep_until(next) => {}
            }
        }
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.open.leave(&self.watch);
        self.metrics.disconnected();
    }
}

/// The connection was closed to make room while the request arrived.
#[derive(Debug, thiserror::Error)]
#[error("the connection is being closed")]
struct Closed;

async fn answer(
    app: Router,
    watch: Arc<Watch>,
    request: Request<Incoming>,
) -> Result<Response<Answer>, Closed> {
    if !watch.begin() {
        return Err(Closed);
    }
    let end = End(Arc::clone(&watch));
    let request = request.map(|body| Body::new(Arriving { body, watch }));
    let answered = app.oneshot(request).await;
    let response = answered.unwrap_or_else(|never: Infallible| match never {});
    Ok(response.map(|body| Answer { body, _end: end }))
}
