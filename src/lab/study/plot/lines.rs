//! Lines over linear axes from 0: how a value grows with a dial.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, VPos};

use super::canvas::{Canvas, Spot, Stroke, TextStyle};
use super::error::PlotError;
use super::frame::{BOTTOM, LABEL, LEFT, LEGEND_RIGHT, LINE, RIGHT, TOP};
use super::legend::{self, Entry, Sign};
use super::marker;
use super::output::{Drawing, HEIGHT, Plot, render};
use super::palette::{self, GRID, INK, SOFT_INK};
use crate::lab::study::words::significant;

/// Lines to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineChart {
    /// Heading.
    pub title: String,
    /// Below it.
    pub subtitle: String,
    /// What x is, with its unit.
    pub x_title: String,
    /// What y is, with its unit.
    pub y_title: String,
    /// Name and points (x, y) of each line, x ascending, nothing negative.
    pub lines: Vec<(String, Vec<(f64, f64)>)>,
    /// Sentences below the legend.
    pub remarks: Vec<String>,
}

/// Draws the lines with a marker at each point.
///
/// # Errors
/// [`PlotError::Empty`] without points, [`PlotError::Figure`] for what is negative or not finite.
pub fn lines(chart: &LineChart) -> Result<Plot, PlotError> {
    let points = || {
        chart
            .lines
            .iter()
            .flat_map(|(name, points)| points.iter().map(move |p| (name, p)))
    };
    for (name, &(x, y)) in points() {
        for (what, value) in [("x", x), ("y", y)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(PlotError::Figure {
                    what,
                    setting: name.clone(),
                    value,
                });
            }
        }
    }
    if points().next().is_none() {
        return Err(PlotError::Empty(chart.title.clone()));
    }
    let largest =
        |of: &dyn Fn(&(f64, f64)) -> f64| points().map(|(_, p)| of(p)).fold(0.0, f64::max);
    render(&Lines {
        chart,
        x: LinearAxis::new(largest(&|p| p.0), (LEFT, RIGHT)),
        y: LinearAxis::new(largest(&|p| p.1), (BOTTOM, TOP)),
    })
}

/// From 0 to a round number.
struct LinearAxis {
    step: f64,
    steps: u32,
    pixels: (f64, f64),
}

impl LinearAxis {
    fn new(largest: f64, pixels: (f64, f64)) -> Self {
        let largest = if largest > 0.0 { largest } else { 1.0 };
        let raw = largest / 5.0;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .map(|digit| digit * power)
            .into_iter()
            .find(|step| *step >= raw * (1.0 - 1e-9))
            .unwrap_or(10.0 * power);
        Self {
            step,
            steps: (largest / step * 1.02).ceil() as u32,
            pixels,
        }
    }

    fn at(&self, value: f64) -> f64 {
        let share = value / (self.step * f64::from(self.steps));
        self.pixels.0 + share * (self.pixels.1 - self.pixels.0)
    }

    fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        (0..=self.steps).map(|k| f64::from(k) * self.step)
    }
}

struct Lines<'a> {
    chart: &'a LineChart,
    x: LinearAxis,
    y: LinearAxis,
}

impl Drawing for Lines<'_> {
    fn draw<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        self.draw_frame(canvas)?;
        let mut entries = Vec::new();
        for (index, (name, points)) in self.chart.lines.iter().enumerate() {
            let colour = palette::sweep(index);
            let spots: Vec<Spot> = points
                .iter()
                .map(|&(x, y)| (self.x.at(x), self.y.at(y)))
                .collect();
            for pair in spots.windows(2) {
                canvas.line(
                    pair[0],
                    pair[1],
                    Stroke {
                        colour,
                        width: LINE,
                    },
                )?;
            }
            for spot in spots {
                marker::draw(canvas, index, spot, colour, false)?;
            }
            let sign = Sign::Marker {
                shape: index,
                colour,
                hollow: false,
            };
            entries.push(Entry {
                sign,
                text: name.clone(),
            });
        }
        legend::draw(canvas, &entries, &self.chart.remarks)
    }
}

impl Lines<'_> {
    fn draw_frame<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError> {
        let width = LEGEND_RIGHT - LEFT;
        let title = canvas.fitted(&self.chart.title, 20.0, width)?;
        canvas.text(&title, (LEFT, 32.0), TextStyle::new(20.0, INK))?;
        let subtitle = canvas.fitted(&self.chart.subtitle, 13.0, width)?;
        canvas.text(&subtitle, (LEFT, 58.0), TextStyle::new(13.0, SOFT_INK))?;
        let grid = Stroke {
            colour: GRID,
            width: 1.0,
        };
        let below = TextStyle::new(LABEL, INK).at(HPos::Center, VPos::Top);
        for tick in self.x.ticks() {
            let x = self.x.at(tick);
            canvas.line((x, TOP), (x, BOTTOM), grid)?;
            canvas.text(&significant(tick, 3), (x, BOTTOM + 10.0), below)?;
        }
        let beside = TextStyle::new(LABEL, INK).at(HPos::Right, VPos::Center);
        for tick in self.y.ticks() {
            let y = self.y.at(tick);
            canvas.line((LEFT, y), (RIGHT, y), grid)?;
            canvas.text(&significant(tick, 3), (LEFT - 8.0, y), beside)?;
        }
        let axis = Stroke {
            colour: INK,
            width: 1.0,
        };
        canvas.line((LEFT, BOTTOM), (RIGHT, BOTTOM), axis)?;
        canvas.line((LEFT, TOP), (LEFT, BOTTOM), axis)?;
        let middle = TextStyle::new(14.0, INK).at(HPos::Center, VPos::Center);
        let bottom = (0.5 * (LEFT + RIGHT), f64::from(HEIGHT) - 16.0);
        canvas.text(&self.chart.x_title, bottom, middle)?;
        let upright = TextStyle {
            upright: true,
            ..middle
        };
        canvas.text(&self.chart.y_title, (22.0, 0.5 * (TOP + BOTTOM)), upright)
    }
}
