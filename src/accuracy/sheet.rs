//! A bitmap to lay tiles and texts on.

use plotters::prelude::{BitMapBackend, DrawingBackend};

use super::plot::PlotError;
use super::plot::canvas::{Canvas, Spot, TextLook};
use super::plot::output::png_file;

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
    pub look: TextLook,
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
    pub(super) fn finish(self) -> Result<Vec<u8>, PlotError> {
        let size = (self.tile.width as u32, self.tile.height as u32);
        let mut bytes = self.tile.pixels.as_flattened().to_vec();
        {
            let mut backend = BitMapBackend::with_buffer(&mut bytes, size);
            let mut canvas = Canvas::new(&mut backend, 1.0)?;
            for caption in &self.captions {
                let text = canvas.fitted(&caption.text, caption.look.size, caption.width)?;
                canvas.text(&text, caption.spot, caption.look)?;
            }
            backend
                .present()
                .map_err(|error| PlotError::Draw(error.to_string()))?;
        }
        png_file(&bytes, size.0, size.1)
    }
}
