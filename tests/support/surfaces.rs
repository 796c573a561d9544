//! Surfaces of scenes without objects.

use caustica::scene::{ResolvedScene, Scene};
use caustica::waves::Surface;

/// The surface of `scene` at its moment.
pub(crate) fn surface_of(scene: &Scene) -> Surface {
    refined_surface(scene, 1)
}

/// The same from grids with `refinement` times as many samples.
pub(crate) fn refined_surface(scene: &Scene, refinement: u32) -> Surface {
    Surface::refined(&ResolvedScene::bare(scene.clone()), refinement).unwrap()
}
