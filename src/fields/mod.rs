//! Arrays of numbers in files that users bring: NPY, EXR and 16-bit PNG.
//!
//! Nothing is known here of what the numbers mean (these are not the fields of light of the glossary). A file has frames of one size, and
//! channels of the same frames.
//!
//! NPY is read by our own code: the library for it allocates what a header claims before it looks at the file, and reads
//! nested brackets by recursion.

mod error;
mod exr;
mod info;
mod npy;
mod png;
mod samples;

pub use error::FieldError;
pub use info::{ChannelInfo, FieldInfo};
pub use samples::{NotFinite, Samples};

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Most samples of a file: those of all channels and frames.
pub const MAX_SAMPLES: u64 = 1 << 27;

/// Most bytes that one byte of a compressed file stands for; more is no picture.
const MAX_EXPANSION: u64 = 4096;

/// Channels that hold heights where a scene names none, in the order in which they are looked for.
const HEIGHT_NAMES: [&str; 6] = ["height", "Height", "h", "Y", "Z", "y"];

/// Pairs of channels that hold slopes where a scene names none.
const SLOPE_NAMES: [[&str; 2]; 4] = [["slope.x", "slope.z"], ["x", "z"], ["X", "Z"], ["R", "G"]];

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FieldFormat {
    /// NumPy array.
    Npy,
    /// OpenEXR.
    Exr,
    /// PNG of 16 bits per channel.
    Png,
}

/// The numbers of a file.
#[derive(Clone, Debug)]
pub struct Field {
    /// `blake3:…` of the file's bytes.
    pub id: String,
    /// The format of the file.
    pub format: FieldFormat,
    /// Samples of a row, and rows.
    pub size: [usize; 2],
    /// Number of frames; above 1 only for NPY.
    pub frames: usize,
    /// Never empty; in an order that depends only on the file.
    pub channels: Vec<Channel>,
}

/// One number per sample.
#[derive(Clone, Debug)]
pub struct Channel {
    /// Its name: in EXR that of the file, in PNG `Y`, `A`, `R`, `G`, `B`, in NPY `value`, or `x` and `z` where the last axis has two.
    pub name: String,
    /// Frame by frame, row by row.
    pub samples: Samples,
    /// Smallest and largest number; NaN and infinity do not count. 0 if there is no other.
    pub range: [f64; 2],
    /// Sum of all numbers, without NaN and infinity.
    pub sum: f64,
    /// Distance of neighbouring numbers that the file can hold, at its largest number.
    pub resolution: f64,
    /// NaN and infinity among them.
    pub not_finite: Option<NotFinite>,
}

/// The content id of a file.
pub fn id(bytes: &[u8]) -> String {
    format!("blake3:{}", blake3::hash(bytes).to_hex())
}

/// Reads a file; its first bytes say which format it has.
///
/// # Errors
/// Files of other formats, damaged ones, and those that claim more than they have.
pub fn read(bytes: &[u8]) -> Result<Field, FieldError> {
    let (format, read): (_, Reader) = match bytes {
        [] => return Err(FieldError::Empty),
        _ if bytes.starts_with(npy::MAGIC) => (FieldFormat::Npy, npy::read),
        _ if bytes.starts_with(exr::MAGIC) => (FieldFormat::Exr, exr::read),
        _ if bytes.starts_with(png::MAGIC) => (FieldFormat::Png, png::read),
        _ => return Err(FieldError::UnknownFormat),
    };
    let read = read(bytes)?;
    let [width, _] = read.size;
    let area = width * read.size[1];
    let channels = read.channels.into_iter();
    Ok(Field {
        id: id(bytes),
        format,
        size: read.size,
        frames: read.frames,
        channels: channels
            .map(|(name, samples)| Channel::of(name, samples, width, area))
            .collect(),
    })
}

/// Reads a file of one format.
type Reader = fn(&[u8]) -> Result<Read, FieldError>;

/// What a format's reader finds.
struct Read {
    size: [usize; 2],
    frames: usize,
    channels: Vec<(String, Samples)>,
}

