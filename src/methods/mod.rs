//! The methods: one folder per method, published or ours, with its description, passes and shaders, and one line in [`ALL`]. Everything
//! that needs the methods walks that list: planner, schema, flags, sweeps, tests, README.
//!
//! Beside the folders: `check` validates a scene's choice of a method; `describe` makes schema, flags and dials of sweeps from the list;
//! `reference_planes` has the dial shared by methods that slice objects.
//!
//! A method reads shared slots (water surface, beams, receivers, points) and makes one product. How to add one:
//! `docs/adding-a-method.md`.

pub mod caustic_volume;
mod check;
mod describe;
pub mod irradiance_volume;
pub mod level_map;
pub mod photon;
pub mod planes;
pub mod reference_planes;
pub mod sub_volume;
pub mod volumetric;

pub use check::{check, misfits, resolve, shortest, validate};
pub use describe::{fields, schema};

use crate::facts::{MethodFacts, SceneFacts};
use crate::gpu::shader::ShaderSources;
use crate::graph::plan::Phase;
use crate::scene::{Dial, Issue, MethodChoice, Quality, ResolvedScene, SceneError};
use crate::stages::shaders::Embedded;
use crate::stages::{AFTER_MAPS, BEFORE_METHOD, PICTURE, Pass, shaders};

/// Declares [`ALL`], with its length.
macro_rules! list {
    ($($method:ident),+ $(,)?) => {
        /// All methods; the first is the default.
        pub static ALL: [&Method; [$(stringify!($method)),+].len()] = [$(&$method::METHOD),+];
    };
}

list![
    level_map,
    planes,
    volumetric,
    photon,
    caustic_volume,
    sub_volume,
    irradiance_volume,
];

/// A method.
pub struct Method {
    /// Its name in `quality.method`, in snake case; also the name of its folders.
    pub name: &'static str,
    /// What it does: one sentence without initial capital and full stop.
    pub summary: &'static str,
    /// Where it was published: author, year, chapter.
    pub paper: &'static str,
    /// Its own dials, fields of the object `quality.method`; other methods may have them too.
    pub dials: &'static [&'static Dial],
    /// Fields of `quality`, shared by all methods, that trade its accuracy for time.
    pub shared_dials: &'static [&'static str],
    /// Its WGSL files, by `embed_shaders!` of [`crate::stages::shaders`].
    pub shaders: Embedded,
    /// Its passes, in the order they run: passes that trace light between [`BEFORE_METHOD`] and [`AFTER_MAPS`], passes that work on
    /// points between [`AFTER_MAPS`] and [`PICTURE`].
    pub passes: &'static [&'static Pass],
    /// Expected order of convergence: the power of the cell size with which its error falls where the light sheet does not fold; 0 if the
    /// error does not go to 0 with more cells.
    pub expected_order: f64,
    /// Whether `target_error` and `time_budget_ms` can choose its dials; the table of settings was measured with it.
    pub dials_can_be_chosen: bool,
    /// Its properties for the stages, given the dials.
    pub facts: fn(&Quality) -> MethodFacts,
    /// Whether it can render a scene; if not, a reason for the user.
    pub supports: fn(&SceneFacts) -> Result<(), String>,
    /// Its requirements in the conformance suite (`tests/gpu/conformance.rs`).
    pub conformance: Conformance,
}

/// Requirements of the conformance suite for a method.
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
    /// Its own dial of this name.
    pub fn dial(&self, name: &str) -> Option<&'static Dial> {
        self.dials.iter().copied().find(|dial| dial.name == name)
    }

    /// Its properties for the stages, with all dials at their defaults.
    pub fn facts_of_default(&self) -> MethodFacts {
        (self.facts)(&Quality::default())
    }

    /// Checks that it can render a scene with these facts.
    ///
    /// # Errors
    /// Its reason against the scene, and the other methods.
    pub fn accepts(&self, facts: &SceneFacts) -> Result<(), SceneError> {
        (self.supports)(facts).map_err(|reason| unsupported(self, reason))
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

/// The method that `quality` names. An unknown name gives the default method; [`check`] refuses such scenes.
pub fn of(quality: &Quality) -> &'static Method {
    let kind = quality.method.kind.as_deref();
    let found = ALL
        .into_iter()
        .find(|method| kind.is_some_and(|kind| method.name == kind));
    found.unwrap_or(ALL[0])
}

/// Every method; a method with word-valued dials appears once for each word. Tests and hard cases about all methods run these choices.
pub fn variants() -> Vec<MethodChoice> {
    let mut all = Vec::new();
    for method in ALL {
        let plain = MethodChoice::named(method.name);
        let words = method.dials.iter().flat_map(|dial| {
            let words = dial.words().into_iter();
            words.map(|word| MethodChoice::named(method.name).with(dial, word))
        });
        let mut of_method: Vec<MethodChoice> = words.collect();
        if of_method.is_empty() {
            of_method.push(plain);
        }
        all.extend(of_method);
    }
    all
}

/// All WGSL files: the shared ones and those of every method.
pub fn embedded() -> ShaderSources {
    let own = ALL.into_iter().flat_map(|method| method.shaders);
    let files: Vec<_> = shaders::SHARED.iter().chain(own).copied().collect();
    ShaderSources::new(&files)
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

/// The facts of a scene that [`resolve`] has accepted. Their only warnings are those about lights that are left out.
///
/// # Errors
/// Those of [`SceneFacts::of`], and a method that cannot render the scene.
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
    // Scenes constructed in Rust may arrive unchecked.
    let issues = check(quality);
    if !issues.is_empty() {
        return Err(SceneError { issues });
    }
    let method = of(quality);
    let facts = facts(resolved, (method.facts)(quality))?;
    method.accepts(&facts)?;
    Ok(facts)
}

/// Why the method of a scene cannot render it although another choice of method or dials might; `None` if it can.
///
/// # Errors
/// Faults of the scene that do not depend on the method.
pub fn reason_against(resolved: &ResolvedScene) -> Result<Option<String>, SceneError> {
    let quality = &resolved.scene.quality;
    let misfits = misfits(quality);
    if !misfits.is_empty() {
        let reasons: Vec<String> = misfits.into_iter().map(|issue| issue.detail).collect();
        return Ok(Some(reasons.join("; ")));
    }
    let issues = check(quality);
    if !issues.is_empty() {
        return Err(SceneError { issues });
    }
    let method = of(quality);
    let facts = SceneFacts::of(resolved, (method.facts)(quality))?;
    Ok((method.supports)(&facts).err())
}

fn unsupported(method: &Method, reason: String) -> SceneError {
    let others = ALL.into_iter().filter(|other| other.name != method.name);
    let pointer = crate::scene::overrides::METHOD;
    SceneError::from(Issue::invalid(pointer, reason, check::methods(others)))
}
