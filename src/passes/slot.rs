//! What flows between the passes: the one table of buffers, with what they hold, in which unit, and how large they are.

use super::desc::Groups;
use super::estimate;
use super::maps::MapLayout;
use crate::facts::SceneFacts;
use crate::facts::placement::LevelMapKey;

/// Words at the head of a queue: the workgroups of the dispatch that empties it, and the count.
pub const QUEUE_HEAD_WORDS: u64 = 4;
/// Words at the head of the split queue, whose levels have counts of their own.
pub const SPLIT_HEAD_WORDS: u64 = 16;
/// First of the words in that head that are the dispatch over wide footprints; before it is their count.
pub const SPLIT_WIDE_WORD: u32 = 13;
/// Parts of straddling beams that a level of the split queue holds, per cell along the window's side and for each doubling: enough
/// for shadow edges that together are thirty times as long as the window's side.
const PARTS_PER_CELL: u64 = 64;
/// Most parts that a level of the split queue holds: 32 MiB of them.
const MOST_PARTS: u64 = 1 << 22;
/// Most workgroups of a dispatch along one axis.
pub const MOST_GROUPS: u32 = 65_535;
/// Workgroups that share one wide footprint.
pub const WIDE_GROUPS: u32 = 16;
/// Words at the head of the queue of beams that may reach an object's planes: two dispatches with their counts.
pub const CULL_HEAD_WORDS: u64 = 8;
/// Words at the head of an object's list of planes.
pub const PLANE_LIST_HEAD_WORDS: u64 = 4;
/// Texels along a side of the tiles that the list of planes knows the near planes of.
pub const PLANE_TILE_TEXELS: u32 = 4;
/// (low, high) pairs of the energy account, see `shaders/shared/flux.wgsl`.
pub const ENERGY_TERMS: u64 = 18;
/// Bytes a frame holds besides its slots: the empty list, queue heads, arguments of indirect dispatches.
pub const SUNDRY_BYTES: u64 = 256 + 32 + 12;
/// Bytes per texel of the five textures that a level map is drawn into.
pub const DRAW_TARGET_BYTES: u64 = 5 * 4;
/// Bytes per texel of the two textures that each further layer is drawn into.
pub const LAYER_TARGET_BYTES: u64 = 2 * 4;
/// Most bytes of one layer of a band of the picture.
pub const BAND_BYTES: u64 = 32 << 20;

/// How long a slot lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lifetime {
    /// Filled by the host before the frame.
    Upload,
    /// Used anew for every light.
    Light,
    /// Until the end of the frame.
    Frame,
    /// Used anew for every band of the picture.
    Band,
    /// Kept from frame to frame.
    Cached,
}

/// A buffer that passes share; WGSL variables that bind it have [`SlotInfo::name`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Slot {
    /// Wave components.
    Waves,
    /// Triangles and hierarchies of the meshes.
    Geometry,
    /// Placed meshes.
    Instances,
    /// Receivers of the light at work.
    Receivers,
    /// Receivers of all lights.
    AllReceivers,
    /// Level maps.
    LevelMaps,
    /// The water grid.
    Surface,
    /// Rays under the grid.
    Beams,
    /// Where they end.
    Hits,
    /// Beams to be halved.
    SplitQueue,
    /// Footprints for a workgroup of their own.
    WideQueue,
    /// Beams that may reach an object's planes.
    BeamQueue,
    /// Which planes of each object are used.
    PlaneLists,
    /// How many beams and planes those were.
    PlaneCounts,
    /// An image of each slice of the object at work.
    Slices,
    /// The slices seen so far, front to back.
    Combined,
    /// Flux sums.
    Flux,
    /// Energy account.
    Energy,
    /// Irradiance maps.
    Irradiance,
    /// The maps that are compared with those of the light done coarsely.
    Comparisons,
    /// Irradiance of the light done coarsely.
    CoarseIrradiance,
    /// How far those are from the maps.
    Differences,
    /// What pixels see: where.
    VisiblePosition,
    /// What pixels see: normal and distance.
    VisibleNormal,
    /// What pixels see: albedo and path.
    VisibleAlbedo,
    /// What pixels see: through what.
    VisibleTransport,
    /// Light on what pixels see.
    VisibleIrradiance,
    /// The picture.
    Radiance,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct SlotInfo {
    /// Name in WGSL and in plans.
    pub name: &'static str,
    /// What one element holds, with its unit.
    pub holds: &'static str,
    /// How long it lives.
    pub lifetime: Lifetime,
    /// Whether its first words are the workgroups of a dispatch.
    pub is_queue: bool,
}

