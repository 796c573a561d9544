//! The receivers of light: the floor, and objects.

use glam::{DVec2, DVec3};

use super::SceneFacts;
use super::placement::ObjectFacts;
use super::window::Rect;
use crate::scene::{Receiver, ResolvedScene};

/// The receivers.
#[derive(Clone, Debug)]
pub struct ReceiverFacts {
    /// The floor.
    pub floor: Option<FloorFacts>,
    /// The floor's irradiance map, if the output needs one.
    pub floor_map: Option<FloorMap>,
    /// The objects.
    pub objects: Vec<ObjectFacts>,
    /// Bytes of hierarchies (32 a node) and triangles (64 each) of the distinct meshes.
    pub geometry_bytes: u64,
}

/// The floor.
#[derive(Clone, Debug)]
pub struct FloorFacts {
    /// Height, m (negative).
    pub y_m: f64,
    /// Its rectangle.
    pub rect: Rect,
    /// Diffuse reflectance.
    pub albedo: [f64; 3],
}

/// An irradiance map on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorMap {
    /// The rectangle it covers.
    pub rect: Rect,
    /// Texels along x.
    pub width: u32,
    /// Texels along z.
    pub height: u32,
}

impl ReceiverFacts {
    /// The receivers around the local origin `origin_m`, under waves of at most `max_height_m`. The floor's map is sized later, when the
    /// output is known.
    pub(super) fn of(resolved: &ResolvedScene, origin_m: DVec3, max_height_m: f64) -> Self {
        let floor = resolved.scene.floor.as_ref().map(|f| {
            let centre = DVec2::from(f.center_m) - DVec2::new(origin_m.x, origin_m.z);
            let half = DVec2::from(f.size_m) * 0.5;
            FloorFacts {
                y_m: -f.depth_m,
                rect: Rect {
                    min: centre - half,
                    max: centre + half,
                },
                albedo: f.albedo,
            }
        });
        Self {
            floor,
            floor_map: None,
            objects: resolved.placed_objects(origin_m, max_height_m),
            geometry_bytes: geometry_bytes(resolved),
        }
    }

    /// Indices of objects that light under water can hit.
    pub fn wet_objects(&self) -> impl Iterator<Item = usize> + '_ {
        self.objects
            .iter()
            .enumerate()
            .filter(|(_, o)| o.wet)
            .map(|(i, _)| i)
    }
}

impl SceneFacts {
    /// Indices of objects that light under water can hit.
    pub fn wet_objects(&self) -> impl Iterator<Item = usize> + '_ {
        self.receivers.wet_objects()
    }

    /// Whether the output needs light on a receiver under water.
    pub fn has_receiver(&self) -> bool {
        match self.output.receiver {
            Some(Receiver::Floor(_)) => self.receivers.floor_map.is_some(),
            Some(Receiver::Object(index)) => {
                let object = self.receivers.objects.get(index as usize);
                object.is_some_and(|o| o.wet)
            }
            None => {
                self.output.wants_irradiance()
                    && (self.receivers.floor_map.is_some() || self.wet_objects().next().is_some())
            }
        }
    }
}

fn geometry_bytes(resolved: &ResolvedScene) -> u64 {
    let distinct: std::collections::BTreeMap<&str, u64> = resolved
        .meshes
        .iter()
        .map(|m| {
            (
                m.id.as_str(),
                32 * m.hierarchy.len() as u64 + 64 * m.triangles.len() as u64,
            )
        })
        .collect();
    distinct.values().sum()
}
