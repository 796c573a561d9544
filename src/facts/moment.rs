//! The facts of a scene at another time. Only the surface moves, and the other facts depend on its bounds only. Point lights are the
//! exception: each is above or under the water at its place.

use super::SceneFacts;
use super::source::Source;
use super::water::surface_around;
use crate::scene::ResolvedScene;

impl SceneFacts {
    /// The facts and warnings of `resolved`, which differs from the scene of these facts only in `time_s`. `None` if more than the surface
    /// changes and the facts must be computed again, or found to have an error.
    pub fn at_time_of(&self, resolved: &ResolvedScene) -> Option<Self> {
        let scene = &resolved.scene;
        let surface = surface_around(resolved, self.origin_m).ok()?;
        // Windows, dry objects, level maps and warnings depend on these bounds.
        if surface.bounds_change_with_time() {
            return None;
        }
        // If the water rises over a light or falls below it, the light's beam sets change.
        let moved = scene.lights.iter().any(|light| {
            let source = |surface| Source::of(light, self.origin_m, surface);
            source(&surface) != source(&self.water.surface)
        });
        if moved {
            return None;
        }
        let mut facts = self.clone();
        facts.water.surface = surface;
        facts.name_fields(resolved);
        Some(facts)
    }
}
