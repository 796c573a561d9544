//! What commands say on stderr: notes, warnings, progress, summaries and errors. [`crate::log`] writes it, so that nothing that happens to
//! stderr stops the work.

use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, WeakProgressBar};

use crate::log;

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
    match log::stderr() {
        Some(log) => log.put(text),
        // Without a thread there is nobody else to write it, and nothing left to tell an error to.
        None => _ = io::stderr().write_all(text.as_bytes()),
    }
}

/// Makes `bar` the one that [`say`] writes above.
pub(super) fn write_above(bar: &ProgressBar) {
    *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.downgrade());
}

/// Waits until stderr has everything that was said, or until its reader has taken nothing for a second.
pub fn flush() {
    if let Some(log) = log::stderr() {
        log.flush(log::PATIENCE);
    }
}
