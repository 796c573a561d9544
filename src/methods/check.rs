//! Validation of a scene's choice of method and dials against the list of methods.

use super::{ALL, Method};
use crate::config::Limits;
use crate::scene::names::meant;
use crate::scene::overrides::METHOD;
use crate::scene::parse::{one_of, quoted};
use crate::scene::pointer::member;
use crate::scene::{
    self, Assets, DialValue, Issue, MethodChoice, Quality, ResolvedScene, Scene, SceneError,
};

/// Most findings about the dials of a method that are listed.
const MOST_ISSUES: usize = 20;

/// Validates a scene, its method included, and looks up the mesh of every object. The choice of method is reduced to its shortest form, so
/// that equivalent scenes have the same hash.
///
/// # Errors
/// The findings of [`scene::resolve`] and [`check`] together.
pub fn resolve(
    scene: Scene,
    limits: &Limits,
    assets: impl Assets,
) -> Result<ResolvedScene, SceneError> {
    let of_method = check(&scene.quality);
    let mut resolved = joined(scene::resolve(scene, limits, assets), of_method)?;
    let quality = &mut resolved.scene.quality;
    quality.method = shortest(&quality.method);
    Ok(resolved)
}

/// Checks every range and reference of a scene, those of its method included.
///
/// # Errors
/// The findings of [`Scene::validate`] and [`check`] together.
pub fn validate(scene: &Scene, limits: &Limits) -> Result<(), SceneError> {
    joined(scene.validate(limits), check(&scene.quality))
}

fn joined<T>(result: Result<T, SceneError>, more: Vec<Issue>) -> Result<T, SceneError> {
    match result {
        Err(mut error) => {
            error.issues.extend(more);
            Err(error)
        }
        Ok(_) if !more.is_empty() => Err(SceneError { issues: more }),
        Ok(done) => Ok(done),
    }
}

/// Faults of the method in `quality` and its dials, and requests that this method cannot meet.
pub fn check(quality: &Quality) -> Vec<Issue> {
    let method = match named(&quality.method) {
        Ok(method) => method,
        Err(issue) => return vec![issue],
    };
    let mut issues = misfits(quality);
    for (name, value) in &quality.method.dials {
        let dial = method.dial(name);
        issues.extend(dial.and_then(|dial| dial.issue_with(value)).map(|issue| {
            let pointer = pointer_to(name);
            Issue { pointer, ..issue }
        }));
    }
    let unlisted = issues.len().saturating_sub(MOST_ISSUES);
    if unlisted > 0 {
        issues.truncate(MOST_ISSUES);
        let detail = format!("{unlisted} more findings about its dials are not listed");
        issues.push(Issue::invalid(METHOD, detail, ""));
    }
    issues
}

/// Requests that this method does not support: dials of other methods, and `target_error` or `time_budget_ms`. Another method may support
/// them, so sweeps over methods skip these settings.
pub fn misfits(quality: &Quality) -> Vec<Issue> {
    let Ok(method) = named(&quality.method) else {
        return Vec::new();
    };
    let names = quality.method.dials.keys();
    let foreign = names.filter(|name| method.dial(name).is_none());
    let mut issues: Vec<Issue> = foreign.map(|name| no_dial(method, name)).collect();
    let asks_for_dials = quality.target_error.is_some() || quality.time_budget_ms.is_some();
    if asks_for_dials && !method.dials_can_be_chosen {
        let reason = format!(
            "target_error and time_budget_ms cannot choose the dials of method {}",
            method.name
        );
        let choosing = ALL.into_iter().filter(|other| other.dials_can_be_chosen);
        issues.push(Issue::invalid(METHOD, reason, methods(choosing)));
    }
    issues
}

/// The chosen method.
fn named(choice: &MethodChoice) -> Result<&'static Method, Issue> {
    let Some(kind) = &choice.kind else {
        return Ok(ALL[0]);
    };
    let found = ALL.into_iter().find(|method| method.name == kind);
    found.ok_or_else(|| {
        let names = ALL.map(|method| method.name);
        let detail = match meant(kind, &names) {
            Some(name) => format!("unknown method `{}`; did you mean `{name}`?", quoted(kind)),
            None => format!("unknown method `{}`", quoted(kind)),
        };
        let pointer = match choice.dials.is_empty() {
            true => METHOD.to_owned(),
            false => pointer_to(scene::dials::KIND),
        };
        Issue::invalid(pointer, detail, one_of(&names))
    })
}

fn no_dial(method: &Method, name: &str) -> Issue {
    let own: Vec<&str> = method.dials.iter().map(|dial| dial.name).collect();
    let mut detail = format!("method {} has no dial `{}`", method.name, quoted(name));
    let others = ALL.into_iter().filter(|other| other.dial(name).is_some());
    let others: Vec<&str> = others.map(|other| other.name).collect();
    match (meant(name, &own), others.is_empty()) {
        (Some(meant), _) => detail.push_str(&format!("; did you mean `{meant}`?")),
        (None, false) => detail.push_str(&format!("; it belongs to {}", one_of(&others))),
        (None, true) => {}
    }
    let accepted = match own.as_slice() {
        [] => "no dials of its own".to_owned(),
        own => format!("the dials {}", one_of(own)),
    };
    Issue::invalid(pointer_to(name), detail, accepted)
}

fn pointer_to(name: &str) -> String {
    format!("{METHOD}{}", member(name))
}

/// The same choice without redundant parts: the name of the default method, and dials at their defaults.
pub fn shortest(choice: &MethodChoice) -> MethodChoice {
    let Ok(method) = named(choice) else {
        return choice.clone();
    };
    let is_set = |name: &str, value: &DialValue| {
        method
            .dial(name)
            .is_none_or(|dial| dial.default_value() != *value)
    };
    let dials = choice.dials.iter();
    MethodChoice {
        kind: (method.name != ALL[0].name).then(|| method.name.to_owned()),
        dials: dials
            .filter(|(name, value)| is_set(name, value))
            .map(|(name, value)| (name.clone(), value.clone()))
            .collect(),
    }
}

/// A list of methods, as the text about accepted values.
pub(super) fn methods(methods: impl Iterator<Item = &'static Method>) -> String {
    let names: Vec<&str> = methods.map(|method| method.name).collect();
    match names.as_slice() {
        [] => "no method".to_owned(),
        [one] => format!("method `{one}`"),
        names => format!("another method: {}", one_of(names)),
    }
}