/// Refuses what no file of `file_bytes` can hold, before anything is allocated.
fn check_claim(
    format: &'static str,
    [width, height]: [u64; 2],
    channels: u64,
    file_bytes: usize,
) -> Result<(), FieldError> {
    let samples = width.saturating_mul(height).saturating_mul(channels);
    if samples == 0 {
        return Err(FieldError::NoSamples);
    }
    if samples > MAX_SAMPLES {
        return Err(FieldError::TooLarge { samples });
    }
    if samples.saturating_mul(2) > (file_bytes as u64).saturating_mul(MAX_EXPANSION) {
        return Err(FieldError::unreadable(
            format,
            format!("it claims {width} × {height} samples, but has {file_bytes} bytes"),
        ));
    }
    Ok(())
}

impl Channel {
    fn of(name: String, samples: Samples, width: usize, area: usize) -> Self {
        let (range, sum, not_finite) = samples.survey(width, area);
        Self {
            name,
            resolution: samples.resolution(range[0].abs().max(range[1].abs())),
            samples,
            range,
            sum,
            not_finite,
        }
    }
}

impl Field {
    /// The channel of that name, or by default that of heights.
    ///
    /// # Errors
    /// What is wrong, and what is accepted.
    pub fn channel(&self, name: Option<&str>) -> Result<usize, [String; 2]> {
        let Some(name) = name else {
            if self.channels.len() == 1 {
                return Ok(0);
            }
            let default = HEIGHT_NAMES.iter().find_map(|name| self.find(name));
            return default.ok_or_else(|| {
                [
                    format!("the file has {} channels", self.channels.len()),
                    format!(
                        "`channel` with one of {}; slopes need `\"holds\": \"slopes\"`",
                        self.channel_names()
                    ),
                ]
            });
        };
        self.find(name).ok_or_else(|| {
            [
                format!("the file has no channel `{}`", printable(name)),
                format!("one of {}", self.channel_names()),
            ]
        })
    }

    /// The channels of those names, or by default those of slopes.
    ///
    /// # Errors
    /// What is wrong, and what is accepted.
    pub fn channel_pair(&self, names: Option<&[String; 2]>) -> Result<[usize; 2], [String; 2]> {
        if let Some([x, z]) = names {
            return Ok([self.channel(Some(x))?, self.channel(Some(z))?]);
        }
        let found = |[x, z]: &[&str; 2]| Some([self.find(x)?, self.find(z)?]);
        SLOPE_NAMES.iter().find_map(found).ok_or_else(|| {
            let accepted = match self.format {
                FieldFormat::Npy => {
                    "an array of shape (rows, columns, 2) or (frames, rows, columns, 2)".to_owned()
                }
                _ => format!(
                    "`channels` with two of {}: ∂h/∂x and ∂h/∂z",
                    self.channel_names()
                ),
            };
            let channels = match self.channels.len() {
                1 => "channel".to_owned(),
                count => format!("{count} channels"),
            };
            [
                format!("which of the file's {channels} hold slopes is not clear"),
                accepted,
            ]
        })
    }

    fn find(&self, name: &str) -> Option<usize> {
        let mut channels = self.channels.iter();
        channels.position(|channel| channel.name == name)
    }

    /// Names of all channels, for messages.
    fn channel_names(&self) -> String {
        const MOST: usize = 20;
        let names = self.channels.iter().take(MOST);
        let mut names: Vec<String> = names
            .map(|channel| format!("`{}`", printable(&channel.name)))
            .collect();
        if self.channels.len() > MOST {
            names.push("…".to_owned());
        }
        names.join(", ")
    }

    /// Host memory, bytes.
    pub fn bytes(&self) -> u64 {
        let of_channels = self
            .channels
            .iter()
            .map(|channel| size_of::<Channel>() + channel.name.len() + channel.samples.bytes());
        (size_of::<Self>() + self.id.len() + of_channels.sum::<usize>()) as u64
    }
}

/// A name from a file or a scene as part of a message: short, and without control characters.
fn printable(name: &str) -> String {
    const MOST: usize = 40;
    let mut text: String = name
        .chars()
        .take(MOST)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if name.chars().nth(MOST).is_some() {
        text.push('…');
    }
    text
}
