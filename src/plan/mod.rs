//! The planner: scene facts and what is cached become the shortest list of passes, with a reason for each that is in or out.
//!
//! A pure function without GPU. The list is walked backwards from what the output awaits; a pass stays if something awaited
//! is written by it and it is wanted. What is cached counts as there, so a cache hit needs no code of its own.

pub mod explain;

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::facts::SceneFacts;
use crate::facts::placement::LevelMapKey;
use crate::passes::{self, PassDesc, Repeat, Slot, slot};
use crate::scene::LayerName;
use crate::stats::{AbsentPass, ChosenDials, Warning};

/// The shortest list of passes that makes what a scene asks for, and why.
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
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A pass needs what no pass before it writes: a defect of the list.
    #[error("pass `{pass}` reads `{slot}`, which nothing before it writes")]
    NothingWrites {
        /// The pass.
        pass: &'static str,
        /// The slot.
        slot: &'static str,
    },
}

/// How much of a frame is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All that the output asks for.
    Frame,
    /// Nothing but the light's own estimate of its error.
    Estimate,
    /// Nothing but the level maps, for frames to come.
    LevelMaps,
}

/// What is already on the GPU.
pub trait Cached {
    /// Whether this level map is there.
    fn has_level_map(&self, key: &LevelMapKey) -> bool;
    /// Bytes that the level-map arena holds, or would hold for maps of `wanted_bytes` in all.
    fn arena_bytes(&self, wanted_bytes: u64) -> u64;
}

/// An empty GPU with room for level maps of `arena_bytes`: what a plan is made for where there is no device.
#[derive(Clone, Copy, Debug)]
pub struct NothingCached {
    /// Size of the level-map arena.
    pub arena_bytes: u64,
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
}

/// A GPU that holds every level map: what a warm frame is planned for.
#[derive(Clone, Copy, Debug)]
pub struct WarmCache;

impl Cached for WarmCache {
    fn has_level_map(&self, _key: &LevelMapKey) -> bool {
        true
    }

    fn arena_bytes(&self, wanted_bytes: u64) -> u64 {
        wanted_bytes
    }
}

