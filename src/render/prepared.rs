//! A scene as it goes to the GPU thread: with all that can be known of it before.

use std::time::Instant;

use super::ms_since;
use crate::facts::SceneFacts;
use crate::methods;
use crate::scene::{ResolvedScene, SceneError};
use crate::tuning::chooses_dials;

/// A scene with its facts, its warnings and its hash. Made where the request is, so that the GPU thread has only to plan and render:
/// the scenes of this project take up to 3 ms, for the light of a sky and the windows of point lights, and rays for warnings more.
#[derive(Clone, Debug)]
pub struct Prepared {
    resolved: ResolvedScene,
    facts: SceneFacts,
    scene_hash: String,
    took_ms: f64,
}

impl Prepared {
    /// Finds facts and warnings of a scene. Where [its dials are chosen](Self::asks_for_dials) facts of the dials as they stand, to
    /// find errors early, and no warnings: they are those of the chosen dials, which only the GPU thread knows.
    ///
    /// # Errors
    /// When the scene cannot be rendered, whatever the GPU.
    pub fn new(resolved: ResolvedScene) -> Result<Self, SceneError> {
        let started = Instant::now();
        let facts = if chooses_dials(&resolved.scene.quality) {
            methods::facts(&resolved)?
        } else {
            methods::facts_with_warnings(&resolved)?
        };
        Ok(Self::of(resolved, facts, started))
    }

    /// The same scene at another moment, such as the next frame of an animation: just what [`new`](Self::new) makes of it, but what
    /// does not depend on time is taken over. `time_s` has to be valid, as in a validated scene.
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
            resolved,
            facts,
            took_ms: ms_since(started),
        }
    }

    /// The same scene with other facts than its own: for programs that carry light in other beam sets than the scene says.
    #[must_use]
    pub fn with_facts(mut self, change: impl FnOnce(&mut SceneFacts)) -> Self {
        change(&mut self.facts);
        self
    }

    /// The scene and its meshes.
    pub fn resolved(&self) -> &ResolvedScene {
        &self.resolved
    }

    /// Its facts, with all warnings that can be found before rendering; without them where [its dials are
    /// chosen](Self::asks_for_dials).
    pub fn facts(&self) -> &SceneFacts {
        &self.facts
    }

    /// `blake3:…` of the canonical scene.
    pub fn scene_hash(&self) -> &str {
        &self.scene_hash
    }

    /// What preparing it took, ms; a part of `stats.time_ms.plan`.
    pub fn took_ms(&self) -> f64 {
        self.took_ms
    }

    /// Whether `quality` asks for an error or a time, from which the renderer chooses the dials.
    pub fn asks_for_dials(&self) -> bool {
        chooses_dials(&self.resolved.scene.quality)
    }
}
