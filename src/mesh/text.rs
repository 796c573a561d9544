//! Lines, words, names and numbers of OBJ and MTL texts, in any encoding.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::MeshError;
use crate::stats::Warning;

/// A text, line by line. The geometry is ASCII in every encoding; the encoding matters only for names and comments.
///
/// UTF-16 is recognised by its byte order mark or by its zero bytes. In any other text, each line that is not UTF-8 is read as
/// Windows-1252, so that the same bytes in OBJ and MTL are the same name. Lines end with LF, CR LF or CR.
#[derive(Debug)]
pub(super) struct Lines<'a> {
    text: Cow<'a, [u8]>,
}

/// A statement: a line, or several that a backslash at the end joins.
pub(super) struct Statement<'a> {
    /// Its first line, counted from 1.
    pub(super) line: usize,
    /// Its text.
    pub(super) text: Cow<'a, str>,
}

impl<'a> Lines<'a> {
    /// The lines of a file.
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        let text = match utf_16(bytes) {
            Some(encoding) => Cow::Owned(
                encoding
                    .decode_with_bom_removal(bytes)
                    .0
                    .into_owned()
                    .into_bytes(),
            ),
            None => Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
        };
        Self { text }
    }

    /// Each line with its number, counted from 1.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
        let mut rest: &[u8] = &self.text;
        let lines = std::iter::from_fn(move || {
            if rest.is_empty() {
                return None;
            }
            let end = rest
                .iter()
                .position(|byte| matches!(byte, b'\n' | b'\r'))
                .unwrap_or(rest.len());
            let (line, after) = rest.split_at(end);
            // CR CR LF comes of programs that turn the LF of CR LF into CR LF.
            let ends: [&[u8]; 2] = [b"\r\r\n", b"\r\n"];
            rest = ends
                .iter()
                .find_map(|end| after.strip_prefix(*end))
                .or_else(|| after.get(1..))
                .unwrap_or_default();
            Some(decoded(line))
        });
        lines.enumerate().map(|(index, line)| (index + 1, line))
    }

    /// Each statement. `may_go_on` says whether a line may be joined with the next one: comments and names may not, because in other
    /// encodings a backslash may be half of a character.
    pub(super) fn statements(
        &self,
        may_go_on: impl Fn(&str) -> bool,
    ) -> impl Iterator<Item = Statement<'_>> {
        let mut lines = self.numbered();
        std::iter::from_fn(move || {
            let (line, mut text) = lines.next()?;
            while let Some(head) = trimmed(before_comment(&text)).strip_suffix('\\')
                && may_go_on(head)
            {
                let next = lines.next().map(|(_, next)| next).unwrap_or_default();
                text = format!("{head} {next}").into();
            }
            Some(Statement { line, text })
        })
    }

    /// Whether there is nothing but white space.
    pub(super) fn are_blank(&self) -> bool {
        self.text.iter().all(u8::is_ascii_whitespace)
    }
}

/// The encoding of a UTF-16 text. A text of ASCII characters has a zero byte in every pair.
fn utf_16(bytes: &[u8]) -> Option<&'static Encoding> {
    match bytes {
        [0xff, 0xfe, ..] => Some(UTF_16LE),
        [0xfe, 0xff, ..] => Some(UTF_16BE),
        [first, 0, second, 0, ..] if *first != 0 && *second != 0 => Some(UTF_16LE),
        [0, first, 0, second, ..] if *first != 0 && *second != 0 => Some(UTF_16BE),
        _ => None,
    }
}

fn decoded(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(line) => line.into(),
        Err(_) => WINDOWS_1252.decode_without_bom_handling(line).0,
    }
}

/// Whether a character separates words. Only ASCII characters do: in names, the bytes of other encodings must not be trimmed. A zero byte
/// does, because some programs fill up lines with them.
fn is_space(c: char) -> bool {
    c.is_ascii_whitespace() || matches!(c, '\0' | '\x0b')
}

/// A line without white space around it.
pub(super) fn trimmed(line: &str) -> &str {
    line.trim_matches(is_space)
}

/// A line's keyword and what follows it, both without white space around.
pub(super) fn keyword_of(line: &str) -> (&str, &str) {
    let line = trimmed(line);
    let end = line.find(is_space).unwrap_or(line.len());
    let (keyword, rest) = line.split_at(end);
    (keyword, trimmed(rest))
}

/// A line of numbers up to a comment, which may begin anywhere (`1.5#corner`), but not within C's `1.#IND`.
fn before_comment(rest: &str) -> &str {
    let is_comment = |&(at, _): &(usize, &str)| !rest[..at].ends_with("1.");
    let comment = rest.match_indices('#').find(is_comment);
    &rest[..comment.map_or(rest.len(), |(at, _)| at)]
}

/// Words of a line of numbers up to a comment.
pub(super) fn words(rest: &str) -> impl Iterator<Item = &str> {
    before_comment(rest)
        .split(is_space)
        .filter(|word| !word.is_empty())
}

/// A name, and the name without what may be a comment after it, if there is one: `red # of the hull`.
pub(super) fn names_in(rest: &str) -> (&str, Option<&str>) {
    let comment = rest
        .match_indices('#')
        .find(|(at, _)| rest[..*at].ends_with(is_space));
    (
        rest,
        comment
            .map(|(at, _)| trimmed(&rest[..at]))
            .filter(|name| !name.is_empty()),
    )
}

/// A decimal number; NaN for the words that C libraries write for NaN and infinity (`-nan(ind)`, `1.#QNAN`, `-1.#IND00`, `1.#INF`).
/// `None` for anything else.
pub(super) fn number(word: &str) -> Option<f64> {
    if let Ok(value) = word.parse() {
        return Some(value);
    }
    let word = word.trim_start_matches(['+', '-']).to_ascii_lowercase();
    let is_not_finite = word.starts_with("nan(")
        || word.strip_prefix("1.#").is_some_and(|rest| {
            ["ind", "inf", "qnan", "snan", "nan"]
                .iter()
                .any(|kind| rest.starts_with(kind))
        });
    is_not_finite.then_some(f64::NAN)
}

/// A line of an OBJ that cannot be parsed.
pub(super) fn syntax(line: usize, message: String) -> MeshError {
    MeshError::Syntax { line, message }
}

/// A corner of a face that cannot be parsed.
pub(super) fn corner_syntax(line: usize, word: &str) -> MeshError {
    syntax(
        line,
        format!(
            "`{}` is not a face corner; expected whole numbers as in `7`, `7/1`, `7//3` or `7/1/3`",
            shorten(word)
        ),
    )
}

/// At most 40 characters of the client's text, for messages.
pub(super) fn shorten(word: &str) -> String {
    word.chars().take(40).collect()
}

/// Lines that are not used for the same reason: their number, and the first of them.
#[derive(Debug, Default)]
pub(super) struct Skipped {
    count: usize,
    first: String,
}

impl Skipped {
    /// Counts a line; `what` describes it if it is the first.
    pub(super) fn add(&mut self, what: impl FnOnce() -> String) {
        if self.count == 0 {
            self.first = what();
        }
        self.count += 1;
    }

    /// A warning with the number, `sentence`, and the first place; none if nothing was counted.
    pub(super) fn warning(&self, code: &str, sentence: &str) -> Option<Warning> {
        let Self { count, first } = self;
        (*count > 0)
            .then(|| Warning::new(code, format!("{count} {sentence} The first is {first}.")))
    }
}
