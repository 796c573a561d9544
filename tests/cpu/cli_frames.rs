//! Frame ranges, file patterns, and what a batch reports.

use std::path::Path;
use std::time::Duration;

use caustica::cli::args::{Cli, Command};
use caustica::cli::batch::{BatchWarnings, pace};
use caustica::cli::frame_pattern::FramePattern;
use caustica::cli::frames::{FrameSet, LARGEST_FRAME, in_ranges};
use caustica::stats::Warning;
use clap::Parser;

#[test]
fn frame_ranges_are_read() {
    let table: &[(&str, &[i64])] = &[
        ("30", &[30]),
        ("0-3", &[0, 1, 2, 3]),
        ("1-20:4", &[1, 5, 9, 13, 17]),
        ("1-20x4", &[1, 5, 9, 13, 17]),
        ("1-20:4,30", &[1, 5, 9, 13, 17, 30]),
        ("5,1-3,2", &[1, 2, 3, 5]),
        (" 7 , 3-3 ", &[3, 7]),
        ("-3", &[-3]),
        ("-3-1", &[-3, -2, -1, 0, 1]),
        ("-3--1", &[-3, -2, -1]),
        ("-7-4x5,-1", &[-7, -2, -1, 3]),
        ("-0", &[0]),
        ("9999999999", &[LARGEST_FRAME]),
        (
            "-9999999999--9999999990:9",
            &[-9_999_999_999, -9_999_999_990],
        ),
    ];
    for (text, frames) in table {
        assert_eq!(
            text.parse::<FrameSet>().unwrap().frames(),
            *frames,
            "{text}"
        );
    }
}

#[test]
fn bad_frame_ranges_are_refused_with_what_is_accepted() {
    for (text, reason) in [
        ("", "is not a frame"),
        (",", "is not a frame"),
        ("1,", "is not a frame"),
        ("a", "is not a frame"),
        ("1-", "is not a frame"),
        ("-", "is not a frame"),
        ("--1", "is not a frame"),
        ("1---3", "is not a frame"),
        ("1-2-3", "is not a frame"),
        ("1..3", "is not a frame"),
        ("1-5:", "is not a frame"),
        ("1-5x", "is not a frame"),
        ("1-5x-2", "is not a frame"),
        ("1-5x2x2", "is not a frame"),
        ("1-5x2-9", "is not a frame"),
        ("1:2", "is not a frame"),
        ("1x2", "is not a frame"),
        ("+3", "is not a frame"),
        ("1.5", "is not a frame"),
        ("0x10", "is not a frame"),
        ("1 - 5", "is not a frame"),
        ("3-1", "runs backwards"),
        ("-1--3", "runs backwards"),
        ("1-5:0", "step of 0"),
        ("1-5x0", "step of 0"),
        ("10000000000", "more than ten digits"),
        ("-10000000000-1", "more than ten digits"),
        ("99999999999999999999", "more than ten digits"),
        ("0-4000000000", "more than 1000000 frames"),
    ] {
        let error = text.parse::<FrameSet>().expect_err(text).to_string();
        assert!(error.contains("accepted"), "{text}: {error}");
        assert!(error.contains(reason), "{text}: {error}");
    }
}

#[test]
fn negative_frames_are_values_and_not_flags() {
    for words in [&["--frames", "-3-1"][..], &["--frames=-3-1"]] {
        let line = ["caustica", "animate", "s.json", "-o", "x.%d.png"];
        let cli = Cli::try_parse_from(line.iter().chain(words)).unwrap();
        let Command::Animate(args) = cli.command else {
            panic!("animate was typed");
        };
        assert_eq!(args.frames.frames(), [-3, -2, -1, 0, 1]);
    }
}

#[test]
fn frames_are_listed_as_they_are_read() {
    let table: &[(&[i64], &str)] = &[
        (&[], ""),
        (&[5], "5"),
        (&[0, 1, 2, 7], "0-2, 7"),
        (&[3, 4], "3-4"),
        (&[3, 5], "3, 5"),
        (&[1, 4, 7, 10, 11, 12], "1-10x3, 11-12"),
        (&[-3, -2, -1, 5], "-3--1, 5"),
        (&[-4, -2, 0], "-4-0x2"),
    ];
    for (frames, text) in table {
        assert_eq!(in_ranges(frames), *text, "{frames:?}");
        if !frames.is_empty() {
            assert_eq!(text.parse::<FrameSet>().unwrap().frames(), *frames);
        }
    }
    // Squares have no two equal distances.
    let squares: Vec<i64> = (0..25).map(|n| n * n * n).collect();
    let text = in_ranges(&squares);
    assert!(text.starts_with("0-1, 8, 27, "), "{text}");
    assert!(text.ends_with(", … (25 in all)"), "{text}");
}

