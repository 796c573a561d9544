//! Markers: both shape and colour distinguish sweeps, so that either alone is enough.

use plotters::prelude::DrawingBackend;
use plotters::style::RGBColor;

use super::canvas::{Canvas, Spot};
use super::error::PlotError;
use super::palette::WHITE;

/// Half the height of a marker, logical pixels.
pub(super) const RADIUS: f64 = 5.0;
/// Width of the line of a hollow marker, logical pixels.
const LINE: f64 = 1.5;

/// Corners of each shape around the origin for a radius of 1, y down; the disc has none.
const SHAPES: [&[Spot]; 6] = [
    &[],
    &[(-0.85, -0.85), (0.85, -0.85), (0.85, 0.85), (-0.85, 0.85)],
    &[(0.0, -1.15), (1.1, 0.8), (-1.1, 0.8)],
    &[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)],
    &[(0.0, 1.15), (1.1, -0.8), (-1.1, -0.8)],
    &[
        (-0.5, -1.0),
        (0.5, -1.0),
        (1.0, 0.0),
        (0.5, 1.0),
        (-0.5, 1.0),
        (-1.0, 0.0),
    ],
];

/// A marker in the shape of that index.
pub(super) fn draw<DB: DrawingBackend>(
    canvas: &mut Canvas<'_, DB>,
    index: usize,
    centre: Spot,
    colour: RGBColor,
    hollow: bool,
) -> Result<(), PlotError> {
    // A thin white rim keeps markers apart from lines and from one another.
    shape(canvas, index, centre, RADIUS + 1.0, WHITE)?;
    shape(canvas, index, centre, RADIUS, colour)?;
    if hollow {
        shape(canvas, index, centre, RADIUS - LINE, WHITE)?;
    }
    Ok(())
}

fn shape<DB: DrawingBackend>(
    canvas: &mut Canvas<'_, DB>,
    index: usize,
    centre: Spot,
    radius: f64,
    colour: RGBColor,
) -> Result<(), PlotError> {
    // After all shapes the colours begin again, so the shapes move on by one.
    let corners = SHAPES[(index + index / SHAPES.len()) % SHAPES.len()];
    if corners.is_empty() {
        return canvas.disc(centre, radius, colour);
    }
    let corners: Vec<Spot> = corners
        .iter()
        .map(|(x, y)| (centre.0 + radius * x, centre.1 + radius * y))
        .collect();
    canvas.polygon(&corners, colour)
}
