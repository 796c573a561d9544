//! The study of sunlight under the sea, without an adapter: figures of made-up light whose figures are known, flags, and the files.

use std::f64::consts::{PI, SQRT_2, TAU};

use caustica::cli::args::{Cli, Command};
use caustica::cli::experiment::Which;
use caustica::cli::experiment::sea::numbers;
use caustica::lab::experiment::sea::{
    Check, Checks, Disc, Estimate, FlashFigures, Flashes, Fluctuation, Grid, Place, PlaceResult,
    SeaStudy, Settings, SlopeResult, flashes, fluctuation, plots, scene, texel_m, to_csv,
    to_markdown,
};
use caustica::scene::{Output, Wave};
use clap::Parser as _;

fn grid(width: usize, height: usize, value: impl Fn(usize, usize) -> f64) -> Grid {
    let places = (0..height).flat_map(|z| (0..width).map(move |x| (x, z)));
    Grid {
        width,
        height,
        values: places.map(|(x, z)| value(x, z)).collect(),
    }
}

#[test]
fn a_sine_has_the_variation_of_a_sine() {
    let sine = |mean: f64, phase: f64| {
        grid(64, 3, move |x, z| {
            mean + 0.4 * (TAU * (x as f64 / 16.0 + phase) + z as f64).sin()
        })
    };
    let found = fluctuation(&[sine(1.0, 0.0), sine(1.0, 0.3), sine(1.0, 0.1)]).unwrap();
    assert!((found.mean.value - 1.0).abs() < 1e-12);
    assert!((found.cv.value - 0.4 / SQRT_2).abs() < 1e-12, "{found:?}");
    // Maps of the same mean and variance: nothing is left to chance.
    assert!(found.mean.error.unwrap() < 1e-12 && found.cv.error.unwrap() < 1e-12);
    assert!((found.highest - 1.4).abs() < 0.01 && found.peak.value <= found.highest);
    // Means that differ count as variation, and as an error of the mean: 0.9, 1.1.
    let found = fluctuation(&[sine(0.9, 0.0), sine(1.1, 0.0)]).unwrap();
    assert!((found.cv.value - (0.08_f64 + 0.01).sqrt()).abs() < 1e-12);
    assert!((found.mean.error.unwrap() - 0.1).abs() < 1e-12, "{found:?}");
    assert_eq!(fluctuation(&[sine(1.0, 0.0)]).unwrap().cv.error, None);
    assert_eq!(fluctuation(&[]), None);
    assert_eq!(fluctuation(&[grid(3, 3, |_, _| 0.0)]), None, "no light");
}

#[test]
fn the_peak_is_what_one_in_a_thousand_exceeds() {
    let ramp = grid(100, 100, |x, z| (100 * z + x) as f64);
    let found = fluctuation(&[ramp]).unwrap();
    let mean = 9999.0 / 2.0;
    assert!((found.peak.value - 9990.0 / mean).abs() < 1e-12);
    assert!((found.highest - 9999.0 / mean).abs() < 1e-12);
}

#[test]
fn four_texels_make_a_detector() {
    let fine = grid(5, 4, |x, z| (10 * z + x) as f64);
    let halved = fine.halved();
    assert_eq!((halved.width, halved.height), (2, 2));
    assert_eq!(halved.values, [5.5, 7.5, 25.5, 27.5]);
}

/// Detectors under 1 + a sin: each period has one upward crossing, and is above for acos((threshold − 1) / a) / π of it.
#[test]
fn flashes_of_a_sine_are_its_periods() {
    let (a, period_s, step_s): (f64, f64, f64) = (0.8, 0.05, 1e-4);
    let mut seas = Vec::new();
    for sea in 0..3 {
        let mut counted = Flashes::over(1.5);
        for step in 0..=5000 {
            let value = |phase: f64| {
                let turns = f64::from(step) * step_s / period_s + phase;
                1.0 + a * (TAU * turns).sin()
            };
            let phase = 0.211 * f64::from(sea);
            counted.push(&[value(phase), value(phase + 0.37), value(phase + 0.703)]);
        }
        seas.push(counted);
    }
    let found = flashes(&seas, step_s).unwrap();
    assert_eq!(found.counted, 3 * 3 * 10);
    assert!((found.per_minute.value - 60.0 / period_s).abs() < 1e-9);
    let length_ms = 1e3 * period_s * (0.5_f64 / a).acos() / PI;
    let seen = found.length_ms.unwrap();
    // A sample is a step long.
    assert!((seen.value - length_ms).abs() < 0.1, "{seen:?} {length_ms}");
    assert!(found.per_minute.error.unwrap() < 1e-9);
}

