//! NumPy arrays. Source of the format: NumPy Enhancement Proposal 1, "A Simple File Format for NumPy Arrays", versions 1.0 … 3.0.

use super::error::FieldError;
use super::printable;
use super::samples::Samples;
use super::{MAX_SAMPLES, Read};

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Longest text that describes an array of plain numbers; NumPy writes 118 bytes.
const MAX_HEADER_BYTES: usize = 4096;

const ACCEPTED: &str = "float16, float32, float64, and integers of 16 and 32 bits";

/// What the header says.
struct Header<'a> {
    descr: &'a str,
    fortran_order: bool,
    shape: Vec<u64>,
}

fn broken(reason: impl Into<String>) -> FieldError {
    FieldError::unreadable("NPY", reason)
}

pub(super) fn read(bytes: &[u8]) -> Result<Read, FieldError> {
    let (header, data) = split(bytes)?;
    let header = Text(header.trim()).header()?;
    let number = Number::of(header.descr)?;
    let axes = Axes::of(&header)?;
    let samples = axes.samples()?;
    let needed = samples * number.bytes as u64;
    if data.len() as u64 != needed {
        return Err(broken(format!(
            "its shape {} needs {needed} bytes, but {} follow the header",
            written(&header.shape),
            data.len()
        )));
    }
    let names: &[&str] = match axes.counts[3] {
        1 => &["value"],
        _ => &["x", "z"],
    };
    let [frames, rows, columns, _] = axes.counts;
    let strides = axes.strides(header.fortran_order);
    let channels = names.iter().enumerate().map(|(channel, name)| {
        let places = (0..frames).flat_map(move |f| {
            (0..rows).flat_map(move |r| {
                (0..columns).map(move |c| {
                    f * strides[0] + r * strides[1] + c * strides[2] + channel * strides[3]
                })
            })
        });
        ((*name).to_owned(), number.samples(data, places))
    });
    Ok(Read {
        size: [columns, rows],
        frames,
        channels: channels.collect(),
    })
}

/// The header's text and the data.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), FieldError> {
    const CUT: &str = "it ends within its header";
    let after = &bytes[MAGIC.len()..];
    let (version, rest) = after.split_first_chunk::<2>().ok_or_else(|| broken(CUT))?;
    let (length, rest) = match version {
        [1, 0] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(|| broken(CUT))?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        }
        [2 | 3, 0] => {
            let (length, rest) = rest.split_first_chunk().ok_or_else(|| broken(CUT))?;
            (u32::from_le_bytes(*length) as usize, rest)
        }
        [major, minor] => {
            return Err(broken(format!(
                "version {major}.{minor} of the format is not known; 1.0, 2.0 and 3.0 are"
            )));
        }
    };
    if length > MAX_HEADER_BYTES {
        return Err(broken(format!(
            "its header has {length} bytes; that of an array of plain numbers is shorter than {MAX_HEADER_BYTES}"
        )));
    }
    let (header, data) = rest.split_at_checked(length).ok_or_else(|| broken(CUT))?;
    let header = std::str::from_utf8(header).map_err(|_| broken("its header is not text"))?;
    Ok((header, data))
}

/// A header that is being read: a Python dictionary with three known keys, without nesting.
struct Text<'a>(&'a str);

