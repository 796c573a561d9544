//! Computes the facts, warnings and hash of a scene before it is sent to the GPU thread.

use std::time::Instant;

use super::ms_since;
use crate::facts::SceneFacts;
use crate::methods;
use crate::scene::{ResolvedScene, SceneError};
use crate::stages::Pass;
use crate::tuning::chooses_dials;

/// A scene with its facts, its warnings and its hash. Computed on the thread of the request, so that the GPU thread only has to plan and
/// render. The scenes of this project take up to 3 ms, for the light of a sky and the windows of point lights; the rays for warnings take
/// longer.
#[derive(Clone, Debug)]
pub struct Prepared {
    resolved: ResolvedScene,
    facts: SceneFacts,
    scene_hash: String,
    took_ms: f64,
    passes: Vec<&'static Pass>,
}

impl Prepared {
    /// Finds facts and warnings of a scene. If [its dials are to be chosen](Self::asks_for_dials), the facts are those of the current dials,
    /// to find errors early, and there are no warnings: these depend on the chosen dials, which only the GPU thread knows.
    ///
    /// # Errors
    /// When the scene cannot be rendered, whatever the GPU.
    pub fn new(resolved: ResolvedScene) -> Result<Self, SceneError> {
        let started = Instant::now();
        let facts = if chooses_dials(&resolved.scene) {
            methods::facts(&resolved)?
        } else {
            methods::facts_with_warnings(&resolved)?
        };
        Ok(Self::of(resolved, facts, started))
    }

    /// The same scene at another time, such as the next frame of an animation. The result equals that of [`new`](Self::new), but facts
    /// that do not depend on time are reused. `time_s` must be valid, as in a validated scene.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn at(&self, time_s: f64) -> Result<Self, SceneError> {
        let started = Instant::now();
        let mut resolved = self.resolved.clone();
        resolved.scene.time_s = time_s;
        match self.facts.at_time_of(&resolved) {
            Some(facts) => Ok(Self::of(resolved, facts, started)),
            None => Self::new(resolved),
        }
    }

    fn of(resolved: ResolvedScene, facts: SceneFacts, started: Instant) -> Self {
        Self {
            scene_hash: resolved.hash(),
            passes: methods::of(&resolved.scene.quality).pipeline(),
            resolved,
            facts,
            took_ms: ms_since(started),
        }
    }

    /// The same scene with other passes than those of its method: for programs that try a method without putting it into the list.
    #[must_use]
    pub fn with_passes(mut self, passes: Vec<&'static Pass>) -> Self {
        self.passes = passes;
        self
    }

    /// All passes that may run, in order: those of the scene's method unless [replaced](Self::with_passes).
    pub fn passes(&self) -> &[&'static Pass] {
        &self.passes
    }

    /// The same scene with changed facts: for programs that trace other beam sets than the scene has.
    #[must_use]
    pub fn with_facts(mut self, change: impl FnOnce(&mut SceneFacts)) -> Self {
        change(&mut self.facts);
        self
    }

    /// The scene and its meshes.
    pub fn resolved(&self) -> &ResolvedScene {
        &self.resolved
    }

    /// Its facts, with all warnings that can be found before rendering; without warnings if [its dials are to be
    /// chosen](Self::asks_for_dials).
    pub fn facts(&self) -> &SceneFacts {
        &self.facts
    }

    /// `blake3:…` of the canonical scene.
    pub fn scene_hash(&self) -> &str {
        &self.scene_hash
    }

    /// Time of the preparation, ms; a part of `stats.time_ms.plan`.
    pub fn took_ms(&self) -> f64 {
        self.took_ms
    }

    /// Whether `quality` requests an error or a time, so that the renderer chooses the dials.
    pub fn asks_for_dials(&self) -> bool {
        chooses_dials(&self.resolved.scene)
    }
}
