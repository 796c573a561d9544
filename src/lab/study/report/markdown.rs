//! The study as Markdown, for readers who do not know the program.

use super::conclusions::conclusions;
use super::csv::passes;
use super::glossary::GLOSSARY;
use super::methods::{method_conclusions, method_orders, method_table};
use super::tables::{escaped, figures, pass_times};
use crate::lab::study::study::{Study, Sweep};
use crate::lab::study::words::{percent, significant, thousands};

/// Paths of the pictures and the other files, relative to the Markdown file; absent ones are not linked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportLinks {
    /// Error against time.
    pub error_time: Option<String>,
    /// One per sweep; none in a comparison.
    pub sweeps: Vec<SweepLinks>,
    /// Contact sheet of a comparison.
    pub methods: Option<String>,
    /// The study as JSON.
    pub json: Option<String>,
    /// The study as CSV.
    pub csv: Option<String>,
}

/// Pictures of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SweepLinks {
    /// Error over the dial.
    pub convergence: Option<String>,
    /// Contact sheet.
    pub errors: Option<String>,
}

/// The whole report.
pub fn to_markdown(study: &Study, links: &ReportLinks) -> String {
    let mut text = heading(study);
    text += "\n## In short\n\n";
    if study.is_comparison() {
        for sentence in method_conclusions(study) {
            text += &format!("- {}\n", escaped(&sentence));
        }
    } else {
        text += &by_sweep(study);
    }
    if study.sweeps.is_empty() {
        text += "Nothing was measured.\n";
    }
    if let Some(link) = &links.error_time {
        text += "\n## Error against time\n\n";
        text += &picture("Error against time of all settings", link);
    }
    if study.is_comparison() {
        text += &comparison(study, links);
    } else {
        for (index, sweep) in study.sweeps.iter().enumerate() {
            let links = links.sweeps.get(index).cloned().unwrap_or_default();
            text += &section(sweep, &links);
        }
    }
    if !passes(study).is_empty() {
        text += "\n## Time of each pass\n\nMedian, ms.\n\n";
        text += &pass_times(study);
    }
    text += &warnings(study);
    text += "\n## Words\n\n";
    for (word, meaning) in GLOSSARY {
        text += &format!("- **{word}**: {meaning}.\n");
    }
    text += &files(links);
    text
}

/// The conclusions of each sweep.
fn by_sweep(study: &Study) -> String {
    let mut text = String::new();
    for sweep in &study.sweeps {
        text += &format!("- **{}**\n", escaped(&sweep.dial));
        for sentence in conclusions(study, sweep) {
            text += &format!("  - {}\n", escaped(&sentence));
        }
    }
    text
}

/// What a comparison of methods measured.
fn comparison(study: &Study, links: &ReportLinks) -> String {
    let mut text = format!("\n## Settings of each method\n\n{}", method_table(study));
    let orders = method_orders(study);
    if !orders.is_empty() {
        text += &format!(
            "\n## Orders of convergence\n\nThe error falls as the method's numbers to minus this power.\n\n{orders}"
        );
    }
    if let Some(link) = &links.methods {
        text += "\n## Pictures\n\n";
        text += &picture("Each method in about the same time, and its errors", link);
    }
    text
}

fn heading(study: &Study) -> String {
    let title = if study.scene.is_empty() {
        "a scene".to_owned()
    } else {
        escaped(&study.scene)
    };
    let settings: usize = study.sweeps.iter().map(|sweep| sweep.points.len()).sum();
    let mut text = format!("# Accuracy and cost: {title}\n\n");
    text += &format!(
        "Caustica rendered one scene at {settings} settings. Each result was compared with a far more exact one, the truth, and its cost was measured. So you can see what accuracy costs, and which setting is enough.\n\n"
    );
    let (adapter, truth) = (&study.adapter, &study.truth);
    let software = if adapter.software {
        ", a CPU instead of a GPU"
    } else {
        ""
    };
    let facts = [
        ("program", format!("Caustica {}", escaped(&study.version))),
        ("scene", format!("`{}`", study.scene_hash)),
        (
            "adapter",
            format!(
                "{} ({}, {}){software}",
                escaped(&adapter.name),
                escaped(&adapter.backend),
                escaped(&adapter.driver)
            ),
        ),
        ("CPU cores", study.cores.to_string()),
        (
            "compared",
            format!(
                "{} ({} × {} values)",
                escaped(&truth.what),
                truth.width,
                truth.height
            ),
        ),
        ("truth", truth_sentence(study)),
    ];
    for (name, fact) in facts {
        text += &format!("- {name}: {fact}\n");
    }
    if let Some(area) = truth.shadow_edge_area {
        text += &format!(
            "- shadow edges: {} of the compared values lie within two texels (for a view: pixels) of one\n",
            percent(area)
        );
    }
    text
}

fn truth_sentence(study: &Study) -> String {
    let truth = &study.truth;
    let kept = if truth.from_disk {
        ", kept from an earlier study"
    } else {
        ""
    };
    format!(
        "{} rays in double precision, {} s{kept}; its own error is **{}**",
        thousands(truth.rays),
        significant(truth.seconds, 3),
        percent(truth.relative_error)
    )
}

fn section(sweep: &Sweep, links: &SweepLinks) -> String {
    let dial = escaped(&sweep.dial);
    let mut text = format!("\n## {dial}\n\n");
    if sweep.points.is_empty() {
        return text + "No setting was measured.\n";
    }
    text += &figures(sweep);
    if let Some(order) = sweep.order {
        text += &format!("\nOrder of convergence: {}.\n", significant(order, 3));
    }
    if let Some(factor) = sweep.factor_per_level {
        text += &format!(
            "\nThe error falls by a factor of {} per level.\n",
            significant(factor, 3)
        );
    }
    let pictures = [
        ("Error over the dial", &links.convergence),
        ("Error images of each setting", &links.errors),
    ];
    for (what, link) in pictures {
        if let Some(link) = link {
            text += &format!("\n{}", picture(&format!("{what}: {dial}"), link));
        }
    }
    text + &point_warnings(sweep)
}

/// The warnings of the renders, each once, with the number of affected settings.
fn point_warnings(sweep: &Sweep) -> String {
    let mut found: Vec<(&str, usize)> = Vec::new();
    for warning in sweep.points.iter().flat_map(|point| &point.warnings) {
        match found.iter_mut().find(|(text, _)| *text == warning.message) {
            Some((_, count)) => *count += 1,
            None => found.push((&warning.message, 1)),
        }
    }
    if found.is_empty() {
        return String::new();
    }
    let mut text = "\nWarnings of the renders:\n\n".to_owned();
    for (message, count) in found {
        text += &format!("- {} ({count}×)\n", escaped(message));
    }
    text
}

fn warnings(study: &Study) -> String {
    if study.warnings.is_empty() {
        return String::new();
    }
    let lines: String = study
        .warnings
        .iter()
        .map(|warning| format!("- {}\n", escaped(&warning.message)))
        .collect();
    format!("\n## Warnings\n\n{lines}")
}

fn files(links: &ReportLinks) -> String {
    let all = [
        ("JSON, with all values", &links.json),
        ("CSV, one row per setting", &links.csv),
    ];
    let lines: String = all
        .into_iter()
        .filter_map(|(what, link)| link.as_ref().map(|link| format!("- [{what}]({link})\n")))
        .collect();
    if lines.is_empty() {
        lines
    } else {
        format!("\n## Files\n\n{lines}")
    }
}

fn picture(what: &str, link: &str) -> String {
    format!("![{what}]({link})\n")
}