impl<'a> Text<'a> {
    fn header(mut self) -> Result<Header<'a>, FieldError> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.expect('{')?;
        while !self.take('}') {
            let key = self.quoted()?;
            self.expect(':')?;
            let is_new = match key {
                "descr" => descr.replace(self.descr()?).is_none(),
                "fortran_order" => fortran_order.replace(self.boolean()?).is_none(),
                "shape" => shape.replace(self.tuple()?).is_none(),
                _ => {
                    let key = printable(key);
                    return Err(broken(format!("its header has the unknown key `{key}`")));
                }
            };
            if !is_new {
                return Err(broken(format!("its header has the key `{key}` twice")));
            }
            if !self.take(',') {
                self.expect('}')?;
                break;
            }
        }
        if !self.0.trim_start().is_empty() {
            return Err(broken("its header goes on behind the dictionary"));
        }
        let missing = |key: &str| broken(format!("its header has no `{key}`"));
        Ok(Header {
            descr: descr.ok_or_else(|| missing("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
        })
    }

    fn take(&mut self, c: char) -> bool {
        self.0 = self.0.trim_start();
        match self.0.strip_prefix(c) {
            Some(rest) => {
                self.0 = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, c: char) -> Result<(), FieldError> {
        if self.take(c) {
            return Ok(());
        }
        let found = printable(self.0);
        Err(broken(format!(
            "its header should have `{c}` before `{found}`"
        )))
    }

    /// A text in single or double quotes, without escapes.
    fn quoted(&mut self) -> Result<&'a str, FieldError> {
        for quote in ['\'', '"'] {
            if self.take(quote) {
                let (text, rest) = self
                    .0
                    .split_once(quote)
                    .ok_or_else(|| broken("a text in its header has no end"))?;
                self.0 = rest;
                return Ok(text);
            }
        }
        self.expect('\'')?;
        Ok("")
    }

    fn descr(&mut self) -> Result<&'a str, FieldError> {
        self.0 = self.0.trim_start();
        if self.0.starts_with(['[', '(']) {
            return Err(FieldError::NumberType {
                format: "NPY",
                found: "elements of several fields".to_owned(),
                accepted: ACCEPTED,
            });
        }
        self.quoted()
    }

    fn boolean(&mut self) -> Result<bool, FieldError> {
        self.0 = self.0.trim_start();
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.0.strip_prefix(word) {
                self.0 = rest;
                return Ok(value);
            }
        }
        Err(broken("`fortran_order` is neither True nor False"))
    }

    fn tuple(&mut self) -> Result<Vec<u64>, FieldError> {
        self.expect('(')?;
        let mut lengths = Vec::new();
        while !self.take(')') {
            self.0 = self.0.trim_start();
            let digits = self
                .0
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(self.0.len());
            let (number, rest) = self.0.split_at(digits);
            let length = number.parse().map_err(|_| {
                broken(format!(
                    "a length in its shape is not a number of at most 64 bits: `{}`",
                    printable(self.0)
                ))
            })?;
            lengths.push(length);
            // Python 2 wrote long integers with an L.
            self.0 = rest.strip_prefix('L').unwrap_or(rest);
            if !self.take(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(lengths)
    }
}

/// Frames, rows, columns and channels.
struct Axes {
    counts: [usize; 4],
    /// Which of them the array has as axes.
    is_axis: [bool; 4],
}

impl Axes {
    fn of(header: &Header<'_>) -> Result<Self, FieldError> {
        let shape = &header.shape;
        let is_axis = match shape[..] {
            [_, _] => [false, true, true, false],
            [_, _, 2] => [false, true, true, true],
            [_, _, _] => [true, true, true, false],
            [_, _, _, 2] => [true; 4],
            _ => {
                let found = written(shape);
                return Err(FieldError::Shape { found });
            }
        };
        let samples = shape.iter().copied().fold(1_u64, u64::saturating_mul);
        if samples > MAX_SAMPLES {
            return Err(FieldError::TooLarge { samples });
        }
        let mut lengths = shape.iter();
        let counts = is_axis.map(|is| match is {
            // A length of more than the samples is impossible unless another is 0.
            true => lengths
                .next()
                .map_or(1, |length| usize::try_from(*length).unwrap_or(0)),
            false => 1,
        });
        Ok(Self { counts, is_axis })
    }

    fn samples(&self) -> Result<u64, FieldError> {
        let samples: u64 = self
            .counts
            .iter()
            .map(|count| *count as u64)
            .fold(1, u64::saturating_mul);
        if samples == 0 {
            return Err(FieldError::NoSamples);
        }
        Ok(samples)
    }

    /// Elements from one to the next along each axis.
    fn strides(&self, fortran_order: bool) -> [usize; 4] {
        let mut strides = [0; 4];
        let mut next = 1;
        let mut set = |axis: usize| {
            if self.is_axis[axis] {
                strides[axis] = next;
                next *= self.counts[axis];
            }
        };
        if fortran_order {
            (0..4).for_each(&mut set);
        } else {
            (0..4).rev().for_each(&mut set);
        }
        strides
    }
}

/// The shape as Python writes it; of a long one the start.
fn written(shape: &[u64]) -> String {
    const MOST: usize = 8;
    let mut lengths: Vec<String> = shape.iter().take(MOST).map(u64::to_string).collect();
    if shape.len() > MOST {
        lengths.push("…".to_owned());
    }
    let comma = if shape.len() == 1 { "," } else { "" };
    format!("({}{comma})", lengths.join(", "))
}

/// The type of an array's elements.
#[derive(Clone, Copy)]
struct Number {
    is_big_endian: bool,
    kind: char,
    bytes: usize,
}

impl Number {
    fn of(descr: &str) -> Result<Self, FieldError> {
        let mut letters = descr.chars();
        let order = letters.next().unwrap_or_default();
        let kind = letters.next().unwrap_or_default();
        let bytes = match (kind, letters.as_str()) {
            ('f' | 'i' | 'u', "2") => Some(2),
            ('f' | 'i' | 'u', "4") => Some(4),
            ('f', "8") => Some(8),
            _ => None,
        };
        match (order, bytes) {
            ('<' | '>' | '=', Some(bytes)) => Ok(Self {
                is_big_endian: order == '>',
                kind,
                bytes,
            }),
            _ => {
                let name = match kind {
                    'O' => " (Python objects)",
                    'c' => " (complex numbers)",
                    'b' => " (booleans)",
                    'S' | 'U' | 'a' => " (texts)",
                    'i' | 'u' if letters.as_str() == "1" => {
                        " (integers of 8 bits, whose steps would show as caustics)"
                    }
                    'i' | 'u' => " (integers of another size)",
                    _ => "",
                };
                Err(FieldError::NumberType {
                    format: "NPY",
                    found: format!("numbers of type `{}`{name}", printable(descr)),
                    accepted: ACCEPTED,
                })
            }
        }
    }

    fn samples(self, data: &[u8], places: impl Iterator<Item = usize>) -> Samples {
        match (self.kind, self.bytes) {
            ('f', 2) => {
                let of = |b| half::f16::from_le_bytes(b).to_f32();
                Samples::F16(self.each(data, places, of))
            }
            ('f', 4) => Samples::F32(self.each(data, places, f32::from_le_bytes)),
            ('i', 2) => Samples::I16(self.each(data, places, i16::from_le_bytes)),
            ('u', 2) => Samples::U16(self.each(data, places, u16::from_le_bytes)),
            ('i', _) => {
                let of = |b| f64::from(i32::from_le_bytes(b));
                Samples::Integers(self.each(data, places, of))
            }
            ('u', _) => {
                let of = |b| f64::from(u32::from_le_bytes(b));
                Samples::Integers(self.each(data, places, of))
            }
            _ => Samples::F64(self.each(data, places, f64::from_le_bytes)),
        }
    }

    fn each<T, const BYTES: usize>(
        self,
        data: &[u8],
        places: impl Iterator<Item = usize>,
        of: impl Fn([u8; BYTES]) -> T,
    ) -> Vec<T> {
        let element = |place: usize| {
            let mut bytes = [0; BYTES];
            bytes.copy_from_slice(&data[place * BYTES..][..BYTES]);
            if self.is_big_endian {
                bytes.reverse();
            }
            of(bytes)
        };
        places.map(element).collect()
    }
}
