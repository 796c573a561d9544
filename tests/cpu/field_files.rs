//! Reading arrays of numbers: files written by other programs, and broken ones.

use std::path::Path;

use caustica::assets::FieldStore;
use caustica::config::Limits;
use caustica::fields::{self, Field, FieldError, FieldFormat};

use super::field_support as files;

/// A file that `make.py` beside it wrote.
fn fixture(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/fields");
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn read(name: &str) -> Field {
    fields::read(&fixture(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The number in row `r` and column `c` of the fixtures.
fn number(r: usize, c: usize) -> f64 {
    10.0 * r as f64 + c as f64 + 0.25
}

fn refused(bytes: &[u8]) -> String {
    let error = fields::read(bytes).expect_err("the file is broken");
    error.to_string()
}

#[test]
fn files_of_numpy_openexr_and_pillow_have_their_numbers() {
    let cases: [(&str, &str, f64); 13] = [
        ("f8.npy", "value", 1.0),
        ("f4.npy", "value", 1.0),
        ("f4_big_endian.npy", "value", 1.0),
        ("f8_fortran.npy", "value", 1.0),
        ("f2.npy", "value", 1.0),
        ("i4.npy", "value", 4.0),
        ("u2.npy", "value", 4.0),
        ("slopes.npy", "x", 1.0),
        ("slopes.npy", "z", -1.0),
        ("channels.exr", "height", 1.0),
        ("channels.exr", "foam", 1.0),
        ("half.exr", "Z", 1.0),
        ("grey.png", "Y", 4.0),
    ];
    for (name, channel, factor) in cases {
        let field = read(name);
        assert_eq!((field.size, field.frames), ([4, 3], 1), "{name}");
        let found = field.channels.iter().find(|found| found.name == channel);
        let found = found.unwrap_or_else(|| panic!("{name} has no {channel}"));
        assert_eq!(found.samples.count(), 12);
        for r in 0..3 {
            for c in 0..4 {
                let expected = factor * number(r, c);
                assert_eq!(
                    found.samples.at(4 * r + c),
                    expected,
                    "{name} {channel} {r} {c}"
                );
            }
        }
        let ends = [factor * number(0, 0), factor * number(2, 3)];
        assert_eq!(found.range, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
        assert!(found.not_finite.is_none());
    }
}

#[test]
fn arrays_of_three_axes_are_frames() {
    for name in ["frames.npy", "frames_fortran_big_endian.npy"] {
        let field = read(name);
        assert_eq!((field.size, field.frames), ([4, 3], 2), "{name}");
        for (i, [frame, r, c]) in [[0, 0, 0], [0, 2, 3], [1, 0, 0], [1, 1, 2]]
            .into_iter()
            .enumerate()
        {
            let expected = number(r, c) + 100.0 * frame as f64;
            let found = field.channels[0].samples.at((frame * 3 + r) * 4 + c);
            assert_eq!(found, expected, "{name} {i}");
        }
    }
}

#[test]
fn the_steps_between_numbers_are_those_of_the_type() {
    let of = |name: &str| read(name).channels[0].resolution;
    assert_eq!(of("u2.npy"), 1.0);
    assert_eq!(of("grey.png"), 1.0);
    // The largest number is 23.25.
    assert_eq!(of("f4.npy"), 16.0 * 2.0_f64.powi(-23));
    assert_eq!(of("f2.npy"), 16.0 * 2.0_f64.powi(-10));
    assert_eq!(of("half.exr"), 16.0 * 2.0_f64.powi(-10));
    assert_eq!(of("f8.npy"), 16.0 * f64::EPSILON);
}

#[test]
fn types_that_hold_no_heights_are_refused_by_name() {
    for (name, words) in [
        ("objects.npy", "Python objects"),
        ("bytes.npy", "8 bits"),
        ("records.npy", "several fields"),
        ("complex.npy", "complex"),
        ("grey8.png", "8 bits"),
    ] {
        let message = refused(&fixture(name));
        assert!(
            message.contains(words) && message.contains("accepted"),
            "{name}: {message}"
        );
    }
    let palette = files::png([4, 4], png::ColorType::Grayscale, 8, &[0; 16]);
    assert!(refused(&palette).contains("8 bits"));
}

#[test]
fn every_truncated_or_changed_file_is_read_or_refused_without_a_panic() {
    for name in [
        "f4.npy",
        "frames_fortran_big_endian.npy",
        "channels.exr",
        "half.exr",
        "grey.png",
    ] {
        let whole = fixture(name);
        for length in 0..whole.len() {
            let message = refused(&whole[..length]);
            assert!(!message.is_empty(), "{name} of {length} bytes");
        }
        for at in 0..whole.len() {
            for change in [0x01, 0x80, 0xff] {
                let mut changed = whole.clone();
                changed[at] ^= change;
                super::fuzz_checks::field::check(&changed);
            }
        }
    }
    let longer: Vec<u8> = fixture("f4.npy").into_iter().chain([0]).collect();
    assert!(refused(&longer).contains("needs 48 bytes, but 49 follow"));
}

#[test]
fn claims_of_gigabytes_are_refused_before_anything_is_allocated() {
    let npy = |shape: &str| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        files::npy_with(&header, &[0; 8])
    };
    for shape in [
        "(16384, 16384)",
        "(1000000000, 1000000000)",
        "(4294967296, 4294967296, 18446744073709551615)",
    ] {
        assert!(
            matches!(fields::read(&npy(shape)), Err(FieldError::TooLarge { .. })),
            "{shape}"
        );
    }
    for shape in ["(4096, 4096)", "(64, 64, 64)"] {
        assert!(
            refused(&npy(shape)).contains("but 8 follow the header"),
            "{shape}"
        );
    }
    for shape in ["(0, 18446744073709551615)", "(3, 0)"] {
        assert!(
            matches!(fields::read(&npy(shape)), Err(FieldError::NoSamples)),
            "{shape}"
        );
    }
    // A header that says it has 4 GiB, and one with a thousand brackets.
    let mut long = b"\x93NUMPY\x02\x00".to_vec();
    long.extend([0xff; 4]);
    assert!(refused(&long).contains("4294967295 bytes"));
    assert!(refused(&npy(&"(".repeat(1000))).contains("shape"));

    let mut wide = files::png([4, 4], png::ColorType::Grayscale, 16, &[0; 16]);
    wide[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let header = crc(&wide[12..29]);
    wide[29..33].copy_from_slice(&header.to_be_bytes());
    assert!(
        matches!(fields::read(&wide), Err(FieldError::TooLarge { .. })),
        "{}",
        refused(&wide)
    );
    wide[16..24].copy_from_slice(&[0, 0, 0x20, 0, 0, 0, 0x20, 0]);
    let header = crc(&wide[12..29]);
    wide[29..33].copy_from_slice(&header.to_be_bytes());
    assert!(
        refused(&wide).contains("it claims 8192 × 8192"),
        "{}",
        refused(&wide)
    );

    let mut exr = fixture("half.exr");
    let window = exr
        .windows(10)
        .position(|text| text == b"dataWindow")
        .unwrap();
    let corner = window + b"dataWindow\0box2i\0".len() + 4 + 8;
    exr[corner..corner + 8].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
    assert!(!refused(&exr).is_empty());
}

/// The checksum of PNG.
fn crc(bytes: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    crc.sum()
}

#[test]
fn shapes_and_headers_that_make_no_field_say_why() {
    let with = |header: &str| refused(&files::npy_with(header, &[0; 64]));
    let shape = |shape: &str| {
        with(&format!(
            "{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}"
        ))
    };
    for (text, written) in [
        ("(16,)", "(16,)"),
        ("()", "()"),
        ("(2, 2, 2, 2, 1)", "(2, 2, 2, 2, 1)"),
        ("(1, 4, 2, 3)", "(1, 4, 2, 3)"),
    ] {
        let message = shape(text);
        assert!(
            message.contains(&format!("the shape {written}"))
                && message.contains("(rows, columns)"),
            "{message}"
        );
    }
    for (header, words) in [
        ("{'descr': '<f4', 'fortran_order': False}", "no `shape`"),
        (
            "{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (4, 4)}",
            "`descr` twice",
        ),
        (
            "{'descr': '<f4', 'fortran_order': 1, 'shape': (4, 4)}",
            "neither True nor False",
        ),
        (
            "{'descr': '<f4', 'fortran_order': True, 'shape': (4, -4)}",
            "not a number",
        ),
        (
            "{'descr': '<f4', 'fortran_order': True, 'shape': (4, 99999999999999999999)}",
            "not a number",
        ),
        (
            "{'descr': '<f4', 'fortran_order': True, 'shape': (4, 4), 'x': 1}",
            "unknown key `x`",
        ),
        (
            "{'descr': '<f4', 'fortran_order': True, 'shape': (4, 4)} more",
            "goes on behind",
        ),
        ("{'descr': '<f4", "has no end"),
        ("[]", "should have `{`"),
        ("", "should have `{`"),
    ] {
        let message = with(header);
        assert!(message.contains(words), "{header}: {message}");
    }
    assert!(refused(b"\x93NUMPY\x04\x00\x00\x00").contains("version 4.0"));
    assert!(refused(b"").contains("empty"));
    for other in [&b"P5 4 4 255 "[..], b"\xff\xd8\xff", b"v 0 0 0"] {
        assert!(refused(other).contains("neither NPY nor EXR nor PNG"));
    }
}

#[test]
fn what_is_not_finite_is_counted_and_placed() {
    let mut values = vec![1.0; 24];
    values[17] = f64::NAN;
    values[20] = f64::NEG_INFINITY;
    let field = fields::read(&files::npy(&[2, 3, 4], &values)).unwrap();
    let found = field.channels[0].not_finite.unwrap();
    assert_eq!((found.count, found.first), (2, [1, 1, 1]));
    assert_eq!(field.channels[0].range, [1.0, 1.0]);
    let info = serde_json::to_value(field.info()).unwrap();
    assert_eq!(info["channels"][0]["not_finite"], 2);
    let nothing = fields::read(&files::npy(&[2, 2], &[f64::NAN; 4])).unwrap();
    assert_eq!(nothing.channels[0].range, [0.0, 0.0]);
}

#[test]
fn the_store_keeps_the_same_bytes_once_within_its_budget() {
    let one = files::npy(&[4, 4], &[0.5; 16]);
    let other = files::npy_f32(&[4, 4], &[0.5; 16]);
    let bytes = fields::read(&one).unwrap().bytes();
    let limits = Limits {
        asset_store_bytes: bytes,
        ..Limits::default()
    };
    let store = FieldStore::new(&limits);
    let first = store.insert(&one).unwrap();
    assert!(first.created && !store.insert(&one).unwrap().created);
    assert_eq!(
        (first.field.format, store.bytes()),
        (FieldFormat::Npy, bytes)
    );
    assert_eq!(
        first.field.id,
        format!("blake3:{}", blake3::hash(&one).to_hex())
    );
    let full = store.insert(&other).unwrap_err();
    assert!(
        matches!(full, FieldError::StoreFull { used_bytes, .. } if used_bytes == bytes),
        "{full}"
    );
    assert_eq!(store.list().len(), 1);
    assert!(store.remove(&first.field.id) && !store.remove(&first.field.id));
    assert_eq!(store.bytes(), 0);
    assert!(store.insert(&other).unwrap().created);
}