#[test]
fn patterns_hold_the_number_once() {
    let table = [
        ("frame.%04d.png", 7, "frame.0007.png"),
        ("frame.%04d.png", 123_456, "frame.123456.png"),
        ("frame.%04d.png", -10, "frame.-0010.png"),
        ("frame.####.png", 10, "frame.0010.png"),
        ("frame.####.png", -10, "frame.-0010.png"),
        ("frame#.png", 12, "frame12.png"),
        ("out/%d.exr", 0, "out/0.exr"),
        ("out/%d.exr", -7, "out/-7.exr"),
        ("out dir/a%06db.exr", 12, "out dir/a000012b.exr"),
        ("50%_gray/f.%04d.png", 1, "50%_gray/f.0001.png"),
        ("50%%_gray/f.%04d.png", 1, "50%_gray/f.0001.png"),
        ("take#1/%d/f.##.png", 1, "take#1/%d/f.01.png"),
        ("50%%.%02d.png", 1, "50%.01.png"),
        ("%%%%%d.png", 1, "%%1.png"),
        ("take#2.%d.png", 3, "take#2.3.png"),
        ("50%%.##.png", 1, "50%.01.png"),
    ];
    for (text, frame, path) in table {
        let pattern: FramePattern = text.parse().unwrap();
        assert_eq!(pattern.path(frame), Path::new(path), "{text}");
    }
    for text in [
        "",
        "frame.png",
        "%d%d.png",
        "#.#.png",
        "%04d/%04d/",
        "%4d.png",
        "%00d.png",
        "%099d.png",
        "#####################.png",
        "%s.png",
        "%",
        "%0",
        "%04x.png",
        "50%.%04d.png",
        "%%d.png",
        "%03d/frame.png",
        "##/frame.png",
        "-",
    ] {
        let error = text.parse::<FramePattern>().expect_err(text);
        assert!(
            error.to_string().contains("frame.%04d.png"),
            "{text}: {error}"
        );
    }
}

#[test]
fn warnings_of_a_batch_are_said_once_and_listed_by_frame() {
    let clipped = |pixels: u32| Warning::new("png_clipped", format!("{pixels} pixels are clipped"));
    let coarse = |pointer: &str| Warning {
        pointer: Some(pointer.to_owned()),
        ..Warning::new("coarse", "a cell is coarse")
    };
    let mut warnings = BatchWarnings::default();
    assert_eq!(
        warnings.add(-1, &clipped(3)).as_deref(),
        Some("warning: frame -1: 3 pixels are clipped")
    );
    assert_eq!(
        warnings.add(-1, &coarse("/a")).as_deref(),
        Some("warning: frame -1: a cell is coarse (/a)")
    );
    assert_eq!(warnings.add(0, &clipped(5)), None);
    assert!(warnings.add(0, &coarse("/b")).is_some(), "another cause");
    assert!(
        warnings.add(0, &coarse("/b")).is_some(),
        "another warning of the same frame"
    );
    assert_eq!(warnings.add(1, &clipped(5)), None);
    assert_eq!(warnings.add(7, &clipped(5)), None);
    assert_eq!(
        warnings.summary(),
        [
            "warning: png_clipped in frames -1-1, 7",
            "warning: coarse (/a) in frame -1",
            "warning: coarse (/b) in frame 0",
        ]
    );
}

#[test]
fn progress_has_rate_and_time_left() {
    let table = [
        (1, 4, 2.0, "1 of 4 done, 2.0 s a frame, 6 s left"),
        (4, 12, 2.0, "4 of 12 done, 2.0 frames/s, 4 s left"),
        (1, 100, 3.0, "1 of 100 done, 3.0 s a frame, 4 min 57 s left"),
        (
            1,
            1000,
            60.0,
            "1 of 1000 done, 60.0 s a frame, 16 h 39 min left",
        ),
        (3, 3, 1.5, "3 of 3 done, 2.0 frames/s, 0 s left"),
    ];
    for (done, total, seconds, text) in table {
        assert_eq!(pace(done, total, Duration::from_secs_f64(seconds)), text);
    }
}
