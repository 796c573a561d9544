//! Plots: their contents in both formats, and the refusal of what cannot be drawn.

use caustica::lab::study::fit_orders;
use caustica::lab::study::plot::{Plot, PlotError, convergence, error_against_time};
use caustica::lab::study::study::{Study, Sweep};
use serde_json::json;

use crate::synthetic_study::{point, study};

/// Width and height of a PNG file, once it decodes; it must not be blank.
fn checked_png(bytes: &[u8]) -> (u32, u32) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let dark = pixels.chunks_exact(3).filter(|p| p[1] < 128).count();
    assert!(dark > 2000, "only {dark} dark pixels");
    (info.width, info.height)
}

fn check(plot: &Plot) {
    assert_eq!(checked_png(&plot.png), (1920, 1200));
    let svg = &plot.svg;
    assert!(svg.starts_with("<svg width=\"960\" height=\"600\" viewBox=\"0 0 3840 2400\""));
    assert!(svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
}

/// Whether a text element holds exactly this.
fn says(plot: &Plot, text: &str) -> bool {
    plot.svg
        .split("<text")
        .skip(1)
        .filter_map(|rest| rest.split_once(">\n"))
        .any(|(_, rest)| rest.split("\n</text>").next() == Some(text))
}

fn alone(sweep: Sweep, truth_error: f64) -> Study {
    let mut study = Study {
        sweeps: vec![sweep],
        ..study()
    };
    study.truth.relative_error = truth_error;
    study
}

fn sweep(dial: &str, settings: &[(serde_json::Value, f64, f64)]) -> Sweep {
    let points = settings.iter().map(|(value, error, ms)| {
        let mut point = point(dial, value.clone(), *error, *ms);
        point.error.relative_l1 = *error;
        point
    });
    Sweep {
        dial: dial.to_owned(),
        points: points.collect(),
        ..Sweep::default()
    }
}

#[test]
fn error_against_time_says_what_it_shows() {
    let plot = error_against_time(&study()).unwrap();
    check(&plot);
    for text in [
        "Error against time",
        "relative L1 error (%)",
        "0.1 %",
        "1 %",
        "10 %",
        "2 ms",
        "10 ms",
        "100 ms",
        "the truth's own error, 0.06 %"
            .replace('\'', "&apos;")
            .as_str(),
        "beams",
        "steps",
        "hits",
        "64",
        "2048",
        "exact",
    ] {
        assert!(says(&plot, text), "no text `{text}`");
    }
    assert!(
        plot.svg
            .contains("pool &lt;deep&gt; &amp; &quot;clear&quot;"),
        "the scene's name is escaped"
    );
}

#[test]
fn convergence_shows_the_order_it_was_made_with() {
    let plot = convergence(&study(), 0).unwrap();
    check(&plot);
    let order = study().sweeps[0].order.unwrap();
    assert!((order - 2.0).abs() < 0.03, "{order}");
    let text = format!("order {:.2}", order);
    assert!(plot.svg.contains(text.trim_end_matches('0')), "{text}");
    for text in ["order 1", "order 2", "64", "512", "beams (logarithmic)"] {
        assert!(says(&plot, text), "no text `{text}`");
    }
    assert!(plot.svg.contains("The fit leaves out"));
}

#[test]
fn halvings_show_their_factor_per_level() {
    let levels = [0, 1, 2, 4].map(|level| (json!(level), 0.08 * 2.5_f64.powi(-level), 3.0));
    let mut study = alone(sweep("split_levels", &levels), 1e-3);
    fit_orders(&mut study);
    let plot = convergence(&study, 0).unwrap();
    check(&plot);
    assert!(says(&plot, "fit: ÷ 2.5 per level"));
    assert!(!plot.svg.contains("order"));
}

#[test]
fn words_have_columns_and_no_order() {
    let plot = convergence(&study(), 2).unwrap();
    check(&plot);
    assert!(says(&plot, "grid") && says(&plot, "exact") && says(&plot, "hits"));
    assert!(!plot.svg.contains("order"));
}

#[test]
fn the_same_study_gives_the_same_bytes() {
    assert_eq!(
        error_against_time(&study()).unwrap(),
        error_against_time(&study()).unwrap()
    );
    assert_eq!(
        convergence(&study(), 1).unwrap(),
        convergence(&study(), 1).unwrap()
    );
    let mut slower = study();
    slower.sweeps[0].points[0].cost.wall_ms.median *= 1.5;
    assert_ne!(
        error_against_time(&slower).unwrap().svg,
        error_against_time(&study()).unwrap().svg
    );
}

#[test]
fn a_single_setting_can_be_drawn() {
    for value in [json!(64), json!("exact"), json!(0), json!(true)] {
        let study = alone(sweep("dial", &[(value, 0.02, 5.0)]), 0.0);
        check(&error_against_time(&study).unwrap());
        check(&convergence(&study, 0).unwrap());
    }
}

#[test]
fn an_error_of_zero_is_moved_and_reported() {
    let settings = [
        (json!(1), 0.02, 5.0),
        (json!(2), 0.0, 9.0),
        (json!(4), 0.0, 0.0),
    ];
    for (truth_error, of) in [
        (1e-3, "a tenth of the truth"),
        (0.0, "a tenth of the smallest"),
    ] {
        let study = alone(sweep("dial", &settings), truth_error);
        for plot in [
            error_against_time(&study).unwrap(),
            convergence(&study, 0).unwrap(),
        ] {
            check(&plot);
            let text: String = plot
                .svg
                .lines()
                .filter(|line| !line.starts_with('<'))
                .collect::<Vec<_>>()
                .join(" ");
            assert!(text.contains("error of 0"), "{text}");
            assert!(text.contains(of), "{of}: {text}");
        }
    }
    let exact = alone(sweep("dial", &[(json!(1), 0.0, 1.0)]), 0.0);
    check(&error_against_time(&exact).unwrap());
}

#[test]
fn figures_that_cannot_be_drawn_are_errors() {
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let mut studies = vec![study(), study(), study(), study()];
        studies[0].sweeps[0].points[1].error.relative_l1 = bad;
        studies[1].sweeps[0].points[1].cost.wall_ms.max = bad;
        studies[2].sweeps[0].points[1].error.estimated = Some(bad);
        studies[3].truth.relative_error = bad;
        for study in &studies {
            for error in [
                error_against_time(study).unwrap_err(),
                convergence(study, 0).unwrap_err(),
            ] {
                assert!(matches!(error, PlotError::Figure { .. }), "{error}");
            }
        }
        let text = error_against_time(&studies[0]).unwrap_err().to_string();
        assert!(text.contains("beams 128"), "{text}");
    }
}

#[test]
fn nothing_to_draw_is_an_error() {
    let empty = Study::default();
    assert!(matches!(
        error_against_time(&empty),
        Err(PlotError::Empty(_))
    ));
    assert_eq!(
        convergence(&empty, 0),
        Err(PlotError::NoSweep {
            index: 0,
            sweeps: 0
        })
    );
    let hollow = alone(sweep("dial", &[]), 0.0);
    assert!(matches!(convergence(&hollow, 0), Err(PlotError::Empty(_))));
}
