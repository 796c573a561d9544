//! Sweeps: each setting of the dials is rendered, compared with the truth, and timed.

use std::time::{Duration, Instant};

use super::dial::{Dial, Setting, as_json, with_dials};
use super::figures::error_figures;
use super::order::fit_orders;
use super::pareto::mark_pareto_front;
use super::study::{
    CostFigures, PassCost, Point, SpreadMs, Study, StudyImages, Sweep, TruthFigures,
};
use crate::accuracy::LinearImage;
use crate::accuracy::metrics::MetricError;
use crate::config::Limits;
use crate::frame::Frame;
use crate::reference::{ReferenceError, Truth, TruthKind, shadow_edge};
use crate::scene::{Issue, LayerName, Output, ResolvedScene, SceneError};
use crate::stats::{Stats, Warning};
use crate::tuning::ladder;

/// Most settings of a study.
pub const MOST_SETTINGS: usize = 64;
/// Most values (texels or pixels, all settings together) that a study holds.
pub const MOST_COMPARED: usize = 32_000_000;
/// Distance from a shadow's edge, in texels (for a view, pixels), within which the error is reported separately.
pub const SHADOW_EDGE_TEXELS: u32 = 2;

/// Timed runs of a slow setting.
const FEWEST_RUNS: usize = 3;
/// Time above which a setting is slow.
const LONG_ENOUGH: Duration = Duration::from_secs(1);

/// What to sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepSettings {
    /// The dials.
    pub dials: Vec<Dial>,
    /// Sweep all combinations of the dials' values, instead of one dial at a time with the others as in the scene.
    pub grid: bool,
    /// Timed runs of each setting, after one that warms up, 1 …; of settings that take over a second only three.
    pub runs: u32,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError<E: std::error::Error> {
    /// A dial's value is not accepted, or nothing of the scene can be compared.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// More than [`MOST_SETTINGS`].
    #[error("the dials have {0} settings; at most {MOST_SETTINGS} are accepted")]
    TooMany(usize),
    /// More than [`MOST_COMPARED`].
    #[error(
        "{0} values would have to be held (texels or pixels times settings); at most {MOST_COMPARED} are accepted"
    )]
    TooLarge(usize),
    /// The shadows' edges cannot be found.
    #[error("the shadows' edges cannot be found: {0}")]
    Edges(ReferenceError),
    /// Images cannot be compared.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// Every setting was skipped.
    #[error("no setting can be rendered: {0}")]
    NothingLeft(String),
    /// A render failed for good.
    #[error("{0}")]
    Render(E),
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// The consequence of a failed render for the study.
#[derive(Debug)]
pub enum Refusal<E> {
    /// This setting cannot be rendered (too much memory). It is skipped, and the study reports it.
    Setting(E),
    /// No setting can be rendered.
    All(E),
}

/// A renderer, wherever it is.
pub type Render<'a, E> = dyn FnMut(ResolvedScene) -> Result<Frame, Refusal<E>> + 'a;

/// Receives progress: settings done, all settings, current work. Returns whether to continue.
pub type Progress<'a> = dyn FnMut(usize, usize, &str) -> bool + 'a;

