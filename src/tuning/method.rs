//! Which method to use for a scene and a wanted error, and why not each of the others.
//!
//! The advice claims only what is known: what a method cannot do or leaves out, and what was measured on scenes of the same kind
//! ([`crate::calibration::frontiers`]). A method other than the default is advised only if it was faster on every such scene.

use crate::calibration::frontiers::{Frontiers, Kind, MeasuredMethod, MeasuredScene};
use crate::facts::SceneFacts;
use crate::facts::source::Source;
use crate::methods::{self, Method};
use crate::scene::{MethodChoice, Output, ResolvedScene};
use crate::stats::{ChosenDials, MethodAdvice, OtherMethod};

/// A method has to be faster than the default by this factor on every scene: measured times scatter.
const CLEARLY: f64 = 0.9;

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The scene, with the dials that were chosen for the default method.
    pub resolved: &'a ResolvedScene,
    /// Its facts.
    pub facts: &'a SceneFacts,
    /// Relative L1 error that is wanted.
    pub target: f64,
    /// Those dials.
    pub chosen: &'a ChosenDials,
}

/// A method that was measured against the default one.
struct Measured<'a> {
    method: &'static Method,
    /// The largest ratio of its time to that of the default method, over the scenes.
    slowest: f64,
    /// Its settings on the scenes.
    fronts: Vec<&'a MeasuredMethod>,
}

/// The kind of a scene; `None` for maps on objects, which are no points of a comparison.
pub fn kind_of(resolved: &ResolvedScene, facts: &SceneFacts) -> Option<Kind> {
    let output = &resolved.scene.output;
    let mut sets = facts.lights.beam_sets.iter();
    let lamps = sets.any(|set| !matches!(set.source, Source::Sun { .. }));
    match output {
        Output::View(_) | Output::IrradianceMap(_) if !output.is_object_map() => Some(Kind {
            view: output.is_view(),
            objects: facts.wet_objects().next().is_some(),
            lamps,
        }),
        _ => None,
    }
}

/// The method to use, what to expect of it, and why not each other method.
pub fn advise(question: &Question<'_>, frontiers: &Frontiers) -> MethodAdvice {
    let default = methods::of(&question.resolved.scene.quality);
    let kind = kind_of(question.resolved, question.facts);
    let scenes: Vec<&MeasuredScene> = frontiers
        .scenes
        .iter()
        .filter(|scene| Some(scene.kind) == kind && scene.of(default.name).is_some())
        .collect();
    let mut others = Vec::new();
    let mut candidates = Vec::new();
    for method in methods::ALL.into_iter().filter(|m| m.name != default.name) {
        let reason = match lacks(method, question) {
            Some(reason) => reason,
            None => match against_measured(method, default, &scenes, question.target) {
                Err(reason) => reason,
                Ok(measured) => {
                    candidates.push(measured);
                    String::new()
                }
            },
        };
        others.push(OtherMethod {
            method: method.name.to_owned(),
            reason,
        });
    }
    let fastest = candidates
        .iter()
        .min_by(|a, b| a.slowest.total_cmp(&b.slowest));
    let mut advice = match fastest {
        Some(measured) => of_measured(measured, default, question, scenes.len(), frontiers),
        None => of_default(default, question, scenes.len()),
    };
    for other in &mut others {
        if other.reason.is_empty() {
            other.reason = format!("{} was faster still", advice.method);
        }
    }
    if fastest.is_some() {
        others.insert(
            0,
            OtherMethod {
                method: default.name.to_owned(),
                reason: format!(
                    "it took longer for this error; it is what a render with target_error uses: {} ms predicted",
                    whole(question.chosen.predicted_ms)
                ),
            },
        );
    }
    others.retain(|other| other.method != advice.method);
    advice.others = others;
    advice
}

/// What a method cannot do, or leaves out of this scene.
fn lacks(method: &'static Method, question: &Question<'_>) -> Option<String> {
    let mut resolved = question.resolved.clone();
    let quality = &mut resolved.scene.quality;
    quality.method = MethodChoice::named(method.name);
    (quality.target_error, quality.time_budget_ms) = (None, None);
    match methods::reason_against(&resolved) {
        Ok(None) => {}
        Ok(Some(reason)) => return Some(format!("it cannot render this scene: {reason}")),
        Err(error) => return Some(format!("it cannot render this scene: {error}")),
    }
    let wet = question.facts.wet_objects().count();
    let leaves_out = method.facts_of_default().leaves_out;
    if wet > 0 && leaves_out.shadows {
        return Some("it leaves out the shadows of objects".to_owned());
    }
    if wet > 1 && leaves_out.shadows_on_objects {
        return Some("it leaves out the shadows of objects on each other".to_owned());
    }
    if wet > 0 && question.facts.quality.layers > 1 && leaves_out.further_layers {
        return Some("it leaves further layers of objects dark".to_owned());
    }
    None
}

