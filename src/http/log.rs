//! The log of the service: written by a thread of its own, so that nothing that happens to it delays or ends work.
//!
//! Lines wait in a bounded queue. A line is dropped, and counted, if the queue is full because the reader of the log has stalled,
//! or if it cannot be written because the disk is full or the reader is gone.

use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tracing::Subscriber;
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;

/// Lines that may wait; at some hundred bytes a line, a few megabytes.
const QUEUE_LINES: usize = 16_384;

/// At the end of the process, how long to wait for the last lines.
pub const LAST_LINES_LIMIT: Duration = Duration::from_secs(1);

/// Lines lost by all logs of the process, for `/metrics`.
static DROPPED: AtomicU64 = AtomicU64::new(0);

/// Lines lost since the process started.
pub(super) fn dropped_lines() -> u64 {
    DROPPED.load(Ordering::Relaxed)
}

/// The end of the log that takes lines; clones share the queue.
#[derive(Clone, Debug)]
pub struct Log {
    lines: SyncSender<Vec<u8>>,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    /// Lines taken that are neither written nor lost.
    open: Mutex<usize>,
    settled: Condvar,
    dropped: AtomicU64,
}

impl Log {
    /// Starts the thread that writes.
    ///
    /// # Errors
    /// If the operating system refuses a thread.
    pub fn start(out: impl Write + Send + 'static) -> io::Result<Self> {
        let (lines, queue) = sync_channel(QUEUE_LINES);
        let shared = Arc::<Shared>::default();
        let of_thread = Arc::clone(&shared);
        std::thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || write_lines(&queue, &of_thread, out))?;
        Ok(Self { lines, shared })
    }

    /// What turns events into lines of this log: those at level `info` and above, or as `RUST_LOG` says.
    pub fn subscriber(&self, json: bool, colours: bool) -> Box<dyn Subscriber + Send + Sync> {
        let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
        let subscriber = tracing_subscriber::fmt()
            .with_env_filter(filter)
            .with_writer(self.clone())
            .log_internal_errors(false)
            .with_ansi(colours);
        if json {
            Box::new(subscriber.json().finish())
        } else {
            Box::new(subscriber.finish())
        }
    }

    /// Lines that this log has lost.
    pub fn dropped_lines(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }

    /// Waits until all lines taken so far are written or lost, at most `limit`. Returns whether they are.
    pub fn flush(&self, limit: Duration) -> bool {
        let open = self.shared.open();
        let waited = self
            .shared
            .settled
            .wait_timeout_while(open, limit, |open| *open > 0);
        *waited.unwrap_or_else(PoisonError::into_inner).0 == 0
    }

    fn take(&self, line: &[u8]) {
        *self.shared.open() += 1;
        if self.lines.try_send(line.to_vec()).is_err() {
            self.shared.settle(true);
        }
    }
}

impl Shared {
    fn open(&self) -> MutexGuard<'_, usize> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One line is written, or lost.
    fn settle(&self, lost: bool) {
        if lost {
            self.dropped.fetch_add(1, Ordering::Relaxed);
            DROPPED.fetch_add(1, Ordering::Relaxed);
        }
        let mut open = self.open();
        *open -= 1;
        if *open == 0 {
            self.settled.notify_all();
        }
    }
}

/// The thread: ends with the last [`Log`].
fn write_lines(queue: &Receiver<Vec<u8>>, shared: &Shared, mut out: impl Write) {
    for line in queue {
        let written = out.write_all(&line).and_then(|()| out.flush());
        shared.settle(written.is_err());
    }
}

/// A line arrives in one piece: the formatter writes whole events.
impl Write for Log {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        self.take(line);
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for Log {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}