#[test]
fn flashes_need_a_crossing() {
    let of = |values: &[f64]| {
        let mut counted = Flashes::over(1.5);
        for value in values {
            counted.push(&[*value]);
        }
        counted
    };
    // From the start above: no crossing, but its time counts. On the threshold is not above.
    let counted = of(&[2.0, 2.0, 1.0, 1.5, 1.6, 1.5, 3.0]);
    assert_eq!((counted.upward, counted.above), (2, 4));
    assert_eq!((counted.steps, counted.samples), (6, 7));
    let dark = flashes(&[of(&[1.0, 1.0]), of(&[0.0, 1.0])], 1e-3).unwrap();
    assert_eq!((dark.per_minute.value, dark.length_ms), (0.0, None));
    assert_eq!(flashes(&[of(&[2.0])], 1e-3), None, "one frame has no steps");
    // Two seas, of which one flashes once in a second.
    let slow = of(&[1.0; 1001]);
    let mut fast = vec![1.0; 1001];
    fast[500] = 2.0;
    let two = flashes(&[slow, of(&fast)], 1e-3).unwrap();
    assert!((two.per_minute.value - 30.0).abs() < 1e-9);
    assert!((two.per_minute.error.unwrap() - 30.0).abs() < 1e-9);
    assert_eq!(two.length_ms.unwrap().error, None, "one sea has no flash");
}

#[test]
fn the_disc_keeps_light_and_blurs_as_wide_as_it_is() {
    let disc = Disc::ellipse([2.3, 1.2]);
    assert_eq!(disc.reach(), 2);
    let even = disc.blurred(&grid(9, 7, |_, _| 3.0));
    assert_eq!((even.width, even.height), (5, 3));
    assert!(even.values.iter().all(|v| (v - 3.0).abs() < 1e-12));
    // A point becomes the disc: its light is kept, and its second moments are a quarter of the squared half axes (and texels').
    let point = grid(13, 13, |x, z| if (x, z) == (6, 6) { 1.0 } else { 0.0 });
    let image = disc.blurred(&point);
    let moment = |power: [i32; 2]| -> f64 {
        let each = image.values.iter().enumerate().map(|(at, v)| {
            let [x, z] = [at % image.width, at / image.width].map(|c| c as f64 - 4.0);
            v * x.powi(power[0]) * z.powi(power[1])
        });
        each.sum()
    };
    assert!((moment([0, 0]) - 1.0).abs() < 1e-12);
    assert!(moment([1, 0]).abs() < 1e-12 && moment([0, 1]).abs() < 1e-12);
    for (found, half) in [(moment([2, 0]), 2.3_f64), (moment([0, 2]), 1.2)] {
        let expected = half * half / 4.0 + 1.0 / 12.0;
        assert!(
            (found - expected).abs() < 0.1 * expected,
            "{found} {expected}"
        );
    }
    // Small ones are a point.
    let small = Disc::ellipse([0.3, 0.001]);
    assert_eq!(small.reach(), 0);
    assert_eq!(small.blurred(&point), point);
}

/// The image of the sun's disc, by Snell's law for its edges.
#[test]
fn the_suns_image_is_that_of_refracted_rays() {
    let depth_m = 10.0;
    let radius = 16.0 / 60.0 * PI / 180.0;
    let landed = |zenith: f64| depth_m * (zenith.sin() / 1.34).asin().tan();
    let zenith = 20_f64.to_radians();
    let along = 0.5 * (landed(zenith + radius) - landed(zenith - radius));
    let across = landed(zenith) * radius / zenith.sin();
    let [x, z] = Disc::half_axes_m(depth_m);
    assert!((x - along).abs() < 1e-4 * along, "{x} {along}");
    assert!((z - across).abs() < 1e-4 * across, "{z} {across}");
    // Three to four detectors wide, or less than one.
    assert_eq!(texel_m(0.5), 0.005);
    assert_eq!(texel_m(10.0), 0.02);
    assert_eq!(Disc::of_sun(10.0, texel_m(10.0)).reach(), 2);
    assert_eq!(Disc::of_sun(0.5, texel_m(0.5)).reach(), 0);
}

