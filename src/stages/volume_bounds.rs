//! Volume bounds — the rays that bound the caustic volumes of a beam set, the flux of each volume, and a hierarchy of bounds over them: blocks of
//! 2 × 2 cells of the water grid, blocks of 2 × 2 of those, and so on.
//!
//! For methods in which points find the volumes that they lie in (`shaders/shared/volume_search.wgsl`): points in the box of an object look
//! at the blocks that meet it, and at no others.

use super::beams::BEAMS;
use super::gpu_values::vec4;
use super::light::{Light, light_uniform};
use super::points;
use super::queues::in_columns;
use super::surface::{SURFACE, wanted_for_light};
use super::{Groups, Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::{BandRun, BeamSetRun};

/// Cells along a side of a block of the first level, as in the shaders.
const BLOCK_CELLS: u32 = 2;
/// Most levels; the finest grid has 2048 cells along a side, which makes 11.
const MOST_LEVELS: usize = 12;
/// Widening of the range of depths for which blocks are bounded, as a share of it, and in m.
const MARGIN: f64 = 1e-3;
const LEAST_MARGIN_M: f64 = 1e-6;

gpu_struct! {
    /// The uniform of `shaders/shared/volumes.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Volumes = "Volumes" {
        power: [f32; 4],
        sides: [[u32; 4]; 3],
        firsts: [[u32; 4]; 3],
        width: u32,
        row_count: u32,
        instance_count: u32,
        level: u32,
        has_shadows: u32,
        top_m: f32,
        bottom_m: f32,
        pad: u32,
    }
}

/// Rays as they are cut with horizontal planes.
pub static VOLUME_RAYS: Slot = Slot::buffer(
    "volume_rays",
    "place at the level of rest m and drift per depth of the ray of each water vertex",
    |facts| 16 * (u64::from(facts.quality.water_cells) + 1).pow(2),
);

/// Flux of the volumes.
pub static VOLUME_FLUX: Slot = Slot::buffer(
    "volume_flux",
    "flux m² or sr of each volume for a light of unit power",
    |facts| 8 * u64::from(facts.quality.water_cells).pow(2),
);

/// Bounds of blocks of volumes.
pub static VOLUME_BOUNDS: Slot = Slot::buffer(
    "volume_bounds",
    "least and largest (x, z) m above and below all receivers, per block of volumes",
    |facts| {
        let blocks = sides(facts.quality.water_cells).into_iter();
        32 * blocks.map(|side| u64::from(side).pow(2)).sum::<u64>()
    },
);

/// See the module.
pub static PASS: Pass = Pass {
    name: "volume_bounds",
    shader: "stages/volume_bounds.wgsl",
    reads: &[&SURFACE, &BEAMS],
    reads_if_present: &[],
    writes: &[&VOLUME_RAYS, &VOLUME_FLUX, &VOLUME_BOUNDS],
    uniforms: &[("light", Light::LAYOUT), ("volumes", Volumes::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let volumes = 2 * u64::from(facts.quality.water_cells).pow(2);
        Ok(format!("{volumes} volumes below the water grid"))
    },
    steps: Steps::BeamSet(|facts, set| {
        let sides = sides(facts.quality.water_cells);
        let step = |entry, level: usize, groups| {
            let volumes = Volumes {
                level: level as u32,
                ..volumes(facts, set)
            };
            let uniforms = vec![
                ("light", light_uniform(facts, set)),
                ("volumes", bytemuck::bytes_of(&volumes).to_vec()),
            ];
            Step::compute(entry, groups, uniforms)
        };
        let of_blocks = |level: usize| {
            let groups = sides[level].div_ceil(8);
            Groups::Direct([groups, groups, 1])
        };
        let vertices = (facts.quality.water_cells + 1).pow(2);
        let mut steps = vec![
            step("volume_rays_main", 0, in_columns(vertices.div_ceil(64))),
            step("volume_blocks_main", 0, of_blocks(0)),
        ];
        steps.extend(
            (1..sides.len()).map(|level| step("volume_levels_main", level, of_blocks(level))),
        );
        steps
    }),
    work: |facts| f64::from(facts.quality.water_cells).powi(2),
};

/// Blocks along a side of the grid, per level; the last level is one block.
fn sides(cells: u32) -> Vec<u32> {
    let mut sides = vec![cells.div_ceil(BLOCK_CELLS).max(1)];
    while let Some(&last) = sides.last()
        && last > 1
    {
        sides.push(last.div_ceil(2));
    }
    sides
}

/// Depths above and below all receivers under water, m.
fn depths_m(facts: &SceneFacts) -> [f64; 2] {
    let crest_m = facts.water.surface.max_height_m();
    let floor = facts.receivers.floor.iter().map(|floor| floor.y_m);
    let objects = facts.wet_objects();
    let lowest = floor.chain(objects.map(|index| facts.receivers.objects[index].min.y));
    let deepest_m = lowest.map(|y_m| -y_m).fold(crest_m, f64::max);
    let margin_m = (deepest_m + crest_m) * MARGIN + LEAST_MARGIN_M;
    [-crest_m - margin_m, deepest_m + margin_m]
}

/// The uniform of the points of a band, which look for objects on their way to the water or do not; `None` without points.
pub fn volumes_of_band(
    facts: &SceneFacts,
    band: BandRun,
    set: BeamSetRun,
    has_shadows: bool,
) -> Option<Volumes> {
    let [width, _] = points::size(facts)?;
    Some(Volumes {
        width,
        row_count: band.rows,
        instance_count: facts.receivers.objects.len() as u32,
        has_shadows: u32::from(has_shadows),
        ..volumes(facts, set)
    })
}

/// Work of the search for the volumes of all points: each descends through the levels of the blocks.
pub fn search_work(facts: &SceneFacts) -> f64 {
    let points =
        points::size(facts).map_or(0.0, |[width, height]| f64::from(width) * f64::from(height));
    points * f64::from(facts.quality.water_cells).log2().max(1.0)
}

/// The reason against a scene with a light under water, whose rays bound no volumes.
///
/// # Errors
/// The reason.
pub fn starts_at_the_surface(facts: &SceneFacts) -> Result<(), String> {
    let mut sets = facts.lights.beam_sets.iter();
    match sets.find(|set| set.is_submerged()) {
        None => Ok(()),
        Some(set) => Err(format!(
            "caustic volumes begin at the surface of the water, and light {} is under it",
            set.light_index
        )),
    }
}

/// The uniform of a beam set; the fields about points are 0.
fn volumes(facts: &SceneFacts, set: BeamSetRun) -> Volumes {
    let mut volumes = Volumes::default();
    let sides = sides(facts.quality.water_cells);
    let mut first = 0;
    for (level, &side) in sides.iter().enumerate().take(MOST_LEVELS) {
        volumes.sides[level / 4][level % 4] = side;
        volumes.firsts[level / 4][level % 4] = first;
        first += side * side;
    }
    let [top_m, bottom_m] = depths_m(facts);
    Volumes {
        power: vec4(facts.lights.beam_sets[set.index].power, 0.0),
        level: sides.len() as u32 - 1,
        top_m: top_m as f32,
        bottom_m: bottom_m as f32,
        ..volumes
    }
}
