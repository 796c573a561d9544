//! Title, grid, axes and their labels.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::LogAxis;
use super::canvas::{Canvas, Spot, Stroke, TextStyle};
use super::error::PlotError;
use super::labels::Area;
use super::output::{HEIGHT, WIDTH};
use super::palette::{FAINT_GRID, FLOOR, GRID, INK, SOFT_INK};
use crate::lab::study::words::percent;

/// The plot within the picture, logical pixels.
pub(super) const LEFT: f64 = 92.0;
pub(super) const RIGHT: f64 = 712.0;
pub(super) const TOP: f64 = 84.0;
pub(super) const BOTTOM: f64 = 528.0;
/// The legend beside it.
pub(super) const LEGEND_LEFT: f64 = 736.0;
pub(super) const LEGEND_RIGHT: f64 = WIDTH as f64 - 16.0;

/// Width of a dashed or fitted line, logical pixels.
pub(super) const LINE: f64 = 1.5;

/// The rectangle of the plot.
pub(super) const PAPER: Area = Area {
    from: (LEFT, TOP),
    to: (RIGHT, BOTTOM),
};

/// A line of the x axis's grid.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Logical pixel.
    pub x: f64,
    /// Text below, where there is one.
    pub label: Option<String>,
    /// Whether it reads upwards, for lack of room.
    pub upright: bool,
}

/// Size of labels below the axis, and of those that read upwards, logical pixels.
pub(super) const LABEL: f64 = 13.0;
pub(super) const UPRIGHT_LABEL: f64 = 10.0;
/// Room below the axis for those that read upwards, logical pixels.
pub(super) const UPRIGHT_ROOM: f64 = 46.0;

/// What stands around a plot.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub title: String,
    pub subtitle: String,
    pub x_title: String,
    pub columns: Vec<Column>,
    /// Relative L1 error.
    pub y: LogAxis,
}

/// The y axis of both plots: relative L1 errors, all above 0.
pub(super) fn error_axis(errors: &[f64]) -> LogAxis {
    LogAxis::new(errors, 1.5, 30.0, (BOTTOM, TOP))
}

impl Frame {
    pub(super) fn draw<DB: DrawingBackend>(
        &self,
        canvas: &mut Canvas<'_, DB>,
    ) -> Result<(), PlotError> {
        let width = LEGEND_RIGHT - LEFT;
        let title = canvas.fitted(&self.title, 20.0, width)?;
        canvas.text(&title, (LEFT, 32.0), TextStyle::new(20.0, INK))?;
        let subtitle = canvas.fitted(&self.subtitle, 13.0, width)?;
        canvas.text(&subtitle, (LEFT, 58.0), TextStyle::new(13.0, SOFT_INK))?;
        self.draw_grid(canvas)?;

        let axis = Stroke {
            colour: INK,
            width: 1.0,
        };
        canvas.line((LEFT, BOTTOM), (RIGHT, BOTTOM), axis)?;
        canvas.line((LEFT, TOP), (LEFT, BOTTOM), axis)?;
        let middle = TextStyle::new(14.0, INK).at(HPos::Center, VPos::Center);
        let x_title = canvas.fitted(&self.x_title, 14.0, RIGHT - LEFT)?;
        let below = (0.5 * (LEFT + RIGHT), f64::from(HEIGHT) - 16.0);
        canvas.text(&x_title, below, middle)?;
        let upright = TextStyle {
            upright: true,
            ..middle
        };
        let beside = (22.0, 0.5 * (TOP + BOTTOM));
        canvas.text("relative L1 error (%)", beside, upright)
    }

    fn draw_grid<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        let stroke = |labelled: bool| Stroke {
            colour: if labelled { GRID } else { FAINT_GRID },
            width: 1.0,
        };
        // Faint lines first, so that none crosses a stronger one.
        let ticks = self.y.decimal_ticks();
        for labelled in [false, true] {
            for column in self
                .columns
                .iter()
                .filter(|c| c.label.is_some() == labelled)
            {
                canvas.line((column.x, TOP), (column.x, BOTTOM), stroke(labelled))?;
            }
            for tick in ticks.iter().filter(|t| t.labelled == labelled) {
                let y = self.y.at(tick.value);
                canvas.line((LEFT, y), (RIGHT, y), stroke(labelled))?;
            }
        }
        let below = TextStyle::new(LABEL, INK).at(HPos::Center, VPos::Top);
        let upwards = TextStyle {
            upright: true,
            ..TextStyle::new(UPRIGHT_LABEL, INK).at(HPos::Right, VPos::Center)
        };
        for column in &self.columns {
            match &column.label {
                Some(label) if column.upright => {
                    canvas.text(label, (column.x, BOTTOM + 6.0), upwards)?;
                }
                Some(label) => canvas.text(label, (column.x, BOTTOM + 10.0), below)?,
                None => {}
            }
        }
        let beside = TextStyle::new(LABEL, INK).at(HPos::Right, VPos::Center);
        for tick in ticks.iter().filter(|t| t.labelled) {
            let spot = (LEFT - 10.0, self.y.at(tick.value));
            canvas.text(&percent(tick.value), spot, beside)?;
        }
        Ok(())
    }
}

/// The dashed line of the truth's own error, with its figure at the left end; nothing when the truth claims none.
pub(super) fn draw_floor<DB: DrawingBackend>(
    canvas: &mut Canvas<'_, DB>,
    y: &LogAxis,
    truth_error: f64,
) -> Result<(), PlotError> {
    if truth_error <= 0.0 {
        return Ok(());
    }
    let height = y.at(truth_error);
    canvas.dashed((LEFT, height), (RIGHT, height), 6.0, floor_stroke())?;
    let text = format!("the truth's own error, {}", percent(truth_error));
    let style = TextStyle::new(12.0, FLOOR).at(HPos::Left, VPos::Center);
    canvas.text(&text, (LEFT + 8.0, height + 10.0), style)
}

/// The stroke of the truth's own error.
pub(super) fn floor_stroke() -> Stroke {
    Stroke {
        colour: FLOOR,
        width: LINE,
    }
}

/// Part of the segment inside the plot; nothing when it passes outside.
pub(super) fn clipped(from: Spot, to: Spot) -> Option<(Spot, Spot)> {
    // Liang and Barsky: narrow the parameter's range side by side.
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut start, mut end) = (0.0f64, 1.0f64);
    for (step, room) in [
        (-dx, from.0 - LEFT),
        (dx, RIGHT - from.0),
        (-dy, from.1 - TOP),
        (dy, BOTTOM - from.1),
    ] {
        if step == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if step < 0.0 {
            start = start.max(room / step);
        } else {
            end = end.min(room / step);
        }
    }
    let at = |t: f64| (from.0 + t * dx, from.1 + t * dy);
    (start < end).then(|| (at(start), at(end)))
}