/// All slots.
pub const SLOTS: [Slot; 28] = [
    Slot::Waves,
    Slot::Geometry,
    Slot::Instances,
    Slot::Receivers,
    Slot::AllReceivers,
    Slot::LevelMaps,
    Slot::Surface,
    Slot::Beams,
    Slot::Hits,
    Slot::SplitQueue,
    Slot::WideQueue,
    Slot::BeamQueue,
    Slot::PlaneLists,
    Slot::PlaneCounts,
    Slot::Slices,
    Slot::Combined,
    Slot::Flux,
    Slot::Energy,
    Slot::Irradiance,
    Slot::Comparisons,
    Slot::CoarseIrradiance,
    Slot::Differences,
    Slot::VisiblePosition,
    Slot::VisibleNormal,
    Slot::VisibleAlbedo,
    Slot::VisibleTransport,
    Slot::VisibleIrradiance,
    Slot::Radiance,
];

impl Slot {
    /// Name, content and lifetime.
    pub fn info(self) -> SlotInfo {
        let (name, holds, lifetime) = match self {
            Self::Waves => (
                "waves",
                "amplitude m, frequency turns/m, phase turns",
                Lifetime::Upload,
            ),
            Self::Geometry => (
                "geometry",
                "hierarchy nodes and triangles, m",
                Lifetime::Upload,
            ),
            Self::Instances => (
                "instances",
                "placement, hierarchy over all m, albedo",
                Lifetime::Upload,
            ),
            Self::Receivers => (
                "receivers",
                "map of each receiver for the light at work",
                Lifetime::Upload,
            ),
            Self::AllReceivers => (
                "all_receivers",
                "map of each receiver for each light",
                Lifetime::Upload,
            ),
            Self::LevelMaps => (
                "level_maps",
                "front and back depth pyramids, packed normals, further layers",
                Lifetime::Cached,
            ),
            Self::Surface => (
                "surface",
                "height m and slope per water vertex",
                Lifetime::Light,
            ),
            Self::Beams => (
                "beams",
                "refracted direction and transmittance per water vertex",
                Lifetime::Light,
            ),
            Self::Hits => (
                "hits",
                "map coordinates texels, path m, receiver per water vertex",
                Lifetime::Light,
            ),
            Self::SplitQueue => (
                "split_queue",
                "beams that straddle receivers, and two levels of their parts",
                Lifetime::Light,
            ),
            Self::WideQueue => (
                "wide_queue",
                "slices of footprints of many texels",
                Lifetime::Light,
            ),
            Self::BeamQueue => (
                "beam_queue",
                "beams that may reach the object at work",
                Lifetime::Light,
            ),
            Self::PlaneLists => (
                "plane_lists",
                "planes in use, texels near each plane and planes near each tile, per object",
                Lifetime::Light,
            ),
            Self::PlaneCounts => (
                "plane_counts",
                "beams kept, planes used and pieces of the box per object",
                Lifetime::Light,
            ),
            Self::Slices => (
                "slices",
                "textures: a colour image per plane of the object at work, and a depth",
                Lifetime::Light,
            ),
            Self::Combined => (
                "combined",
                "colour of the first slice per texel of the object at work",
                Lifetime::Light,
            ),
            Self::Flux => (
                "flux",
                "64-bit fixed-point flux per texel and channel",
                Lifetime::Light,
            ),
            Self::Energy => (
                "energy",
                "64-bit fixed-point flux per term of the account",
                Lifetime::Light,
            ),
            Self::Irradiance => ("irradiance", "linear RGB per texel, W/m²", Lifetime::Frame),
            Self::Comparisons => (
                "comparisons",
                "where the maps lie that are compared, and at how many places",
                Lifetime::Upload,
            ),
            Self::CoarseIrradiance => (
                "coarse_irradiance",
                "linear RGB of the light done coarsely per place that is compared, W/m²",
                Lifetime::Frame,
            ),
            Self::Differences => (
                "differences",
                "sums of |fine − coarse| and fine per workgroup, W/m²",
                Lifetime::Frame,
            ),
            Self::VisiblePosition => (
                "visible_position",
                "surface point m and receiver per pixel",
                Lifetime::Band,
            ),
            Self::VisibleNormal => (
                "visible_normal",
                "normal and distance m per pixel",
                Lifetime::Band,
            ),
            Self::VisibleAlbedo => (
                "visible_albedo",
                "reflectance and way under water m per pixel",
                Lifetime::Band,
            ),
            Self::VisibleTransport => (
                "visible_transport",
                "weights of surface and sky, way of the sky's light m, notes per pixel",
                Lifetime::Band,
            ),
            Self::VisibleIrradiance => (
                "visible_irradiance",
                "linear RGB per pixel, W/m²",
                Lifetime::Band,
            ),
            Self::Radiance => (
                "radiance",
                "linear RGB per pixel, W/(m² sr), and notes",
                Lifetime::Band,
            ),
        };
        SlotInfo {
            name,
            holds,
            lifetime,
            is_queue: matches!(self, Self::SplitQueue | Self::WideQueue | Self::BeamQueue),
        }
    }

