//! The connections of the service: how many there are, and how long one may do nothing.
//!
//! A connection is *busy* from the end of a request's header until the answer has been sent. Otherwise it is *waiting*; such a
//! connection is closed after a time, or to make room for another.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io::{self, IoSlice};
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes, HttpBody};
use axum::http::{Request, Response};
use hyper::body::{Frame, Incoming, SizeHint};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::TokioIo;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;
use tower::ServiceExt as _;

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
    /// How long a connection may wait for a request, and a client for reading its answer.
    pub idle: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        Self {
            most: 1024,
            idle: Duration::from_secs(60),
        }
    }
}

/// Why the service closed a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CloseReason {
    /// No request, or half of one, for too long.
    Idle,
    /// It waited, and another connection needed the place.
    Evicted,
    /// The client did not read its answer.
    Stalled,
}

impl CloseReason {
    pub(super) const ALL: [Self; 3] = [Self::Idle, Self::Evicted, Self::Stalled];

    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Evicted => "evicted",
            Self::Stalled => "stalled",
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
            reason: None,
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

/// All open connections.
#[derive(Debug)]
struct Open {
    places: Arc<Semaphore>,
    watches: Mutex<BTreeMap<u64, Arc<Watch>>>,
    next: AtomicU64,
    /// A connection has started to wait.
    waits: Arc<Notify>,
}

impl Open {
    fn new(most: u32) -> Self {
        Self {
            places: Arc::new(Semaphore::new(most as usize)),
            watches: Mutex::default(),
            next: AtomicU64::new(0),
            waits: Arc::default(),
        }
    }

    /// A place for a new connection: a free one, else that of the connection that has waited longest, else the first to become
    /// free.
    async fn place(&self) -> OwnedSemaphorePermit {
        loop {
            if let Ok(place) = Arc::clone(&self.places).try_acquire_owned() {
                return place;
            }
            let evicted = self.evict_longest_waiting();
            tokio::select! {
                place = Arc::clone(&self.places).acquire_owned() => {
                    return place.expect("the semaphore is never closed");
                }
                // One that was evicted gives its place up.
                () = self.waits.notified(), if !evicted => {}
            }
        }
    }

    fn evict_longest_waiting(&self) -> bool {
        let watches = self.watches();
        let waiting = watches
            .values()
            .filter_map(|watch| Some((watch.waiting_since()?, watch)));
        let longest = waiting.min_by_key(|(since, _)| *since);
        longest.is_some_and(|(_, watch)| watch.evict())
    }

    fn enter(&self) -> Arc<Watch> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let watch = Arc::new(Watch {
            number,
            phase: Mutex::new(Phase::Silent(Instant::now())),
            waits: Arc::clone(&self.waits),
            evicted: Notify::new(),
        });
        self.watches().insert(number, Arc::clone(&watch));
        watch
    }

    fn leave(&self, watch: &Watch) {
        self.watches().remove(&watch.number);
    }

    async fn emptied(&self, most: u32) {
        // An error means a closed semaphore, which nobody closes.
        let _ = self.places.acquire_many(most).await;
    }

    fn watches(&self) -> MutexGuard<'_, BTreeMap<u64, Arc<Watch>>> {
        self.watches.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What a connection is doing.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Nothing of a request has arrived since then.
    Silent(Instant),
    /// A part of a header has arrived, its first byte then.
    Header(Instant),
    /// A request is in flight, or its answer is being written. If the client does not take any more of it: since when.
    Busy { stalled: Option<Instant> },
    /// The same, and the end of the answer has been handed over for writing.
    Ending { stalled: Option<Instant> },
    /// It is being closed to make room; nothing changes that.
    Evicted,
}

/// When a connection is to be closed, and why.
type Deadline = (Instant, CloseReason);

/// The state of one connection.
#[derive(Debug)]
struct Watch {
    number: u64,
    phase: Mutex<Phase>,
    waits: Arc<Notify>,
    evicted: Notify,
}

impl Watch {
    fn phase(&self) -> MutexGuard<'_, Phase> {
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn waiting_since(&self) -> Option<Instant> {
        match *self.phase() {
            Phase::Silent(since) | Phase::Header(since) => Some(since),
            Phase::Busy { .. } | Phase::Ending { .. } | Phase::Evicted => None,
        }
    }