#[test]
fn lists_are_read_and_sorted() {
    let read = |text: &str| numbers("--depths", text, [0.1, 100.0]);
    assert_eq!(read("5, 0.5,25").unwrap(), [0.5, 5.0, 25.0]);
    for text in ["", "0", "1,1", "1,,2", "1;2", "a", "NaN", "101"] {
        let error = read(text).unwrap_err().to_string();
        assert!(
            error.contains("--depths") && error.contains("0.1 … 100"),
            "{error}"
        );
    }
}

#[test]
fn flags_have_the_defaults_of_the_settings() {
    let settings = |more: &[&str]| {
        let all = ["caustica", "experiment", "sea", "-o", "x"];
        let cli = Cli::try_parse_from(all.iter().chain(more)).map_err(|e| e.to_string())?;
        let Command::Experiment(args) = cli.command else {
            panic!("another command");
        };
        let Which::Sea(args) = args.which else {
            panic!("another experiment");
        };
        args.settings().map_err(|e| e.to_string())
    };
    assert_eq!(settings(&[]).unwrap(), Settings::default());
    let found = settings(&[
        "--depths",
        "3",
        "--winds",
        "9,4",
        "--moments",
        "2",
        "--seconds",
        "1",
        "--texels",
        "16",
        "--water-cells",
        "64",
    ]);
    let expected = Settings {
        depths_m: vec![3.0],
        winds_m_s: vec![4.0, 9.0],
        moments: 2,
        seconds: 1.0,
        texels: 16,
        water_cells: 64,
    };
    assert_eq!(found.unwrap(), expected);
    for (wrong, accepted) in [
        (["--moments", "1"], "2..=10000"),
        (["--seconds", "0"], "0.008 … 3600"),
        (["--texels", "8"], "16..=1024"),
        (["--water-cells", "4096"], "64..=2048"),
        (["--winds", "0"], "1 … 20"),
    ] {
        let error = settings(&wrong).unwrap_err();
        assert!(error.contains(accepted), "{error}");
    }
}

#[test]
fn a_scene_is_two_spectra_over_a_floor_as_large_as_its_map() {
    let place = Place {
        wind_m_s: 7.0,
        depth_m: 5.0,
    };
    let resolved = scene(place, 64, 128, 3, 1.5).unwrap();
    let [Wave::Spectrum(long), Wave::Spectrum(short)] = &resolved.scene.water.waves[..] else {
        panic!("{:?}", resolved.scene.water.waves);
    };
    // No wave is in both, and the short ones do not repeat with the long ones.
    assert_eq!(long.band_m()[0], short.band_m()[1]);
    assert!((long.tile_m / short.tile_m).fract() > 0.1);
    assert_ne!(long.seed, short.seed);
    // Samples enough for the shortest waves.
    for waves in [long, short] {
        let samples = waves.band_m()[0] / waves.tile_m * f64::from(waves.samples);
        assert!(samples > 8.0, "{samples}");
    }
    let floor = resolved.scene.floor.unwrap();
    assert_eq!((floor.depth_m, floor.size_m), (5.0, [0.64, 0.64]));
    assert!(matches!(resolved.scene.output, Output::IrradianceMap(map) if map.width == Some(64)));
    assert_eq!(resolved.scene.time_s, 1.5);
}

/// Two winds, three depths: variation falls with depth, flashes with wind.
fn found() -> SeaStudy {
    let estimate = |value: f64| Estimate {
        value,
        error: Some(0.1 * value),
    };
    let place = |wind_m_s: f64, depth_m: f64| {
        let light = |scale: f64| Fluctuation {
            mean: estimate(0.99),
            cv: estimate(scale * 0.8 / depth_m.sqrt()),
            peak: estimate(scale * 6.0 / depth_m.sqrt() + 0.1 * wind_m_s),
            highest: scale * 12.0 / depth_m.sqrt(),
        };
        PlaceResult {
            place: Place { wind_m_s, depth_m },
            texel_mm: 1e3 * texel_m(depth_m),
            sun: light(1.0),
            point_sun: light(1.5),
            flashes: (depth_m < 20.0).then(|| FlashFigures {
                per_minute: estimate(1000.0 / wind_m_s / depth_m),
                length_ms: (wind_m_s < 9.0 || depth_m < 2.0).then(|| estimate(9.0 * depth_m)),
                counted: 40,
            }),
            water_cells: 300,
            undersampled: depth_m > 20.0,
        }
    };
    let check = |what: &str, cv: f64| Check {
        what: what.to_owned(),
        cv: Some(Estimate {
            value: cv,
            error: Some(0.02),
        }),
        ..Check::default()
    };
    SeaStudy {
        moments: 8,
        seconds: 0.24,
        series: 4,
        step_s: 0.002,
        texels: 128,
        series_texels: 48,
        water_cells: 512,
        slopes: [2.0, 10.0]
            .map(|wind_m_s| SlopeResult {
                wind_m_s,
                mean_square: 0.002 * wind_m_s,
            })
            .to_vec(),
        places: [2.0, 10.0]
            .into_iter()
            .flat_map(|wind| [1.0, 4.0, 25.0].map(|depth| place(wind, depth)))
            .collect(),
        checks: vec![Checks {
            place: Place {
                wind_m_s: 2.0,
                depth_m: 4.0,
            },
            rows: vec![
                check("as in the tables", 0.4),
                check("twice the water cells", 0.41),
                check("texels of half the side", 0.396),
                check("detectors of half the side", 0.7),
            ],
        }],
        closure: 2e-7,
        ..SeaStudy::default()
    }
}

