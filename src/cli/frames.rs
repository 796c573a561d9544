//! Frame numbers: `0-59`, `-10--1`, `1-20x4,30`.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::str::FromStr;

/// Most frames of one command.
pub const MAX_FRAMES: usize = 1_000_000;

/// Largest frame number, and the smallest without its sign.
pub const LARGEST_FRAME: i64 = 9_999_999_999;

/// Most ranges that are listed in a message.
const MAX_LISTED: usize = 20;

/// Frame numbers, ascending, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameSet(Vec<i64>);

impl FrameSet {
    /// The frames.
    pub fn frames(&self) -> &[i64] {
        &self.0
    }
}

/// Why a text is not a frame set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FramesError {
    /// A part that is not a frame or range.
    #[error(
        "`{0}` is not a frame or range; accepted: `30`, `0-59`, `-10--1`, `1-20x4` or `1-20:4` (every 4th), joined by commas"
    )]
    Part(String),
    /// A range that runs backwards.
    #[error("the range `{0}` runs backwards; accepted: first-last with first at most last")]
    Backwards(String),
    /// A step of zero.
    #[error("the range `{0}` has a step of 0; accepted: 1 or more")]
    Step(String),
    /// A number beyond [`LARGEST_FRAME`].
    #[error(
        "`{0}` has a number with more than ten digits; accepted: -{LARGEST_FRAME} … {LARGEST_FRAME}"
    )]
    TooFar(String),
    /// Too many frames.
    #[error("there are more than {MAX_FRAMES} frames; accepted: at most {MAX_FRAMES}")]
    TooMany,
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
fn range(part: &str) -> Result<(i64, i64, usize), FramesError> {
    let refused = || FramesError::Part(part.to_owned());
    // A number with its sign, and the text after it.
    let number = |text: &str| -> Result<(i64, String), FramesError> {
        let digits = text.strip_prefix('-').unwrap_or(text);
        let end = digits.find(|c: char| !c.is_ascii_digit());
        let (digits, rest) = digits.split_at(end.unwrap_or(digits.len()));
        if digits.is_empty() {
            return Err(refused());
        }
        let too_far = || FramesError::TooFar(part.to_owned());
        let size: i64 = digits.parse().map_err(|_| too_far())?;
        if size > LARGEST_FRAME {
            return Err(too_far());
        }
        let number = if text.starts_with('-') { -size } else { size };
        Ok((number, rest.to_owned()))
    };
    let (first, rest) = number(part)?;
    if rest.is_empty() {
        return Ok((first, first, 1));
    }
    let (last, rest) = number(rest.strip_prefix('-').ok_or_else(refused)?)?;
    let step = match rest.strip_prefix(['x', ':']) {
        Some(step) if !step.starts_with('-') => {
            let (step, rest) = number(step)?;
            let is_whole = rest.is_empty();
            usize::try_from(step).ok().filter(|_| is_whole)
        }
        None if rest.is_empty() => Some(1),
        _ => None,
    };
    let step = step.ok_or_else(refused)?;
    if first > last {
        return Err(FramesError::Backwards(part.to_owned()));
    }
    if step == 0 {
        return Err(FramesError::Step(part.to_owned()));
    }
    Ok((first, last, step))
}

/// Ascending frames as `--frames` reads them: `0-2, 7, 10-40x10`. Of many ranges, the first twenty.
pub fn in_ranges(frames: &[i64]) -> String {
    let mut text = String::new();
    let mut rest = frames;
    for listed in 0.. {
        let Some((&first, after)) = rest.split_first() else {
            break;
        };
        if listed > 0 {
            text.push_str(", ");
        }
        if listed == MAX_LISTED {
            let _ = write!(text, "… ({} in all)", frames.len());
            break;
        }
        let step = after.first().map_or(1, |next| next - first);
        let steps = after
            .iter()
            .zip(1..)
            .take_while(|(frame, count)| **frame == first + count * step);
        let count = steps.count();
        let last = first + count as i64 * step;
        let _ = match (step, count) {
            (1, 1..) => write!(text, "{first}-{last}"),
            (_, 2..) => write!(text, "{first}-{last}x{step}"),
            _ => write!(text, "{first}"),
        };
        let is_single = count == 0 || (step > 1 && count == 1);
        rest = if is_single { after } else { &after[count..] };
    }
    text
}
