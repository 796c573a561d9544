//! Contact sheets: of each setting of a sweep, or of what each method achieves within a time, the render, its errors, and their visibility.
//!
//! One column per setting: the render, the signed error (blue: too dark, red: too bright), the ꟻLIP map. The first column has
//! the truth and the colour bars. All colours mean the same in all columns.

use plotters::style::text_anchor::{HPos, VPos};

use super::colour_map::{diverging, magma};
use super::equal_time;
use super::error_tiles::{Column, mean, picture, scale};
use super::plot::PlotError;
use super::plot::canvas::TextStyle;
use super::plot::palette::{INK, SOFT_INK};
use super::resize::Fit;
use super::sheet::{Caption, Sheet, Tile};
use super::study::{Point, Study, StudyImages};
use super::words;
use crate::accuracy::LinearImage;

/// Settings that one sheet has room for.
pub const MOST_COLUMNS: usize = 8;
/// Longest side of a tile, pixels.
pub const TILE: usize = 256;

/// Narrowest column, pixels: its captions need room.
const LEAST_COLUMN: usize = 176;
const GAP: usize = 14;
const MARGIN: usize = 20;
/// Height of the title, of the captions above the tiles, and of the remarks below.
const TITLE: usize = 58;
const CAPTIONS: usize = 44;
const REMARKS: usize = 66;
const ROW_GAP: usize = 14;

/// Draws the sheet of one sweep as a PNG file. If there are more than [`MOST_COLUMNS`] settings, some are shown,
/// evenly from the first to the last, and a remark lists the rest.
///
/// # Errors
///
/// [`PlotError::NoSweep`], [`PlotError::Empty`], [`PlotError::Images`] when there is not one image of the truth's size for each
/// setting, and [`PlotError::Metric`] for values that are not finite or a truth without light.
pub fn error_images(
    study: &Study,
    images: &StudyImages,
    sweep_index: usize,
) -> Result<Vec<u8>, PlotError> {
    let shown = shown_images(study, images, sweep_index)?;
    let sweep = &study.sweeps[sweep_index];
    let indices = shown_indices(sweep.points.len());
    let columns = shown.into_iter().zip(&indices).map(|(image, index)| {
        let point = &sweep.points[*index];
        (image, words::named_setting(sweep, point), point)
    });
    let mut remarks = Vec::new();
    if sweep.points.len() > MOST_COLUMNS {
        let hidden = (0..sweep.points.len()).filter(|index| !indices.contains(index));
        let rest: Vec<String> = hidden
            .map(|index| words::setting(sweep, &sweep.points[index]))
            .collect();
        remarks.push(format!("Not shown, for lack of room: {}.", rest.join("; ")));
    }
    let title = format!("Errors by setting of {}", sweep.dial);
    draw(study, images, columns.collect(), &title, remarks)
}

/// Draws the setting of each method of a comparison that takes about `limit_ms` ([`equal_time::standings`]) as a PNG file, a column per
/// method, at most [`MOST_COLUMNS`]. Remarks name methods that take longer, and those that cannot render the scene.
///
/// # Errors
///
/// As [`error_images`]; [`PlotError::Empty`] if it is no comparison.
pub fn method_images(
    study: &Study,
    images: &StudyImages,
    limit_ms: f64,
) -> Result<Vec<u8>, PlotError> {
    let standings = equal_time::standings(study, limit_ms);
    if standings.is_empty() {
        return Err(PlotError::Empty("the comparison of methods".to_owned()));
    }
    let mut columns = Vec::new();
    let mut slower = Vec::new();
    for standing in standings.iter().take(MOST_COLUMNS) {
        let found = all_images(study, images, standing.sweep_index)?;
        let sweep = standing.sweep;
        columns.push((
            &found[standing.point_index],
            sweep.dial.clone(),
            standing.point,
        ));
        if standing.error_in_time.is_none() {
            slower.push(sweep.dial.as_str());
        }
    }
    let mut remarks = Vec::new();
    if !slower.is_empty() {
        remarks.push(format!(
            "Takes longer at every setting: {}.",
            slower.join("; ")
        ));
    }
    let absent = equal_time::absent(study).into_iter();
    let absent: Vec<&str> = absent.map(|(name, _)| name).collect();
    if !absent.is_empty() {
        remarks.push(format!("Cannot render this: {}.", absent.join("; ")));
    }
    let title = format!("Methods in about {} ms", words::ms(limit_ms));
    draw(study, images, columns, &title, remarks)
}

