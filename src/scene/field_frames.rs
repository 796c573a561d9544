//! The files of height fields, found and checked.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::error::{Issue, IssueKind};
use super::height_field::{FieldEdges, FieldHolds, HeightField, MAX_FRAMES, RowAxis};
use super::json::MAX_ISSUES;
use super::ranges::{self, number};
use super::resolve::Assets;
use super::strict::quoted;
use super::types::Scene;
use super::waves::Wave;
use crate::fields::{Channel, Field, FieldFormat, Samples};

/// Fewest samples along a side of a height field.
const LEAST_SIDE: usize = 4;

/// Largest slope of a file.
const MAX_SLOPE: f64 = 100.0;

/// Largest number of a PNG, or of an NPY of unsigned integers.
const MOST_CODE: f64 = 65_535.0;

/// The frames of a height field: which channels of which files, and what their numbers mean.
#[derive(Clone, Debug)]
pub struct FieldFrames {
    files: Vec<File>,
    /// For each frame, the file and the frame in it.
    frames: Vec<[usize; 2]>,
}

/// A file of a height field.
#[derive(Clone, Debug)]
struct File {
    field: Arc<Field>,
    /// That of heights, or those of the slopes along x and z.
    channels: Vec<usize>,
    /// What a number v means: v · scale + offset.
    scale: f64,
    offset: f64,
}

impl FieldFrames {
    /// Number of frames; at least 1.
    pub fn count(&self) -> usize {
        self.frames.len()
    }

    /// Samples of a row of the files, and rows.
    pub fn file_size(&self) -> [usize; 2] {
        self.files[0].field.size
    }

    /// The mean of all samples of all frames: of heights, m.
    pub fn mean(&self) -> f64 {
        let [columns, rows] = self.file_size();
        // A file may be used several times.
        let starts = self.frames.iter().filter(|[_, frame]| *frame == 0);
        let sums = starts.map(|[file, _]| {
            let file = &self.files[*file];
            let count = (columns * rows * file.field.frames) as f64;
            file.channel(0).sum * file.scale + file.offset * count
        });
        sums.sum::<f64>() / (columns * rows * self.count()) as f64
    }

    /// Height of the water at rest where the scene does not say it, m: of a bounded field the mean along its edges, because water at rest is
    /// beyond them; of a periodic one the mean of all heights.
    pub fn rest_m(&self, edges: FieldEdges) -> f64 {
        let [columns, rows] = self.file_size();
        if edges == FieldEdges::Periodic {
            return self.mean();
        }
        let [last_row, last_column] = [rows - 1, columns - 1];
        let along_rows = (0..columns).flat_map(|column| [[0, column], [last_row, column]]);
        let along_columns = (1..last_row).flat_map(|row| [[row, 0], [row, last_column]]);
        let places: Vec<[usize; 2]> = along_rows.chain(along_columns).collect();
        let frames = 0..self.count();
        let of_frame = |frame: usize| -> f64 {
            let heights = places
                .iter()
                .map(|[row, column]| self.value(frame, 0, *row, *column));
            heights.sum()
        };
        frames.map(of_frame).sum::<f64>() / (places.len() * self.count()) as f64
    }

    /// Height (m) or slope at a place in a frame: the first channel is that of heights or of slopes along x, the second that of slopes
    /// along z.
    pub fn value(&self, frame: usize, channel: usize, row: usize, column: usize) -> f64 {
        let [file, frame] = self.frames[frame];
        let file = &self.files[file];
        let [columns, rows] = file.field.size;
        let samples = &file.channel(channel).samples;
        samples.at((frame * rows + row) * columns + column) * file.scale + file.offset
    }

    /// The coarsest step between neighbouring numbers that the files can hold: of heights, m.
    pub fn resolution(&self) -> f64 {
        let of_file = |file: &File| {
            let channels = (0..file.channels.len()).map(|i| file.channel(i).resolution);
            channels.fold(0.0, f64::max) * file.scale.abs()
        };
        self.files.iter().map(of_file).fold(0.0, f64::max)
    }
}

