//! Plans: from facts and the requested result to the passes that run, the reason for each, and the memory they take.
//!
//! The graph walks the list of passes ([`crate::graph::plan`]). This room supplies the slots that a frame requests and those that are
//! cached, and makes the report.

pub mod explain;

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::facts::placement::LevelMapKey;
use crate::facts::{FieldKey, Product, SceneFacts};
use crate::graph::{self, Allocation, Clear, PlanError, Planned, PlannedSlot as HeldSlot, Scope};
use crate::methods;
use crate::scene::LayerName;
use crate::stages::camera_hits::{VISIBLE_ALBEDO, VISIBLE_DEPTH};
use crate::stages::estimate::DIFFERENCES;
use crate::stages::irradiance::IRRADIANCE;
use crate::stages::level_map::LEVEL_MAPS;
use crate::stages::light_field::LIGHT_FIELD;
use crate::stages::maps::MapLayout;
use crate::stages::points::{POINT_IRRADIANCE, POINTS, band_rows, size};
use crate::stages::shade::RADIANCE;
use crate::stages::sums::ENERGY;
use crate::stages::water_map::WATER_MAP;
use crate::stages::{Caustica, Pass, Slot};
use crate::stats::{AbsentPass, ChosenDials, MethodAdvice, Warning};

/// Bytes of the list that is bound where a scene has no elements.
pub const EMPTY_LIST_BYTES: u64 = 256;
/// Bytes of the arguments of indirect dispatches.
pub const INDIRECT_BYTES: u64 = 12;

/// The shortest list of passes that renders a scene's output, and why each runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Plan {
    /// Passes in the order they run.
    pub passes: Vec<PlannedPass>,
    /// Passes and effects that are not needed, and why.
    pub absent: Vec<AbsentPass>,
    /// What flows between the passes.
    pub slots: Vec<PlannedSlot>,
    /// Most bytes held on the GPU at once, level maps included.
    pub peak_bytes: u64,
    /// The dials that `quality.target_error` or `quality.time_budget_ms` were turned into; absent where neither is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<ChosenDials>,
    /// For `quality.target_error`: the method that would be chosen for this error, and why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method_choice: Option<MethodAdvice>,
    /// What the plan leaves out or sub-samples.
    pub warnings: Vec<Warning>,
}

/// A pass that will run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlannedPass {
    /// Pass name.
    pub name: String,
    /// Why it is in.
    pub reason: String,
    /// How often it runs.
    pub runs: u32,
}

/// A slot that will be held.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlannedSlot {
    /// Slot name.
    pub name: String,
    /// Size, bytes.
    pub bytes: u64,
    /// What one element holds, with its unit.
    pub holds: String,
    /// The slot in whose memory it lies; absent where it has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shares: Option<String>,
}

/// A plan as the executor runs it, with its report.
#[derive(Debug)]
pub struct FramePlan {
    /// The part of the frame that it renders.
    pub wanted: Wanted,
    /// Passes and slots.
    pub graph: Planned<Caustica>,
    /// The plan for users.
    pub report: Plan,
}

/// The part of a frame that is requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The whole output.
    Frame,
    /// Only the maps' estimate of their own error: a trial render.
    Estimate,
    /// Only the level maps, for later frames.
    LevelMaps,
    /// Only the points: what the pixels see, or where the texels of the map lie.
    Points,
}

/// What is already on the GPU.
pub trait Cached {
    /// Whether this level map is cached.
    fn has_level_map(&self, key: &LevelMapKey) -> bool;
    /// Bytes that the level-map arena holds, or would hold for maps of `wanted_bytes` in all.
    fn arena_bytes(&self, wanted_bytes: u64) -> u64;
    /// Whether this field of light is kept.
    fn has_field(&self, key: &FieldKey) -> bool;
    /// Bytes that the arena of fields holds, or would hold for fields of `wanted_bytes` in all.
    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64;
}

/// An empty GPU with room for level maps and fields; for plans without a device.
#[derive(Clone, Copy, Debug)]
pub struct NothingCached {
    /// Size of the level-map arena.
    pub arena_bytes: u64,
    /// Size of the arena of fields.
    pub field_arena_bytes: u64,
}

