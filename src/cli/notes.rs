//! What commands say on stderr: notes, warnings, progress, summaries and errors. [`crate::log`] writes it, so that nothing that happens to
//! stderr stops the work.

use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, WeakProgressBar};

use crate::log;

/// The progress bar that is on the screen.
static BAR: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

/// Writes text to stderr, and a line end if it has none. Never waits and never fails; on a terminal the text appears above the
/// progress bar. Control characters are replaced, as [`printable`] has it.
pub fn say(text: impl Into<String>) {
    let text: String = text.into();
    say_coloured(printable(&text));
}

/// Says notes about the meshes of a scene.
pub(super) fn say_notes(notes: &[String]) {
    for note in notes {
        say(format!("note: {note}"));
    }
}

/// The text with U+FFFD for each control character but line end and tab: names in files of others would control the terminal.
pub fn printable(text: &str) -> String {
    let is_replaced = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    text.replace(is_replaced, "\u{fffd}")
}

/// The same as [`say`] for a text of the program's own, which may have colours.
pub(super) fn say_coloured(mut text: String) {
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