impl File {
    fn channel(&self, index: usize) -> &Channel {
        &self.field.channels[self.channels[index]]
    }

    /// Smallest and largest value.
    fn range(&self, index: usize) -> [f64; 2] {
        let [a, b] = self
            .channel(index)
            .range
            .map(|v| v * self.scale + self.offset);
        [a.min(b), a.max(b)]
    }
}

/// Samples of water at rest that are added on each side of a bounded field.
pub(super) const FLAT_MARGIN: u64 = 18;

/// Finds the files of all height fields of a scene, by index into its waves; adds to `issues` what is wrong.
pub(super) fn find(
    scene: &Scene,
    assets: &impl Assets,
    issues: &mut Vec<Issue>,
) -> BTreeMap<usize, Arc<FieldFrames>> {
    let mut found = BTreeMap::new();
    let others = scene.water.waves.iter().map(Wave::grid_samples);
    let mut samples = others.fold(0, u64::saturating_add);
    for (index, wave) in scene.water.waves.iter().enumerate() {
        let Wave::HeightField(waves) = wave else {
            continue;
        };
        let at = |field: &str| format!("/water/waves/{index}/{field}");
        match frames(waves, assets, &at) {
            Ok(frames) => {
                samples = samples.saturating_add(grid_samples(waves, &frames));
                found.insert(index, Arc::new(frames));
            }
            Err(more) => {
                let left = MAX_ISSUES.saturating_sub(issues.len());
                issues.extend(more.into_iter().take(left));
            }
        }
    }
    if samples > ranges::MAX_GRID_SAMPLES && !found.is_empty() {
        let issue = Issue::invalid(
            "/water/waves",
            format!(
                "all spectra, basins and height fields together have {samples} samples; bounded fields have a margin of {FLAT_MARGIN} samples, and those of slopes count four times"
            ),
            format!("at most {}", ranges::MAX_GRID_SAMPLES),
        );
        issues.push(issue.of_kind(IssueKind::LimitExceeded));
    }
    found
}

/// Samples of the grid of a height field, or of the mirror images with which its slopes are integrated.
fn grid_samples(waves: &HeightField, frames: &FieldFrames) -> u64 {
    let [columns, rows] = frames.file_size();
    let mirrored = match (waves.holds, waves.edges) {
        (FieldHolds::Slopes, FieldEdges::Bounded) => 4,
        _ => 1,
    };
    let margin = match waves.edges {
        FieldEdges::Bounded => 2 * FLAT_MARGIN,
        FieldEdges::Periodic => 0,
    };
    mirrored * (columns as u64 + margin) * (rows as u64 + margin)
}

