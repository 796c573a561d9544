//! Renders a drawing to an SVG document and a PNG file.

use plotters::prelude::{BitMapBackend, DrawingBackend, SVGBackend};
use png::{BitDepth, ColorType, Compression, SrgbRenderingIntent};

use super::canvas::Canvas;
use super::error::PlotError;
use super::palette::WHITE;

/// A drawing as files. The same study gives the same bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// SVG document; its texts are texts.
    pub svg: String,
    /// PNG file, sRGB, 8 bits, twice the logical size.
    pub png: Vec<u8>,
}

/// Something that can be drawn on any backend.
pub(super) trait Drawing {
    /// Draws on white paper of [`WIDTH`] × [`HEIGHT`] logical pixels.
    fn draw<DB: DrawingBackend>(&self, canvas: &mut Canvas<'_, DB>) -> Result<(), PlotError>;
}

/// Logical pixels along x.
pub(super) const WIDTH: u32 = 960;
/// Logical pixels along y.
pub(super) const HEIGHT: u32 = 600;

/// Backend pixels in a logical one: the library places everything on whole pixels, and its polygons have hard edges.
pub(in crate::lab::study) const FINE: u32 = 4;
/// Samples along each side of a pixel of the PNG file.
const SAMPLES: u32 = 2;

/// Draws twice, by the same routine at the same coordinates.
pub(super) fn render(drawing: &impl Drawing) -> Result<Plot, PlotError> {
    Ok(Plot {
        svg: svg(drawing)?,
        png: bitmap(drawing)?,
    })
}

fn svg(drawing: &impl Drawing) -> Result<String, PlotError> {
    let (width, height) = (WIDTH * FINE, HEIGHT * FINE);
    let mut text = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut text, (width, height));
        paint(drawing, &mut backend)?;
        backend
            .present()
            .map_err(|e| PlotError::Draw(e.to_string()))?;
    }
    // The fine coordinates stay; the picture is shown at its logical size.
    let fine = format!("<svg width=\"{width}\" height=\"{height}\"");
    let shown = format!("<svg width=\"{WIDTH}\" height=\"{HEIGHT}\"");
    Ok(text.replacen(&fine, &shown, 1))
}

fn bitmap(drawing: &impl Drawing) -> Result<Vec<u8>, PlotError> {
    let (width, height) = (WIDTH * FINE, HEIGHT * FINE);
    let mut pixels = vec![0; width as usize * height as usize * 3];
    {
        let mut backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
        paint(drawing, &mut backend)?;
        backend
            .present()
            .map_err(|e| PlotError::Draw(e.to_string()))?;
    }
    let smooth = averaged(&pixels, width as usize, SAMPLES as usize);
    png_file(&smooth, width / SAMPLES, height / SAMPLES)
}

fn paint<DB: DrawingBackend>(drawing: &impl Drawing, backend: &mut DB) -> Result<(), PlotError> {
    let mut canvas = Canvas::new(backend, f64::from(FINE))?;
    let corner = (f64::from(WIDTH), f64::from(HEIGHT));
    canvas.rectangle((0.0, 0.0), corner, WHITE)?;
    drawing.draw(&mut canvas)
}

/// Mean of each square of `samples` × `samples` RGB pixels; width and height are multiples of it.
pub(in crate::lab::study) fn averaged(pixels: &[u8], width: usize, samples: usize) -> Vec<u8> {
    let height = pixels.len() / (3 * width);
    let mut out = Vec::with_capacity(pixels.len() / (samples * samples));
    for y in (0..height).step_by(samples) {
        for x in (0..width).step_by(samples) {
            for channel in 0..3 {
                let mut sum = 0;
                for dy in 0..samples {
                    for dx in 0..samples {
                        sum += usize::from(pixels[((y + dy) * width + x + dx) * 3 + channel]);
                    }
                }
                out.push(((sum + samples * samples / 2) / (samples * samples)) as u8);
            }
        }
    }
    out
}

/// An sRGB PNG file of 8 bits.
pub(in crate::lab::study) fn png_file(
    pixels: &[u8],
    width: u32,
    height: u32,
) -> Result<Vec<u8>, PlotError> {
    let failed = |error: png::EncodingError| PlotError::Png(error.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_compression(Compression::Balanced);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}
