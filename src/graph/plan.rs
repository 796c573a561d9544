//! The planner: picks the shortest list of passes that fills the requested slots, with a reason for each pass that is in or out, and the
//! memory they take.
//!
//! A pure function without GPU. It walks the list backwards from the requested slots and keeps a pass if the pass is wanted and writes a
//! slot that is still needed. Cached slots count as available, so a cache hit needs no extra code.

use std::collections::BTreeSet;

use super::pass::PassDesc;
use super::scope::{Program, Scope};
use super::slot::{Origin, SlotDesc};

/// Passes and their memory, in the order they run.
#[derive(Debug)]
pub struct Planned<P: Program> {
    /// Passes that run, with the reason for each.
    pub passes: Vec<(&'static PassDesc<P>, String)>,
    /// Passes that do not run, with the reason for each.
    pub absent: Vec<(&'static PassDesc<P>, String)>,
    /// Slots of these passes, in the order of first use.
    pub slots: Vec<PlannedSlot<P>>,
    /// Bytes of the buffers that the slots share. Slots in one buffer are never alive at the same time.
    pub buffers: Vec<u64>,
    /// Largest total of textures that are alive at once, bytes.
    pub texture_bytes: u64,
}

/// Where a slot lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allocation {
    /// In the buffer of this number.
    Buffer(usize),
    /// In textures of its own.
    Textures,
    /// Kept by a cache.
    Kept,
}

/// A slot that the frame holds.
#[derive(Debug)]
pub struct PlannedSlot<P: Program> {
    /// The slot.
    pub slot: &'static SlotDesc<P>,
    /// Its size.
    pub bytes: u64,
    /// Where it lies.
    pub allocation: Allocation,
    /// First and last phase in which it lives.
    pub life: [Phase; 2],
}

/// A part of a frame. Slots that live in different phases share memory. Within a phase passes run in loops, so each of its slots lives
/// for the whole phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Passes that run once per frame, and level maps.
    Preparation,
    /// Beam sets at full and at coarse resolution, and the estimate of the error.
    Light,
    /// Bands of the picture.
    Picture,
}

impl Phase {
    /// The phase of a scope.
    pub fn of(scope: Scope) -> Self {
        match scope {
            Scope::Frame | Scope::LevelMap => Self::Preparation,
            Scope::BeamSet
            | Scope::FineBeamSet
            | Scope::BeamSetMaps
            | Scope::CoarseBeamSet
            | Scope::Estimate => Self::Light,
            Scope::Band | Scope::BandBeamSet => Self::Picture,
        }
    }
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// A pass reads a slot that no earlier pass writes: a defect of the list.
    #[error("pass `{pass}` reads `{slot}`, which nothing before it writes")]
    NothingWrites {
        /// The pass.
        pass: &'static str,
        /// The slot.
        slot: &'static str,
    },
    /// A requested slot is written by no pass of the list: a defect of the list.
    #[error("`{slot}` is requested, but no pass of the list writes it")]
    NothingMakes {
        /// The slot.
        slot: &'static str,
    },
}

impl<P: Program> PlannedSlot<P> {
    /// Whether the frame holds a texture of the slot in a phase. Textures of the preparation are dropped after it; others stay until the
    /// end, because light may be traced again for the estimate.
    pub fn has_texture(&self, phase: Phase) -> bool {
        self.allocation == Allocation::Textures
            && self.life[0] <= phase
            && (phase == Phase::Preparation || self.life[1] > Phase::Preparation)
    }
}

impl<P: Program> Planned<P> {
    /// Whether a pass runs.
    pub fn runs(&self, name: &str) -> bool {
        self.passes.iter().any(|(pass, _)| pass.name == name)
    }

