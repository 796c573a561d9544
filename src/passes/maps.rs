//! Where the irradiance maps of the receivers lie in the arrays that hold them all.
//!
//! In the flux sums of a sun: the floor's map, then for each wet object its layers, nearest first. In the irradiance array: the
//! floor's map, to which every sun adds, then the objects' maps of the first sun, of the second, and so on.

use crate::scene::facts::SceneFacts;

/// The maps of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapLayout {
    floor: u64,
    /// Per object: first texel in the flux sums and texels of a layer; of dry ones 0 texels.
    objects: Vec<(u64, u64)>,
    layers: u64,
    /// Texels of all objects under one sun.
    per_sun: u64,
    suns: u64,
}

impl MapLayout {
    /// The layout for a scene.
    pub fn of(facts: &SceneFacts) -> Self {
        let layers = u64::from(facts.quality.layers);
        let floor = facts
            .floor_map
            .map_or(0, |map| u64::from(map.width) * u64::from(map.height));
        let mut end = floor;
        let objects = facts
            .objects
            .iter()
            .map(|object| {
                let side = if object.wet {
                    u64::from(object.map_texels)
                } else {
                    0
                };
                let first = end;
                end += layers * side * side;
                (first, side * side)
            })
            .collect();
        Self {
            floor,
            objects,
            layers,
            per_sun: end - floor,
            suns: facts.suns.len() as u64,
        }
    }

    /// Texels, behind the flux sums of a sun, of the caustics map of one plane: as many as the largest object's map has.
    pub fn scratch_texels(&self) -> u64 {
        self.objects
            .iter()
            .map(|&(_, texels)| texels)
            .max()
            .unwrap_or(0)
    }

    /// The first of those.
    pub fn scratch(&self) -> u32 {
        narrow(self.flux_texels())
    }

    /// Texels of the flux sums of one sun.
    pub fn flux_texels(&self) -> u64 {
        self.floor + self.per_sun
    }

    /// Texels of all objects' maps of one sun.
    pub fn object_texels(&self) -> u64 {
        self.per_sun
    }

    /// Texels of all irradiance maps.
    pub fn irradiance_texels(&self) -> u64 {
        self.floor + self.per_sun * self.suns
    }

    /// Texels of a layer of an object's map.
    pub fn texels_of(&self, object: usize) -> u64 {
        self.objects[object].1
    }

    /// First texel of a layer of an object in the flux sums.
    pub fn flux_of(&self, object: usize, layer: u32) -> u32 {
        let (first, texels) = self.objects[object];
        narrow(first + u64::from(layer) * texels)
    }

    /// First texel of a layer of an object under sun number `sun` in the irradiance array.
    pub fn irradiance_of(&self, sun: usize, object: usize, layer: u32) -> u32 {
        let (first, texels) = self.objects[object];
        narrow(first + sun as u64 * self.per_sun + u64::from(layer) * texels)
    }
}

/// Buffers this long are refused before anything runs.
fn narrow(texel: u64) -> u32 {
    u32::try_from(texel).unwrap_or(u32::MAX)
}
