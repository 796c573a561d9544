//! Convergence: how the error of a sweep falls with its dial.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::LogAxis;
use super::canvas::{Canvas, Spot, Stroke, TextStyle};
use super::error::PlotError;
use super::frame::{
    BOTTOM, Column, Frame, LABEL, LEFT, LINE, RIGHT, UPRIGHT_LABEL, UPRIGHT_ROOM, clipped,
    draw_floor, error_axis, floor_stroke,
};
use super::legend::{self, Entry, Sign};
use super::marker;
use super::output::{Drawing, Plot, render};
use super::palette::{self, REFERENCE, SOFT_INK};
use super::series::{Mark, marks, moved_remark, subtitle};
use crate::lab::study::order::{
    LevelFit, OrderFit, TRUTH_MARGIN, fit_levels, fit_order, level_number,
};
use crate::lab::study::study::{Study, Sweep};
use crate::lab::study::words::significant;

/// Draws the relative L1 error of one sweep over its dial. For a dial that is a number: logarithmic axis, the fitted power
/// law with its order, the slopes of order 1 and 2 for comparison. For words, switches and several dials: side by side. For a dial that
/// counts halvings: the fitted factor per level. The truth's own error is dashed; what the renders estimated themselves is hollow.
///
/// # Errors
///
/// [`PlotError::NoSweep`], [`PlotError::Empty`] for a sweep without settings, [`PlotError::Figure`] for figures that are
/// negative or not finite.
pub fn convergence(study: &Study, sweep_index: usize) -> Result<Plot, PlotError> {
    let Some(sweep) = study.sweeps.get(sweep_index) else {
        return Err(PlotError::NoSweep {
            index: sweep_index,
            sweeps: study.sweeps.len(),
        });
    };
    let marks = marks(study, Some(sweep_index))?;
    if marks.is_empty() {
        return Err(PlotError::Empty(format!("the sweep of {}", sweep.dial)));
    }
    let truth_error = study.truth.relative_error;
    let errors: Vec<f64> = marks
        .iter()
        .flat_map(|mark| [Some(mark.error), mark.estimated])
        .flatten()
        .chain(Some(truth_error).filter(|error| *error > 0.0))
        .collect();
    render(&Convergence {
        study,
        sweep,
        x: DialAxis::new(&marks),
        y: error_axis(&errors),
        fit: fit_order(sweep, truth_error),
        levels: fit_levels(sweep, truth_error),
        marks,
    })
}

/// Where a dial's values lie.
enum DialAxis {
    Numbers(LogAxis),
    /// One column per setting; the number of settings.
    Words(usize),
}

impl DialAxis {
    fn new(marks: &[Mark]) -> Self {
        let numbers: Option<Vec<f64>> = marks.iter().map(|mark| mark.dial).collect();
        match numbers {
            Some(dials) => Self::Numbers(LogAxis::new(&dials, 1.4, 4.0, (LEFT, RIGHT))),
            None => Self::Words(marks.len()),
        }
    }

    fn at(&self, index: usize, mark: &Mark) -> f64 {
        match (self, mark.dial) {
            (Self::Numbers(axis), Some(dial)) => axis.at(dial),
            (Self::Numbers(_), None) => LEFT,
            (Self::Words(count), _) => LEFT + (index as f64 + 0.5) / *count as f64 * (RIGHT - LEFT),
        }
    }
}

struct Convergence<'a> {
    study: &'a Study,
    sweep: &'a Sweep,
    x: DialAxis,
    y: LogAxis,
    fit: Option<OrderFit>,
    levels: Option<LevelFit>,
    marks: Vec<Mark>,
}

/// Room between the texts below the axis, logical pixels.
const LABEL_GAP: f64 = 10.0;

impl Drawing for Convergence<'_> {
    fn draw<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        let columns = self.columns(canvas)?;
        self.frame(columns).draw(canvas)?;
        self.draw_slopes(canvas)?;
        draw_floor(canvas, &self.y, self.study.truth.relative_error)?;
        self.draw_fit(canvas)?;
        self.draw_levels(canvas)?;
        for (index, mark) in self.marks.iter().enumerate() {
            let x = self.x.at(index, mark);
            if let Some(estimated) = mark.estimated {
                let spot = (x, self.y.at(estimated));
                marker::draw(canvas, ESTIMATE, spot, SOFT_INK, true)?;
            }
        }
        for (index, mark) in self.marks.iter().enumerate() {
            let spot = (self.x.at(index, mark), self.y.at(mark.error));
            marker::draw(canvas, mark.sweep, spot, self.colour(), mark.moved)?;
        }
        legend::draw(canvas, &self.entries(), &self.remarks())
    }
}