/// Draws columns (image, name, figures) beside the truth.
fn draw(
    study: &Study,
    images: &StudyImages,
    shown: Vec<(&LinearImage, String, &Point)>,
    title: &str,
    remarks: Vec<String>,
) -> Result<Vec<u8>, PlotError> {
    let (width, height) = (images.truth.width as usize, images.truth.height as usize);
    let fit = Fit::new(width, height, TILE);
    let layout = Layout {
        tile: (fit.size(width), fit.size(height)),
        columns: shown.len() + 1,
    };
    let mean_w_m2 = mean(&images.truth)?;
    let columns = shown
        .iter()
        .map(|(image, _, _)| Column::new(image, images, mean_w_m2))
        .collect::<Result<Vec<_>, _>>()?;
    let scale = scale(&columns);

    let mut sheet = Sheet::new(layout.width(), layout.height());
    let view = |image: &LinearImage| picture(image, images.white_w_m2, fit);
    let (x, y) = layout.spot(0, 0);
    sheet.lay(&view(&images.truth)?, x, y);
    for (index, column) in columns.iter().enumerate() {
        let tiles = [
            view(column.image)?,
            column.signed_tile(fit, scale),
            column.flip_tile(fit),
        ];
        for (row, tile) in tiles.iter().enumerate() {
            let (x, y) = layout.spot(index + 1, row);
            sheet.lay(tile, x, y);
        }
    }
    lay_bars(&mut sheet, layout, scale);
    let names = shown.into_iter().map(|(_, name, point)| (name, point));
    write_captions(&mut sheet, layout, study, title, names.collect(), remarks);
    sheet.finish()
}

/// The images of the settings that are shown, once all fit the study.
fn shown_images<'a>(
    study: &Study,
    images: &'a StudyImages,
    sweep_index: usize,
) -> Result<Vec<&'a LinearImage>, PlotError> {
    let found = all_images(study, images, sweep_index)?;
    let shown = shown_indices(found.len()).into_iter();
    Ok(shown.map(|index| &found[index]).collect())
}

/// The images of a sweep's settings, once all fit the study.
fn all_images<'a>(
    study: &Study,
    images: &'a StudyImages,
    sweep_index: usize,
) -> Result<&'a [LinearImage], PlotError> {
    let Some(sweep) = study.sweeps.get(sweep_index) else {
        return Err(PlotError::NoSweep {
            index: sweep_index,
            sweeps: study.sweeps.len(),
        });
    };
    if sweep.points.is_empty() {
        return Err(PlotError::Empty(format!("the sweep of {}", sweep.dial)));
    }
    let found = images
        .points
        .get(sweep_index)
        .map_or(&[][..], Vec::as_slice);
    if found.len() != sweep.points.len() {
        return Err(PlotError::Images(format!(
            "the sweep of {} has {} settings and {} images; one image each is needed",
            sweep.dial,
            sweep.points.len(),
            found.len()
        )));
    }
    let size = (images.truth.width, images.truth.height);
    if let Some(other) = found.iter().find(|i| (i.width, i.height) != size) {
        return Err(PlotError::Images(format!(
            "an image of the sweep of {} is {} × {}, the truth {} × {}; all must have the same size",
            sweep.dial, other.width, other.height, size.0, size.1
        )));
    }
    Ok(found)
}

/// Which of a number of settings are shown.
fn shown_indices(count: usize) -> Vec<usize> {
    if count <= MOST_COLUMNS {
        return (0..count).collect();
    }
    (0..MOST_COLUMNS)
        .map(|column| column * (count - 1) / (MOST_COLUMNS - 1))
        .collect()
}

/// The layout of the sheet.
#[derive(Clone, Copy)]
struct Layout {
    tile: (usize, usize),
    /// With the truth's.
    columns: usize,
}

impl Layout {
    fn column_width(self) -> usize {
        self.tile.0.max(LEAST_COLUMN)
    }

    fn width(self) -> usize {
        2 * MARGIN + self.columns * (self.column_width() + GAP) - GAP
    }