    /// The passes of a scope, in order.
    pub fn of(&self, scope: Scope) -> Vec<&'static PassDesc<P>> {
        let all = self.passes.iter().map(|(pass, _)| *pass);
        all.filter(|pass| pass.steps.scope() == scope).collect()
    }

    /// The largest of the slots that share a buffer; the first of them if several are equal.
    pub fn owner(&self, buffer: usize) -> Option<&'static SlotDesc<P>> {
        let all = self.slots.iter();
        let own = all.filter(|slot| slot.allocation == Allocation::Buffer(buffer));
        own.reduce(|a, b| if b.bytes > a.bytes { b } else { a })
            .map(|planned| planned.slot)
    }

    /// The planned slot, if the frame holds it.
    pub fn slot(&self, slot: &SlotDesc<P>) -> Option<&PlannedSlot<P>> {
        self.slots.iter().find(|planned| planned.slot == slot)
    }
}

/// Plans a frame.
///
/// - `passes`: all passes that may run, in order;
/// - `awaited`: the requested slots;
/// - `available`: slots whose content is cached from an earlier frame;
/// - `kept_bytes`: size of a slot that a cache keeps.
///
/// # Errors
/// [`PlanError`].
pub fn plan<P: Program>(
    passes: &[&'static PassDesc<P>],
    facts: &P::Facts,
    awaited: &BTreeSet<&'static SlotDesc<P>>,
    available: &BTreeSet<&'static SlotDesc<P>>,
    kept_bytes: impl Fn(&SlotDesc<P>) -> u64,
) -> Result<Planned<P>, PlanError> {
    let mut awaiting = awaited.clone();
    let is_made = |slot: &&&'static SlotDesc<P>| {
        available.contains(**slot) || passes.iter().any(|pass| pass.writes.contains(*slot))
    };
    if let Some(slot) = awaited.iter().find(|slot| !is_made(slot)) {
        return Err(PlanError::NothingMakes { slot: slot.name });
    }
    let (mut kept, mut absent) = (Vec::new(), Vec::new());
    for pass in passes.iter().copied().rev() {
        match verdict(pass, facts, &awaiting, available) {
            Ok(reason) => {
                awaiting.extend(pass.reads.iter().chain(pass.reads_if_present));
                kept.push((pass, reason));
            }
            Err(reason) => absent.push((pass, reason)),
        }
    }
    kept.reverse();
    absent.reverse();
    check_order(&kept, available)?;
    let mut planned = Planned {
        slots: held(&kept, facts, kept_bytes),
        passes: kept,
        absent,
        buffers: Vec::new(),
        texture_bytes: 0,
    };
    share_buffers(&mut planned);
    planned.texture_bytes = [Phase::Preparation, Phase::Light, Phase::Picture]
        .into_iter()
        .map(|phase| {
            let alive = planned.slots.iter().filter(|slot| slot.has_texture(phase));
            alive.map(|slot| slot.bytes).sum()
        })
        .max()
        .unwrap_or(0);
    Ok(planned)
}

fn verdict<P: Program>(
    pass: &'static PassDesc<P>,
    facts: &P::Facts,
    awaiting: &BTreeSet<&'static SlotDesc<P>>,
    available: &BTreeSet<&'static SlotDesc<P>>,
) -> Result<String, String> {
    let reason = (pass.wanted)(facts)?;
    let names = |slots: &[&'static SlotDesc<P>]| {
        let names: Vec<&str> = slots.iter().map(|slot| slot.name).collect();
        names.join(", ")
    };
    let (mut missing, mut kept) = (Vec::new(), Vec::new());
    for slot in pass.writes {
        if available.contains(slot) {
            kept.push(*slot);
        } else {
            missing.push(*slot);
        }
    }
    if missing.iter().any(|slot| awaiting.contains(slot)) {
        return Ok(reason);
    }
    if kept.iter().any(|slot| awaiting.contains(slot)) {
        return Err(format!("its output ({}) is cached", names(&kept)));
    }
    Err(format!(
        "nothing in this frame reads its output ({})",
        names(pass.writes)
    ))
}

