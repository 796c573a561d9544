//! The command line: syntax, frame ranges, file patterns, and printed texts.

use std::path::Path;

use caustica::cli::args::Command;
use caustica::cli::health::ServiceUrl;
use caustica::cli::{Cli, animate, plan, selfcheck, summary};
use caustica::config::AdapterPolicy;
use caustica::methods;
use caustica::plan::{Plan, PlannedPass, PlannedSlot};
use caustica::render::{SelfCheck, SelfCheckItem};
use caustica::stats::{AbsentPass, ChosenDials, MethodAdvice, OtherMethod};
use clap::{CommandFactory, Parser};
use serde_json::json;

fn parsed(words: &[&str]) -> Result<Cli, clap::Error> {
    Cli::try_parse_from(std::iter::once("caustica").chain(words.iter().copied()))
}

#[test]
fn the_definition_is_consistent() {
    Cli::command().debug_assert();
}

#[test]
fn every_field_has_a_flag_in_every_command_that_reads_a_scene() {
    for name in ["render", "animate", "plan"] {
        let mut root = Cli::command();
        let command = root.find_subcommand_mut(name).unwrap();
        let help = command.render_long_help().to_string();
        for field in methods::fields() {
            assert!(
                help.contains(&format!("--{} <VALUE", field.flag)),
                "{name} --{}",
                field.flag
            );
            assert!(
                help.contains(&field.help[..20.min(field.help.len())]),
                "{name} --{}",
                field.flag
            );
        }
    }
    for name in ["serve", "health", "selfcheck"] {
        let mut root = Cli::command();
        let help = root
            .find_subcommand_mut(name)
            .unwrap()
            .render_long_help()
            .to_string();
        assert!(!help.contains("--water-cells"), "{name}");
    }
}

#[test]
fn flags_become_overrides() {
    let words = [
        "render",
        "s.json",
        "-o",
        "x.exr",
        "--water-cells",
        "512",
        "--exposure-ev",
        "-1",
        "--layers",
        "radiance,depth",
        "--min-m",
        "-1,-2",
        "--adapter",
        "software",
        "--max-pixels",
        "77",
    ];
    let cli = parsed(&words).unwrap();
    assert_eq!(cli.render.adapter, AdapterPolicy::Software);
    assert_eq!(cli.limits.max_pixels, 77);
    let Command::Render(args) = cli.command else {
        panic!("render was typed");
    };
    assert_eq!(args.output, Path::new("x.exr"));
    let mut given = args.scene.overrides.0;
    given.sort();
    let owned = |(pointer, text): (&str, &str)| (pointer.to_owned(), text.to_owned());
    let expected = [
        ("/output/exposure_ev", "-1"),
        ("/output/layers", "radiance,depth"),
        ("/output/min_m", "-1,-2"),
        ("/quality/water_cells", "512"),
    ];
    assert_eq!(given, expected.map(owned));
}

#[test]
fn command_lines_that_make_no_sense_are_refused() {
    let table: &[&[&str]] = &[
        &[],
        &["paint"],
        &["render"],
        &["render", "s.json"],
        &["render", "s.json", "-o"],
        &["render", "s.json", "-o", "x.png", "--water-depth", "3"],
        &[
            "render", "s.json", "-o", "x.png", "--width", "3", "--width", "4",
        ],
        &["animate", "s.json", "-o", "x.%04d.png"],
        &["animate", "s.json", "-o", "x.png", "--frames", "0-3"],
        &["animate", "s.json", "-o", "x.%d.png", "--frames", "3-0"],
        &["animate", "s.json", "-o", "-", "--frames", "0-3"],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "0",
        ],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "nan",
        ],
        &[
            "animate", "s.json", "-o", "x.%d.png", "--frames", "0", "--fps", "-30",
        ],
        &["health", "--url", "https://localhost:8080"],
        &["health", "--timeout-s", "0"],
        &["selfcheck", "--adapter", "quantum"],
        &["serve", "--listen", "nowhere"],
    ];
    for words in table {
        let error = parsed(words).map(|_| ()).expect_err(&format!("{words:?}"));
        assert_eq!(error.exit_code(), 2, "{words:?}");
    }
}

#[test]
fn frames_lie_one_period_apart() {
    assert_eq!(animate::time_of(2.0, 0, 30.0), 2.0);
    assert_eq!(animate::time_of(2.0, 45, 30.0), 3.5);
    assert_eq!(animate::time_of(-1.0, 1, 0.5), 1.0);
    assert_eq!(animate::time_of(2.0, -45, 30.0), 0.5);
}

#[test]
fn service_urls_are_plain_http() {
    let table = [
        ("http://127.0.0.1:8080", "127.0.0.1:8080", ""),
        ("http://caustica", "caustica:80", ""),
        ("http://[::1]:8080/", "[::1]:8080", ""),
        ("http://[::1]", "[::1]:80", ""),
        ("http://host:81/a/b/", "host:81", "/a/b"),
    ];
    for (text, authority, prefix) in table {
        let url: ServiceUrl = text.parse().unwrap();
        assert_eq!(
            (url.authority.as_str(), url.prefix.as_str()),
            (authority, prefix),
            "{text}"
        );
    }
    for text in [
        "",
        "localhost",
        "https://x",
        "http://",
        "http://:80",
        "http://x:port",
        "http://x:99999",
        "http://u@x",
        "http://x/?q",
        "http://x/a b",
        "http://x/\r\nHost: y",
    ] {
        assert!(text.parse::<ServiceUrl>().is_err(), "{text}");
    }
}

