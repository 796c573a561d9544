//! Error against time of each setting.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::LogAxis;
use super::canvas::{Canvas, Spot, Stroke, TextStyle};
use super::error::PlotError;
use super::frame::{Column, Frame, LEFT, LINE, PAPER, RIGHT, draw_floor, error_axis, floor_stroke};
use super::labels::{Area, Occupied};
use super::legend::{self, Entry, Sign};
use super::marker;
use super::output::{Drawing, Plot, render};
use super::palette::{self, GRID, INK};
use super::series::{Look, Mark, looks, marks, moved_remark, subtitle};
use crate::lab::study::equal_time;
use crate::lab::study::study::Study;
use crate::lab::study::words;

/// Draws the relative L1 error over the median time of every setting of all sweeps, on logarithmic axes: whiskers from the
/// fastest to the slowest run, the Pareto front as a line, the truth's own error dashed. In a comparison each method has a colour, in which
/// its own front is drawn, and only settings on that have a label.
///
/// An error of 0 is drawn at a tenth of the truth's own error, with a remark.
///
/// # Errors
///
/// [`PlotError::Empty`] without settings, [`PlotError::Figure`] for figures that are negative or not finite.
pub fn error_against_time(study: &Study) -> Result<Plot, PlotError> {
    let marks = marks(study, None)?;
    if marks.is_empty() {
        return Err(PlotError::Empty("the study".to_owned()));
    }
    let times: Vec<f64> = marks
        .iter()
        .flat_map(|mark| [mark.ms.min, mark.ms.median, mark.ms.max])
        .collect();
    let mut errors: Vec<f64> = marks.iter().map(|mark| mark.error).collect();
    errors.extend(Some(study.truth.relative_error).filter(|error| *error > 0.0));
    render(&ErrorTime {
        study,
        looks: looks(study),
        x: LogAxis::new(&times, 1.35, 10.0, (LEFT, RIGHT)),
        y: error_axis(&errors),
        marks,
    })
}

struct ErrorTime<'a> {
    study: &'a Study,
    looks: Vec<Look>,
    x: LogAxis,
    y: LogAxis,
    marks: Vec<Mark>,
}

const FRONT: Stroke = Stroke {
    colour: INK,
    width: 1.25,
};
/// Width of the Pareto front of a comparison, and of each method's front.
const WIDE: f64 = 4.0;
const THIN: f64 = 1.0;
const LABEL_SIZE: f64 = 12.0;

impl Drawing for ErrorTime<'_> {
    fn draw<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        self.frame().draw(canvas)?;
        draw_floor(canvas, &self.y, self.study.truth.relative_error)?;
        let front = self.front();
        for pair in front.windows(2) {
            canvas.line(pair[0], pair[1], self.front_stroke())?;
        }
        let of_methods = self.method_fronts();
        for (colour, spots) in &of_methods {
            let stroke = Stroke {
                colour: palette::sweep(*colour),
                width: THIN,
            };
            for pair in spots.windows(2) {
                canvas.line(pair[0], pair[1], stroke)?;
            }
        }
        self.draw_whiskers(canvas)?;
        for mark in &self.marks {
            let look = self.looks[mark.sweep];
            let colour = palette::sweep(look.colour);
            marker::draw(canvas, look.shape, self.spot(mark), colour, mark.moved)?;
        }
        let left_out = self.draw_labels(canvas, &front)?;
        legend::draw(canvas, &self.entries(), &self.remarks(left_out))
    }
}

