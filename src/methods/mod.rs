//! The methods: one folder per published method and ours, each with a description, its passes and its shaders; one line each in
//! [`ALL`]. Everything that has to know which methods there are walks that list: planner, schema, flags, sweeps, tests, README.
//!
//! A method reads shared slots (water surface, beams, receivers, points) and makes one product. How to add one:
//! `docs/adding-a-method.md`.

pub mod level_map;
pub mod planes;
pub mod volumetric;

use crate::facts::{MethodFacts, SceneFacts};
use crate::graph::plan::Phase;
use crate::scene::{Issue, Quality, ResolvedScene, SceneError};
use crate::stages::{AFTER_MAPS, BEFORE_METHOD, PICTURE, Pass};

/// All methods; the first is the default.
pub static ALL: [&Method; 3] = [&level_map::METHOD, &planes::METHOD, &volumetric::METHOD];

/// A method.
pub struct Method {
    /// Its name in `quality.method`.
    pub name: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// Where it was published: author, year, chapter.
    pub paper: &'static str,
    /// Fields of `quality` that trade its accuracy for time.
    pub dials: &'static [&'static str],
    /// Its passes, in the order they run: those that follow light between [`BEFORE_METHOD`] and [`AFTER_MAPS`], those that work on
    /// points between [`AFTER_MAPS`] and [`PICTURE`].
    pub passes: &'static [&'static Pass],
    /// The power of the cells' size with which its error is expected to fall where the light sheet does not fold; 0 where it does not
    /// go to 0 with more cells.
    pub expected_order: f64,
    /// Whether `target_error` and `time_budget_ms` can choose its dials: their rungs were measured with it.
    pub dials_can_be_chosen: bool,
    /// What the stages need to know of it, for some dials.
    pub facts: fn(&Quality) -> MethodFacts,
    /// Whether it can make what a scene asks for, or a reason that a reader understands.
    pub supports: fn(&SceneFacts) -> Result<(), String>,
    /// What the conformance suite (`tests/gpu/conformance.rs`) holds it to.
    pub conformance: Conformance,
}

/// What the conformance suite holds a method to.
pub struct Conformance {
    /// Largest relative L1 error on the floor of `scenes/sine_pool.json` with 256 water cells.
    pub sine_pool_error_at_256: f64,
    /// Cases that it skips, each with the reason.
    pub skips: &'static [(&'static str, &'static str)],
}

impl std::fmt::Debug for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl Method {
    /// What the stages need to know of it, with all dials as they are unless set.
    pub fn facts_of_default(&self) -> MethodFacts {
        (self.facts)(&Quality::default())
    }

    /// All passes of a frame with this method, in the order they run.
    pub fn pipeline(&self) -> Vec<&'static Pass> {
        let own = |in_picture: bool| {
            let passes = self.passes.iter().copied();
            passes
                .filter(move |pass| in_picture == (Phase::of(pass.steps.scope()) == Phase::Picture))
        };
        let before = BEFORE_METHOD.into_iter();
        before
            .chain(own(false))
            .chain(AFTER_MAPS)
            .chain(own(true))
            .chain(PICTURE)
            .collect()
    }
}

/// The method that `quality` names.
pub fn of(quality: &Quality) -> &'static Method {
    let name = quality.method_name();
    let found = ALL.into_iter().find(|method| method.name == name);
    found.unwrap_or(ALL[0])
}

/// All passes of all methods, each once, in the order in which the methods run them.
pub fn all_passes() -> Vec<&'static Pass> {
    let mut all: Vec<&'static Pass> = Vec::new();
    for method in ALL {
        for pass in method.pipeline() {
            if !all.iter().any(|known| known.name == pass.name) {
                all.push(pass);
            }
        }
    }
    all
}

/// The facts of a validated scene; of its warnings only those about lights that are left out.
///
/// # Errors
/// Those of [`SceneFacts::of`], and a method that cannot make what the scene asks for.
pub fn facts(resolved: &ResolvedScene) -> Result<SceneFacts, SceneError> {
    supported(resolved, SceneFacts::of)
}

/// Like [`facts`], and adds every warning that can be found before rendering.
///
/// # Errors
/// As [`facts`].
pub fn facts_with_warnings(resolved: &ResolvedScene) -> Result<SceneFacts, SceneError> {
    supported(resolved, SceneFacts::with_warnings)
}

fn supported(
    resolved: &ResolvedScene,
    facts: impl Fn(&ResolvedScene, MethodFacts) -> Result<SceneFacts, SceneError>,
) -> Result<SceneFacts, SceneError> {
    let quality = &resolved.scene.quality;
    let method = of(quality);
    let asks_for_dials = quality.target_error.is_some() || quality.time_budget_ms.is_some();
    if asks_for_dials && !method.dials_can_be_chosen {
        let reason = format!(
            "target_error and time_budget_ms cannot choose the dials of method {}",
            method.name
        );
        let issue = Issue::invalid("/quality/method", reason, others(method));
        return Err(SceneError {
            issues: vec![issue],
        });
    }
    let facts = facts(resolved, (method.facts)(quality))?;
    match (method.supports)(&facts) {
        Ok(()) => Ok(facts),
        Err(reason) => Err(SceneError {
            issues: vec![Issue::invalid("/quality/method", reason, others(method))],
        }),
    }
}

fn others(method: &Method) -> String {
    let others = ALL.into_iter().filter(|other| other.name != method.name);
    let names: Vec<String> = others.map(|other| format!("`{}`", other.name)).collect();
    format!("another method: {}", names.join(", "))
}
