//! Declares the slots in which beams sum their light (flux per texel, and the energy account), with their sizes and the cost of a texel.

use super::Slot;
use super::maps::MapLayout;
use crate::facts::SceneFacts;
use crate::graph::Clear;

/// Number of (low, high) pairs in the energy account, see `shaders/shared/terms.wgsl`.
pub const ENERGY_TERMS: u64 = 18;

/// Flux sums of a beam set.
pub static FLUX: Slot = Slot {
    clear: Clear::Zero(flux_bytes),
    ..Slot::buffer(
        "flux",
        "64-bit fixed-point flux per texel and channel",
        |facts| flux_bytes(facts, true),
    )
};

/// Energy account of a beam set.
pub static ENERGY: Slot = Slot {
    clear: Clear::Zero(|_, _| 8 * ENERGY_TERMS),
    ..Slot::buffer(
        "energy",
        "64-bit fixed-point flux per term of the account",
        |_| 8 * ENERGY_TERMS,
    )
};

/// Bytes of a beam set's flux sums, and of the scratch map that a method may have behind them.
pub fn flux_bytes(facts: &SceneFacts, wide_sums: bool) -> u64 {
    let maps = MapLayout::of(facts);
    let scratch = if facts.method.has_scratch_map {
        maps.scratch_texels()
    } else {
        0
    };
    let bytes = if wide_sums { 8 } else { 4 };
    bytes * u64::from(facts.channels()) * (maps.flux_texels() + scratch)
}

/// Relative cost of a texel of the flux sums: a fixed part, and a part per channel.
pub(super) fn cost_of_channels(facts: &SceneFacts) -> f64 {
    0.6 + 0.4 * f64::from(facts.channels())
}

/// Texels of the flux sums, as work.
pub(super) fn texels(facts: &SceneFacts) -> f64 {
    MapLayout::of(facts).flux_texels() as f64
}
