//! A bitmap to lay tiles and texts on.

use plotters::prelude::{BitMapBackend, DrawingBackend};
use plotters::style::text_anchor::HPos;

use super::plot::PlotError;
use super::plot::canvas::{Canvas, Spot, TextStyle};
use super::plot::output::{FINE, averaged, png_file};

/// A picture of pixels, row by row from the top, sRGB.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 3]>,
}

/// A text on a sheet.
pub(super) struct Caption {
    pub text: String,
    pub spot: Spot,
    /// Level, and centred about its height.
    pub style: TextStyle,
    /// It ends in an ellipsis where it is wider, pixels.
    pub width: f64,
}

/// White paper.
pub(super) struct Sheet {
    tile: Tile,
    captions: Vec<Caption>,
}

impl Sheet {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self {
            tile: Tile {
                width,
                height,
                pixels: vec![[255; 3]; width * height],
            },
            captions: Vec::new(),
        }
    }

    /// Lays a tile with its top left corner at (x, y), in a thin grey frame; what passes the edges is cut.
    pub(super) fn lay(&mut self, tile: &Tile, x: usize, y: usize) {
        for row in 0..tile.height + 2 {
            for column in 0..tile.width + 2 {
                let (x, y) = (x + column, y + row);
                if x == 0 || y == 0 || x > self.tile.width || y > self.tile.height {
                    continue;
                }
                let inside = (1..=tile.width).contains(&column) && (1..=tile.height).contains(&row);
                self.tile.pixels[(y - 1) * self.tile.width + x - 1] = if inside {
                    tile.pixels[(row - 1) * tile.width + column - 1]
                } else {
                    [150; 3]
                };
            }
        }
    }

    pub(super) fn write(&mut self, caption: Caption) {
        self.captions.push(caption);
    }

    /// The PNG file.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, PlotError> {
        for caption in std::mem::take(&mut self.captions) {
            self.stamp(&caption)?;
        }
        let (width, height) = (self.tile.width as u32, self.tile.height as u32);
        png_file(self.tile.pixels.as_flattened(), width, height)
    }

    /// Prints a caption, drawn fine and averaged: the library sets letters on whole pixels, which shows in small texts.
    fn stamp(&mut self, caption: &Caption) -> Result<(), PlotError> {
        let (size, fine) = (caption.style.size, FINE as usize);
        let height = (2.0 * size).ceil() as usize;
        let (text, width) = measured(caption)?;
        let (across, down) = (width * fine, height * fine);
        let mut bytes = vec![255; across * down * 3];
        {
            let mut backend = BitMapBackend::with_buffer(&mut bytes, (across as u32, down as u32));
            let mut canvas = Canvas::new(&mut backend, f64::from(FINE))?;
            let style = TextStyle::new(size, caption.style.colour);
            canvas.text(&text, (0.0, size), style)?;
            backend
                .present()
                .map_err(|error| PlotError::Draw(error.to_string()))?;
        }
        let print = averaged(&bytes, across, fine);
        let left = match caption.style.h {
            HPos::Left => caption.spot.0,
            HPos::Center => caption.spot.0 - 0.5 * width as f64,
            HPos::Right => caption.spot.0 - width as f64,
        };
        let corner = (
            left.round() as isize,
            (caption.spot.1 - size).round() as isize,
        );
        self.print(&print, width, corner);
        Ok(())
    }

    /// Multiplies the paper by a print, so that white leaves it as it is; what passes the edges is cut.
    fn print(&mut self, print: &[u8], width: usize, (left, top): (isize, isize)) {
        for (index, ink) in print.chunks_exact(3).enumerate() {
            let x = left + (index % width) as isize;
            let y = top + (index / width) as isize;
            let inside = (0..self.tile.width as isize).contains(&x)
                && (0..self.tile.height as isize).contains(&y);
            if !inside {
                continue;
            }
            let pixel = &mut self.tile.pixels[y as usize * self.tile.width + x as usize];
            for (paper, ink) in pixel.iter_mut().zip(ink) {
                *paper = (u16::from(*paper) * u16::from(*ink) / 255) as u8;
            }
        }
    }
}

/// The text as far as it fits, and its width in whole pixels.
fn measured(caption: &Caption) -> Result<(String, usize), PlotError> {
    let mut none = [0; 3];
    let mut backend = BitMapBackend::with_buffer(&mut none, (1, 1));
    let canvas = Canvas::new(&mut backend, f64::from(FINE))?;
    let text = canvas.fitted(&caption.text, caption.style.size, caption.width)?;
    let width = canvas.text_width(&text, caption.style.size)?.ceil() as usize + 1;
    Ok((text, width))
}
