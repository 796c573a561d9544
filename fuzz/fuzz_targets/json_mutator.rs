//! Mutations of the values in a JSON text: replaces a number, adds or removes a field, copies a part of the document to another
//! place.

use std::sync::OnceLock;

use serde_json::{Map, Number, Value};

/// The contract, from which the names of fields and kinds are taken.
const CONTRACT: &str = include_str!("../../openapi.yaml");

/// Numbers at and near the limits of f32, f64, angles and counts.
const NUMBERS: [f64; 32] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    3.0,
    1e-3,
    1e-7,
    1e-12,
    1e-38,
    1e-45,
    5e-324,
    1e3,
    1e5,
    1e7,
    1e9,
    1e18,
    1e30,
    3.5e38,
    1e154,
    1e300,
    1.797e308,
    -1e300,
    0.1,
    1.0001,
    89.999_999,
    90.0,
    180.0,
    360.0,
    8192.0,
    4_294_967_296.0,
];

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 … `count` − 1; 0 if `count` is 0.
    fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }
}

/// `bytes` with one to four of their values changed; `None` where they are not JSON.
pub(crate) fn change(bytes: &[u8], seed: u32) -> Option<Vec<u8>> {
    let mut document: Value = serde_json::from_slice(bytes).ok()?;
    let mut random = Random(u64::from(seed));
    for _ in 0..=random.below(4) {
        let count = count(&document);
        let mut donor = random.below(count);
        let donor = find(&mut document, &mut donor).cloned().unwrap_or_default();
        let mut place = random.below(count);
        if let Some(place) = find(&mut document, &mut place) {
            change_value(place, donor, &mut random);
        }
    }
    serde_json::to_vec(&document).ok()
}

fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(members) => members.values().map(count).sum(),
        _ => 0,
    }
}

/// The value at `index`, in the order of the text.
fn find<'a>(value: &'a mut Value, index: &mut usize) -> Option<&'a mut Value> {
    if *index == 0 {
        return Some(value);
    }
    *index -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| find(item, index)),
        Value::Object(members) => members.values_mut().find_map(|item| find(item, index)),
        _ => None,
    }
}

fn change_value(value: &mut Value, donor: Value, random: &mut Random) {
    match random.below(12) {
        0 => *value = donor,
        1 => *value = Value::Null,
        _ => match value {
            Value::Null | Value::Bool(_) => *value = some_value(random),
            Value::Number(number) => {
                *value = some_number(number.as_f64().unwrap_or_default(), random)
            }
            Value::String(text) => word(random).clone_into(text),
            Value::Array(items) => match random.below(3) {
                0 => items.push(donor),
                1 if !items.is_empty() => {
                    items.remove(random.below(items.len()));
                }
                _ => items.extend_from_within(..),
            },
            Value::Object(members) => change_members(members, donor, random),
        },
    }
}

fn change_members(members: &mut Map<String, Value>, donor: Value, random: &mut Random) {
    let at = random.below(members.len());
    match (random.below(3), members.keys().nth(at).cloned()) {
        (0, Some(key)) => {
            members.remove(&key);
        }
        (1, _) => {
            members.insert(word(random).to_owned(), donor);
        }
        _ => {
            members.insert(word(random).to_owned(), some_value(random));
        }
    }
}

fn some_value(random: &mut Random) -> Value {
    match random.below(6) {
        0 => Value::from(word(random)),
        1 => Value::from(random.below(2) == 0),
        2 => Value::from(vec![
            some_number(1.0, random),
            some_number(1.0, random),
            some_number(1.0, random),
        ]),
        _ => some_number(1.0, random),
    }
}

fn some_number(number: f64, random: &mut Random) -> Value {
    let edge = NUMBERS[random.below(NUMBERS.len())];
    let changed = match random.below(5) {
        0 => -number,
        1 => number * edge,
        2 => number + edge,
        // Whole numbers, as JSON writes them.
        3 => return Value::from(random.below(9)),
        _ => edge,
    };
    Number::from_f64(changed).map_or(Value::Null, Value::from)
}

/// A name of a field, or a word that a field takes.
fn word(random: &mut Random) -> &'static str {
    static WORDS: OnceLock<Vec<&str>> = OnceLock::new();
    let words = WORDS.get_or_init(|| {
        let is_word = |text: &&str| {
            !text.is_empty()
                && text
                    .bytes()
                    .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
        };
        let of_line = |line: &'static str| {
            let line = line.trim();
            line.strip_suffix(':').or_else(|| line.strip_prefix("- "))
        };
        let mut words: Vec<&str> = CONTRACT
            .lines()
            .filter_map(of_line)
            .filter(is_word)
            .collect();
        words.sort_unstable();
        words.dedup();
        words
    });
    words[random.below(words.len())]
}