impl Cached for NothingCached {
    fn has_level_map(&self, _key: &LevelMapKey) -> bool {
        false
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 {
            0
        } else {
            self.arena_bytes
        }
    }

    fn has_field(&self, _key: &FieldKey) -> bool {
        false
    }

    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64 {
        if wanted_bytes == 0 {
            0
        } else {
            self.field_arena_bytes
        }
    }
}

/// A GPU that holds every level map and field; for plans of warm frames.
#[derive(Clone, Copy, Debug)]
pub struct WarmCache;

impl Cached for WarmCache {
    fn has_level_map(&self, _key: &LevelMapKey) -> bool {
        true
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        wanted_bytes
    }

    fn has_field(&self, _key: &FieldKey) -> bool {
        true
    }

    fn field_arena_bytes(&self, wanted_bytes: u64) -> u64 {
        wanted_bytes
    }
}

/// The slots that hold the requested part of a scene's output. The energy account is always requested if light is traced; [`plan`] leaves it
/// out if no pass of its list keeps an account.
pub fn awaited(facts: &SceneFacts, wanted: Wanted) -> BTreeSet<&'static Slot> {
    match wanted {
        Wanted::LevelMaps => return BTreeSet::from([&LEVEL_MAPS]),
        Wanted::Points => return BTreeSet::from([&POINTS]),
        Wanted::Frame | Wanted::Estimate => {}
    }
    let mut all = BTreeSet::new();
    if !facts.lights.beam_sets.is_empty() {
        all.insert(&ENERGY);
        if facts.quality.estimate_error && facts.method.product == Product::ReceiverMaps {
            all.insert(&DIFFERENCES);
        }
    }
    if wanted == Wanted::Frame {
        all.extend(awaited_layers(facts));
    }
    all
}

/// The slots that hold the layers of the output.
pub fn awaited_layers(facts: &SceneFacts) -> BTreeSet<&'static Slot> {
    if facts.output.is_water_map() {
        return BTreeSet::from([&WATER_MAP]);
    }
    if facts.output.camera.is_none() {
        return BTreeSet::from([match facts.method.product {
            Product::PointIrradiance | Product::Field => &POINT_IRRADIANCE,
            Product::ReceiverMaps => &IRRADIANCE,
        }]);
    }
    let layers = facts.output.layers.iter();
    layers
        .map(|layer| match layer {
            LayerName::Radiance => &RADIANCE,
            LayerName::Depth => &VISIBLE_DEPTH,
            LayerName::SeenDepth | LayerName::Normal | LayerName::Position => &POINTS,
            LayerName::Albedo => &VISIBLE_ALBEDO,
            LayerName::Irradiance => &POINT_IRRADIANCE,
            LayerName::Water => &WATER_MAP,
        })
        .collect()
}

/// The distinct level maps that a scene needs, in the order of lights and objects.
pub fn level_maps(facts: &SceneFacts) -> Vec<&LevelMapKey> {
    let mut seen = BTreeSet::new();
    facts
        .lights
        .lit
        .iter()
        .flat_map(|light| light.boxes.iter().flatten())
        .map(|level_box| &level_box.key)
        .filter(|key| seen.insert(*key))
        .collect()
}

/// The distinct fields of light that a scene needs, in the order of the beam sets.
pub fn fields(facts: &SceneFacts) -> Vec<&FieldKey> {
    let mut seen = BTreeSet::new();
    let keys = facts
        .lights
        .beam_sets
        .iter()
        .filter_map(|set| set.field.as_ref());
    keys.filter(|key| seen.insert(*key)).collect()
}