/// Checks that every slot a pass reads comes from the host, is cached, or is written by a pass that runs earlier: in an earlier scope, or
/// in the same scope and earlier in the list.
fn check_order<P: Program>(
    kept: &[(&'static PassDesc<P>, String)],
    available: &BTreeSet<&'static SlotDesc<P>>,
) -> Result<(), PlanError> {
    let mut available = available.clone();
    let mut in_order: Vec<&'static PassDesc<P>> = kept.iter().map(|(pass, _)| *pass).collect();
    in_order.sort_by_key(|pass| pass.steps.scope().order());
    for pass in in_order {
        let missing = pass.reads.iter().find(|slot| {
            let from_host = matches!(slot.origin, Origin::Host | Origin::HostCached);
            !from_host && !available.contains(*slot)
        });
        if let Some(missing) = missing {
            return Err(PlanError::NothingWrites {
                pass: pass.name,
                slot: missing.name,
            });
        }
        available.extend(pass.writes);
    }
    Ok(())
}

/// The slots that passes read or write, with their sizes and lifetimes.
fn held<P: Program>(
    kept: &[(&'static PassDesc<P>, String)],
    facts: &P::Facts,
    kept_bytes: impl Fn(&SlotDesc<P>) -> u64,
) -> Vec<PlannedSlot<P>> {
    // Where a pass runs per band and beam set, the passes that trace the beam set run again for each band.
    let again_in_picture = kept
        .iter()
        .any(|(pass, _)| pass.steps.scope() == Scope::BandBeamSet);
    let mut slots: Vec<PlannedSlot<P>> = Vec::new();
    for (pass, _) in kept {
        let scope = pass.steps.scope();
        let first = Phase::of(scope);
        let last = if again_in_picture && scope == Scope::BeamSet {
            Phase::Picture
        } else {
            first
        };
        for slot in pass.slots() {
            if let Some(known) = slots.iter_mut().find(|known| known.slot == slot) {
                known.life = [known.life[0].min(first), known.life[1].max(last)];
                continue;
            }
            let (bytes, allocation) = match slot.origin {
                Origin::Cached | Origin::HostCached => (kept_bytes(slot), Allocation::Kept),
                // A binding may not be shorter than one element of its array.
                _ if slot.is_buffer() => (slot.bytes(facts).max(16), Allocation::Buffer(0)),
                _ => (slot.bytes(facts), Allocation::Textures),
            };
            slots.push(PlannedSlot {
                slot,
                bytes,
                allocation,
                life: [first, last],
            });
        }
    }
    for planned in &mut slots {
        if planned.slot.origin == Origin::Host {
            // The host fills it before anything runs.
            planned.life[0] = Phase::Preparation;
        }
    }
    slots
}

/// Assigns slots to buffers so that slots alive at the same time never share one: the largest slot first, each into the first buffer
/// whose slots all live at other times.
fn share_buffers<P: Program>(planned: &mut Planned<P>) {
    let mut order: Vec<usize> = (0..planned.slots.len())
        .filter(|&index| matches!(planned.slots[index].allocation, Allocation::Buffer(_)))
        .collect();
    order.sort_by_key(|&index| std::cmp::Reverse(planned.slots[index].bytes));
    let mut lives: Vec<Vec<[Phase; 2]>> = Vec::new();
    for index in order {
        let slot = &mut planned.slots[index];
        let is_free = |lives: &Vec<[Phase; 2]>| {
            lives
                .iter()
                .all(|life| life[1] < slot.life[0] || slot.life[1] < life[0])
        };
        let number = lives.iter().position(is_free).unwrap_or_else(|| {
            // Later slots are no larger, so this size fits them too.
            lives.push(Vec::new());
            planned.buffers.push(slot.bytes.next_multiple_of(4));
            lives.len() - 1
        });
        lives[number].push(slot.life);
        slot.allocation = Allocation::Buffer(number);
    }
}