#[test]
fn a_selfcheck_that_checks_nothing_has_not_passed() {
    let item = |passed| SelfCheckItem {
        name: "fresnel".to_owned(),
        error: 1e-7,
        tolerance: 1e-6,
        passed,
    };
    let check = |passed, checks| SelfCheck { passed, checks };
    assert!(selfcheck::verdict(&check(true, vec![item(true)])).is_ok());
    for bad in [
        check(true, vec![]),
        check(false, vec![item(true)]),
        check(true, vec![item(true), item(false)]),
    ] {
        assert_eq!(selfcheck::verdict(&bad).unwrap_err().exit_code(), 1);
    }
    let text = selfcheck::in_words(&check(false, vec![item(true), item(false)]));
    assert_eq!(
        text,
        "ok      fresnel  error 1.0e-7 of 1.0e-6\nFAILED  fresnel  error 1.0e-7 of 1.0e-6\n"
    );
}

#[test]
fn a_plan_reads_well() {
    let mut plan = Plan {
        passes: vec![PlannedPass {
            name: "surface".to_owned(),
            reason: "beams read it".to_owned(),
            runs: 2,
        }],
        absent: vec![AbsentPass {
            name: "level_map".to_owned(),
            reason: "no objects".to_owned(),
        }],
        slots: vec![PlannedSlot {
            shares: None,
            name: "water".to_owned(),
            bytes: 3 << 20,
            holds: "height, m".to_owned(),
        }],
        peak_bytes: 1536,
        chosen: None,
        method_choice: None,
        warnings: Vec::new(),
    };
    assert_eq!(
        plan::in_words(&plan),
        "Passes\n  surface  2 ×  beams read it\n\n\
         Not needed\n  level_map  no objects\n\n\
         Memory\n  water  3.0 MiB  height, m\n\n\
         Peak: 1.5 KiB\n"
    );
    plan.chosen = Some(ChosenDials {
        water_cells: 113,
        map_texels: 169,
        level_map_texels: 128,
        split_levels: 2,
        predicted_error: 0.0198,
        predicted_ms: 9.2,
        meets: true,
        reason: "2 trial renders".to_owned(),
    });
    let chosen = "Chosen dials\n  water_cells       113\n  map_texels        169\n  level_map_texels  128\n  \
                  split_levels      2\n  predicted         error 1.98 %, 9 ms\n  reason            2 trial renders\n\nPasses\n";
    let text = plan::in_words(&plan);
    assert!(text.starts_with(chosen), "{text}");
    let text = plan.to_string();
    let chosen = "chosen dials\n  water_cells: 113\n";
    assert!(
        text.starts_with(chosen) && text.contains("1.98e-2 and 9 ms predicted: 2 trial renders"),
        "{text}"
    );
    plan.method_choice = Some(MethodAdvice {
        method: "quick".to_owned(),
        dials: [("grains".to_owned(), json!(64))].into(),
        reason: "it was faster".to_owned(),
        expected_error: 0.02,
        expected_ms: 4.0,
        source: "measurements".to_owned(),
        others: vec![OtherMethod {
            method: "slow".to_owned(),
            reason: "it was not".to_owned(),
        }],
    });
    let advice = "Method for this error\n  quick     it was faster\n  dials     grains 64\n  \
                  expected  error 2.00 %, 4 ms, from measurements\n  not slow  it was not\n\nPasses\n";
    let text = plan::in_words(&plan);
    assert!(text.contains(advice), "{text}");
    let text = plan.to_string();
    assert!(text.contains("  not slow: it was not\n"), "{text}");
}

#[test]
fn columns_are_aligned_and_cells_of_any_length_are_printed() {
    let row = |cells: &[&str]| -> Vec<String> { cells.iter().map(|&cell| cell.into()).collect() };
    let rows = [row(&["a", "bb", "c"]), row(&["aaa", "b"]), row(&[])];
    assert_eq!(summary::columns(&rows, " "), " a    bb  c\n aaa  b\n\n");
    // The formatter of the standard library panics at widths above 65 535.
    let long = "x".repeat(70_000);
    let rows = [row(&[long.as_str(), long.as_str()]), row(&["a", "b"])];
    let text = summary::columns(&rows, "");
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0] == format!("{long}  {long}"), "both whole");
    assert_eq!(lines[1].len(), 200 + 3);
}

#[test]
fn errors_have_three_digits_that_count() {
    let table = [
        (0.5, "50.0 %"),
        (0.0198, "1.98 %"),
        (0.0035, "0.350 %"),
        (0.00012, "0.0120 %"),
        (0.0, "0.0000 %"),
    ];
    for (share, text) in table {
        assert_eq!(summary::percent(share), text);
    }
}

#[test]
fn sizes_have_the_unit_that_suits_them() {
    let table = [
        (0, "0 B"),
        (1023, "1023 B"),
        (1024, "1.0 KiB"),
        (5 << 30, "5.0 GiB"),
    ];
    for (count, text) in table {
        assert_eq!(summary::bytes(count), text);
    }
}
