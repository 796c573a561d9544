//! Where the irradiance maps of the receivers lie in the arrays that hold them all.
//!
//! The flux sums of a light hold the floor's map, then for each wet object its layers, nearest first. The irradiance array holds the
//! floor's map, to which every light adds, then the objects' maps of the first light, of the second, and so on. Maps that the output
//! does not need have no place: light that lands there only enters the energy account.

use std::ops::Range;

use crate::facts::{FloorMap, SceneFacts};
use crate::scene::Receiver;

/// Offset of a map that is not requested, as in `shaders/shared/receivers.wgsl`.
pub const NOWHERE: u32 = u32::MAX;

/// The maps of an object.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ObjectMaps {
    /// First texel in the flux sums.
    first: u64,
    /// Texels of a layer; of a dry object 0.
    texels: u64,
    /// The requested layers.
    layers: Range<u32>,
}

/// The maps of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapLayout {
    floor: u64,
    objects: Vec<ObjectMaps>,
    /// Texels of all objects under one light.
    per_light: u64,
    lights: u64,
}

impl MapLayout {
    /// The layout for a scene.
    pub fn of(facts: &SceneFacts) -> Self {
        Self::with_floor(facts, facts.receivers.floor_map)
    }

    /// The layout for a scene with another map of the floor.
    pub fn with_floor(facts: &SceneFacts, floor_map: Option<FloorMap>) -> Self {
        let floor = floor_map.map_or(0, |map| u64::from(map.width) * u64::from(map.height));
        let mut end = floor;
        let objects = facts
            .receivers
            .objects
            .iter()
            .enumerate()
            .map(|(number, object)| {
                let side = if object.wet {
                    u64::from(object.map_texels)
                } else {
                    0
                };
                let maps = ObjectMaps {
                    first: end,
                    texels: side * side,
                    layers: requested_layers(facts, number),
                };
                end += maps.layers.len() as u64 * maps.texels;
                maps
            })
            .collect();
        Self {
            floor,
            objects,
            per_light: end - floor,
            lights: facts.lights.lit.len() as u64,
        }
    }

    /// Texels of the caustics map of one plane, which lies behind the flux sums of a light: as many as the largest object's map has.
    pub fn scratch_texels(&self) -> u64 {
        self.objects
            .iter()
            .map(|maps| maps.texels)
            .max()
            .unwrap_or(0)
    }

    /// First texel of that map.
    pub fn scratch(&self) -> u32 {
        narrow(self.flux_texels())
    }

    /// Texels of the flux sums of one light.
    pub fn flux_texels(&self) -> u64 {
        self.floor + self.per_light
    }

    /// Texels of all objects' maps of one light.
    pub fn object_texels(&self) -> u64 {
        self.per_light
    }

    /// Texels of all irradiance maps.
    pub fn irradiance_texels(&self) -> u64 {
        self.floor + self.per_light * self.lights
    }

    /// Whether a layer of an object is requested.
    pub fn holds(&self, object: usize, layer: u32) -> bool {
        self.objects[object].layers.contains(&layer)
    }

    /// First texel of a layer of an object in the flux sums; [`NOWHERE`] if the layer is not requested.
    pub fn flux_of(&self, object: usize, layer: u32) -> u32 {
        self.place(object, layer).map_or(NOWHERE, narrow)
    }

    /// First texel of a layer of an object under light number `light` in the irradiance array; [`NOWHERE`] if it is not requested.
    pub fn irradiance_of(&self, light: usize, object: usize, layer: u32) -> u32 {
        let place = self.place(object, layer);
        place.map_or(NOWHERE, |first| {
            narrow(first + light as u64 * self.per_light)
        })
    }

    fn place(&self, object: usize, layer: u32) -> Option<u64> {
        let maps = &self.objects[object];
        let before = layer.wrapping_sub(maps.layers.start);
        self.holds(object, layer)
            .then(|| maps.first + u64::from(before) * maps.texels)
    }
}

/// Layers of an object that the output reads: a camera reads all, an irradiance map is one. A method that does not light meshes by hits
/// needs all of them, because it lights every object that its rays hit.
fn requested_layers(facts: &SceneFacts, object: usize) -> Range<u32> {
    if !facts.method.lights_meshes_by_hits {
        return 0..facts.quality.layers;
    }
    match facts.output.receiver {
        Some(Receiver::Object(wanted)) if wanted as usize == object => {
            facts.output.receiver_layer..facts.output.receiver_layer + 1
        }
        Some(_) => 0..0,
        None => 0..facts.quality.layers,
    }
}

/// Buffers too long for u32 are refused before anything runs.
fn narrow(texel: u64) -> u32 {
    u32::try_from(texel).unwrap_or(NOWHERE)
}