/// Renders, compares and times every setting.
///
/// The first run of a setting warms up, and gives the image and the frame's estimate of its own error. The timed runs omit the
/// estimate.
///
/// # Errors
/// [`StudyError`].
pub fn run_study<E: std::error::Error>(
    resolved: &ResolvedScene,
    name: &str,
    truth: &Truth,
    settings: &SweepSettings,
    limits: &Limits,
    render: &mut Render<'_, E>,
    progress: &mut Progress<'_>,
) -> Result<(Study, StudyImages), StudyError<E>> {
    let plan = settings_of(settings);
    // Every setting is checked before any time is spent.
    let scenes = scenes_of(&plan, resolved, limits)?;
    let total = scenes.len();
    let values = truth.irradiance.len().saturating_mul(total);
    if values > MOST_COMPARED {
        return Err(StudyError::TooLarge(values));
    }
    let edge = shadow_edge(resolved, truth, SHADOW_EDGE_TEXELS, &mut || {
        progress(0, total, "the edges of shadows")
    })
    .map_err(|error| match error {
        ReferenceError::Cancelled => StudyError::Cancelled,
        other => StudyError::Edges(other),
    })?;
    let mut study = Study {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        scene: name.to_owned(),
        scene_hash: resolved.hash(),
        cores: std::thread::available_parallelism().map_or(1, |n| n.get() as u32),
        truth: truth_figures(truth, edge.as_deref()),
        ..Study::default()
    };
    let mut images = StudyImages {
        truth: LinearImage {
            width: truth.width,
            height: truth.height,
            rgb: truth.irradiance.clone(),
        },
        points: Vec::new(),
        white_w_m2: std::f64::consts::PI * crate::methods::facts(resolved)?.lights.white_radiance,
    };
    let mut scenes = scenes.into_iter();
    let mut done = 0;
    for (dial, settings_here) in &plan {
        let mut sweep = Sweep {
            dial: dial.clone(),
            ..Sweep::default()
        };
        let mut sweep_images = Vec::new();
        for (dials, scene) in settings_here.iter().zip(scenes.by_ref()) {
            let words = in_words(dials);
            if !progress(done, total, &words) {
                return Err(StudyError::Cancelled);
            }
            done += 1;
            let scene = match scene {
                Setting::Scene(scene) => scene,
                Setting::LeftOut(reason) => {
                    study.warnings.push(left_out(&words, &reason));
                    continue;
                }
            };
            match measure(&scene, settings.runs, render) {
                Ok((frame, costs)) => {
                    let image = compared_image(&frame, truth)?;
                    let mut error = error_figures(
                        &image,
                        &images.truth,
                        &truth.compared,
                        edge.as_deref(),
                        images.white_w_m2,
                    )?;
                    error.estimated = frame.stats.accuracy.and_then(|a| a.estimated_error);
                    study.adapter = frame.stats.adapter;
                    sweep.points.push(Point {
                        dials: dials
                            .iter()
                            .map(|(name, text)| (name.clone(), as_json(text)))
                            .collect(),
                        error,
                        cost: cost_figures(&costs),
                        on_pareto_front: false,
                        warnings: frame.stats.warnings,
                    });
                    sweep_images.push(image);
                }
                Err(Refusal::Setting(error)) => {
                    study.warnings.push(left_out(&words, &error.to_string()));
                }
                Err(Refusal::All(error)) => return Err(StudyError::Render(error)),
            }
        }
        // A sweep is dropped if all its settings were skipped; the warnings report it.
        if !sweep.points.is_empty() {
            study.sweeps.push(sweep);
            images.points.push(sweep_images);
        }
    }
    if study.sweeps.is_empty() {
        let reasons: Vec<String> = study.warnings.into_iter().map(|w| w.message).collect();
        return Err(StudyError::NothingLeft(reasons.join("; ")));
    }
    progress(total, total, "done");
    fit_orders(&mut study);
    mark_pareto_front(&mut study);
    Ok((study, images))
}

/// Checks that [`run_study`] makes before it renders, for callers that have to compute a truth first.
///
/// # Errors
/// [`StudyError::Scene`] where a dial's value is not accepted or the output has no light, [`StudyError::TooMany`], [`StudyError::NothingLeft`] where no method can do
/// its setting.
pub fn check<E: std::error::Error>(
    resolved: &ResolvedScene,
    settings: &SweepSettings,
    limits: &Limits,
) -> Result<(), StudyError<E>> {
    if resolved.scene.output.is_water_map() {
        return Err(StudyError::Scene(SceneError::from(Issue::invalid(
            "/output/kind",
            "a study compares light, and a map of the water has none",
            "`view` or `irradiance_map`",
        ))));
    }
    let plan = settings_of(settings);
    let scenes = scenes_of(&plan, resolved, limits)?;
    let all = plan.iter().flat_map(|(_, settings)| settings);
    let reasons: Option<Vec<String>> = all
        .zip(&scenes)
        .map(|(dials, setting)| match setting {
            Setting::Scene(_) => None,
            Setting::LeftOut(reason) => Some(left_out(&in_words(dials), reason).message),
        })
        .collect();
    match reasons {
        Some(reasons) if !reasons.is_empty() => Err(StudyError::NothingLeft(reasons.join("; "))),
        _ => Ok(()),
    }
}