/// Shape of the marks for estimates: the diamond, whatever the sweep.
const ESTIMATE: usize = 3;

impl Convergence<'_> {
    fn colour(&self) -> plotters::style::RGBColor {
        palette::sweep(self.marks[0].sweep)
    }

    /// One line of the grid for each value, with a label where there is room.
    fn columns<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, DB>,
    ) -> Result<Vec<Column>, PlotError> {
        let mut spots: Vec<(f64, &Mark)> = self
            .marks
            .iter()
            .enumerate()
            .map(|(index, mark)| (self.x.at(index, mark), mark))
            .collect();
        spots.sort_by(|a, b| a.0.total_cmp(&b.0));
        spots.dedup_by(|a, b| a.0 == b.0);
        let upright = self.lacks_room(canvas)?;
        let mut columns = Vec::new();
        let mut free_from = f64::NEG_INFINITY;
        for (x, mark) in spots {
            let (size, room) = if upright {
                (UPRIGHT_LABEL, UPRIGHT_ROOM)
            } else {
                (LABEL, RIGHT - LEFT)
            };
            let text = canvas.fitted(&mark.label, size, room)?;
            let half = if upright {
                0.5 * size
            } else {
                0.5 * (canvas.text_width(&text, size)? + LABEL_GAP)
            };
            let fits = x - half >= free_from;
            if fits {
                free_from = x + half;
            }
            columns.push(Column {
                x,
                label: fits.then_some(text),
                upright,
            });
        }
        Ok(columns)
    }

    /// Whether words are too wide to stand side by side.
    fn lacks_room<DB: DrawingBackend>(&self, canvas: &Canvas<'_, DB>) -> Result<bool, PlotError> {
        let DialAxis::Words(count) = self.x else {
            return Ok(false);
        };
        let room = (RIGHT - LEFT) / count as f64 - LABEL_GAP;
        for mark in &self.marks {
            if canvas.text_width(&mark.label, LABEL)? > room {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn frame(&self, columns: Vec<Column>) -> Frame {
        let scale = match self.x {
            DialAxis::Numbers(_) => " (logarithmic)",
            DialAxis::Words(_) => "",
        };
        Frame {
            title: format!("Convergence with {}", self.sweep.dial),
            subtitle: subtitle(self.study),
            x_title: format!("{}{scale}", self.sweep.dial),
            columns,
            y: self.y.clone(),
        }
    }

    /// Orders 1 and 2, through the first setting of the fit.
    fn draw_slopes<DB: DrawingBackend>(
        &self,
        canvas: &mut Canvas<'_, DB>,
    ) -> Result<(), PlotError> {
        let (DialAxis::Numbers(axis), Some(fit)) = (&self.x, &self.fit) else {
            return Ok(());
        };
        let Some(start) = self.fitted_range(fit).map(|(low, _)| low) else {
            return Ok(());
        };
        let stroke = Stroke {
            colour: REFERENCE,
            width: 1.0,
        };
        for order in [1.0, 2.0] {
            let law = |dial: f64| fit.error_at(start) * (dial / start).powf(-order);
            let Some((from, to)) = self.segment(axis, start, axis.ends().1, law) else {
                continue;
            };
            canvas.dashed(from, to, 2.5, stroke)?;
            // Below the end, or beside it where the line leaves through the bottom.
            let below = to.1 + 20.0 < BOTTOM;
            let (h, spot) = if below {
                (HPos::Right, (to.0 - 4.0, to.1 + 13.0))
            } else {
                (HPos::Left, (to.0 + 6.0, to.1 - 9.0))
            };
            let style = TextStyle::new(11.0, SOFT_INK).at(h, VPos::Center);
            canvas.text(&format!("order {order}"), spot, style)?;
        }
        Ok(())
    }

    fn draw_fit<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        let (DialAxis::Numbers(axis), Some(fit)) = (&self.x, &self.fit) else {
            return Ok(());
        };
        let Some((low, high)) = self.fitted_range(fit) else {
            return Ok(());
        };
        let Some((from, to)) = self.segment(axis, low, high, |dial| fit.error_at(dial)) else {
            return Ok(());
        };
        canvas.line(from, to, self.fit_stroke())?;
        let middle = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        // Towards the corner that a falling line leaves empty.
        let style = TextStyle::new(14.0, palette::sweep_ink(self.marks[0].sweep))
            .at(HPos::Right, VPos::Center);
        let text = format!("order {}", significant(fit.order, 3));
        canvas.text(&text, (middle.0 - 10.0, middle.1 + 12.0), style)
    }

    /// The law of a factor per level, from setting to setting: they need not be evenly spaced.
    fn draw_levels<DB: DrawingBackend>(
        &self,
        canvas: &mut Canvas<'_, DB>,
    ) -> Result<(), PlotError> {
        let Some(fit) = &self.levels else {
            return Ok(());
        };
        let points = self.sweep.points.iter().enumerate().zip(&self.marks);
        let mut spots: Vec<Spot> = points
            .filter(|((index, _), _)| fit.used[*index])
            .filter_map(|((index, point), mark)| {
                let level = level_number(self.sweep, point)?;
                Some((self.x.at(index, mark), self.y.at(fit.error_at(level))))
            })
            .collect();
        spots.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in spots.windows(2) {
            if let Some((from, to)) = clipped(pair[0], pair[1]) {
                canvas.line(from, to, self.fit_stroke())?;
            }
        }
        Ok(())
    }

    fn fit_stroke(&self) -> Stroke {
        Stroke {
            colour: self.colour(),
            width: LINE,
        }
    }

    /// Smallest and largest dial that took part in the fit.
    fn fitted_range(&self, fit: &OrderFit) -> Option<(f64, f64)> {
        let used = self.marks.iter().zip(&fit.used).filter(|(_, used)| **used);
        let dials: Vec<f64> = used.filter_map(|(mark, _)| mark.dial).collect();
        let low = dials.iter().copied().fold(f64::INFINITY, f64::min);
        let high = dials.iter().copied().fold(0.0, f64::max);
        (low < high).then_some((low, high))
    }

    /// A power law is straight on logarithmic axes.
    fn segment(
        &self,
        axis: &LogAxis,
        low: f64,
        high: f64,
        law: impl Fn(f64) -> f64,
    ) -> Option<(Spot, Spot)> {
        let spot = |dial: f64| (axis.at(dial), self.y.at(law(dial)));
        clipped(spot(low), spot(high))
    }

    fn entries(&self) -> Vec<Entry> {
        let mut entries = vec![Entry {
            sign: Sign::Marker {
                shape: self.marks[0].sweep,
                colour: self.colour(),
                hollow: false,
            },
            text: "measured against the truth".to_owned(),
        }];
        if self.marks.iter().any(|mark| mark.estimated.is_some()) {
            entries.push(Entry {
                sign: Sign::Marker {
                    shape: ESTIMATE,
                    colour: SOFT_INK,
                    hollow: true,
                },
                text: "estimated by the render itself".to_owned(),
            });
        }
        if let Some(fit) = &self.fit {
            entries.push(Entry {
                sign: Sign::Line(self.fit_stroke()),
                text: format!("fit: order {}", significant(fit.order, 3)),
            });
            entries.push(Entry {
                sign: Sign::Dashed(Stroke {
                    colour: REFERENCE,
                    width: 1.0,
                }),
                text: "orders 1 and 2, for comparison".to_owned(),
            });
        }
        if let Some(levels) = &self.levels {
            entries.push(Entry {
                sign: Sign::Line(self.fit_stroke()),
                text: format!("fit: ÷ {} per level", significant(levels.factor, 3)),
            });
        }
        if self.study.truth.relative_error > 0.0 {
            entries.push(Entry {
                sign: Sign::Dashed(floor_stroke()),
                text: "the truth's own error".to_owned(),
            });
        }
        entries
    }

    fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        let fits = [
            self.fit.as_ref().map(|fit| &fit.used),
            self.levels.as_ref().map(|fit| &fit.used),
        ];
        let left_out = fits
            .into_iter()
            .flatten()
            .flatten()
            .filter(|used| !**used)
            .count();
        if left_out > 0 {
            remarks.push(format!(
                "The fit leaves out {left_out} of {} settings: their error is less than {TRUTH_MARGIN} times the truth's own.",
                self.marks.len()
            ));
        }
        remarks.extend(moved_remark(&self.marks, self.study.truth.relative_error));
        remarks
    }
}