    /// Whether it holds finished irradiance maps.
    pub fn is_map(self) -> bool {
        matches!(self, Self::Irradiance | Self::CoarseIrradiance)
    }

    /// The slot of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        SLOTS.into_iter().find(|slot| slot.info().name == name)
    }

    /// Size for a scene, bytes. Level maps are sized by their cache.
    pub fn bytes(self, facts: &SceneFacts) -> u64 {
        let side = u64::from(facts.quality.water_cells) + 1;
        let cells = u64::from(facts.quality.water_cells);
        let pixels = facts.camera.map_or(0, |c| {
            u64::from(c.width) * u64::from(band_rows(c.width, c.height))
        });
        match self {
            Self::Surface | Self::Beams | Self::Hits => 16 * side * side,
            Self::WideQueue => 4 * (QUEUE_HEAD_WORDS + 2 * cells * cells),
            Self::SplitQueue => {
                4 * (SPLIT_HEAD_WORDS
                    + 2 * cells * cells
                    + 4 * u64::from(split_parts(facts))
                    + 2 * u64::from(split_wides(facts)))
            }
            Self::BeamQueue => 4 * (CULL_HEAD_WORDS + 2 * cells * cells),
            Self::PlaneLists => 4 * plane_list_words(facts) * facts.objects.len() as u64,
            Self::PlaneCounts => 16 * facts.objects.len() as u64,
            Self::Slices => {
                let planes = u64::from(facts.quality.planes);
                4 * MapLayout::of(facts).scratch_texels() * (planes + 1)
            }
            Self::Combined => 4 * MapLayout::of(facts).scratch_texels(),
            Self::Flux => flux_bytes(facts, true),
            Self::Energy => 8 * ENERGY_TERMS,
            Self::Irradiance => 12 * MapLayout::of(facts).irradiance_texels(),
            Self::Comparisons | Self::CoarseIrradiance | Self::Differences => {
                let compared = estimate::compared(facts);
                let groups = u64::from(estimate::groups_of(&compared));
                match self {
                    Self::Comparisons => {
                        (size_of::<super::gpu_data::Comparison>() * compared.len().max(1)) as u64
                    }
                    Self::CoarseIrradiance => 12 * u64::from(estimate::PLACES_PER_GROUP) * groups,
                    _ => 16 * groups,
                }
            }
            Self::VisiblePosition
            | Self::VisibleNormal
            | Self::VisibleAlbedo
            | Self::VisibleTransport
            | Self::VisibleIrradiance
            | Self::Radiance => 16 * pixels,
            Self::Waves => 16 * facts.surface.gpu_element_count() as u64,
            // At least one: a binding may not be shorter than an element of its array.
            Self::Instances => {
                size_of::<super::gpu_data::Instance>() as u64 * facts.objects.len().max(1) as u64
            }
            Self::Receivers => receiver_bytes(facts),
            Self::AllReceivers => receiver_bytes(facts) * facts.lights.len().max(1) as u64,
            Self::Geometry => facts.geometry_bytes,
            Self::LevelMaps => 0,
        }
    }
}