/// Plans `facts` from `passes`, usually those of the [method's pipeline](methods::Method::pipeline).
///
/// # Errors
/// When a pass in the list reads a slot that no earlier pass writes.
pub fn plan(
    passes: &[&'static Pass],
    facts: &SceneFacts,
    wanted: Wanted,
    cached: &dyn Cached,
) -> Result<FramePlan, PlanError> {
    let level_maps = level_maps(facts);
    let level_map_bytes: u64 = level_maps.iter().map(|key| key.bytes()).sum();
    let missing = level_maps
        .iter()
        .filter(|key| !cached.has_level_map(key))
        .count();
    let fields = fields(facts);
    let field_bytes: u64 = fields.iter().map(|key| key.bytes).sum();
    let missing_fields = fields.iter().filter(|key| !cached.has_field(key)).count();
    let mut available = BTreeSet::new();
    if missing == 0 {
        available.insert(&LEVEL_MAPS);
    }
    if missing_fields == 0 && !fields.is_empty() {
        available.insert(&LIGHT_FIELD);
    }
    let kept_bytes = |slot: &Slot| {
        if *slot == LEVEL_MAPS {
            cached.arena_bytes(level_map_bytes)
        } else if *slot == LIGHT_FIELD {
            cached.field_arena_bytes(field_bytes)
        } else {
            slot.bytes(facts)
        }
    };
    let mut awaited = awaited(facts, wanted);
    awaited.retain(|slot| **slot != ENERGY || passes.iter().any(|p| p.writes.contains(slot)));
    let graph = graph::plan(passes, facts, &awaited, &available, kept_bytes)?;
    let report = report(&graph, facts, wanted, [missing, missing_fields]);
    Ok(FramePlan {
        wanted,
        graph,
        report,
    })
}

fn report(
    graph: &Planned<Caustica>,
    facts: &SceneFacts,
    wanted: Wanted,
    missing: [usize; 2],
) -> Plan {
    let absent = graph.absent.iter().map(|(pass, reason)| AbsentPass {
        name: pass.name.to_owned(),
        reason: reason.clone(),
    });
    let besides = besides(graph, facts, wanted);
    let kept = graph.slots.iter();
    let kept = kept.filter(|slot| slot.allocation == Allocation::Kept);
    let peak_bytes = graph.buffers.iter().sum::<u64>()
        + graph.texture_bytes
        + kept.map(|slot| slot.bytes).sum::<u64>()
        + besides.iter().map(|slot| slot.bytes).sum::<u64>();
    Plan {
        passes: graph
            .passes
            .iter()
            .map(|(pass, reason)| PlannedPass {
                name: pass.name.to_owned(),
                reason: reason.clone(),
                runs: runs(pass.steps.scope(), facts, missing),
            })
            .collect(),
        absent: absent.chain(absent_effects(facts)).collect(),
        slots: graph
            .slots
            .iter()
            .map(|held| PlannedSlot {
                name: held.slot.name.to_owned(),
                bytes: held.bytes,
                holds: held.slot.holds.to_owned(),
                shares: shares(graph, held),
            })
            .chain(besides)
            .collect(),
        peak_bytes,
        chosen: None,
        method_choice: None,
        warnings: facts.warnings.clone(),
    }
}

/// The largest slot in the same buffer, if that is another one.
fn shares(graph: &Planned<Caustica>, held: &HeldSlot<Caustica>) -> Option<String> {
    let Allocation::Buffer(number) = held.allocation else {
        return None;
    };
    let owner = graph.owner(number)?;
    (owner != held.slot).then(|| owner.name.to_owned())
}

/// Memory held besides the slots.
fn besides(graph: &Planned<Caustica>, facts: &SceneFacts, wanted: Wanted) -> Vec<PlannedSlot> {
    let readback = match wanted {
        Wanted::LevelMaps => 0,
        Wanted::Points => POINTS.bytes(facts),
        Wanted::Frame | Wanted::Estimate => readback_bytes(facts),
    };
    [
        (
            "readback",
            readback,
            "the largest result copied to the host, and the sums of the error estimate",
        ),
        (
            "sundry",
            EMPTY_LIST_BYTES + 4 * queue_heads(graph).len().max(1) as u64 + INDIRECT_BYTES,
            "empty list, queue heads, dispatch arguments",
        ),
    ]
    .map(|(name, bytes, holds)| PlannedSlot {
        name: name.to_owned(),
        bytes,
        holds: holds.to_owned(),
        shares: None,
    })
    .into()
}

/// The heads of a frame's queues, one behind the other, in the order of their slots.
pub fn queue_heads(graph: &Planned<Caustica>) -> Vec<u32> {
    let heads = graph
        .slots
        .iter()
        .filter_map(|planned| match planned.slot.clear {
            Clear::Head(words) => Some(words),
            Clear::Nothing | Clear::Zero(_) => None,
        });
    heads.flatten().copied().collect()
}

/// Bytes of the estimate's sums, which are held for the host beside any other result.
pub fn differences_beside(facts: &SceneFacts) -> u64 {
    if facts.quality.estimate_error && !facts.lights.beam_sets.is_empty() {
        DIFFERENCES.bytes(facts)
    } else {
        0
    }
}

/// Bytes of the largest result that is copied to the host at once, and of the estimate's sums beside it.
pub fn readback_bytes(facts: &SceneFacts) -> u64 {
    let beside = differences_beside(facts);
    beside
        + match size(facts) {
            Some([width, height]) if is_made_in_bands(facts) => {
                let layers = awaited_layers(facts).into_iter();
                let texel = layers.map(bytes_per_point).max().unwrap_or(0);
                texel * u64::from(width) * u64::from(band_rows(width, height))
            }
            _ if facts.lights.beam_sets.is_empty() => 0,
            _ => 12 * MapLayout::of(facts).irradiance_texels(),
        }
}

/// Whether the output is made and read band by band: a view, a map of the water, and a map of a method that finds the light at points.
pub fn is_made_in_bands(facts: &SceneFacts) -> bool {
    facts.output.camera.is_some()
        || facts.output.is_water_map()
        || facts.method.product != Product::ReceiverMaps
}

/// Bytes per pixel of a slot that layers are read from.
pub fn bytes_per_point(slot: &Slot) -> u64 {
    if *slot == POINTS {
        32
    } else if *slot == VISIBLE_DEPTH {
        4
    } else {
        16
    }
}

/// Effects inside passes that a scene does not need.
fn absent_effects(facts: &SceneFacts) -> Vec<AbsentPass> {
    let mut absent = Vec::new();
    let mut add = |name: &str, reason: &str| {
        absent.push(AbsentPass {
            name: name.to_owned(),
            reason: reason.to_owned(),
        });
    };
    if facts.output.is_water_map() {
        add(
            "light",
            "the output is a map of the water: lights, objects and quality have no effect on it",
        );
        return absent;
    }
    if !facts.attenuates() {
        add(
            "attenuation",
            "water.absorption_per_m and water.scattering_per_m are zero",
        );
    }
    if facts.channels() == 1 {
        add(
            "spectral_flux",
            "all colour channels have the same extinction: one is traced for all",
        );
    }
    if !facts.lights.sky.shines() {
        add("sky", "the scene has no sky with radiance");
    } else if facts.output.camera.is_none() && facts.output.sky_w_m2.iter().all(|&e| e == 0.0) {
        add("sky", "output.include_sky is false");
    }
    if facts.output.requested_layers > facts.quality.layers {
        add(
            "layers",
            "the output is a map of the floor: the objects' maps are unused",
        );
    }
    if facts.quality.level_of_detail > 0.0 && facts.output.camera.is_none() {
        add(
            "level_of_detail",
            "the output is an irradiance map, which has no camera: every object gets quality.level_map_texels",
        );
    }
    absent
}

/// How often a pass of this scope runs, given how many level maps and fields are missing.
fn runs(scope: Scope, facts: &SceneFacts, [missing_level_maps, missing_fields]: [usize; 2]) -> u32 {
    let narrow = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let sets = narrow(facts.lights.beam_sets.len());
    let bands = size(facts).map_or(0, |[width, height]| {
        height.div_ceil(band_rows(width, height))
    });
    match scope {
        Scope::LevelMap => narrow(missing_level_maps),
        Scope::BeamSet | Scope::FineBeamSet if facts.field.is_some() => narrow(missing_fields),
        Scope::BeamSet | Scope::FineBeamSet | Scope::BeamSetMaps | Scope::CoarseBeamSet => sets,
        Scope::Frame | Scope::Estimate => 1,
        Scope::Band => bands,
        Scope::BandBeamSet => bands.saturating_mul(sets),
    }
}

/// Plans with the passes of the scene's method.
///
/// # Errors
/// As [`plan`].
pub fn plan_scene(
    facts: &SceneFacts,
    wanted: Wanted,
    cached: &dyn Cached,
) -> Result<FramePlan, PlanError> {
    plan(
        &methods::of(&facts.quality).pipeline(),
        facts,
        wanted,
        cached,
    )
}
