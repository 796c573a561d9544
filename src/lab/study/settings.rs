//! The settings of a study: what is rendered, series by series, and which of it can be.

use super::comparison::{DialTexts, METHOD_DIAL, contenders};
use super::dial::{Dial, Setting, with_dials};
use super::study::{LeftOut, SeriesOf};
use super::sweep::StudyError;
use crate::config::Limits;
use crate::scene::{
    ImageFormat, Issue, LayerName, MethodChoice, Output, Quality, ResolvedScene, SceneError,
};
use crate::stats::Warning;
use crate::tuning::ladder;

/// Most settings of a study of dials.
pub const MOST_SETTINGS: usize = 64;
/// Most settings of a comparison of methods.
pub const MOST_COMPARED_SETTINGS: usize = 256;

/// What to sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepSettings {
    /// The dials. `method` alone, without `grid`, is a comparison of methods, each at settings of its own
    /// ([`contenders`]); its values are what that function reads.
    pub dials: Vec<Dial>,
    /// Sweep all combinations of the dials' values, instead of one dial at a time with the others as in the scene.
    pub grid: bool,
    /// Settings of each series of a comparison, [`super::comparison::RUNGS`].
    pub rungs: u32,
    /// Timed runs of each setting, after one that warms up, 1 …; of settings that take over a second only three.
    pub runs: u32,
}

impl SweepSettings {
    /// Whether methods are compared, each at settings of its own.
    pub fn is_comparison(&self) -> bool {
        !self.grid && self.dials.len() == 1 && self.dials[0].name == METHOD_DIAL
    }
}

/// A series of settings.
pub(super) struct Series {
    /// What varies.
    pub name: String,
    /// The method, in a comparison.
    pub of: Option<SeriesOf>,
    pub settings: Vec<Planned>,
}

/// A setting, and the scene with it.
pub(super) struct Planned {
    pub dials: DialTexts,
    /// Where on a method's ladder, in a comparison.
    pub scale: Option<f64>,
    pub scene: Setting,
}

impl Planned {
    /// `water_cells = 64, split_levels = 1`.
    pub(super) fn in_words(&self) -> String {
        let each = self.dials.iter();
        let each: Vec<String> = each
            .map(|(name, value)| format!("{name} = {value}"))
            .collect();
        each.join(", ")
    }
}

impl Series {
    /// What stands in progress and warnings for a setting.
    pub(super) fn setting_in_words(&self, planned: &Planned) -> String {
        match &self.of {
            None => planned.in_words(),
            Some(of) => {
                let chief = planned.dials.iter().find(|(name, _)| *name == of.chief);
                let value = chief.map_or("", |(_, value)| value);
                format!("{}, {} = {value}", self.name, of.chief)
            }
        }
    }

    /// The reason why no setting of the method can be rendered, if it is one and the same.
    pub(super) fn reason_against(&self) -> Option<LeftOut> {
        let of = self.of.as_ref()?;
        let mut reasons = self.settings.iter().map(|planned| match &planned.scene {
            Setting::LeftOut(reason) => Some(reason),
            Setting::Scene(_) => None,
        });
        let reason = reasons.next()??;
        reasons.all(|other| other == Some(reason)).then(|| LeftOut {
            series: self.name.clone(),
            method: of.method.clone(),
            reason: reason.clone(),
        })
    }
}

/// Checks that [`super::sweep::run_study`] makes before it renders, for callers that have to compute a truth first.
///
/// # Errors
/// [`StudyError::Scene`] where a dial's value is not accepted or the output has no light, [`StudyError::TooMany`],
/// [`StudyError::NothingLeft`] where no method can do its setting.
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
    let all = plan(resolved, settings, limits)?;
    let mut reasons = Vec::new();
    for series in &all {
        for planned in &series.settings {
            match &planned.scene {
                Setting::Scene(_) => return Ok(()),
                Setting::LeftOut(reason) => {
                    let words = series.setting_in_words(planned);
                    reasons.push(left_out(&words, reason).message);
                }
            }
        }
    }
    match reasons.is_empty() {
        true => Ok(()),
        false => Err(StudyError::NothingLeft(reasons.join("; "))),
    }
}

/// The warning about a setting that is skipped.
pub(super) fn left_out(setting: &str, reason: &str) -> Warning {
    let message = format!("{setting} cannot be rendered: {reason}");
    Warning::new("setting_left_out", message)
}

