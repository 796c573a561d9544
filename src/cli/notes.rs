//! The only way to stderr: notes, warnings, progress, summaries and errors.
//!
//! A thread of its own writes them. Commands only put text into its queue, so a reader that stalls or leaves, or a full disk, can neither
//! stop the work nor end the program.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, WeakProgressBar};

/// Most text that waits for a reader, bytes; what exceeds it is dropped.
const MAX_WAITING_BYTES: usize = 4 << 20;

/// How long [`flush`] waits for a reader that takes nothing.
const PATIENCE: Duration = Duration::from_secs(1);

/// Texts on their way to a writer that may block or fail.
#[derive(Debug)]
pub struct Notes {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<String>,
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

    /// Writes text after text; errors are ignored, because there is nobody left to report them to.
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
            let _ = writer
                .write_all(text.as_bytes())
                .and_then(|()| writer.flush());
            queue = self.lock();
            queue.bytes -= text.len();
            queue.is_writing = false;
            queue.done += 1;
            self.changed.notify_all();
        }
    }
}

impl Notes {
    /// Starts the thread that writes to `writer`.
    ///
    /// # Errors
    ///
    /// If the system has no further thread.
    pub fn to(writer: impl Write + Send + 'static) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let notes = Self {
            shared: Arc::clone(&shared),
        };
        std::thread::Builder::new()
            .name("notes".to_owned())
            .spawn(move || shared.write_to(writer))?;
        Ok(notes)
    }

    /// Queues a text. Never waits; drops the text if 4 MiB wait already.
    pub fn put(&self, text: String) {
        let mut queue = self.shared.lock();
        if !text.is_empty() && queue.bytes + text.len() <= MAX_WAITING_BYTES {
            queue.bytes += text.len();
            queue.waiting.push_back(text);
            self.shared.changed.notify_all();
        }
    }

    /// Waits until everything is written, or until the writer has taken nothing for `patience`. Returns whether all is written.
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

/// The notes on stderr; none if no thread can be started.
static STDERR: LazyLock<Option<Notes>> = LazyLock::new(|| Notes::to(io::stderr()).ok());

/// The progress bar that is on the screen.
static BAR: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

/// Writes text to stderr, and a line end if it has none. Never waits and never fails; on a terminal the text appears above the
/// progress bar.
pub fn say(text: impl Into<String>) {
    let mut text = text.into();
    if !text.ends_with('\n') {
        text.push('\n');
    }
    let bar = BAR.lock().unwrap_or_else(PoisonError::into_inner);
    let bar = bar.as_ref().and_then(WeakProgressBar::upgrade);
    match bar {
        Some(bar) => bar.suspend(|| put(text)),
        None => put(text),
    }
}

/// Writes text to stderr as it is.
pub(super) fn put(text: String) {
    match &*STDERR {
        Some(notes) => notes.put(text),
        None => {
            let _ = io::stderr().write_all(text.as_bytes());
        }
    }
}

/// Makes `bar` the one that [`say`] writes above.
pub(super) fn write_above(bar: &ProgressBar) {
    *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.downgrade());
}

/// Waits until stderr has everything that was said, or until its reader has taken nothing for a second.
pub fn flush() {
    if let Some(notes) = &*STDERR {
        notes.flush(PATIENCE);
    }
}
