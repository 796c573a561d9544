//! Sweeps: each setting of the dials is rendered, compared with the truth, and timed.

use std::time::{Duration, Instant};

use super::dial::{Setting, as_json};
use super::figures::error_figures;
use super::order::fit_orders;
use super::pareto::mark_pareto_front;
use super::settings::{left_out, plan};
use super::study::{
    CostFigures, PassCost, Point, SpreadMs, Study, StudyImages, Sweep, TruthFigures,
};
use super::words;
use crate::accuracy::LinearImage;
use crate::accuracy::metrics::MetricError;
use crate::config::Limits;
use crate::frame::Frame;
use crate::reference::{ReferenceError, Truth, TruthKind, shadow_edge};
use crate::scene::{LayerName, MethodChoice, ResolvedScene, SceneError};
use crate::stats::{Stats, Warning};

pub use super::settings::{MOST_COMPARED_SETTINGS, MOST_SETTINGS, SweepSettings, check};

/// Most values (texels or pixels, all settings together) that a study holds.
pub const MOST_COMPARED: usize = 32_000_000;
/// Distance from a shadow's edge, in texels (for a view, pixels), within which the error is reported separately.
pub const SHADOW_EDGE_TEXELS: u32 = 2;

/// Timed runs of a slow setting.
const FEWEST_RUNS: usize = 3;
/// Time above which a setting is slow.
const LONG_ENOUGH: Duration = Duration::from_secs(1);
/// From one timed frame of a comparison to the next, s: a moment, so that light that a method keeps for water at rest in time is carried
/// again, and the work stays the same.
const MOMENT_S: f64 = 1e-3;
/// Time of a frame, ms, after which a method of a comparison is not rendered at more costly settings.
const SLOW_MS: f64 = 2000.0;

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum StudyError<E: std::error::Error> {
    /// A dial's value is not accepted, or nothing of the scene can be compared.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// More than [`MOST_SETTINGS`], or [`MOST_COMPARED_SETTINGS`] of methods.
    #[error("the dials have {total} settings; at most {most} are accepted")]
    TooMany {
        /// How many there are.
        total: usize,
        /// How many are accepted.
        most: usize,
    },
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
    // Every setting is checked before any time is spent.
    let plan = plan(resolved, settings, limits)?;
    let total = plan.iter().map(|series| series.settings.len()).sum();
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
        white_w_m2: white_w_m2(resolved, settings)?,
    };
    let mut done = 0;
    for series in &plan {
        if let Some(reason) = series.reason_against() {
            study.left_out.push(reason);
            done += series.settings.len();
            continue;
        }
        let mut sweep = Sweep {
            dial: series.name.clone(),
            series: series.of.clone(),
            ..Sweep::default()
        };
        let mut sweep_images = Vec::new();
        for planned in &series.settings {
            let words = series.setting_in_words(planned);
            if !progress(done, total, &words) {
                return Err(StudyError::Cancelled);
            }
            done += 1;
            let scene = match &planned.scene {
                Setting::Scene(scene) => scene,
                Setting::LeftOut(reason) => {
                    study.warnings.push(left_out(&words, reason));
                    continue;
                }
            };
            if let Some(reason) = too_slow(&sweep) {
                let message = format!("{words} was left out: {reason}");
                study
                    .warnings
                    .push(Warning::new("setting_left_out", message));
                continue;
            }
            let step_s = if series.of.is_some() { MOMENT_S } else { 0.0 };
            match measure(scene, settings.runs, step_s, render) {
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
                    let dials = planned.dials.iter();
                    sweep.points.push(Point {
                        dials: dials
                            .map(|(name, text)| (name.clone(), as_json(text)))
                            .collect(),
                        scale: planned.scale,
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
        let against = study.left_out.into_iter();
        let mut reasons: Vec<String> = against
            .map(|left| format!("{}: {}", left.series, left.reason))
            .collect();
        reasons.extend(study.warnings.into_iter().map(|w| w.message));
        return Err(StudyError::NothingLeft(reasons.join("; ")));
    }
    progress(total, total, "done");
    fit_orders(&mut study);
    mark_pareto_front(&mut study);
    Ok((study, images))
}

/// Irradiance, W/m², that the pictures show as white. It does not depend on the method, so that of a comparison may refuse the scene.
fn white_w_m2(resolved: &ResolvedScene, settings: &SweepSettings) -> Result<f64, SceneError> {
    let mut scene = resolved.clone();
    if settings.is_comparison() {
        scene.scene.quality.method = MethodChoice::default();
    }
    let lights = crate::methods::facts(&scene)?.lights;
    Ok(std::f64::consts::PI * lights.white_radiance)
}

/// In a comparison, why the next setting of a series is not rendered: it costs more than the last one, which took long already.
fn too_slow(sweep: &Sweep) -> Option<String> {
    let last_ms = sweep.points.last()?.cost.wall_ms.median;
    let is_slow = sweep.series.is_some() && last_ms > SLOW_MS;
    is_slow.then(|| {
        format!(
            "the setting before it takes {} ms a frame",
            words::ms(last_ms)
        )
    })
}

/// Renders once for the image and then for the clock. From one timed frame to the next the scene moves by `step_s`.
fn measure<E>(
    scene: &ResolvedScene,
    runs: u32,
    step_s: f64,
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
        plain.scene.time_s = scene.scene.time_s + step_s * (costs.len() + 1) as f64;
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
            "irradiance on what the camera sees, at {compared} of its pixels (one in {} along each side)",
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
