//! Estimate — compares the maps with those of the light done coarsely: the frame's own estimate of its error.

use super::desc::{Groups, PassDesc, Repeat, Run, Step, Work};
use super::gpu_data::Comparison;
use super::maps::MapLayout;
use super::slot::{self, Slot};
use super::surface::wanted_for_sun;
use crate::scene::Receiver;
use crate::scene::facts::{FloorMap, SceneFacts};

/// Places (texels or blocks of them) of a workgroup, as in the shader.
pub const PLACES_PER_GROUP: u32 = 64 * 4;
/// A map of twice as many places and more is looked at in about so many, spread over it: their mean is the map's to a few hundredths,
/// where the estimate itself is good to a factor of two.
const ENOUGH_PLACES: u32 = 4096;

/// See the module.
pub const PASS: PassDesc = PassDesc {
    name: "estimate",
    repeat: Repeat::Frame,
    reads: &[Slot::Irradiance, Slot::CoarseIrradiance],
    reads_if_present: &[],
    writes: &[Slot::Differences],
    wanted: |facts| {
        wanted(facts)?;
        Ok("the maps are compared with those of the light done coarsely".to_owned())
    },
    steps: |facts, run| {
        let Run::Frame { coarse } = run else {
            return Vec::new();
        };
        compared(facts, coarse)
            .into_iter()
            .map(|(comparison, _)| {
                let groups = groups_of(&comparison);
                let columns = groups.min(slot::MOST_GROUPS);
                Step {
                    entry: "estimate_main",
                    work: Work::Compute(Groups::Direct([columns, groups.div_ceil(columns), 1])),
                    uniforms: vec![("comparison", bytemuck::bytes_of(&comparison).to_vec())],
                }
            })
            .collect()
    },
};

/// Whether the error is to be estimated.
pub(super) fn wanted(facts: &SceneFacts) -> Result<String, String> {
    if !facts.quality.estimate_error {
        return Err("quality.estimate_error is false".to_owned());
    }
    wanted_for_sun(facts)
}

/// Each map that is compared, and the area that a texel which is looked at stands for, m².
pub fn compared(facts: &SceneFacts, coarse: &SceneFacts) -> Vec<(Comparison, f64)> {
    let mut all: Vec<(Comparison, f64)> = Vec::new();
    let mut first_group = 0;
    let mut add = |mut comparison: Comparison, texel_m2: f64| {
        let all_places = if comparison.blocks == 1 {
            comparison.coarse_width * comparison.coarse_height
        } else {
            comparison.fine_width * comparison.fine_height
        };
        comparison.one_in = (all_places / ENOUGH_PLACES).max(1);
        comparison.places = all_places.div_ceil(comparison.one_in);
        comparison.first_group = first_group;
        first_group += groups_of(&comparison);
        let stands_for = f64::from(all_places) / f64::from(comparison.places);
        all.push((comparison, texel_m2 * stands_for));
    };
    if let (Some(fine), Some(low)) = (facts.floor_map, coarse.floor_map) {
        let size = fine.rect.size();
        let comparison = Comparison {
            fine_width: fine.width,
            fine_height: fine.height,
            coarse_width: low.width,
            coarse_height: low.height,
            blocks: u32::from(facts.camera.is_none()),
            ..Comparison::default()
        };
        add(
            comparison,
            size.x * size.y / (f64::from(fine.width) * f64::from(fine.height)),
        );
    }
    let (fine, low) = (MapLayout::of(facts), MapLayout::of(coarse));
    for (index, sun) in facts.suns.iter().enumerate() {
        for (object, level_box) in sun.boxes.iter().enumerate() {
            let Some(level_box) = level_box else { continue };
            let side = level_box.key.texels;
            let counts = match facts.map_receiver {
                None => true,
                Some(Receiver::Object(wanted)) => wanted as usize == object,
                Some(Receiver::Floor(_)) => false,
            };
            let is_asked_for =
                |layer: &u32| facts.map_receiver.is_none() || *layer == facts.map_layer;
            for layer in (0..facts.quality.layers).filter(|layer| counts && is_asked_for(layer)) {
                let comparison = Comparison {
                    fine_width: side,
                    fine_height: side,
                    coarse_width: side,
                    coarse_height: side,
                    first_fine: fine.irradiance_of(index, object, layer),
                    first_coarse: low.irradiance_of(index, object, layer),
                    blocks: 1,
                    ..Comparison::default()
                };
                add(comparison, 1.0 / level_box.density_per_flux);
            }
        }
    }
    all
}

/// Workgroups that compare a map.
pub fn groups_of(comparison: &Comparison) -> u32 {
    comparison.places.div_ceil(PLACES_PER_GROUP)
}

/// Workgroups of all comparisons.
pub fn groups(facts: &SceneFacts) -> u32 {
    compared(facts, &facts.coarse())
        .iter()
        .map(|(comparison, _)| groups_of(comparison))
        .sum()
}

impl SceneFacts {
    /// The same scene with two fifths of the water cells and, where that divides evenly, half the floor's texels: about a sixth of the work.
    ///
    /// Beams that straddle receivers are halved once less.
    ///
    /// A view's map may always be halved, since it is looked up between its texels.
    #[must_use]
    pub fn coarse(&self) -> Self {
        let halved = |texels: u32| {
            if self.camera.is_some() || texels.is_multiple_of(2) {
                texels.div_ceil(2)
            } else {
                texels
            }
        };
        let mut coarse = self.clone();
        coarse.quality.water_cells = (2 * self.quality.water_cells / 5).max(1);
        coarse.quality.split_levels = self.quality.split_levels.saturating_sub(1);
        coarse.floor_map = self.floor_map.map(|map| FloorMap {
            width: halved(map.width),
            height: halved(map.height),
            ..map
        });
        coarse
    }
}
