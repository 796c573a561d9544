//! How far long work is, on stderr.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of a thousand steps on stderr, if a person looks at it.
pub(super) fn bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{bar:40} {percent}% {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(1000).with_style(style)
}

/// A bar for a person; where none looks, a line for each step, so that a log shows that the program works and on what.
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

    /// The step that begins; saying it again changes nothing.
    pub(super) fn say(&self, step: &str) {
        if self.bar.message() == step {
            return;
        }
        self.bar.set_message(step.to_owned());
        if self.lines {
            eprintln!("{step}");
        }
    }

    /// The finished part, 0 … 1.
    pub(super) fn at(&self, part: f64) {
        self.bar.set_position((1000.0 * part) as u64);
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
