//! The facts of a scene at another moment. Only the surface moves, and nothing but its bounds is in the other facts: except for point
//! lights, which are over or under the water of their place.

use super::SceneFacts;
use super::source::Source;
use super::water::surface_around;
use crate::scene::ResolvedScene;

impl SceneFacts {
    /// The facts and warnings of `resolved`, which differs from the scene of these facts in `time_s` only. `None` where more than the
    /// surface changes, so that they have to be found anew.
    pub fn at_time_of(&self, resolved: &ResolvedScene) -> Option<Self> {
        let scene = &resolved.scene;
        let surface = surface_around(scene, self.origin_m);
        // Windows, dry objects, level maps and warnings are made from these bounds.
        if surface.bounds_change_with_time() {
            return None;
        }
        // A light that the water rises over shines into it in another way, through other beam sets.
        let moved = scene.lights.iter().any(|light| {
            let source = |surface| Source::of(light, self.origin_m, surface);
            source(&surface) != source(&self.water.surface)
        });
        if moved {
            return None;
        }
        let mut facts = self.clone();
        facts.water.surface = surface;
        Some(facts)
    }
}