    /// Closes the connection unless it is busy by now.
    fn evict(&self) -> bool {
        let mut phase = self.phase();
        let waiting = matches!(*phase, Phase::Silent(_) | Phase::Header(_));
        if waiting {
            *phase = Phase::Evicted;
            self.evicted.notify_one();
        }
        waiting
    }

    /// A request begins; false if the connection is being closed.
    fn begin(&self) -> bool {
        let mut phase = self.phase();
        let stays = !matches!(*phase, Phase::Evicted);
        if stays {
            *phase = Phase::Busy { stalled: None };
        }
        stays
    }

    /// Bytes have arrived.
    fn received(&self) {
        let mut phase = self.phase();
        if matches!(*phase, Phase::Silent(_)) {
            *phase = Phase::Header(Instant::now());
        }
    }

    /// The client takes no more of the answer at the moment, or takes it again.
    fn stalls(&self, stalls: bool) {
        if let Phase::Busy { stalled } | Phase::Ending { stalled } = &mut *self.phase() {
            *stalled = stalls.then(|| stalled.unwrap_or_else(Instant::now));
        }
    }

    /// The end of the answer is in the server's buffer, or there is no more answer.
    fn handed_over(&self) {
        let mut phase = self.phase();
        if let Phase::Busy { stalled } = *phase {
            *phase = Phase::Ending { stalled };
        }
    }

    /// The server's buffer is written.
    fn flushed(&self) {
        let mut phase = self.phase();
        if matches!(*phase, Phase::Ending { .. }) {
            *phase = Phase::Silent(Instant::now());
            self.waits.notify_one();
        }
    }

    /// When the connection is to be closed if nothing changes, and why.
    fn deadline(&self, silent: Duration, header: Duration, idle: Duration) -> Option<Deadline> {
        match *self.phase() {
            Phase::Silent(since) => Some((since + silent, CloseReason::Idle)),
            Phase::Header(since) => Some((since + header, CloseReason::Idle)),
            Phase::Busy { stalled } | Phase::Ending { stalled } => {
                stalled.map(|since| (since + idle, CloseReason::Stalled))
            }
            Phase::Evicted => Some((Instant::now(), CloseReason::Evicted)),
        }
    }
}

/// A connection that is being served.
struct Connection {
    watch: Arc<Watch>,
    open: Arc<Open>,
    metrics: Metrics,
    limits: ConnectionLimits,
    /// Why the service closes it, if it does.
    reason: Option<CloseReason>,
    _place: OwnedSemaphorePermit,
}

impl Connection {
    async fn serve(mut self, stream: TcpStream, app: Router, closing: CancellationToken) {
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
                    self.reason = Some(reason);
                    return;
                }
                Some((deadline, _)) => next = next.min(deadline),
                None => {}
            }
            tokio::select! {
                biased;
                // An error concerns this client only, who sees it: a broken header is answered, the rest are breaks of the line.
                _ = http.as_mut() => return,
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
        self.metrics.disconnected(self.reason);
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
    let end = End(watch);
    let answered = app.oneshot(request.map(Body::new)).await;
    let response = answered.unwrap_or_else(|never: Infallible| match never {});
    Ok(response.map(|body| Answer { body, _end: end }))
}

/// Dropped when the answer has been handed over for writing.
struct End(Arc<Watch>);

impl Drop for End {
    fn drop(&mut self) {
        self.0.handed_over();
    }
}

/// The body of an answer, whose end is noticed.
struct Answer {
    body: Body,
    _end: End,
}

impl HttpBody for Answer {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// A socket that tells its watch what happens.
struct Socket {
    stream: TcpStream,
    watch: Arc<Watch>,
}

impl AsyncRead for Socket {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        ready!(Pin::new(&mut self.stream).poll_read(context, buffer))?;
        if buffer.filled().len() > before {
            self.watch.received();
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Socket {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.watch.stalls(written.is_pending());
        written
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, bytes);
        self.watch.stalls(written.is_pending());
        written
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    /// The server calls this when it has written everything it holds.
    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(Pin::new(&mut self.stream).poll_flush(context))?;
        self.watch.flushed();
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}
