//! Field names: the unit that a name ends with, and the field that a misspelt name was meant to be.

use super::strict::quoted;

/// Suffix of a field name and the unit it stands for; longer suffixes first.
const UNITS: [(&str, &str); 10] = [
    ("_w_m2_sr", "W/(m² sr)"),
    ("_w_m2", "W/m²"),
    ("_w_sr", "W/sr"),
    ("_per_m", "1/m"),
    ("_per_s", "1/s"),
    ("_deg", "degrees"),
    ("_ev", "stops"),
    ("_cells", "cells"),
    ("_m", "m"),
    ("_s", "s"),
];

/// The longest name that is compared letter by letter.
const MAX_COMPARED: usize = 64;

/// The unit that a field name ends with.
pub(super) fn unit_of(field: &str) -> Option<&'static str> {
    UNITS
        .iter()
        .find(|(suffix, _)| field.ends_with(suffix))
        .map(|(_, unit)| *unit)
}

/// The field (or other name) that `given` was probably meant to be.
pub fn meant<'a>(given: &str, fields: &[&'a str]) -> Option<&'a str> {
    let given = snake_case(given);
    let same_stem = |field: &&&str| {
        let stem = stem_of(field);
        stem == given || (stem == stem_before_unit(&given) && stem != **field)
    };
    if let Some(field) = fields.iter().find(same_stem) {
        return Some(field);
    }
    if given.len() > MAX_COMPARED {
        return None;
    }
    fields
        .iter()
        .map(|field| (edits(&given, field), *field))
        .filter(|(edits, field)| *edits <= 2 && edits * 3 <= field.len())
        .min()
        .map(|(_, field)| field)
}

/// Why a field beside `method` is unknown, and what to write instead: it may be a dial, which belongs inside `method`, or a field
/// of older versions. `None` if `method` is not among `fields`, or if `given` is a misspelt field.
pub(super) fn moved(given: &str, fields: &[&str]) -> Option<(&'static str, String)> {
    if !fields.contains(&"method") {
        return None;
    }
    if given == "placement" {
        return Some((
            "it was removed; `method` alone selects how light is placed",
            "`method` with the value that `placement` had, or no `method` if that was `hit`"
                .to_owned(),
        ));
    }
    if meant(given, fields).is_some() {
        return None;
    }
    let given = quoted(given);
    Some((
        "a dial that only some methods have belongs inside `method`",
        format!("`\"method\": {{ \"kind\": \"…\", \"{given}\": … }}`"),
    ))
}

/// `waterCells` and `water-cells` as `water_cells`.
fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() && !snake.ends_with('_') {
            snake.push('_');
        }
        match c {
            '-' | ' ' => snake.push('_'),
            _ => snake.extend(c.to_lowercase()),
        }
    }
    snake
}

/// `depth` of `depth_m`; a field without unit is its own stem.
fn stem_of(field: &str) -> &str {
    UNITS
        .iter()
        .find_map(|(suffix, _)| field.strip_suffix(suffix))
        .unwrap_or(field)
}

/// `depth` of `depth_cm`: the name before what may be a unit that we do not use.
fn stem_before_unit(name: &str) -> &str {
    match name.rsplit_once('_') {
        Some((stem, unit)) if unit.len() <= 4 => stem,
        _ => name,
    }
}

/// Levenshtein distance: the smallest number of letters to insert, delete or replace.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, a_letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b_letter) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a_letter != *b_letter);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
