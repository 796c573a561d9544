//! Estimate — compares the maps with those of the coarse beam sets: the frame's own estimate of its error.

use super::coarse_irradiance::COARSE_IRRADIANCE;
use super::deposit::CELLS_ALONG_GROUP;
use super::irradiance::IRRADIANCE;
use super::maps::MapLayout;
use super::queues::in_columns;
use super::surface::wanted_for_light;
use super::{Pass, Slot, Step, Steps};
use crate::facts::{FloorMap, Product, SceneFacts};
use crate::gpu_struct;
use crate::graph::Origin;
use crate::scene::Receiver;

/// Places (texels or blocks of them) of a workgroup, as in the shader.
pub const PLACES_PER_GROUP: u32 = 64 * 2;
/// A map with at least twice this many places is sampled at about this many, spread over it. Their mean is within a few hundredths of
/// the map's mean; the estimate itself is good to a factor of two.
const ENOUGH_PLACES: u32 = 2048;
/// Fine texels along a side of the largest blocks that are compared. Half as many of these blocks are enough, because reading their
/// texels dominates the cost.
const QUARTER: u32 = 4;

gpu_struct! {
    /// A comparison of `shaders/shared/comparison.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Comparison = "Comparison" {
        fine_width: u32,
        fine_height: u32,
        coarse_width: u32,
        coarse_height: u32,
        first_fine: u32,
        first_coarse: u32,
        receiver: u32,
        blocks: u32,
        first_group: u32,
        places: u32,
        one_in: u32,
        pad: u32,
    }
}