/// The files of one height field.
fn frames(
    waves: &HeightField,
    assets: &impl Assets,
    at: &dyn Fn(&str) -> String,
) -> Result<FieldFrames, Vec<Issue>> {
    let mut issues = Vec::new();
    let mut files: Vec<File> = Vec::new();
    let mut places = Vec::new();
    // Of each id its file, or nothing if it is of no use, which has been said.
    let mut known: BTreeMap<&str, Option<usize>> = BTreeMap::new();
    // `validate` has reported lists that are too long, and empty ids.
    for (index, id) in waves.frames.iter().take(MAX_FRAMES).enumerate() {
        if id.is_empty() {
            continue;
        }
        let found = match known.get(id.as_str()) {
            Some(found) => *found,
            None => {
                let pointer = at(&format!("frames/{index}"));
                let read = assets
                    .field(id)
                    .ok_or_else(|| unknown(pointer.clone(), id))
                    .and_then(|field| file(waves, field, pointer, at, files.first()));
                let found = match read {
                    Ok(file) => {
                        files.push(file);
                        Some(files.len() - 1)
                    }
                    Err(issue) => {
                        issues.push(issue);
                        None
                    }
                };
                known.insert(id, found);
                found
            }
        };
        let Some(file) = found else { continue };
        let frames = files[file].field.frames;
        if places.len() + frames > MAX_FRAMES {
            let issue = Issue::invalid(
                at("frames"),
                format!(
                    "the files up to number {} have {} frames together",
                    index + 1,
                    places.len() + frames
                ),
                format!("at most {MAX_FRAMES}"),
            );
            issues.push(issue.of_kind(IssueKind::LimitExceeded));
            break;
        }
        places.extend((0..frames).map(|frame| [file, frame]));
    }
    if places.len() > 1 && waves.frames_per_s.is_none() {
        issues.push(Issue::invalid(
            at("frames_per_s"),
            format!(
                "there are {} frames, but not how fast they follow each other",
                places.len()
            ),
            ranges::FRAME_RATE.to_string(),
        ));
    }
    match files.first() {
        Some(file) if issues.is_empty() => {
            issues.extend(sides(waves, file.field.size, at));
            let frames = FieldFrames {
                files,
                frames: places,
            };
            issues.extend(heights(waves, &frames, at));
            if issues.is_empty() {
                return Ok(frames);
            }
        }
        _ => {}
    }
    Err(issues)
}

fn unknown(pointer: String, id: &str) -> Issue {
    Issue::invalid(
        pointer,
        format!("there is no asset `{}`", quoted(id)),
        "the id of an uploaded file, `blake3:…`, from the answer of POST /v1/assets",
    )
    .of_kind(IssueKind::UnknownAsset)
}

/// A file that is to be like `first`.
fn file(
    waves: &HeightField,
    field: Arc<Field>,
    pointer: String,
    at: &dyn Fn(&str) -> String,
    first: Option<&File>,
) -> Result<File, Issue> {
    let (channels, name) = match waves.holds {
        FieldHolds::Heights => {
            let found = field.channel(waves.channel.as_deref());
            (found.map(|channel| vec![channel]), "channel")
        }
        FieldHolds::Slopes => {
            let found = field.channel_pair(waves.channels.as_ref());
            (found.map(Vec::from), "channels")
        }
    };
    let is_named = waves.channel.is_some() || waves.channels.is_some();
    let channels = channels.map_err(|[detail, accepted]| {
        let pointer = if is_named { at(name) } else { pointer.clone() };
        Issue::invalid(pointer, detail, accepted)
    })?;
    if let Some(first) = first.filter(|first| first.field.size != field.size) {
        let [[a, b], [c, d]] = [field.size, first.field.size];
        return Err(Issue::invalid(
            pointer,
            format!("the file has {a} columns and {b} rows, the first one {c} and {d}"),
            "frames of one size",
        ));
    }
    for channel in &channels {
        let channel = &field.channels[*channel];
        if let Some(found) = channel.not_finite {
            let [frame, row, column] = found.first;
            return Err(Issue::invalid(
                pointer,
                format!(
                    "{} of the numbers in channel `{}` are NaN or infinite, the first in frame {frame}, row {row}, column {column} (counted from 0)",
                    found.count,
                    quoted(&channel.name)
                ),
                "finite numbers",
            ));
        }
    }
    let (scale, range, names) = match waves.holds {
        FieldHolds::Heights => (waves.scale_m, waves.range_m, ["scale_m", "range_m"]),
        FieldHolds::Slopes => (
            waves.slope_scale,
            waves.slope_range,
            ["slope_scale", "slope_range"],
        ),
    };
    let has_codes = channels
        .iter()
        .all(|channel| matches!(field.channels[*channel].samples, Samples::U16(_)));
    if let (Some(_), false) = (range, has_codes) {
        return Err(Issue::invalid(
            at(names[1]),
            "the file does not hold unsigned integers of 16 bits",
            format!("`{}`", names[0]),
        ));
    }
    if range.is_none() && field.format == FieldFormat::Png {
        return Err(Issue::invalid(
            at(names[1]),
            "what the numbers of a PNG stand for is not in the file",
            format!("`{}`: what 0 and 65535 stand for", names[1]),
        ));
    }
    let (scale, offset) = match range {
        Some([low, high]) => ((high - low) / MOST_CODE, low),
        None => (scale.unwrap_or(1.0), 0.0),
    };
    Ok(File {
        field,
        channels,
        scale,
        offset,
    })
}