fn left_out(setting: &str, reason: &str) -> Warning {
    let message = format!("{setting} cannot be rendered: {reason}");
    Warning::new("setting_left_out", message)
}

/// The scene with each setting, in order.
fn scenes_of<E: std::error::Error>(
    plan: &[(String, Vec<DialTexts>)],
    resolved: &ResolvedScene,
    limits: &Limits,
) -> Result<Vec<Setting>, StudyError<E>> {
    let total = plan.iter().map(|(_, settings)| settings.len()).sum();
    if total > MOST_SETTINGS {
        return Err(StudyError::TooMany(total));
    }
    let base = with_irradiance(resolved);
    let settings = plan.iter().flat_map(|(_, settings)| settings);
    settings
        .map(|dials| {
            let scene = with_dials(&base, dials, limits)?;
            if let Setting::Scene(scene) = &scene {
                refuse_overruled(scene, dials)?;
            }
            Ok(scene)
        })
        .collect()
}

/// Refuses to sweep a dial that the program would choose itself: every setting would be the same.
fn refuse_overruled(scene: &ResolvedScene, dials: &[(String, String)]) -> Result<(), SceneError> {
    let quality = &scene.scene.quality;
    let target = match (quality.target_error, quality.time_budget_ms) {
        (Some(_), _) => "target_error",
        (_, Some(_)) => "time_budget_ms",
        _ => return Ok(()),
    };
    let is_chosen = |(name, _): &&(String, String)| ladder::sets(name, &scene.scene.output);
    match dials.iter().find(is_chosen) {
        None => Ok(()),
        Some((name, _)) => Err(Issue::invalid(
            format!("/quality/{target}"),
            format!("with it the program chooses {name} itself, so there is nothing to sweep"),
            format!("no {target}, or sweeps of {target} itself"),
        )
        .into()),
    }
}

/// One setting: dials with their values.
type DialTexts = Vec<(String, String)>;

/// The sweeps: what varies, and the settings.
fn settings_of(settings: &SweepSettings) -> Vec<(String, Vec<DialTexts>)> {
    if !settings.grid {
        return settings
            .dials
            .iter()
            .map(|dial| {
                let each = dial
                    .values
                    .iter()
                    .map(|value| vec![(dial.name.clone(), value.clone())]);
                (dial.name.clone(), each.collect())
            })
            .collect();
    }
    let mut all: Vec<DialTexts> = vec![Vec::new()];
    for dial in &settings.dials {
        all = all
            .iter()
            .flat_map(|setting| {
                dial.values.iter().map(|value| {
                    let mut longer = setting.clone();
                    longer.push((dial.name.clone(), value.clone()));
                    longer
                })
            })
            .take(MOST_SETTINGS + 1)
            .collect();
    }
    let names: Vec<&str> = settings.dials.iter().map(|d| d.name.as_str()).collect();
    vec![(names.join(" × "), all)]
}

fn in_words(dials: &[(String, String)]) -> String {
    let each: Vec<String> = dials
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    each.join(", ")
}

/// The scene with the layer that is compared; a map holds nothing else anyway.
fn with_irradiance(resolved: &ResolvedScene) -> ResolvedScene {
    let mut resolved = resolved.clone();
    if let Output::View(view) = &mut resolved.scene.output
        && !view.layers.contains(&LayerName::Irradiance)
    {
        view.layers.push(LayerName::Irradiance);
        view.format = crate::scene::ImageFormat::Exr;
    }
    resolved
}

/// Renders once for the image and then for the clock.
fn measure<E>(
    scene: &ResolvedScene,
    runs: u32,
    render: &mut Render<'_, E>,
) -> Result<(Frame, Vec<Stats>), Refusal<E>> {
    let mut estimating = scene.clone();
    estimating.scene.quality.estimate_error = true;
    let frame = render(estimating)?;
    let mut costs = Vec::new();
    let mut plain = scene.clone();
    plain.scene.quality.estimate_error = false;
    let started = Instant::now();
    while costs.len() < runs.max(1) as usize {
        costs.push(render(plain.clone())?.stats);
        // The times of slow frames vary little, so a few runs are enough.
        if costs.len() >= FEWEST_RUNS && started.elapsed() > LONG_ENOUGH {
            break;
        }
    }
    Ok((frame, costs))
}