gpu_struct! {
    /// The uniform of `shaders/stages/estimate.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Estimate = "Estimate" {
        comparison_count: u32,
        group_count: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

/// The maps that are compared with those of the coarse beam sets.
pub static COMPARISONS: Slot = Slot {
    origin: Origin::Host,
    element: Some(Comparison::LAYOUT),
    ..Slot::buffer(
        "comparisons",
        "where the maps lie that are compared, and at how many places",
        |facts| (size_of::<Comparison>() * compared(facts).len().max(1)) as u64,
    )
};

/// Differences between the maps and the coarse ones.
pub static DIFFERENCES: Slot = Slot::buffer(
    "differences",
    "sums of |fine − coarse| and fine per workgroup, W/m²",
    |facts| 16 * u64::from(groups_of(&compared(facts))),
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "estimate",
    shader: "stages/estimate.wgsl",
    reads: &[&COMPARISONS, &IRRADIANCE, &COARSE_IRRADIANCE],
    reads_if_present: &[],
    writes: &[&DIFFERENCES],
    uniforms: &[("estimate", Estimate::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted(facts)?;
        Ok("the maps are compared with those of the coarse beam sets".to_owned())
    },
    steps: Steps::Estimate(|facts| {
        let compared = compared(facts);
        let group_count = groups_of(&compared);
        let estimate = Estimate {
            comparison_count: compared.len() as u32,
            group_count,
            ..Estimate::default()
        };
        vec![Step::compute(
            "estimate_main",
            in_columns(group_count),
            vec![("estimate", bytemuck::bytes_of(&estimate).to_vec())],
        )]
    }),
    work: |facts| compared_places(facts, |_| true),
};

/// Number of places at which the estimate compares these maps.
fn compared_places(facts: &SceneFacts, these: impl Fn(&Compared) -> bool) -> f64 {
    let compared = compared(facts);
    let these = compared.iter().filter(|map| these(map));
    these.map(|map| f64::from(map.comparison.places)).sum()
}

/// Mean number of compared places per light: the floor's, to which every light adds, and those of the light's own maps.
pub(super) fn places_of_a_light(facts: &SceneFacts) -> f64 {
    let lights = facts.lights.lit.len().max(1) as f64;
    compared_places(facts, |map| map.light.is_none())
        + compared_places(facts, |map| map.light.is_some()) / lights
}

/// Number of places of all comparing workgroups.
pub(super) fn places_of_groups(facts: &SceneFacts) -> u64 {
    u64::from(PLACES_PER_GROUP) * u64::from(groups_of(&compared(facts)))
}

/// The reason why the error is estimated, or why not.
pub(super) fn wanted(facts: &SceneFacts) -> Result<String, String> {
    if !facts.quality.estimate_error {
        return Err("quality.estimate_error is false".to_owned());
    }
    if facts.method.product != Product::ReceiverMaps {
        return Err(format!(
            "method {} makes no receiver maps that could be compared",
            facts.method.name
        ));
    }
    wanted_for_light(facts)
}

/// A map that is compared.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Its parameters for the shaders.
    pub comparison: Comparison,
    /// Area that a compared fine texel stands for, m².
    pub texel_m2: f64,
    /// The light of the map; `None` for the floor's map, to which every light adds.
    pub light: Option<usize>,
}

impl Compared {
    /// Workgroups that compare it.
    pub fn groups(&self) -> u32 {
        self.comparison.places.div_ceil(PLACES_PER_GROUP)
    }
}

/// All maps that are compared: the floor's, then those of the first light, of the second, and so on.
pub fn compared(facts: &SceneFacts) -> Vec<Compared> {
    let coarse_floor = coarse_floor_map(facts);
    let mut all: Vec<Compared> = Vec::new();
    let mut add = |mut comparison: Comparison, texel_m2: f64, light: Option<usize>| {
        let all_places = if comparison.blocks == 1 {
            comparison.coarse_width * comparison.coarse_height
        } else {
            comparison.fine_width * comparison.fine_height
        };
        let in_quarters =
            comparison.blocks == 1 && comparison.fine_width == QUARTER * comparison.coarse_width;
        let enough = if in_quarters {
            ENOUGH_PLACES / 2
        } else {
            ENOUGH_PLACES
        };
        comparison.one_in = (all_places / enough).max(1);
        comparison.places = all_places.div_ceil(comparison.one_in);
        comparison.first_group = groups_of(&all);
        let stands_for = f64::from(all_places) / f64::from(comparison.places);
        all.push(Compared {
            comparison,
            texel_m2: texel_m2 * stands_for,
            light,
        });
    };
    if let (Some(fine), Some(low)) = (facts.receivers.floor_map, coarse_floor) {
        let size = fine.rect.size();
        let comparison = Comparison {
            fine_width: fine.width,
            fine_height: fine.height,
            coarse_width: low.width,
            coarse_height: low.height,
            blocks: u32::from(facts.output.camera.is_none()),
            ..Comparison::default()
        };
        let texel_m2 = size.x * size.y / (f64::from(fine.width) * f64::from(fine.height));
        add(comparison, texel_m2, None);
    }
    let (fine, low) = (
        MapLayout::of(facts),
        MapLayout::with_floor(facts, coarse_floor),
    );
    let layers = facts.quality.layers;
    for (index, light) in facts.lights.lit.iter().enumerate() {
        for (object, level_box) in light.boxes.iter().enumerate() {
            let Some(level_box) = level_box else { continue };
            let side = level_box.key.texels;
            for layer in (0..layers).filter(|layer| is_requested(facts, object, *layer)) {
                let comparison = Comparison {
                    fine_width: side,
                    fine_height: side,
                    coarse_width: side,
                    coarse_height: side,
                    first_fine: fine.irradiance_of(index, object, layer),
                    first_coarse: low.flux_of(object, layer),
                    receiver: 1 + object as u32 * layers + layer,
                    blocks: 1,
                    ..Comparison::default()
                };
                add(comparison, 1.0 / level_box.density_per_flux, Some(index));
            }
        }
    }
    all
}

/// Whether the output needs this map of an object.
fn is_requested(facts: &SceneFacts, object: usize, layer: u32) -> bool {
    match facts.output.receiver {
        None => true,
        Some(Receiver::Object(wanted)) => {
            wanted as usize == object && layer == facts.output.receiver_layer
        }
        Some(Receiver::Floor(_)) => false,
    }
}

/// Workgroups of all comparisons.
pub fn groups_of(compared: &[Compared]) -> u32 {
    compared
        .last()
        .map_or(0, |last| last.comparison.first_group + last.groups())
}

/// Cells along a side of the coarse grid: two fifths of the fine one's, rounded down to whole workgroups if at least a third remains.
pub fn coarse_cells(facts: &SceneFacts) -> u32 {
    let fine = facts.quality.water_cells;
    let two_fifths = (2 * fine / 5).max(1);
    let in_whole_groups = two_fifths - two_fifths % CELLS_ALONG_GROUP;
    if 3 * in_whole_groups >= fine {
        in_whole_groups
    } else {
        two_fifths
    }
}

/// The floor's map of the coarse beam sets. It has half the texels along a side where that divides evenly, or a quarter where that leaves
/// at least as many texels as the frame has water cells, because then the light of only a few cells falls into a texel.
///
/// A view's map is always halved, since it is interpolated between its texels.
pub fn coarse_floor_map(facts: &SceneFacts) -> Option<FloorMap> {
    let map = facts.receivers.floor_map?;
    let sides = [map.width, map.height];
    let quarters = |texels: u32| {
        texels.is_multiple_of(QUARTER) && texels / QUARTER >= facts.quality.water_cells
    };
    let is_view = facts.output.camera.is_some();
    let [width, height] = if !is_view && sides.into_iter().all(quarters) {
        sides.map(|texels| texels / QUARTER)
    } else {
        sides.map(|texels| {
            if is_view || texels.is_multiple_of(2) {
                texels.div_ceil(2)
            } else {
                texels
            }
        })
    };
    Some(FloorMap {
        width,
        height,
        ..map
    })
}

impl SceneFacts {
    /// The same scene for coarse beam sets: with [fewer water cells](coarse_cells) and a [smaller map of the
    /// floor](coarse_floor_map). The work per cell falls to between a ninth and a sixth. The work per texel of the floor falls to a quarter
    /// or a sixteenth, but stays whole where its size does not divide; meshes' maps keep their size.
    ///
    /// Beams that straddle receivers are halved once less.
    #[must_use]
    pub fn coarse(&self) -> Self {
        let mut coarse = self.clone();
        coarse.quality.water_cells = coarse_cells(self);
        coarse.quality.split_levels = self.quality.split_levels.saturating_sub(1);
        coarse.receivers.floor_map = coarse_floor_map(self);
        coarse
    }
}