/// Bytes of a light's flux sums, and of what volumetric light adds up behind them.
pub fn flux_bytes(facts: &SceneFacts, wide_sums: bool) -> u64 {
    let maps = MapLayout::of(facts);
    let scratch = if facts.quality.is_volumetric() {
        maps.scratch_texels()
    } else {
        0
    };
    let bytes = if wide_sums { 8 } else { 4 };
    bytes * u64::from(facts.channels()) * (maps.flux_texels() + scratch)
}

/// Words of an object's list of planes: its head, the planes, the texels near each, and the planes near each tile of its map.
pub fn plane_list_words(facts: &SceneFacts) -> u64 {
    let tiles = u64::from(facts.quality.level_map_texels / PLANE_TILE_TEXELS);
    PLANE_LIST_HEAD_WORDS + 2 * u64::from(facts.quality.planes) + tiles * tiles
}

/// Bytes of the textures that a level map is drawn into.
pub fn draw_target_bytes(key: &LevelMapKey) -> u64 {
    let per_texel = DRAW_TARGET_BYTES + LAYER_TARGET_BYTES * u64::from(key.layers - 1);
    per_texel * u64::from(key.texels) * u64::from(key.texels)
}

/// Bytes of the estimate's sums, which wait for the host beside any other result.
pub fn differences_beside(facts: &SceneFacts) -> u64 {
    if facts.quality.estimate_error && !facts.lights.is_empty() {
        Slot::Differences.bytes(facts)
    } else {
        0
    }
}

/// Bytes of the largest result that is copied to the host at once, and of what waits beside it.
pub fn readback_bytes(facts: &SceneFacts) -> u64 {
    let beside = differences_beside(facts);
    beside
        + match facts.camera {
            Some(camera) => {
                16 * u64::from(camera.width) * u64::from(band_rows(camera.width, camera.height))
            }
            None if facts.lights.is_empty() => 0,
            None => 12 * MapLayout::of(facts).irradiance_texels(),
        }
}

/// Parts of straddling beams that a level of the split queue holds: what has been halved less than `split_levels` times is queued,
/// and about twice as many parts straddle with each halving.
pub fn split_parts(facts: &SceneFacts) -> u32 {
    let levels = facts.quality.split_levels;
    if levels < 2 || facts.wet_objects().next().is_none() {
        return 0;
    }
    let cells = u64::from(facts.quality.water_cells);
    // A level is opened only if it fits even where all four parts of each straddle.
    let all = (2 * cells * cells) << (2 * (levels - 1));
    let parts = ((PARTS_PER_CELL * cells) << levels)
        .min(all)
        .min(MOST_PARTS);
    u32::try_from(parts).unwrap_or(u32::MAX)
}

/// Footprints of straddling beams that are queued for workgroups of their own: no more than there are beams and parts.
pub fn split_wides(facts: &SceneFacts) -> u32 {
    if facts.wet_objects().next().is_none() {
        return 0;
    }
    let cells = facts.quality.water_cells;
    (2 * cells * cells).saturating_add(split_parts(facts))
}

/// Bytes of the receivers of one light.
fn receiver_bytes(facts: &SceneFacts) -> u64 {
    let receivers = 1 + facts.objects.len() as u64 * u64::from(facts.quality.layers);
    size_of::<super::gpu_data::Receiver>() as u64 * receivers
}

/// A dispatch of so many workgroups in a row, which may be more than fit one axis: then in rows of the same length. Shaders pass over the
/// last ones.
pub fn in_columns(groups: u32) -> Groups {
    let rows = groups.div_ceil(MOST_GROUPS).max(1);
    Groups::Direct([groups.div_ceil(rows).max(1), rows, 1])
}

/// Rows of a picture that are made at once.
pub fn band_rows(width: u32, height: u32) -> u32 {
    let rows = BAND_BYTES / (16 * u64::from(width.max(1)));
    u32::try_from(rows)
        .unwrap_or(u32::MAX)
        .clamp(1, height.max(1))
}
