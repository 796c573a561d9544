//! What a run of many frames reports on stderr: how far it is, and the warnings of its frames.

use std::io::{self, IsTerminal};
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::frames::in_ranges;
use super::notes::say;
use super::progress;
use crate::stats::Warning;

/// Time between two lines of progress where there is no terminal.
const LINE_PERIOD: Duration = Duration::from_secs(5);

/// The warnings of many frames, by code and pointer, in the order of their first frames.
#[derive(Clone, Debug, Default)]
pub struct BatchWarnings(Vec<Kind>);

#[derive(Clone, Debug)]
struct Kind {
    code: String,
    pointer: Option<String>,
    frames: Vec<i64>,
}

impl BatchWarnings {
    /// Adds a warning of a frame. Returns it in full if `frame` is the first with a warning of this kind.
    pub fn add(&mut self, frame: i64, warning: &Warning) -> Option<String> {
        let same =
            |kind: &&mut Kind| (&kind.code, &kind.pointer) == (&warning.code, &warning.pointer);
        let kind = match self.0.iter_mut().find(same) {
            Some(kind) => kind,
            None => {
                self.0.push(Kind {
                    code: warning.code.clone(),
                    pointer: warning.pointer.clone(),
                    frames: Vec::new(),
                });
                self.0.last_mut()?
            }
        };
        if kind.frames.last() != Some(&frame) {
            kind.frames.push(frame);
        }
        let place = in_brackets(warning.pointer.as_ref());
        (kind.frames.len() == 1)
            .then(|| format!("warning: frame {frame}: {}{place}", warning.message))
    }

    /// A line for each kind, with the frames that have it.
    pub fn summary(&self) -> Vec<String> {
        let line = |kind: &Kind| {
            let place = in_brackets(kind.pointer.as_ref());
            let frames = if kind.frames.len() == 1 {
                "frame"
            } else {
                "frames"
            };
            let list = in_ranges(&kind.frames);
            format!("warning: {}{place} in {frames} {list}", kind.code)
        };
        self.0.iter().map(line).collect()
    }
}

fn in_brackets(pointer: Option<&String>) -> String {
    pointer.map_or_else(String::new, |pointer| format!(" ({pointer})"))
}

/// How far a run is: a bar on a terminal, otherwise a line for the first frame, one every few seconds, and one at the end.
#[derive(Debug)]
pub(super) struct Batch {
    bar: ProgressBar,
    has_lines: bool,
    total: usize,
    done: usize,
    start: Instant,
    last_line: Instant,
    warnings: BatchWarnings,
}

impl Batch {
    /// A run of `total` frames that begins now.
    pub(super) fn new(total: usize) -> Self {
        let bar = progress::bar_of(
            total as u64,
            "{bar:30} {pos}/{len} frames, {eta} left  {msg}",
        );
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(500));
        }
        Self {
            bar,
            has_lines: !io::stderr().is_terminal(),
            total,
            done: 0,
            start: Instant::now(),
            last_line: Instant::now(),
            warnings: BatchWarnings::default(),
        }
    }

    /// A frame begins.
    pub(super) fn begin(&self, frame: i64, path: &Path) {
        self.bar.set_message(path.display().to_string());
        if self.has_lines && self.done == 0 {
            let (path, total) = (path.display(), self.total);
            say(format!(
                "frame {frame}, {path}: begins, the first of {total}"
            ));
        }
    }

    /// A frame is in its file.
    pub(super) fn end(&mut self, frame: i64, path: &Path, warnings: &[Warning]) {
        self.done += 1;
        self.bar.inc(1);
        for warning in warnings {
            if let Some(line) = self.warnings.add(frame, warning) {
                say(line);
            }
        }
        let is_due = self.done == self.total || self.last_line.elapsed() >= LINE_PERIOD;
        if self.has_lines && is_due {
            self.last_line = Instant::now();
            let pace = pace(self.done, self.total, self.start.elapsed());
            say(format!("frame {frame}, {}: {pace}", path.display()));
        }
    }

    /// Removes the bar and reports the warnings of the frames that are done.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
        for line in self.warnings.summary() {
            say(line);
        }
    }

    /// Reports a frame that failed, after [`Self::finish`].
    pub(super) fn failed(&self, frame: i64) {
        let Self { done, total, .. } = self;
        say(format!("frame {frame} failed; {done} of {total} are done"));
    }
}

/// `3 of 12 done, 0.5 frames/s, 18 s left`.
pub fn pace(done: usize, total: usize, elapsed: Duration) -> String {
    let per_frame = elapsed.as_secs_f64() / done.max(1) as f64;
    let rate = if per_frame < 1.0 {
        format!("{:.1} frames/s", 1.0 / per_frame.max(1e-6))
    } else {
        format!("{per_frame:.1} s a frame")
    };
    let left = (per_frame * total.saturating_sub(done) as f64).ceil() as u64;
    let left = match (left / 3600, left / 60 % 60, left % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    };
    format!("{done} of {total} done, {rate}, {left} left")
}