    fn height(self) -> usize {
        TITLE + CAPTIONS + 3 * (self.tile.1 + ROW_GAP) + REMARKS
    }

    /// Top left corner of a tile.
    fn spot(self, column: usize, row: usize) -> (usize, usize) {
        (
            MARGIN + column * (self.column_width() + GAP),
            TITLE + CAPTIONS + row * (self.tile.1 + ROW_GAP),
        )
    }
}

/// Colour bars of the lower two rows, in the first column.
fn lay_bars(sheet: &mut Sheet, layout: Layout, scale: f64) {
    let width = layout.column_width() - 8;
    let bar = |colour: &dyn Fn(f64) -> [u8; 3]| Tile {
        width,
        height: 14,
        pixels: (0..14 * width)
            .map(|i| colour((i % width) as f64 / (width - 1) as f64))
            .collect(),
    };
    let end = words::percent(scale);
    let rows = [
        (
            1,
            bar(&|t| diverging(2.0 * t - 1.0)),
            ["E − truth,", "in % of the truth's mean"],
            [format!("−{end}"), "0".to_owned(), format!("+{end}")],
        ),
        (
            2,
            bar(&magma),
            ["FLIP: difference that", "people see"],
            ["0".to_owned(), "0.5".to_owned(), "1".to_owned()],
        ),
    ];
    for (row, bar, title, ends) in rows {
        let (x, y) = layout.spot(0, row);
        let (left, top) = (x as f64, y as f64);
        for (line, text) in title.into_iter().enumerate() {
            sheet.write(Caption {
                text: text.to_owned(),
                spot: (left, top + 8.0 + 17.0 * line as f64),
                style: TextStyle::new(13.0, INK),
                width: width as f64,
            });
        }
        sheet.lay(&bar, x, y + 40);
        let anchors = [HPos::Left, HPos::Center, HPos::Right];
        for ((text, h), place) in ends.into_iter().zip(anchors).zip([0.0, 0.5, 1.0]) {
            sheet.write(Caption {
                text,
                spot: (left + place * width as f64, top + 68.0),
                style: TextStyle::new(12.0, SOFT_INK).at(h, VPos::Center),
                width: width as f64,
            });
        }
    }
}

fn write_captions(
    sheet: &mut Sheet,
    layout: Layout,
    study: &Study,
    title: &str,
    columns: Vec<(String, &Point)>,
    more_remarks: Vec<String>,
) {
    let wide = (layout.width() - 2 * MARGIN) as f64;
    let mut write = |text: String, (x, y): (f64, f64), style: TextStyle, width: f64| {
        sheet.write(Caption {
            text,
            spot: (x, y),
            style,
            width,
        });
    };
    let left = MARGIN as f64;
    let mut title = title.to_owned();
    if !study.scene.is_empty() {
        title += &format!(": {}", study.scene);
    }
    write(title, (left, 28.0), TextStyle::new(19.0, INK), wide);

    let narrow = layout.column_width() as f64;
    let (strong, soft) = (TextStyle::new(14.0, INK), TextStyle::new(12.0, SOFT_INK));
    let y = TITLE as f64;
    let truth = format!("own error {}", words::percent(study.truth.relative_error));
    write("truth".to_owned(), (left, y + 8.0), strong, narrow);
    write(truth, (left, y + 28.0), soft, narrow);
    for (column, (name, point)) in columns.into_iter().enumerate() {
        let x = layout.spot(column + 1, 0).0 as f64;
        let figures = format!(
            "L1 {} · {} ms",
            words::percent(point.error.relative_l1),
            words::ms(point.cost.wall_ms.median)
        );
        write(name, (x, y + 8.0), strong, narrow);
        write(figures, (x, y + 28.0), soft, narrow);
    }

    let y = (layout.height() - REMARKS) as f64;
    let mut remarks = vec![
        "Blue: too dark, red: too bright. Stronger errors have the colour of the scale's end."
            .to_owned(),
    ];
    remarks.extend(more_remarks);
    for (line, remark) in remarks.into_iter().enumerate() {
        let spot = (left, y + 8.0 + 17.0 * line as f64);
        write(remark, spot, soft, wide);
    }
}