/// The values of a frame that are compared with the truth's.
fn compared_image(frame: &Frame, truth: &Truth) -> Result<LinearImage, MetricError> {
    let is_map = truth.kind != TruthKind::View;
    if is_map && (frame.width, frame.height) != (truth.width, truth.height) {
        return Err(MetricError::SizeMismatch {
            image: frame.width as usize * frame.height as usize,
            truth: truth.irradiance.len(),
        });
    }
    let layer = &frame.layers[&LayerName::Irradiance];
    let mut rgb = Vec::with_capacity(truth.irradiance.len());
    for j in 0..truth.height {
        for i in 0..truth.width {
            let x = truth.first_pixel[0] + i * truth.pixel_step;
            let y = truth.first_pixel[1] + j * truth.pixel_step;
            let at = layer.channels * (y as usize * frame.width as usize + x as usize);
            let compared = truth.compared[rgb.len()];
            rgb.push(std::array::from_fn(|c| {
                if compared {
                    f64::from(layer.data[at + c])
                } else {
                    0.0
                }
            }));
        }
    }
    Ok(LinearImage {
        width: truth.width,
        height: truth.height,
        rgb,
    })
}

fn truth_figures(truth: &Truth, edge: Option<&[bool]>) -> TruthFigures {
    let compared = truth.compared.iter().filter(|&&c| c).count();
    let what = match truth.kind {
        TruthKind::FloorMap => format!(
            "irradiance on the floor, {} × {} texels",
            truth.width, truth.height
        ),
        TruthKind::ObjectMap => format!(
            "irradiance on a mesh, {compared} of {} × {} texels",
            truth.width, truth.height
        ),
        TruthKind::View => format!(
            "irradiance on what the camera sees, at {compared} of its pixels (every {}th along each side)",
            truth.pixel_step
        ),
    };
    TruthFigures {
        what,
        width: truth.width,
        height: truth.height,
        rays: truth.rays,
        relative_error: truth.relative_error,
        seconds: truth.seconds,
        from_disk: truth.from_disk,
        shadow_edge_area: edge.filter(|_| compared > 0).map(|edge| {
            let inside = edge.iter().zip(&truth.compared).filter(|(e, c)| **e && **c);
            inside.count() as f64 / compared as f64
        }),
    }
}

fn cost_figures(runs: &[Stats]) -> CostFigures {
    let spread_of = |figure: &dyn Fn(&Stats) -> Option<f64>| {
        SpreadMs::of(runs.iter().filter_map(figure).collect())
    };
    let passes = runs.first().map(|stats| &stats.passes);
    let passes = passes.into_iter().flatten().filter_map(|pass| {
        let ms =
            spread_of(&|stats: &Stats| stats.passes.iter().find(|p| p.name == pass.name)?.gpu_ms);
        ms.map(|ms| PassCost {
            name: pass.name.clone(),
            ms,
        })
    });
    CostFigures {
        runs: runs.len() as u32,
        wall_ms: spread_of(&|stats| Some(stats.time_ms.total)).unwrap_or_default(),
        gpu_ms: spread_of(&|stats| Some(stats.time_ms.gpu + stats.time_ms.readback))
            .unwrap_or_default(),
        passes: passes.collect(),
        peak_bytes: runs.iter().map(|s| s.memory.peak_bytes).max().unwrap_or(0),
    }
}

impl SpreadMs {
    /// Median, smallest and largest; `None` without values.
    pub fn of(mut runs: Vec<f64>) -> Option<Self> {
        runs.sort_by(f64::total_cmp);
        let (min, max) = (*runs.first()?, *runs.last()?);
        let middle = runs.len() / 2;
        let median = if runs.len().is_multiple_of(2) {
            0.5 * (runs[middle - 1] + runs[middle])
        } else {
            runs[middle]
        };
        Some(Self { median, min, max })
    }
}
