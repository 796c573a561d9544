//! Frame numbers (`0-59`, `1-20:4,30`) and file name patterns (`frame.%04d.png`).

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Most frames of one command.
pub const MAX_FRAMES: usize = 1_000_000;

/// Widest number of a pattern, digits.
const MAX_WIDTH: usize = 20;

/// Frame numbers, ascending, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameSet(Vec<u32>);

impl FrameSet {
    /// The frames.
    pub fn frames(&self) -> &[u32] {
        &self.0
    }
}

/// Why a text is not a frame set or not a pattern.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FramesError {
    /// A part that is not a frame or range.
    #[error(
        "`{0}` is not a frame or range; accepted: `30`, `0-59`, `1-20:4` (every 4th), joined by commas"
    )]
    Part(String),
    /// A range that runs backwards.
    #[error("the range `{0}` runs backwards; accepted: first-last with first at most last")]
    Backwards(String),
    /// A step of zero.
    #[error("the range `{0}` has a step of 0; accepted: 1 or more")]
    Step(String),
    /// Too many frames.
    #[error("there are more than {MAX_FRAMES} frames; accepted: at most {MAX_FRAMES}")]
    TooMany,
    /// A pattern without its number, or with several.
    #[error(
        "`{0}` does not have a frame number exactly once; accepted: a name such as `frame.%04d.png`"
    )]
    Pattern(String),
}

impl FromStr for FrameSet {
    type Err = FramesError;

    fn from_str(text: &str) -> Result<Self, FramesError> {
        let mut frames = BTreeSet::new();
        for part in text.split(',') {
            let (first, last, step) = range(part.trim())?;
            for frame in (first..=last).step_by(step) {
                frames.insert(frame);
                if frames.len() > MAX_FRAMES {
                    return Err(FramesError::TooMany);
                }
            }
        }
        Ok(Self(frames.into_iter().collect()))
    }
}

/// First, last and step of one part.
fn range(part: &str) -> Result<(u32, u32, usize), FramesError> {
    let number = |text: &str| -> Result<u32, FramesError> {
        // `parse` would take a sign.
        let is_digits = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        match text.parse() {
            Ok(number) if is_digits => Ok(number),
            _ => Err(FramesError::Part(part.to_owned())),
        }
    };
    let Some((first, rest)) = part.split_once('-') else {
        let frame = number(part)?;
        return Ok((frame, frame, 1));
    };
    let (last, step) = match rest.split_once(':') {
        Some((last, step)) => (number(last)?, number(step)?),
        None => (number(rest)?, 1),
    };
    let first = number(first)?;
    if first > last {
        return Err(FramesError::Backwards(part.to_owned()));
    }
    if step == 0 {
        return Err(FramesError::Step(part.to_owned()));
    }
    Ok((first, last, step as usize))
}

/// A file name with a place for the frame number: `%d`, or `%04d` for at least four digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    before: String,
    width: usize,
    after: String,
}

impl FramePattern {
    /// The file of a frame.
    pub fn path(&self, frame: u32) -> PathBuf {
        let Self {
            before,
            width,
            after,
        } = self;
        PathBuf::from(format!("{before}{frame:0width$}{after}"))
    }
}

impl FromStr for FramePattern {
    type Err = FramesError;

    fn from_str(text: &str) -> Result<Self, FramesError> {
        let refused = || FramesError::Pattern(text.to_owned());
        let (before, rest) = text.split_once('%').ok_or_else(refused)?;
        let (digits, after) = rest.split_once('d').ok_or_else(refused)?;
        let width = match digits.strip_prefix('0') {
            None if digits.is_empty() => 1,
            Some(digits) if digits.bytes().all(|b| b.is_ascii_digit()) => {
                digits.parse().map_err(|_| refused())?
            }
            _ => return Err(refused()),
        };
        let is_in_name = !after.contains(['/', '%']) && Path::new(text).file_name().is_some();
        if width == 0 || width > MAX_WIDTH || !is_in_name {
            return Err(refused());
        }
        Ok(Self {
            before: before.to_owned(),
            width,
            after: after.to_owned(),
        })
    }
}
