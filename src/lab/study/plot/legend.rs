//! What each mark stands for, right of the plot; below it, remarks.

use plotters::prelude::DrawingBackend;
use plotters::style::RGBColor;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Canvas, Stroke, TextStyle};
use super::error::PlotError;
use super::frame::{LEGEND_LEFT, LEGEND_RIGHT, TOP};
use super::marker;
use super::palette::{INK, SOFT_INK};

/// How an entry is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sign {
    /// A marker of this shape.
    Marker {
        shape: usize,
        colour: RGBColor,
        hollow: bool,
    },
    Line(Stroke),
    Dashed(Stroke),
}

/// A line of the legend.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub sign: Sign,
    pub text: String,
}

const SIGN_WIDTH: f64 = 22.0;
/// More entries than this are set in small type.
const MOST_LARGE: usize = 14;

/// Size of the letters, from line to line, and what an entry has below it.
struct Type {
    size: f64,
    line: f64,
    gap: f64,
}

const LARGE: Type = Type {
    size: 13.0,
    line: 17.0,
    gap: 5.0,
};
const SMALL: Type = Type {
    size: 11.0,
    line: 13.0,
    gap: 4.0,
};

/// Draws the entries from the top down, then the remarks, wrapped.
pub(super) fn draw<DB: DrawingBackend>(
    canvas: &mut Canvas<'_, DB>,
    entries: &[Entry],
    remarks: &[String],
) -> Result<(), PlotError> {
    let mut y = TOP + 8.0;
    let set = match entries.len() > MOST_LARGE {
        true => SMALL,
        false => LARGE,
    };
    for entry in entries {
        let (left, right) = (LEGEND_LEFT, LEGEND_LEFT + SIGN_WIDTH);
        let middle = 0.5 * (left + right);
        match entry.sign {
            Sign::Marker {
                shape,
                colour,
                hollow,
            } => marker::draw(canvas, shape, (middle, y), colour, hollow)?,
            Sign::Line(stroke) => canvas.line((left, y), (right, y), stroke)?,
            Sign::Dashed(stroke) => canvas.dashed((left, y), (right, y), 4.0, stroke)?,
        }
        let style = TextStyle::new(set.size, INK);
        for line in wrapped(canvas, &entry.text, set.size, LEGEND_RIGHT - right - 8.0)? {
            canvas.text(&line, (right + 8.0, y), style)?;
            y += set.line;
        }
        y += set.gap;
    }
    y += 10.0;
    for remark in remarks {
        for line in wrapped(canvas, remark, 11.0, LEGEND_RIGHT - LEGEND_LEFT)? {
            let style = TextStyle::new(11.0, SOFT_INK).at(HPos::Left, VPos::Center);
            canvas.text(&line, (LEGEND_LEFT, y), style)?;
            y += 14.0;
        }
        y += 6.0;
    }
    Ok(())
}

/// Lines of words no wider than `width`; a single word that is wider ends in an ellipsis.
fn wrapped<DB: DrawingBackend>(
    canvas: &Canvas<'_, DB>,
    text: &str,
    size: f64,
    width: f64,
) -> Result<Vec<String>, PlotError> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        let longer = match lines.last() {
            Some(line) => format!("{line} {word}"),
            None => word.to_owned(),
        };
        if lines.is_empty() || canvas.text_width(&longer, size)? > width {
            lines.push(canvas.fitted(word, size, width)?);
        } else if let Some(line) = lines.last_mut() {
            *line = longer;
        }
    }
    Ok(lines)
}
