//! Text on its way to a stream that may block or fail: the log of the service, and what commands say on stderr.
//!
//! A thread of its own writes. All others only put text into its queue, so a reader that stalls or leaves, or a full disk, can neither
//! stop work nor end the program. Text is dropped, and counted, if the queue is full or if it cannot be written.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// No further text is taken while this much waits for a reader, bytes. One text may be longer.
const MAX_WAITING_BYTES: usize = 4 << 20;

/// At the end of the process, how long to wait for a reader that takes nothing.
pub const PATIENCE: Duration = Duration::from_secs(1);

/// Texts lost by all logs of the process.
static DROPPED: AtomicU64 = AtomicU64::new(0);

/// The log on stderr; none if no thread can be started.
static STDERR: LazyLock<Option<Log>> = LazyLock::new(|| Log::start(io::stderr()).ok());

/// The process's log on stderr, which all parts of the program share; none if no thread can be started.
pub fn stderr() -> Option<&'static Log> {
    STDERR.as_ref()
}

/// Texts, usually lines, that all logs have lost since the process started.
pub fn dropped() -> u64 {
    DROPPED.load(Ordering::Relaxed)
}

/// The end of a log that takes text; clones share the queue.
#[derive(Clone, Debug)]
pub struct Log {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
    dropped: AtomicU64,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Vec<u8>>,
    bytes: usize,
    is_writing: bool,
    /// The number of texts that the writer has taken or refused.
    done: u64,
}

impl Shared {
    /// A queue is complete after each change, so it can be used after a panic, too.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn count_dropped(&self) {
        self.dropped.fetch_add(1, Ordering::Relaxed);
        DROPPED.fetch_add(1, Ordering::Relaxed);
    }

    /// Writes text after text. The counter is all that is left of an error: there is nobody to report it to.
    fn write_to(&self, mut writer: impl Write) {
        let mut queue = self.lock();
        loop {
            let Some(text) = queue.waiting.pop_front() else {
                let wait = self.changed.wait(queue);
                queue = wait.unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            queue.is_writing = true;
            drop(queue);
            let written = writer.write_all(&text).and_then(|()| writer.flush());
            if written.is_err() {
                self.count_dropped();
            }
            queue = self.lock();
            queue.bytes -= text.len();
            queue.is_writing = false;
            queue.done += 1;
            self.changed.notify_all();
        }
    }
}

impl Log {
    /// Starts the thread that writes to `writer`. It lasts as long as the process.
    ///
    /// # Errors
    /// If the system has no further thread.
    pub fn start(writer: impl Write + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        std::thread::Builder::new()
            .name("log".to_owned())
            .spawn(move || of_thread.write_to(writer))?;
        Ok(Self { shared })
    }

    /// Queues a text, which is written in one piece. Never waits; drops the text if 4 MiB wait already.
    pub fn put(&self, text: impl Into<Vec<u8>>) {
        let text = text.into();
        if text.is_empty() {
            return;
        }
        let mut queue = self.shared.lock();
        if queue.bytes >= MAX_WAITING_BYTES {
            self.shared.count_dropped();
            return;
        }
        queue.bytes += text.len();
        queue.waiting.push_back(text);
        self.shared.changed.notify_all();
    }

    /// Texts that this log has lost.
    pub fn dropped(&self) -> u64 {
        self.shared.dropped.load(Ordering::Relaxed)
    }

    /// Waits until everything is written or lost, or until the writer has taken nothing for `patience`. Returns whether nothing waits.
    pub fn flush(&self, patience: Duration) -> bool {
        let mut queue = self.shared.lock();
        while queue.is_writing || !queue.waiting.is_empty() {
            let before = queue.done;
            let wait = self
                .shared
                .changed
                .wait_timeout_while(queue, patience, |queue| queue.done == before);
            let timeout;
            (queue, timeout) = wait.unwrap_or_else(PoisonError::into_inner);
            if timeout.timed_out() {
                return false;
            }
        }
        true
    }
}

/// Each `write` is one text: the formatter of the service's log writes whole lines.
impl Write for Log {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.put(text);
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
