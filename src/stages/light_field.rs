//! The kept field of light, whichever method makes it: per beam set the light on horizontal slices of a box ([`crate::facts::FieldBox`]),
//! for a light of unit power.
//!
//! A slice has texels, row by row along x. A texel has one word per channel (f32: flux down through the slice per horizontal area, of a light
//! of unit power), and one with the mean direction of that light (the drift along x and z, metres sideways per metre down, weighted by flux,
//! as shares of the largest drift in two 16-bit numbers; in a texel without light the drift of an undisturbed ray). `shaders/shared/light_field.wgsl` looks light up in it.
//!
//! Of several beams on a surface that all of them face, the drift's mean gives the exact irradiance: with n for the normal each gives
//! E (n_y − n_x s_x − n_z s_z), which is linear in the drift s.

use super::gpu_values::{vec2, vec4};
use super::sums::ENERGY_TERMS;
use super::{Pass, Slot};
use crate::facts::{FieldBox, SceneFacts, field};
use crate::gpu_struct;
use crate::graph::{Clear, Origin};

/// Drift beyond which rays are not cut, metres sideways per metre down.
const FLATTEST: f64 = 1000.0;

gpu_struct! {
    /// A field of `shaders/shared/light_field.wgsl`; its fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub LightField = "LightField" {
        power: [f32; 4],
        min_m: [f32; 2],
        texels_per_m: [f32; 2],
        bottom_m: f32,
        spacing_m: f32,
        width: u32,
        height: u32,
        slices: u32,
        channels: u32,
        first_word: u32,
        most_drift: f32,
    }
}

/// The content of all kept fields.
pub static LIGHT_FIELD: Slot = Slot {
    origin: Origin::Cached,
    ..Slot::buffer(
        "light_field",
        "flux per area on slices, 1/m² or sr/m² for unit power, and mean direction",
        total_bytes,
    )
};

/// Where the field of each beam set lies, and its box.
pub static LIGHT_FIELDS: Slot = Slot {
    origin: Origin::Host,
    element: Some(LightField::LAYOUT),
    ..Slot::buffer(
        "light_fields",
        "box m, texels and place of the field of each beam set",
        |facts| size_of::<LightField>() as u64 * facts.lights.beam_sets.len().max(1) as u64,
    )
};

/// The energy account of each slice of a beam set's field: its light ends on the slice. Terms as in the account of a beam set.
pub static SLICE_ENERGY: Slot = Slot {
    clear: Clear::Zero(|facts, _| slice_energy_bytes(facts)),
    ..Slot::buffer(
        "slice_energy",
        "64-bit fixed-point flux per slice and term of the account",
        slice_energy_bytes,
    )
};

fn slice_energy_bytes(facts: &SceneFacts) -> u64 {
    let slices = facts.field.map_or(1, |field| field.slices);
    8 * ENERGY_TERMS * u64::from(slices)
}

/// Bytes of all fields that a frame needs.
pub fn total_bytes(facts: &SceneFacts) -> u64 {
    let Some(own) = &facts.field else { return 0 };
    field::bytes(own, facts.channels()) * facts.lights.beam_sets.len() as u64
}

/// The fields of all beam sets; `first_word` gives the place of each in the content.
pub fn light_fields(facts: &SceneFacts, first_word: impl Fn(usize) -> u32) -> Vec<LightField> {
    let Some(own) = &facts.field else {
        return Vec::new();
    };
    let sets = facts.lights.beam_sets.iter().enumerate();
    sets.map(|(index, set)| LightField {
        power: vec4(set.power, 0.0),
        min_m: vec2(own.rect.min),
        texels_per_m: vec2(own.texels_per_m()),
        bottom_m: own.bottom_m as f32,
        spacing_m: own.spacing_m() as f32,
        width: own.width,
        height: own.height,
        slices: own.slices,
        channels: facts.channels(),
        first_word: first_word(index),
        most_drift: most_drift(facts, index) as f32,
    })
    .collect()
}

/// A field in words.
pub fn in_words(field: &FieldBox) -> String {
    format!(
        "{} slices of {} × {} texels, {:.3} m apart",
        field.slices,
        field.width,
        field.height,
        field.spacing_m()
    )
}

/// Whether a pass makes fields. Such passes take so long that their steps are submitted in batches.
pub fn is_made_by(pass: &Pass) -> bool {
    pass.writes.contains(&&LIGHT_FIELD)
}

/// Largest drift of a ray of a beam set: the flattest that refraction allows, at the steepest slope of the water.
fn most_drift(facts: &SceneFacts, index: usize) -> f64 {
    let ior = facts.lights.beam_sets[index].band.ior;
    let lean = (1.0 / ior).min(1.0).asin() + facts.water.surface.max_slope().atan();
    let most = if lean < FLATTEST.atan() {
        lean.tan()
    } else {
        FLATTEST
    };
    // With a margin for rounding.
    1.001 * most
}