/// The slots that hold what is wanted of a scene's output.
pub fn awaited(facts: &SceneFacts, wanted: Wanted) -> BTreeSet<Slot> {
    let estimate = (facts.quality.estimate_error && !facts.lights.beam_sets.is_empty())
        .then_some(Slot::Differences);
    match wanted {
        Wanted::LevelMaps => return BTreeSet::from([Slot::LevelMaps]),
        Wanted::Estimate => return estimate.into_iter().collect(),
        Wanted::Frame => {}
    }
    if facts.output.camera.is_none() {
        return BTreeSet::from([Slot::Irradiance])
            .into_iter()
            .chain(estimate)
            .collect();
    }
    facts
        .output
        .layers
        .iter()
        .map(|layer| match layer {
            LayerName::Radiance => Slot::Radiance,
            LayerName::Depth | LayerName::Normal => Slot::VisibleNormal,
            LayerName::Position => Slot::VisiblePosition,
            LayerName::Albedo => Slot::VisibleAlbedo,
            LayerName::Irradiance => Slot::VisibleIrradiance,
        })
        .chain(estimate)
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

/// Plans `facts` from `passes` (usually [`passes::ALL`]).
pub fn plan(
    passes: &[&PassDesc],
    facts: &SceneFacts,
    wanted: Wanted,
    cached: &dyn Cached,
) -> Result<Plan, PlanError> {
    let mut awaiting = awaited(facts, wanted);
    let missing = level_maps(facts)
        .iter()
        .filter(|key| !cached.has_level_map(key))
        .count();
    let mut kept: Vec<(&PassDesc, String)> = Vec::new();
    let mut absent = Vec::new();
    for pass in passes.iter().rev() {
        let verdict = verdict(pass, facts, &awaiting, missing);
        match verdict {
            Ok(reason) => {
                awaiting.extend(pass.reads.iter().chain(pass.reads_if_present));
                kept.push((pass, reason));
            }
            Err(reason) => absent.push(AbsentPass {
                name: pass.name.to_owned(),
                reason,
            }),
        }
    }
    kept.reverse();
    absent.reverse();
    absent.extend(absent_effects(facts));
    check_order(&kept, missing == 0)?;
    let slots = slots(facts, wanted, &kept, cached);
    Ok(Plan {
        passes: kept
            .iter()
            .map(|(pass, reason)| PlannedPass {
                name: pass.name.to_owned(),
                reason: reason.clone(),
                runs: runs(pass.repeat, facts, missing),
            })
            .collect(),
        absent,
        peak_bytes: slots.iter().map(|slot| slot.bytes).sum(),
        slots,
        chosen: None,
        warnings: facts.warnings.clone(),
    })
}

fn verdict(
    pass: &PassDesc,
    facts: &SceneFacts,
    awaiting: &BTreeSet<Slot>,
    missing: usize,
) -> Result<String, String> {
    let reason = (pass.wanted)(facts)?;
    if pass.repeat == Repeat::LevelMap && missing == 0 {
        return Err("every level map it would build is cached".to_owned());
    }
    if pass.writes.iter().any(|slot| awaiting.contains(slot)) {
        return Ok(reason);
    }
    let writes: Vec<&str> = pass.writes.iter().map(|slot| slot.info().name).collect();
    Err(format!(
        "nothing in this frame reads what it writes ({})",
        writes.join(", ")
    ))
}

/// Work inside passes that a scene does not call for.
fn absent_effects(facts: &SceneFacts) -> Vec<AbsentPass> {
    let mut absent = Vec::new();
    let mut add = |name: &str, reason: &str| {
        absent.push(AbsentPass {
            name: name.to_owned(),
            reason: reason.to_owned(),
        });
    };
    if !facts.attenuates() {
        add(
            "attenuation",
            "water.absorption_per_m and water.scattering_per_m are zero",
        );
    }
    if facts.channels() == 1 {
        add(
            "spectral_flux",
            "all colour channels fade alike: one is carried for all",
        );
    }
    if facts.lights.sky.radiance.iter().all(|&l| l == 0.0) {
        add("sky", "no sky shines");
    } else if facts.output.camera.is_none() && facts.output.sky_w_m2.iter().all(|&e| e == 0.0) {
        add("sky", "output.include_sky is false");
    }
    if facts.output.asked_layers > facts.quality.layers {
        add(
            "layers",
            "the output is a map of the floor: nobody looks at the objects' maps",
        );
    }
    if facts.quality.level_of_detail > 0.0 && facts.output.camera.is_none() {
        add(
            "level_of_detail",
            "the output is an irradiance map, seen by no camera: every object gets quality.level_map_texels",
        );
    }
    absent
}

fn runs(repeat: Repeat, facts: &SceneFacts, missing: usize) -> u32 {
    match repeat {
        Repeat::LevelMap => u32::try_from(missing).unwrap_or(u32::MAX),
        Repeat::Light | Repeat::FineLight | Repeat::CoarseLight => {
            u32::try_from(facts.lights.beam_sets.len()).unwrap_or(u32::MAX)
        }
        Repeat::Frame => 1,
        Repeat::Band => facts
            .output
            .camera
            .map_or(0, |c| c.height.div_ceil(slot::band_rows(c.width, c.height))),
    }
}

/// Every slot that is read must be an upload, cached, or written before.
fn check_order(kept: &[(&PassDesc, String)], level_maps_cached: bool) -> Result<(), PlanError> {
    let mut there: BTreeSet<Slot> = slot::SLOTS
        .into_iter()
        .filter(|s| s.info().lifetime == slot::Lifetime::Upload)
        .collect();
    if level_maps_cached {
        there.insert(Slot::LevelMaps);
    }
    for (pass, _) in kept {
        if let Some(missing) = pass.reads.iter().find(|slot| !there.contains(slot)) {
            return Err(PlanError::NothingWrites {
                pass: pass.name,
                slot: missing.info().name,
            });
        }
        there.extend(pass.writes);
    }
    Ok(())
}

fn slots(
    facts: &SceneFacts,
    wanted: Wanted,
    kept: &[(&PassDesc, String)],
    cached: &dyn Cached,
) -> Vec<PlannedSlot> {
    let used: BTreeSet<Slot> = kept
        .iter()
        .flat_map(|(pass, _)| {
            pass.reads
                .iter()
                .chain(pass.writes)
                .chain(pass.reads_if_present)
        })
        .copied()
        .collect();
    let level_map_bytes: u64 = level_maps(facts).iter().map(|key| key.bytes()).sum();
    let draws = kept.iter().any(|(pass, _)| pass.repeat == Repeat::LevelMap);
    let readback_bytes = match wanted {
        Wanted::LevelMaps => 0,
        Wanted::Frame | Wanted::Estimate => slot::readback_bytes(facts),
    };
    let mut besides = vec![
        (
            "readback",
            readback_bytes,
            "the largest result on its way to the host, and an estimate's sums",
        ),
        (
            "sundry",
            slot::SUNDRY_BYTES,
            "empty list, queue heads, dispatch arguments",
        ),
    ];
    if draws {
        let largest = level_maps(facts)
            .into_iter()
            .map(slot::draw_target_bytes)
            .max();
        besides.push((
            "level_map_targets",
            largest.unwrap_or(0),
            "textures that a level map is drawn into",
        ));
    }
    let besides = besides.into_iter().map(|(name, bytes, holds)| PlannedSlot {
        name: name.to_owned(),
        bytes,
        holds: holds.to_owned(),
    });
    used.into_iter()
        .map(|slot| {
            let info = slot.info();
            let bytes = match slot {
                Slot::LevelMaps => cached.arena_bytes(level_map_bytes),
                _ => slot.bytes(facts),
            };
            // What is empty and lent out has one element; what is empty and kept is not there at all.
            let kept = matches!(slot, Slot::LevelMaps | Slot::Geometry);
            PlannedSlot {
                name: info.name.to_owned(),
                bytes: if kept { bytes } else { bytes.max(16) },
                holds: info.holds.to_owned(),
            }
        })
        .chain(besides)
        .collect()
}

/// Plans with the program's own passes.
pub fn plan_scene(
    facts: &SceneFacts,
    wanted: Wanted,
    cached: &dyn Cached,
) -> Result<Plan, PlanError> {
    plan(&passes::ALL, facts, wanted, cached)
}
