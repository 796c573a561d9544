//! Facts of a scene: the values that decide which work a frame needs, computed once, without a GPU.
//!
//! Everything is in *local* coordinates. The origin lies on the water at rest, in the middle of the output's region, so that f32 is as
//! accurate far from the world's origin as near it.
//!
//! - [`water`]: surface and optics; [`lights`]: sources and their beam sets; [`receivers`]: floor and objects; [`output`]: camera, layers,
//!   the receiver of a map;
//! - [`field`]: the box in which a method keeps light between surface and floor;
//! - `placement`: objects and the boxes of their level maps; `detail`: texels of those maps, by the object's size in the picture;
//!   `source`: where light comes from; `window`, `lamp_window`: the water through which light reaches the receivers;
//! - `legs`: how camera rays split at the water;
//! - `warnings`: what is left out or sub-sampled; `height_fields`: the same of water that users bring; `unfollowed`, `blocked`: how much
//!   light that concerns;
//! - `moment`: which facts change with time.

mod blocked;
mod detail;
pub mod field;
mod height_fields;
mod lamp_window;
mod legs;
pub mod lights;
pub mod method;
mod moment;
pub mod output;
pub mod placement;
pub mod receivers;
pub mod source;
pub mod unfollowed;
pub mod warnings;
pub mod water;
pub mod window;

use glam::{DVec2, DVec3};

pub use self::field::{FieldBox, FieldKey};
pub use self::legs::Legs;
pub use self::lights::{BeamSet, LightsFacts, LitLight, MOST_LIGHTS, SkyFacts};
pub use self::method::{MethodFacts, Product};
pub use self::output::{CameraFacts, OutputFacts, WaterMapFacts};
pub use self::receivers::{FloorFacts, FloorMap, ReceiverFacts};
pub use self::water::{Band, WaterFacts};
use crate::scene::{Output, Quality, Receiver, ResolvedScene, SceneError};
use crate::stats::Warning;

/// The facts of a scene.
#[derive(Clone, Debug)]
pub struct SceneFacts {
    /// World position of the local origin, m.
    pub origin_m: DVec3,
    /// The water.
    pub water: WaterFacts,
    /// The lights.
    pub lights: LightsFacts,
    /// What receives light.
    pub receivers: ReceiverFacts,
    /// The requested output.
    pub output: OutputFacts,
    /// The box of the field, for methods that make one.
    pub field: Option<FieldBox>,
    /// Properties of the method that the stages need.
    pub method: MethodFacts,
    /// The dials, reduced to what the output uses.
    pub quality: Quality,
    /// Whether the adapter can blend into textures of 32-bit floats. True until a renderer knows better.
    pub blends_float32: bool,
    /// Warnings about what is not simulated.
    pub warnings: Vec<Warning>,
}

impl SceneFacts {
    /// The facts of a validated scene that is rendered with `method`. Its only warnings are those about lights that are left out.
    ///
    /// # Errors
    /// Too many lights in the air, lights whose refracted rays are too flat to trace, and seas that are too choppy at this moment.
    pub fn of(resolved: &ResolvedScene, method: MethodFacts) -> Result<Self, SceneError> {
        let scene = &resolved.scene;
        let origin_m = match method.product {
            Product::Field if !scene_fixes_box(&scene.output) => field::origin(origin(resolved)),
            _ => origin(resolved),
        };
        let surface = water::surface_around(resolved, origin_m)?;
        let mut quality = scene.quality.clone();
        let output = OutputFacts::of(scene, origin_m);
        if output.is_floor_map() {
            // The objects' maps are unused.
            quality.layers = 1;
        }
        let mut facts = Self {
            origin_m,
            lights: LightsFacts::of(scene, origin_m, &surface)?,
            receivers: ReceiverFacts::of(resolved, origin_m, surface.max_height_m()),
            water: WaterFacts::of(&scene.water, surface),
            output,
            field: None,
            method,
            quality,
            blends_float32: true,
            warnings: Vec::new(),
        };
        facts.size_floor_map(&scene.output);
        facts.size_maps();
        facts.place_field();
        facts.find_lights(resolved)?;
        facts.name_fields(resolved);
        Ok(facts)
    }

    /// Like [`of`](Self::of), and adds every warning that can be found before rendering. To find shadows it sends rays through the
    /// meshes, which nothing but the warnings needs.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn with_warnings(
        resolved: &ResolvedScene,
        method: MethodFacts,
    ) -> Result<Self, SceneError> {
        let mut facts = Self::of(resolved, method)?;
        let found = warnings::warnings(&facts, resolved);
        facts.warnings.extend(found);
        Ok(facts)
    }

    /// Number of colour channels to trace: 1 if all channels of all beam sets have the same extinction, else 3.
    pub fn channels(&self) -> u32 {
        let sets = self.lights.beam_sets.iter();
        sets.map(|set| set.band.channels())
            .max()
            .unwrap_or_else(|| self.water.band().channels())
    }

    /// Whether the water absorbs or scatters any light.
    pub fn attenuates(&self) -> bool {
        self.water.attenuates()
    }
}

/// Whether the output alone decides which part of the floor is lit.
fn scene_fixes_box(output: &Output) -> bool {
    matches!(output, Output::IrradianceMap(map) if matches!(map.receiver, Receiver::Floor(_)))
}

/// The local origin: the middle of the output's region, on the water at rest.
fn origin(resolved: &ResolvedScene) -> DVec3 {
    let scene = &resolved.scene;
    let xz = match (&scene.output, &scene.floor) {
        (Output::IrradianceMap(map), Some(floor)) if matches!(map.receiver, Receiver::Floor(_)) => {
            let centre = DVec2::from(floor.center_m);
            let half = DVec2::from(floor.size_m) * 0.5;
            let low = map.min_m.map_or(centre - half, DVec2::from);
            let high = map.max_m.map_or(centre + half, DVec2::from);
            (low + high) * 0.5
        }
        (Output::IrradianceMap(map), _) => match map.receiver {
            Receiver::Object(index) => scene.objects.get(index as usize).map_or(DVec2::ZERO, |o| {
                DVec2::new(o.translation_m[0], o.translation_m[2])
            }),
            Receiver::Floor(_) => DVec2::ZERO,
        },
        (Output::WaterMap(map), floor) => {
            let corners = map.corners_m(floor.as_ref());
            corners.map_or(DVec2::ZERO, |[low, high]| {
                (DVec2::from(low) + DVec2::from(high)) * 0.5
            })
        }
        (Output::View(_), _) => scene.camera.as_ref().map_or(DVec2::ZERO, |camera| {
            let (_, target, _) = camera.pose();
            DVec2::new(target[0], target[2])
        }),
    };
    DVec3::new(xz.x, scene.water.level_m, xz.y)
}
