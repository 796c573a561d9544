//! Field slices — makes the field of a beam set, slice by slice: cuts every beam with the slice and deposits it by exact coverage, then finishes the
//! slice's part of the field.

use crate::facts::{FieldBox, SceneFacts};
use crate::gpu_struct;
use crate::graph::{BeamSetRun, Clear};
use crate::stages::beams::BEAMS;
use crate::stages::deposit::CELLS_ALONG_GROUP;
use crate::stages::light::{Light, addend_scale, light_uniform};
use crate::stages::light_field::{LIGHT_FIELD, LIGHT_FIELDS, SLICE_ENERGY, in_words};
use crate::stages::queues::{QUEUE_HEAD_WORDS, in_columns};
use crate::stages::surface::{SURFACE, wanted_for_light};
use crate::stages::{Groups, Pass, Slot, Step, Steps};

/// Texels that a workgroup finishes, as in the shader.
const TEXELS_PER_GROUP: u32 = 64 * 16;

gpu_struct! {
    /// The uniform of `shaders/methods/irradiance_volume/field_slices.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Slice = "Slice" {
        height_m: f32,
        index: u32,
        field: u32,
        sum_scale: f32,
        density_per_flux: f32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

/// Workgroups that share one wide footprint. Fewer than elsewhere, because there are more such footprints and fewer texels.
const SHARE: u32 = 4;

/// Sums of one slice.
pub static SLICE_SUMS: Slot = Slot {
    clear: Clear::Zero(|facts, _| sum_bytes(facts)),
    ..Slot::buffer(
        "slice_sums",
        "64-bit fixed-point flux, and flux times drift, per texel of one slice",
        sum_bytes,
    )
};

/// Wide footprints on one slice, each shared by several workgroups.
pub static SLICE_QUEUE: Slot = Slot {
    clear: Clear::Head(&[0, SHARE, 1, 0]),
    ..Slot::buffer(
        "slice_queue",
        "beams with footprints of many texels on one slice",
        |facts| 4 * (QUEUE_HEAD_WORDS + 2 * u64::from(facts.quality.water_cells).pow(2)),
    )
};

fn sum_bytes(facts: &SceneFacts) -> u64 {
    let texels = facts.field.map_or(1, |field| field.texels());
    8 * u64::from(facts.channels() + 2) * texels
}

/// See the module.
pub static PASS: Pass = Pass {
    name: "field_slices",
    shader: "methods/irradiance_volume/field_slices.wgsl",
    reads: &[&SURFACE, &BEAMS, &LIGHT_FIELDS],
    reads_if_present: &[],
    writes: &[&LIGHT_FIELD, &SLICE_ENERGY, &SLICE_SUMS, &SLICE_QUEUE],
    uniforms: &[("light", Light::LAYOUT), ("slice", Slice::LAYOUT)],
    views: &[],
    wanted: |facts| {
        let shining = wanted_for_light(facts)?;
        match &facts.field {
            Some(field) => Ok(format!("{shining}; {}", in_words(field))),
            None => Err("nothing under water needs light".to_owned()),
        }
    },
    steps: Steps::FineBeamSet(|facts, set| match &facts.field {
        Some(field) => {
            let light = light_uniform(facts, set);
            (0..field.slices)
                .flat_map(|index| of_slice(facts, set, field, index, &light))
                .collect()
        }
        None => Vec::new(),
    }),
    // Beams cover a slice about twice, whatever their number.
    work: |facts| {
        let cells = f64::from(facts.quality.water_cells).powi(2);
        facts.field.map_or(0.0, |field| {
            f64::from(field.slices) * (5.0 * cells + 2.0 * field.texels() as f64)
        })
    },
};

fn of_slice(
    facts: &SceneFacts,
    set: BeamSetRun,
    field: &FieldBox,
    index: u32,
    light: &[u8],
) -> [Step; 3] {
    let per_m = field.texels_per_m();
    let slice = Slice {
        height_m: (field.bottom_m + field.spacing_m() * f64::from(index)) as f32,
        index,
        field: set.index as u32,
        sum_scale: addend_scale(facts, set.index) as f32,
        density_per_flux: (per_m.x * per_m.y) as f32,
        ..Slice::default()
    };
    let step = |entry, groups| {
        let uniforms = vec![
            ("light", light.to_vec()),
            ("slice", bytemuck::bytes_of(&slice).to_vec()),
        ];
        Step::compute(entry, groups, uniforms)
    };
    let cells = facts.quality.water_cells.div_ceil(CELLS_ALONG_GROUP);
    let texels = u32::try_from(field.texels()).unwrap_or(u32::MAX);
    [
        step("slices_main", Groups::Direct([cells, cells, 1])),
        step("slices_wide", Groups::Queue(&SLICE_QUEUE, 0)),
        step(
            "slices_finish",
            in_columns(texels.div_ceil(TEXELS_PER_GROUP)),
        ),
    ]
}