impl ErrorTime<'_> {
    fn spot(&self, mark: &Mark) -> Spot {
        (self.x.at(mark.ms.median), self.y.at(mark.error))
    }

    fn frame(&self) -> Frame {
        let columns = self.x.decimal_ticks().into_iter().map(|tick| Column {
            x: self.x.at(tick.value),
            label: tick
                .labelled
                .then(|| format!("{} ms", words::ms(tick.value))),
            upright: false,
        });
        Frame {
            title: "Error against time".to_owned(),
            subtitle: subtitle(self.study),
            x_title: "time of a frame (ms): median, and from the fastest to the slowest run"
                .to_owned(),
            columns: columns.collect(),
            y: self.y.clone(),
        }
    }

    /// In a comparison the front is wide and pale, so that the methods' own fronts are visible on it.
    fn front_stroke(&self) -> Stroke {
        match self.study.is_comparison() {
            true => Stroke {
                colour: GRID,
                width: WIDE,
            },
            false => FRONT,
        }
    }

    /// The front of each method: its colour, and its spots, fastest first.
    fn method_fronts(&self) -> Vec<(usize, Vec<Spot>)> {
        let names = equal_time::methods(self.study).into_iter().enumerate();
        names
            .map(|(colour, name)| {
                let own = equal_time::method_front(self.study, name);
                let spots = own.iter().filter_map(|standing| {
                    let mark = self.marks.iter().find(|mark| {
                        mark.sweep == standing.sweep_index && mark.point == standing.point_index
                    });
                    mark.map(|mark| self.spot(mark))
                });
                (colour, spots.collect())
            })
            .collect()
    }

    /// Whether a mark has a label: all have one, in a comparison those on their method's front.
    fn is_labelled(&self, mark: &Mark) -> bool {
        if !self.study.is_comparison() {
            return true;
        }
        let method = equal_time::method_of(&self.study.sweeps[mark.sweep]);
        let own = equal_time::method_front(self.study, method);
        own.iter()
            .any(|s| s.sweep_index == mark.sweep && s.point_index == mark.point)
    }

    /// The front's spots, fastest first.
    fn front(&self) -> Vec<Spot> {
        let mut front: Vec<&Mark> = self.marks.iter().filter(|mark| mark.on_front).collect();
        front.sort_by(|a, b| {
            let by_time = a.ms.median.total_cmp(&b.ms.median);
            by_time.then(b.error.total_cmp(&a.error))
        });
        front.into_iter().map(|mark| self.spot(mark)).collect()
    }

    fn draw_whiskers<DB: DrawingBackend>(
        &self,
        canvas: &mut Canvas<'_, DB>,
    ) -> Result<(), PlotError> {
        for mark in &self.marks {
            let y = self.y.at(mark.error);
            let stroke = Stroke {
                colour: palette::sweep(self.looks[mark.sweep].colour),
                width: LINE,
            };
            let ends = [self.x.at(mark.ms.min), self.x.at(mark.ms.max)];
            canvas.line((ends[0], y), (ends[1], y), stroke)?;
            for x in ends {
                canvas.line((x, y - 4.0), (x, y + 4.0), stroke)?;
            }
        }
        Ok(())
    }

    /// Writes the dials' values beside the marks; returns the number of marks without room for a label.
    fn draw_labels<DB: DrawingBackend>(
        &self,
        canvas: &mut Canvas<'_, DB>,
        front: &[Spot],
    ) -> Result<usize, PlotError> {
        let mut occupied = Occupied::new(PAPER);
        for mark in &self.marks {
            let (x, y) = self.spot(mark);
            let reach = marker::RADIUS + 1.0;
            occupied.add(Area::around((x, y), reach, reach));
            let ends = (self.x.at(mark.ms.min), self.x.at(mark.ms.max));
            occupied.add_line((ends.0, y), (ends.1, y));
        }
        for pair in front.windows(2) {
            occupied.add_line(pair[0], pair[1]);
        }
        let truth_error = self.study.truth.relative_error;
        if truth_error > 0.0 {
            let y = self.y.at(truth_error);
            occupied.add_line((LEFT, y), (RIGHT, y));
            occupied.add(Area {
                from: (LEFT, y + 2.0),
                to: (LEFT + 200.0, y + 18.0),
            });
        }
        let mut left_out = 0;
        for mark in self.marks.iter().filter(|mark| self.is_labelled(mark)) {
            let width = canvas.text_width(&mark.label, LABEL_SIZE)?;
            match occupied.place(self.spot(mark), width, LABEL_SIZE) {
                Some(centre) => {
                    let style = TextStyle::new(
                        LABEL_SIZE,
                        palette::sweep_ink(self.looks[mark.sweep].colour),
                    )
                    .at(HPos::Center, VPos::Center);
                    canvas.text(&mark.label, centre, style)?;
                }
                None => left_out += 1,
            }
        }
        Ok(left_out)
    }

    fn entries(&self) -> Vec<Entry> {
        let drawn = |index: usize| self.marks.iter().any(|mark| mark.sweep == index);
        let mut entries: Vec<Entry> = self
            .study
            .sweeps
            .iter()
            .enumerate()
            .filter(|(index, _)| drawn(*index))
            .map(|(index, sweep)| Entry {
                sign: Sign::Marker {
                    shape: self.looks[index].shape,
                    colour: palette::sweep(self.looks[index].colour),
                    hollow: false,
                },
                text: sweep.dial.clone(),
            })
            .collect();
        if self.marks.iter().filter(|mark| mark.on_front).count() > 1 {
            entries.push(Entry {
                sign: Sign::Line(self.front_stroke()),
                text: "Pareto front: no setting is both faster and nearer".to_owned(),
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

    /// What the numbers and the thin lines are, and which methods are absent.
    fn words_of_comparison(&self) -> String {
        let mut chiefs: Vec<&str> = Vec::new();
        for of in self
            .study
            .sweeps
            .iter()
            .filter_map(|sweep| sweep.series.as_ref())
        {
            if !chiefs.contains(&of.chief.as_str()) {
                chiefs.push(&of.chief);
            }
        }
        let mut text = format!(
            "Thin lines: each method's own front. Numbers: {}.",
            chiefs.join(" or ")
        );
        let absent = equal_time::absent(self.study).into_iter();
        let absent: Vec<&str> = absent.map(|(name, _)| name).collect();
        if !absent.is_empty() {
            text.push_str(&format!(" Cannot do it: {}.", absent.join("; ")));
        }
        text
    }

    fn remarks(&self, left_out: usize) -> Vec<String> {
        let mut remarks = vec![match self.study.is_comparison() {
            true => self.words_of_comparison(),
            false => "Numbers beside the marks: the dial's value.".to_owned(),
        }];
        remarks.extend(moved_remark(&self.marks, self.study.truth.relative_error));
        if left_out > 0 {
            remarks.push(format!(
                "{left_out} of {} marks have no label, for lack of room.",
                self.marks.len()
            ));
        }
        remarks
    }
}
