//! The page of methods itself.

use std::fmt::Write as _;

use caustica::lab::study::equal_time::{Standing, best, limit_ms, standings};
use caustica::lab::study::order::fit_order;
use caustica::lab::study::report::{method_conclusions, method_table};
use caustica::lab::study::words::{ms, percent, significant, thousands};
use caustica::methods::{self, Method};

use crate::methods::Chapter;

/// All of `docs/methods.md`; `papers` is the section on published figures.
pub(crate) fn write(chapters: &[Chapter], papers: &str) -> String {
    let mut page = head(chapters);
    page += &in_equal_time(chapters);
    page += &not_best(chapters);
    page += "\n## The methods\n";
    for method in methods::ALL {
        page += &about(method, chapters);
    }
    page += "\n## The scenes\n";
    for chapter in chapters {
        page += &scene(chapter);
    }
    page + papers
}

fn head(chapters: &[Chapter]) -> String {
    let machine = chapters.first().map_or_else(String::new, |chapter| {
        let adapter = &chapter.study.adapter;
        format!(
            "{} ({}), {}, {} CPU cores",
            adapter.name,
            adapter.driver,
            match adapter.software {
                true => "a CPU driver",
                false => "a GPU",
            },
            chapter.study.cores
        )
    });
    format!(
        "# Methods side by side\n\n\
         Written by `make docs` from the program's own measurements, in one run on\n{machine}.\n\n\
         Every method renders every scene at several settings. From one setting to the next all its numbers that trade accuracy for\n\
         time grow together, by factors of two: `water_cells` from 64 to 512, a method's own dials in proportion. A method with several\n\
         numbers of its own has a second ladder, on which the first is four times as large. Each word of a dial is a series of its own. All results are\n\
         compared with the same float64 truth: relative L1 error, FLIP (what people see, 0 … 1), and the energy balance (light in\n\
         excess or missing in total). Times are medians of warm\n\
         frames, each of a new moment, so that no method profits from light that it keeps. [The glossary](glossary.md) explains the terms.\n\n\
         `caustica compare SCENE -o FOLDER` makes such a comparison of any scene.\n"
    )
}

/// The standings of a chapter, in the time of its middle setting.
fn ranked(chapter: &Chapter) -> Vec<Standing<'_>> {
    limit_ms(&chapter.study).map_or_else(Vec::new, |limit| standings(&chapter.study, limit))
}

