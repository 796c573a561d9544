//! Progress of long work, on stderr.

use std::io::{self, IsTerminal};
use std::mem::take;
use std::sync::{Mutex, PoisonError};

use console::Term;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle, TermLike};

use super::notes;

/// Draws of a bar in a second, at most.
const DRAWS_PER_SECOND: u8 = 10;

/// A bar of a thousand steps on stderr if that is a terminal.
pub(super) fn bar() -> ProgressBar {
    bar_of(1000, "{bar:40} {percent}% {msg}")
}

/// A bar on stderr if that is a terminal; otherwise a hidden one.
pub(super) fn bar_of(steps: u64, template: &str) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(template);
    let screen = Box::new(Screen::default());
    let target = ProgressDrawTarget::term_like_with_hz(screen, DRAWS_PER_SECOND);
    let bar = ProgressBar::with_draw_target(Some(steps), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    notes::write_above(&bar);
    bar
}

/// A terminal on stderr that is written to by way of [`notes`], because a terminal can stall, too.
#[derive(Debug)]
struct Screen {
    size: Term,
    drawn: Mutex<String>,
}

impl Default for Screen {
    fn default() -> Self {
        Self {
            size: Term::stderr(),
            drawn: Mutex::default(),
        }
    }
}

impl Screen {
    fn add(&self, text: &str) {
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        drawn.push_str(text);
    }

    /// Adds a movement of the cursor by `count` cells.
    fn add_move(&self, count: usize, direction: char) {
        if count > 0 {
            self.add(&format!("\x1b[{count}{direction}"));
        }
    }
}

impl TermLike for Screen {
    fn width(&self) -> u16 {
        self.size.size().1
    }

    fn height(&self) -> u16 {
        self.size.size().0
    }

    fn move_cursor_up(&self, count: usize) -> io::Result<()> {
        self.add_move(count, 'A');
        Ok(())
    }

    fn move_cursor_down(&self, count: usize) -> io::Result<()> {
        self.add_move(count, 'B');
        Ok(())
    }

    fn move_cursor_right(&self, count: usize) -> io::Result<()> {
        self.add_move(count, 'C');
        Ok(())
    }

    fn move_cursor_left(&self, count: usize) -> io::Result<()> {
        self.add_move(count, 'D');
        Ok(())
    }

    fn write_line(&self, text: &str) -> io::Result<()> {
        self.add(text);
        self.add("\n");
        Ok(())
    }

    fn write_str(&self, text: &str) -> io::Result<()> {
        self.add(text);
        Ok(())
    }

    fn clear_line(&self) -> io::Result<()> {
        self.add("\r\x1b[2K");
        Ok(())
    }

    fn flush(&self) -> io::Result<()> {
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        notes::put(take(&mut drawn));
        Ok(())
    }
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
            lines: !io::stderr().is_terminal(),
        }
    }

    /// Shows the step that begins. Repeating the same step changes nothing.
    pub(super) fn say(&self, step: &str) {
        if self.bar.message() == step {
            return;
        }
        self.bar.set_message(step.to_owned());
        if self.lines {
            notes::say(step);
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
