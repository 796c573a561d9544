//! File names with a place for the frame number: `frame.%04d.png`, `frame.####.png`.

use std::path::{PathBuf, is_separator};
use std::str::FromStr;

/// Widest number of a pattern, digits.
const MAX_WIDTH: usize = 20;

/// A path with a place for the frame number in the file name: `%d`, `%04d` or `####` for at least four digits. `%%` is a `%`. In the
/// folder everything else is literal; `#` is literal in a name with `%d`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    before: String,
    width: usize,
    after: String,
}

/// Why a text is not a pattern.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// No number in the file name, or several.
    #[error(
        "`{0}` does not have a frame number exactly once in its file name; accepted: a name such as `frame.%04d.png` or `frame.####.png`"
    )]
    Number(String),
    /// A `%` that does not begin a number.
    #[error(
        "`{0}` has a % in its file name that is not part of `%d`, `%04d` or the like; accepted: a name such as `frame.%04d.png`, with %% for a %"
    )]
    Percent(String),
    /// A width that no number needs.
    #[error(
        "`{0}` has a frame number of {1} digits; accepted: 1 … {MAX_WIDTH}, as in `frame.%04d.png`"
    )]
    Width(String, usize),
    /// `-`, which is one stream.
    #[error(
        "`-` (stdout) cannot take several files; accepted: a name such as `frame.%04d.png`, or `caustica render -o -` for one frame"
    )]
    Stdout,
}

/// A piece of a file name.
enum Piece {
    Text(String),
    Number(usize),
}

impl FramePattern {
    /// The file of a frame. A negative number has its sign in front of the padding: `-0010`.
    pub fn path(&self, frame: i64) -> PathBuf {
        let Self {
            before,
            width,
            after,
        } = self;
        let sign = if frame < 0 { "-" } else { "" };
        let digits = frame.unsigned_abs();
        PathBuf::from(format!("{before}{sign}{digits:0width$}{after}"))
    }
}

impl FromStr for FramePattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, PatternError> {
        if text == "-" {
            return Err(PatternError::Stdout);
        }
        let name_at = text.rfind(is_separator).map_or(0, |at| at + 1);
        let (folder, name) = text.split_at(name_at);
        let mut pieces = by_percent(name).ok_or_else(|| PatternError::Percent(text.to_owned()))?;
        if !pieces.iter().any(|piece| matches!(piece, Piece::Number(_))) {
            pieces = pieces.into_iter().flat_map(by_hashes).collect();
        }
        let mut before = folder.replace("%%", "%");
        let mut after = String::new();
        let mut found = None;
        for piece in pieces {
            match (piece, found) {
                (Piece::Text(text), None) => before.push_str(&text),
                (Piece::Text(text), Some(_)) => after.push_str(&text),
                (Piece::Number(width), None) => found = Some(width),
                (Piece::Number(_), Some(_)) => return Err(PatternError::Number(text.to_owned())),
            }
        }
        let width = found.ok_or_else(|| PatternError::Number(text.to_owned()))?;
        if !(1..=MAX_WIDTH).contains(&width) {
            return Err(PatternError::Width(text.to_owned(), width));
        }
        Ok(Self {
            before,
            width,
            after,
        })
    }
}

/// The pieces of a name around `%d` and `%04d`; `None` if a `%` is neither of them nor `%%`.
fn by_percent(name: &str) -> Option<Vec<Piece>> {
    let mut pieces = Vec::new();
    let mut parts = name.split('%');
    pieces.push(Piece::Text(parts.next()?.to_owned()));
    while let Some(part) = parts.next() {
        if part.is_empty() {
            // `%%`: the text after it is a part, too.
            pieces.push(Piece::Text(format!("%{}", parts.next()?)));
            continue;
        }
        let (digits, rest) = part.split_once('d')?;
        let width = match digits.strip_prefix('0') {
            None if digits.is_empty() => 1,
            Some(digits) if digits.bytes().all(|b| b.is_ascii_digit()) => digits.parse().ok()?,
            _ => return None,
        };
        pieces.push(Piece::Number(width));
        pieces.push(Piece::Text(rest.to_owned()));
    }
    Some(pieces)
}

/// The pieces of a text around runs of `#`.
fn by_hashes(piece: Piece) -> Vec<Piece> {
    let Piece::Text(mut text) = piece else {
        return vec![piece];
    };
    let mut pieces = Vec::new();
    while let Some(at) = text.find('#') {
        let rest = text.split_off(at);
        let after = rest.trim_start_matches('#');
        pieces.push(Piece::Text(text));
        pieces.push(Piece::Number(rest.len() - after.len()));
        text = after.to_owned();
    }
    pieces.push(Piece::Text(text));
    pieces
}