fn in_equal_time(chapters: &[Chapter]) -> String {
    let mut text = format!(
        "\n## In the same time\n\n\
         The error of each method in the time that `{}` takes with 256 water cells, interpolated between its settings. The smallest of each\n\
         scene is bold; *slower* takes longer at every setting; *the same* does what the first method does, pass by pass and bit by bit; a\n\
         dash means that the method cannot do the scene.\n\n| scene | time (ms) |",
        methods::ALL[0].name
    );
    for method in methods::ALL {
        let _ = write!(text, " `{}` |", method.name);
    }
    text += "\n| --- | ---: |";
    text += &" ---: |".repeat(methods::ALL.len());
    text.push('\n');
    for chapter in chapters {
        let ranked = ranked(chapter);
        let winner = best(&ranked).map(Standing::method);
        let limit = limit_ms(&chapter.study).map_or_else(String::new, ms);
        let _ = write!(text, "| [{0}](#{0}) | {limit} |", chapter.scene.name);
        for method in methods::ALL {
            let found = ranked.iter().find(|s| s.method() == method.name);
            if found.is_some_and(|standing| standing.twin) {
                let _ = write!(text, " *the same* |");
                continue;
            }
            let cell = match found.map(|standing| standing.error_in_time) {
                Some(Some(error)) if winner == Some(method.name) => {
                    format!("**{}**", percent(error))
                }
                Some(Some(error)) => percent(error),
                Some(None) => "*slower*".to_owned(),
                None => "–".to_owned(),
            };
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
    text
}

/// Where the default method is not the best, and why.
fn not_best(chapters: &[Chapter]) -> String {
    let mut text = String::new();
    for chapter in chapters {
        if let Some(why) = caustica::lab::study::report::why_not_first(&chapter.study) {
            let _ = writeln!(text, "- **{}**: {}", chapter.scene.name, code(&why));
        }
    }
    let default = methods::ALL[0].name;
    match text.is_empty() {
        true => format!(
            "\n`{default}` is the nearest to the truth on every scene, or as near as the nearest.\n"
        ),
        false => format!("\nWhere `{default}` is not the nearest:\n\n{text}"),
    }
}

/// Underscores are no emphasis.
fn code(text: &str) -> String {
    text.replace('_', "\\_")
}

fn about(method: &'static Method, chapters: &[Chapter]) -> String {
    let mut text = format!("\n### {}\n\n", method.name);
    let _ = writeln!(text, "- does: {}", code(method.summary));
    let _ = writeln!(text, "- source: {}", method.paper);
    let _ = writeln!(text, "- best at: {}", best_at(method, chapters));
    let _ = writeln!(text, "- error: {}", orders(method, chapters));
    let _ = writeln!(text, "- cannot: {}", cannot(method, chapters));
    text
}

/// The scenes on which it is the nearest in the same time, or how near it comes.
fn best_at(method: &Method, chapters: &[Chapter]) -> String {
    let mut wins = Vec::new();
    let mut same = Vec::new();
    let mut closest: Option<(f64, &str)> = None;
    for chapter in chapters {
        let ranked = ranked(chapter);
        let Some(least) = best(&ranked) else {
            continue;
        };
        if least.method() == method.name {
            wins.push(chapter.scene.name);
            continue;
        }
        let own = ranked.iter().find(|s| s.method() == method.name);
        if own.is_some_and(|own| own.twin) {
            same.push(chapter.scene.name);
            continue;
        }
        let errors = own.and_then(|s| s.error_in_time).zip(least.error_in_time);
        if let Some(factor) = errors.map(|(own, least)| own / least)
            && factor.is_finite()
            && closest.is_none_or(|(before, _)| factor < before)
        {
            closest = Some((factor, chapter.scene.name));
        }
    }
    let same = match same.is_empty() {
        true => String::new(),
        false => format!(
            "; it does the same as `{}` on {}",
            methods::ALL[0].name,
            code(&same.join(", "))
        ),
    };
    if !wins.is_empty() {
        let wins = code(&wins.join(", "));
        return format!("the nearest in the same time on {wins}{same}");
    }
    let best = match closest {
        Some((factor, scene)) => format!(
            "on no scene the nearest in the same time; on {} it comes closest, with {} times the least error",
            code(scene),
            significant(factor, 2)
        ),
        None => "on no scene the nearest in the same time".to_owned(),
    };
    best + &same
}

/// The fitted order on each scene, of the series with the least error.
fn orders(method: &Method, chapters: &[Chapter]) -> String {
    let mut fitted = Vec::new();
    for chapter in chapters {
        let own = chapter.study.sweeps.iter().filter(|sweep| {
            sweep
                .series
                .as_ref()
                .is_some_and(|of| of.method == method.name)
        });
        let least = own.min_by(|a, b| {
            let least = |sweep: &&caustica::lab::study::study::Sweep| {
                let errors = sweep.points.iter().map(|p| p.error.relative_l1);
                errors.fold(f64::INFINITY, f64::min)
            };
            least(a).total_cmp(&least(b))
        });
        let truth = chapter.study.truth.relative_error;
        if let Some(fit) = least.and_then(|sweep| fit_order(sweep, truth)) {
            let order = significant(fit.order, 2);
            fitted.push(format!("{order} on {}", code(chapter.scene.name)));
        }
    }
    let expected = match method.expected_order {
        0.0 => "does not go to 0 with its numbers".to_owned(),
        order => format!("falls with the power {order} of its numbers where light does not fold"),
    };
    match fitted.is_empty() {
        true => expected,
        false => format!("{expected}; fitted orders: {}", fitted.join(", ")),
    }
}

fn cannot(method: &'static Method, chapters: &[Chapter]) -> String {
    let facts = method.facts_of_default();
    let mut lacks = Vec::new();
    if facts.leaves_out.shadows {
        lacks.push("shadows of objects".to_owned());
    }
    if facts.leaves_out.shadows_on_objects {
        lacks.push("shadows of objects on each other".to_owned());
    }
    if facts.leaves_out.further_layers {
        lacks.push("light on further layers of objects".to_owned());
    }
    if !facts.keeps_account {
        lacks.push("an energy account".to_owned());
    } else if !facts.conserves_energy {
        lacks.push("conservation of energy".to_owned());
    }
    if !method.dials_can_be_chosen {
        lacks.push("`target_error` and `time_budget_ms`".to_owned());
    }
    let mut reasons: Vec<String> = Vec::new();
    for chapter in chapters {
        for left in &chapter.study.left_out {
            if left.method == method.name && !reasons.contains(&left.reason) {
                reasons.push(left.reason.clone());
            }
        }
    }
    lacks.extend(
        reasons
            .iter()
            .map(|reason| format!("scenes where {}", code(reason))),
    );
    match lacks.is_empty() {
        true => "nothing that the other methods can".to_owned(),
        false => lacks.join("; "),
    }
}

fn scene(chapter: &Chapter) -> String {
    let (scene, study) = (chapter.scene, &chapter.study);
    let mut text = format!("\n### {}\n\n{}\n\n", scene.name, scene.about);
    let truth = &study.truth;
    let _ = writeln!(
        text,
        "Compared: {}. Truth: {} rays, its own error {}.\n",
        truth.what,
        thousands(truth.rays),
        percent(truth.relative_error)
    );
    for sentence in method_conclusions(study) {
        let _ = writeln!(text, "- {}", code(&sentence));
    }
    let _ = writeln!(
        text,
        "\n![Error against time of every method](methods/{0}/error_time.svg)\n\n\
         ![Each method in about the same time, and its errors](methods/{0}/methods.png)\n\n\
         <details><summary>All settings</summary>\n\n{1}\n</details>\n\n[All figures](methods/{0}/study.csv)",
        scene.name,
        method_table(study)
    );
    let warnings: Vec<String> = study
        .warnings
        .iter()
        .map(|warning| format!("- {}\n", code(&warning.message)))
        .collect();
    if !warnings.is_empty() {
        let _ = write!(text, "\n{}", warnings.concat());
    }
    text
}
