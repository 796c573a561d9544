//! Lines, shapes and texts on any backend, in logical pixels from the top left.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, RGBColor, ShapeStyle};

use super::error::PlotError;
use super::font;

/// A point in logical pixels.
pub(in crate::lab::study) type Spot = (f64, f64);

/// Ratio of a font's line height, by which the library sizes it, to its em.
const LINE_PER_EM: f64 = 1.24;

/// How far the library sets centred text too high, in ems: its bitmaps by 0.22, its SVG files by 0.1. The mean of both.
const CENTRE_LIFT: f64 = 0.16;

/// Size, colour, anchor and direction of a text.
#[derive(Clone, Copy)]
pub(in crate::lab::study) struct TextStyle {
    /// Em size, logical pixels.
    pub size: f64,
    pub colour: RGBColor,
    pub h: HPos,
    pub v: VPos,
    /// Whether the text reads from bottom to top.
    pub upright: bool,
}

impl TextStyle {
    /// Level text, anchored at its left end, halfway up.
    pub(in crate::lab::study) fn new(size: f64, colour: RGBColor) -> Self {
        Self {
            size,
            colour,
            h: HPos::Left,
            v: VPos::Center,
            upright: false,
        }
    }

    pub(in crate::lab::study) fn at(self, h: HPos, v: VPos) -> Self {
        Self { h, v, ..self }
    }
}

/// A stroke.
#[derive(Clone, Copy, Debug)]
pub(in crate::lab::study) struct Stroke {
    pub colour: RGBColor,
    /// Logical pixels.
    pub width: f64,
}

/// Where things are drawn.
pub(in crate::lab::study) struct Canvas<'a, DB: DrawingBackend> {
    backend: &'a mut DB,
    /// Backend pixels in a logical one.
    scale: f64,
}

impl<'a, DB: DrawingBackend> Canvas<'a, DB> {
    pub(in crate::lab::study) fn new(backend: &'a mut DB, scale: f64) -> Result<Self, PlotError> {
        font::register()?;
        Ok(Self { backend, scale })
    }

    fn pixel(&self, (x, y): Spot) -> (i32, i32) {
        (
            (x * self.scale).round() as i32,
            (y * self.scale).round() as i32,
        )
    }

    fn stroke(&self, stroke: Stroke) -> ShapeStyle {
        ShapeStyle {
            color: stroke.colour.to_rgba(),
            filled: false,
            stroke_width: ((stroke.width * self.scale).round() as u32).max(1),
        }
    }

    fn fill(colour: RGBColor) -> ShapeStyle {
        ShapeStyle {
            color: colour.to_rgba(),
            filled: true,
            stroke_width: 0,
        }
    }

    /// A filled rectangle.
    pub(in crate::lab::study) fn rectangle(
        &mut self,
        from: Spot,
        to: Spot,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let (from, to) = (self.pixel(from), self.pixel(to));
        self.backend
            .draw_rect(from, to, &Self::fill(colour), true)
            .map_err(failed)
    }

    pub(in crate::lab::study) fn line(
        &mut self,
        from: Spot,
        to: Spot,
        stroke: Stroke,
    ) -> Result<(), PlotError> {
        let (from, to, style) = (self.pixel(from), self.pixel(to), self.stroke(stroke));
        self.backend.draw_line(from, to, &style).map_err(failed)
    }

    /// A dashed line: `dash` logical pixels on, as many off.
    pub(in crate::lab::study) fn dashed(
        &mut self,
        from: Spot,
        to: Spot,
        dash: f64,
        stroke: Stroke,
    ) -> Result<(), PlotError> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        let mut start = 0.0;
        while start < length {
            let end = (start + dash).min(length);
            let spot = |t: f64| (from.0 + dx * t / length, from.1 + dy * t / length);
            self.line(spot(start), spot(end), stroke)?;
            start += 2.0 * dash;
        }
        Ok(())
    }

    /// A filled polygon.
    pub(in crate::lab::study) fn polygon(
        &mut self,
        corners: &[Spot],
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let corners: Vec<_> = corners.iter().map(|c| self.pixel(*c)).collect();
        self.backend
            .fill_polygon(corners, &Self::fill(colour))
            .map_err(failed)
    }

    /// A filled disc.
    pub(in crate::lab::study) fn disc(
        &mut self,
        centre: Spot,
        radius: f64,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let (centre, radius) = (
            self.pixel(centre),
            (radius * self.scale).round().max(1.0) as u32,
        );
        self.backend
            .draw_circle(centre, radius, &Self::fill(colour), true)
            .map_err(failed)
    }

    pub(in crate::lab::study) fn text(
        &mut self,
        text: &str,
        spot: Spot,
        style: TextStyle,
    ) -> Result<(), PlotError> {
        let lift = match style.v {
            VPos::Center => CENTRE_LIFT * style.size,
            _ => 0.0,
        };
        // The foot of upright text points to the right.
        let spot = if style.upright {
            (spot.0 + lift, spot.1)
        } else {
            (spot.0, spot.1 + lift)
        };
        let (style, spot) = (self.backend_style(style), self.pixel(spot));
        self.backend.draw_text(text, &style, spot).map_err(failed)
    }

    /// Width of a level text, logical pixels, in the built-in font.
    pub(in crate::lab::study) fn text_width(
        &self,
        text: &str,
        size: f64,
    ) -> Result<f64, PlotError> {
        let style = self.backend_style(TextStyle::new(size, super::palette::INK));
        let (width, _) = self
            .backend
            .estimate_text_size(text, &style)
            .map_err(failed)?;
        Ok(f64::from(width) / self.scale)
    }

    /// The text, or as much of it as fits into `width`, with an ellipsis.
    pub(in crate::lab::study) fn fitted(
        &self,
        text: &str,
        size: f64,
        width: f64,
    ) -> Result<String, PlotError> {
        let mut fitted = text.to_owned();
        let mut kept = text.chars().count();
        while kept > 0 && self.text_width(&fitted, size)? > width {
            kept -= 1;
            fitted = text.chars().take(kept).collect::<String>();
            fitted = fitted.trim_end().to_owned() + "…";
        }
        Ok(fitted)
    }

    /// The same style for the drawing library.
    fn backend_style(&self, style: TextStyle) -> plotters::style::TextStyle<'static> {
        let mut font = (font::FAMILY, style.size * LINE_PER_EM * self.scale).into_font();
        if style.upright {
            font = font.transform(FontTransform::Rotate270);
        }
        let mut backend_style =
            plotters::style::TextStyle::from(font).pos(Pos::new(style.h, style.v));
        backend_style.color = style.colour.to_backend_color();
        backend_style
    }
}

fn failed(error: impl std::fmt::Display) -> PlotError {
    PlotError::Draw(error.to_string())
}