/// All settings with their scenes, checked before any time is spent.
pub(super) fn plan<E: std::error::Error>(
    resolved: &ResolvedScene,
    settings: &SweepSettings,
    limits: &Limits,
) -> Result<Vec<Series>, StudyError<E>> {
    let (texts, most) = match settings.is_comparison() {
        true => (compared(resolved, settings)?, MOST_COMPARED_SETTINGS),
        false => (swept(settings), MOST_SETTINGS),
    };
    let total = texts.iter().map(|(_, _, settings)| settings.len()).sum();
    if total > most {
        return Err(StudyError::TooMany { total, most });
    }
    let mut base = with_irradiance(resolved);
    if settings.is_comparison() {
        // The scene's own dials belong to one of the methods only.
        base.scene.quality.method = MethodChoice::default();
    }
    let scene_of = |dials: &DialTexts| -> Result<Setting, SceneError> {
        let scene = with_dials(&base, dials, limits)?;
        if let Setting::Scene(scene) = &scene {
            refuse_overruled(scene, dials)?;
        }
        Ok(scene)
    };
    texts
        .into_iter()
        .map(|(name, of, settings)| {
            let settings = settings.into_iter().map(|(scale, dials)| {
                Ok(Planned {
                    scene: scene_of(&dials)?,
                    dials,
                    scale,
                })
            });
            Ok(Series {
                name,
                of,
                settings: settings.collect::<Result<_, StudyError<E>>>()?,
            })
        })
        .collect()
}

/// Name, method, and settings of a series.
type SeriesTexts = (String, Option<SeriesOf>, Vec<(Option<f64>, DialTexts)>);

/// One series per method of a comparison.
fn compared(
    resolved: &ResolvedScene,
    settings: &SweepSettings,
) -> Result<Vec<SeriesTexts>, SceneError> {
    if let Some(target) = requested(&resolved.scene.quality) {
        let dials = "the dials, which a comparison of methods sets,";
        return Err(chosen_anyway(target, dials));
    }
    let dial = &settings.dials[0];
    let found = contenders(&dial.values, resolved, settings.rungs)?;
    let texts = found.into_iter().map(|contender| {
        let settings = contender.settings.into_iter();
        let of = SeriesOf {
            method: contender.method.to_owned(),
            chief: contender.chief,
        };
        let settings = settings.map(|(scale, dials)| (Some(scale), dials));
        (contender.name, Some(of), settings.collect())
    });
    Ok(texts.collect())
}

/// One series per dial, or one of all combinations.
fn swept(settings: &SweepSettings) -> Vec<SeriesTexts> {
    let series = |name: String, settings: Vec<DialTexts>| {
        let settings = settings.into_iter().map(|dials| (None, dials));
        (name, None, settings.collect())
    };
    if !settings.grid {
        let dials = settings.dials.iter();
        return dials
            .map(|dial| {
                let values = dial.values.iter();
                let each = values.map(|value| vec![(dial.name.clone(), value.clone())]);
                series(dial.name.clone(), each.collect())
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
    vec![series(names.join(" × "), all)]
}

/// Refuses to sweep a dial that the program would choose itself: every setting would be the same.
fn refuse_overruled(scene: &ResolvedScene, dials: &[(String, String)]) -> Result<(), SceneError> {
    let Some(target) = requested(&scene.scene.quality) else {
        return Ok(());
    };
    let is_chosen = |(name, _): &&(String, String)| ladder::sets(name, &scene.scene.output);
    match dials.iter().find(is_chosen) {
        None => Ok(()),
        Some((name, _)) => Err(chosen_anyway(target, name)),
    }
}

/// The field by which the scene lets the program choose dials.
fn requested(quality: &Quality) -> Option<&'static str> {
    match (quality.target_error, quality.time_budget_ms) {
        (Some(_), _) => Some("target_error"),
        (_, Some(_)) => Some("time_budget_ms"),
        _ => None,
    }
}

fn chosen_anyway(target: &str, what: &str) -> SceneError {
    Issue::invalid(
        format!("/quality/{target}"),
        format!("with it the program chooses {what} itself, so there is nothing to sweep"),
        format!("no {target}, or sweeps of {target} itself"),
    )
    .into()
}

/// The scene with the layer that is compared; a map holds nothing else anyway.
fn with_irradiance(resolved: &ResolvedScene) -> ResolvedScene {
    let mut resolved = resolved.clone();
    if let Output::View(view) = &mut resolved.scene.output
        && !view.layers.contains(&LayerName::Irradiance)
    {
        view.layers.push(LayerName::Irradiance);
        view.format = ImageFormat::Exr;
    }
    resolved
}