#[test]
fn the_page_has_our_figures_beside_those_of_others() {
    let page = to_markdown(&found(), "sea/");
    for text in [
        // A row for each depth, a column for each wind.
        "| depth | detector | 2 m/s | 10 m/s |\n|---:|---:|---:|---:|\n| 1 m | 5 mm | 0.8 ± 0.08 | 0.8 ± 0.08 |",
        "| 25 m | 50 mm | 0.16 ± 0.016 * | 0.16 ± 0.016 * |",
        "| 1 m | 5 mm | 1.2 ± 0.12 |",
        "| 1 m | 5 mm | 6.2 ± 0.62 (12) | 7 ± 0.7 (12) |",
        "| 1 m | 5 mm | 500 ± 50 | 100 ± 10 |",
        "| 4 m | 8 mm | 36 ± 3.6 | none |",
        "| 25 m | 50 mm |  |  |",
        "Other settings at 4 m under 2 m/s",
        "](sea/cv.svg)",
        "](sea/peaks.svg)",
        "](sea/flashes.svg)",
        "Stramski & Legendre",
        "Hieronymi",
        "is 5 times that at 25 m; measured: 4. About the same.",
        "At 1 m the highest of all values is 12 times the mean (18 for a point sun)",
        "highest under 10 m/s there",
        "2 … 7 m/s: others have it otherwise",
        "25 … 500 a minute, 9 … 36 ms long; published: 230, 5 … 20 ms. The published number lies in this range; ours last longer",
        "| 10 m/s | 0.02 | 0.0542 ± 0.004 |",
        "change the coefficient of variation by 0.5 standard errors at most",
    ] {
        assert!(page.contains(text), "no `{text}` in\n{page}");
    }
    // Coarse settings are said to be so.
    let mut coarse = found();
    coarse.checks[0].rows[1].cv.as_mut().unwrap().value = 0.5;
    let page = to_markdown(&coarse, "");
    assert!(page.contains("by 5 standard errors: the settings of this run are too coarse for"));
    // Without the depths that are compared, nothing is said about them.
    coarse.places.retain(|place| place.place.depth_m == 4.0);
    let page = to_markdown(&coarse, "");
    assert!(!page.contains("**Variation.**") && !page.contains("**Peaks.**"));
}

#[test]
fn the_table_has_a_row_for_each_place_and_the_plots_a_line_for_each_wind() {
    let text = to_csv(&found());
    let mut lines = text.lines();
    let columns = lines.next().unwrap().split(',').count();
    let rows: Vec<&str> = lines.collect();
    assert_eq!(rows.len(), 6);
    for row in &rows {
        assert_eq!(row.split(',').count(), columns, "{row}");
    }
    assert!(
        rows[0].starts_with("2,1,5,0.99,0.099,0.8,0.08"),
        "{}",
        rows[0]
    );
    assert!(rows[1].ends_with(",36,3.6,40,300,false"), "{}", rows[1]);
    assert!(rows[2].ends_with(",,,,,300,true"), "{}", rows[2]);
    let mut deep = found();
    deep.places.retain(|place| place.place.depth_m > 20.0);
    assert_eq!(plots(&deep).unwrap().len(), 2, "without flashes");
    assert!(!to_markdown(&deep, "").contains("## Flashes"));
    let plots = plots(&found()).unwrap();
    let names: Vec<&str> = plots.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["cv", "peaks", "flashes"]);
    for (_, plot) in &plots {
        assert!(plot.svg.contains("10 m/s") && plot.svg.contains("depth (m)"));
        assert!(plot.png.starts_with(b"\x89PNG"));
    }
}
