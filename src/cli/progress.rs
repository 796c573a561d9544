//! Progress of long work, on stderr.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of a thousand steps on stderr if that is a terminal.
pub(super) fn bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {percent}% {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000).with_style(style)
}

/// A bar on a terminal; otherwise a line for each step, so that a log shows what the program is doing.
pub(super) struct Progress {
    bar: ProgressBar,
    lines: bool,
}

impl Progress {
    pub(super) fn new() -> Self {
        Self {
            bar: bar(),
            lines: !std::io::stderr().is_terminal(),
        }
    }

    /// Shows the step that begins. Repeating the same step changes nothing.
    pub(super) fn say(&self, step: &str) {
        if self.bar.message() == step {
            return;
        }
        self.bar.set_message(step.to_owned());
        if self.lines {
            eprintln!("{step}");
        }
    }

    /// Shows the finished part, 0 … 1.
    pub(super) fn at(&self, part: f64) {
        self.bar.set_position((1000.0 * part) as u64);
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