/// The method's measurements, if it was clearly faster than the default on every scene; otherwise why it is not advised.
fn against_measured<'a>(
    method: &'static Method,
    default: &Method,
    scenes: &[&'a MeasuredScene],
    target: f64,
) -> Result<Measured<'a>, String> {
    let stays = match method.expected_order {
        0.0 => "its error does not go to 0 with more cells, and ",
        _ => "",
    };
    if scenes.is_empty() {
        return Err(format!("{stays}no scene of this kind was measured"));
    }
    let mut ratios = Vec::new();
    let mut fronts = Vec::new();
    for scene in scenes {
        let Some(front) = scene.of(method.name) else {
            return Err(format!("{stays}it was not measured on {}", scene.scene));
        };
        let Some(ms) = front.ms_at(target) else {
            return Err(format!(
                "the smallest error measured with it on {} is {}",
                scene.scene,
                percent(front.least_error())
            ));
        };
        let Some(default_ms) = scene.of(default.name).and_then(|d| d.ms_at(target)) else {
            return Err(format!(
                "{} was not measured down to this error on {}, so the two cannot be compared",
                default.name, scene.scene
            ));
        };
        ratios.push(ms / default_ms);
        fronts.push(front);
    }
    let fastest = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let slowest = ratios.iter().copied().fold(0.0, f64::max);
    if slowest < CLEARLY {
        return Ok(Measured {
            method,
            slowest,
            fronts,
        });
    }
    Err(format!(
        "for this error it took {} times as long as {} on {}",
        match ratios.len() {
            1 => significant(slowest),
            _ => format!("{} … {}", significant(fastest), significant(slowest)),
        },
        default.name,
        names(scenes)
    ))
}

fn of_default(default: &Method, question: &Question<'_>, scenes: usize) -> MethodAdvice {
    let chosen = question.chosen;
    let mut reason = match chosen.meets {
        true => format!(
            "its dials can be chosen for an error: {} water cells are predicted to stay under {}",
            chosen.water_cells, question.target
        ),
        false => format!(
            "no number of its water cells is certain to stay under {}, but its error falls with them",
            question.target
        ),
    };
    reason.push_str(match scenes {
        0 => "; no other method was measured on scenes of this kind",
        _ => "; no other method was faster on every measured scene of this kind",
    });
    MethodAdvice {
        method: default.name.to_owned(),
        reason,
        expected_error: chosen.predicted_error,
        expected_ms: chosen.predicted_ms,
        source: "trial renders of this scene, and the calibration of times".to_owned(),
        ..MethodAdvice::default()
    }
}

fn of_measured(
    measured: &Measured<'_>,
    default: &Method,
    question: &Question<'_>,
    scenes: usize,
    frontiers: &Frontiers,
) -> MethodAdvice {
    let settings = measured.fronts.iter();
    let settings = settings.filter_map(|front| front.setting_at(question.target));
    // The most costly one meets the error on every scene.
    let setting = settings.max_by(|a, b| a.ms.total_cmp(&b.ms));
    MethodAdvice {
        method: measured.method.name.to_owned(),
        dials: setting
            .map(|setting| setting.dials.clone())
            .unwrap_or_default(),
        reason: format!(
            "for this error it took at most {} of the time of {} on each of {scenes} measured scenes of this kind",
            percent(measured.slowest),
            default.name
        ),
        expected_error: question.target,
        expected_ms: measured.slowest * question.chosen.predicted_ms,
        source: format!(
            "measurements of other scenes on {}; nothing of this scene was rendered with it",
            frontiers.adapter
        ),
        others: Vec::new(),
    }
}

fn names(scenes: &[&MeasuredScene]) -> String {
    let names: Vec<&str> = scenes.iter().map(|scene| scene.scene.as_str()).collect();
    names.join(", ")
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share))
}

/// Two significant digits.
fn significant(value: f64) -> String {
    let decimals = 1 - value.abs().max(1e-9).log10().floor() as i32;
    format!("{value:.*}", decimals.max(0) as usize)
}

fn whole(value: f64) -> String {
    format!("{value:.0}")
}
