//! Words, names and numbers of OBJ and MTL lines.

use super::MeshError;

/// The name of the file in messages.
pub(super) const OBJ: &str = "OBJ";

/// Longest name of a material or library, bytes. It is limited because the library copies a name at every change of material.
const MAX_NAME_BYTES: usize = 255;

/// Words of a line up to a trailing comment.
pub(super) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_whitespace()
        .take_while(|word| !word.starts_with('#'))
}

/// The name after a keyword: the rest of the line, which may contain spaces.
pub(super) fn name<'a>(
    file: &'static str,
    line: usize,
    keyword: &str,
    rest: &'a str,
) -> Result<&'a str, MeshError> {
    let name = rest.trim();
    if name.is_empty() || name.len() > MAX_NAME_BYTES {
        return Err(MeshError::Syntax {
            file,
            line,
            message: format!(
                "`{keyword}` has a name of {} bytes; expected 1 … {MAX_NAME_BYTES} bytes",
                name.len()
            ),
        });
    }
    Ok(name)
}

/// A decimal number of an OBJ line.
pub(super) fn number(line: usize, word: &str) -> Result<f64, MeshError> {
    word.parse().map_err(|_| {
        syntax(
            line,
            format!(
                "`{}` is not a number; expected a decimal number such as -1.25 or 3e-2",
                shorten(word)
            ),
        )
    })
}

/// A line of an OBJ that cannot be parsed.
pub(super) fn syntax(line: usize, message: String) -> MeshError {
    MeshError::Syntax {
        file: OBJ,
        line,
        message,
    }
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