/// What is wrong with the sides of a field, whose files have `file_size` columns and rows.
fn sides(waves: &HeightField, file_size: [usize; 2], at: &dyn Fn(&str) -> String) -> Vec<Issue> {
    let size = waves.size(file_size);
    let step_m = waves.sample_m.per_axis_m();
    let mut issues = Vec::new();
    for axis in [0, 1] {
        let name = ["x", "z"][axis];
        let count = size[axis];
        if count < LEAST_SIDE {
            issues.push(Issue::invalid(
                at("frames/0"),
                format!("the field has too few samples along {name}: {count}"),
                format!("at least {LEAST_SIDE}"),
            ));
            continue;
        }
        let side_m = count as f64 * step_m[axis];
        if !ranges::TILE.contains(side_m) {
            issues.push(Issue::invalid(
                at("sample_m"),
                format!("the field is {} m long along {name}", number(side_m)),
                format!(
                    "sides of {} … {} m",
                    number(ranges::TILE.min),
                    number(ranges::TILE.max)
                ),
            ));
            continue;
        }
        let half_m = 0.5 * (count - 1) as f64 * step_m[axis];
        if let Some(rim_m) = waves.rim_m.filter(|rim_m| *rim_m > half_m) {
            issues.push(Issue::invalid(
                at("rim_m"),
                format!(
                    "a rim of {} m is wider than half of the field along {name}",
                    number(rim_m)
                ),
                format!("at most {} m", number(half_m)),
            ));
        }
    }
    issues
}

/// What is wrong with the values.
fn heights(
    waves: &HeightField,
    frames: &FieldFrames,
    at: &dyn Fn(&str) -> String,
) -> Option<Issue> {
    let (limit, rest) = match waves.holds {
        FieldHolds::Heights => (
            ranges::AMPLITUDE.max,
            waves.rest_m.unwrap_or_else(|| frames.rest_m(waves.edges)),
        ),
        FieldHolds::Slopes => (MAX_SLOPE, 0.0),
    };
    let ranges = frames
        .files
        .iter()
        .flat_map(|file| (0..file.channels.len()).map(|channel| file.range(channel)));
    let [low, high] = ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |all, range| {
        [all[0].min(range[0]), all[1].max(range[1])]
    });
    if low - rest >= -limit && high - rest <= limit {
        return None;
    }
    let (low, high) = (number(low), number(high));
    Some(match waves.holds {
        FieldHolds::Heights => Issue::invalid(
            at("frames/0"),
            format!(
                "the heights reach from {low} to {high} m, with the water at rest at {} m",
                number(rest)
            ),
            format!(
                "heights of at most {limit} m above and below the water at rest; `scale_m` or `range_m` sets the unit, `rest_m` the water at rest"
            ),
        ),
        FieldHolds::Slopes => Issue::invalid(
            at("frames/0"),
            format!("the slopes reach from {low} to {high}"),
            format!("slopes of at most {limit}; `slope_scale` or `slope_range` sets the unit"),
        ),
    })
}

impl HeightField {
    /// Samples along x and z, of files with so many columns and rows.
    pub fn size(&self, [columns, rows]: [usize; 2]) -> [usize; 2] {
        match self.rows_along {
            RowAxis::X => [columns, rows],
            RowAxis::Z => [rows, columns],
        }
    }
}
