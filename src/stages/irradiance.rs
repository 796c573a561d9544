//! Irradiance — converts a beam set's flux sums to W/m² and adds them to the irradiance maps.

use super::gpu_values::vec4;
use super::light::{Light, light_uniform};
use super::maps::MapLayout;
use super::queues::in_columns;
use super::receivers::{RECEIVERS, receivers};
use super::sums::{FLUX, texels};
use super::surface::wanted_for_light;
use super::{Pass, Slot, Step, Steps};
use crate::facts::SceneFacts;
use crate::gpu_struct;
use crate::graph::BeamSetRun;
use crate::scene::Receiver;

gpu_struct! {
    /// The uniform of `shaders/shared/resolve.wgsl`; fields are documented there.
    #[expect(missing_docs, reason = "documented in the WGSL twin")]
    pub Resolve = "Resolve" {
        power: [f32; 4],
        first_texel: u32,
        texel_count: u32,
        first_output: u32,
        adds: u32,
        density_per_flux: f32,
        receiver_count: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

/// Irradiance maps of all receivers.
pub static IRRADIANCE: Slot = Slot::buffer("irradiance", "linear RGB per texel, W/m²", |facts| {
    12 * MapLayout::of(facts).irradiance_texels()
});

/// See the module.
pub static PASS: Pass = Pass {
    name: "irradiance",
    shader: "stages/irradiance.wgsl",
    reads: &[&FLUX, &RECEIVERS],
    reads_if_present: &[],
    writes: &[&IRRADIANCE],
    uniforms: &[("light", Light::LAYOUT), ("resolve", Resolve::LAYOUT)],
    views: &[],
    wanted: |facts| {
        wanted_for_light(facts)?;
        let mut parts = Vec::new();
        if let Some(map) = facts.receivers.floor_map {
            parts.push(format!(
                "the floor's map of {} × {} texels",
                map.width, map.height
            ));
        }
        parts.extend(object_maps(facts));
        Ok(parts.join(" and "))
    },
    steps: Steps::BeamSetMaps(resolve_steps),
    work: texels,
};

/// Number and size of the objects' maps, in words.
fn object_maps(facts: &SceneFacts) -> Option<String> {
    let all = match facts.output.receiver {
        None => facts.wet_objects().count() as u32 * facts.quality.layers,
        Some(Receiver::Floor(_)) => 0,
        Some(Receiver::Object(_)) => 1,
    };
    let most = facts
        .wet_objects()
        .map(|o| facts.receivers.objects[o].map_texels);
    let most = most.max().filter(|_| all > 0)?;
    let of_layers = match facts.quality.layers {
        1 => String::new(),
        layers if facts.output.receiver.is_none() => format!(", {layers} for each object"),
        layers => format!(", layer {} of {layers}", facts.output.receiver_layer),
    };
    Some(format!(
        "{all} object map{} of {most}² texels{of_layers}{}",
        if all == 1 { "" } else { "s" },
        facts.reduced_maps()
    ))
}

/// A range of a light's flux sums that one dispatch converts to W/m².
struct Piece {
    first_texel: u32,
    texels: u32,
    first_output: u32,
    density_per_flux: f32,
    /// Number of receivers whose maps it holds; 0: it is one map with the density above.
    receivers: u32,
}

/// The ranges that the output needs. A camera needs the floor's map and the maps of all objects, which lie one behind the other; an
/// irradiance map is of one receiver.
fn pieces(facts: &SceneFacts, index: usize) -> Vec<Piece> {
    let light = facts.lights.beam_sets[index].light;
    let all = receivers(facts, light, |_| 0);
    let layers = facts.quality.layers as usize;
    let one = |number: usize| {
        all.get(number).map(|receiver| Piece {
            first_texel: receiver.map_offset,
            texels: receiver.map_width * receiver.map_height,
            first_output: receiver.irradiance_offset,
            density_per_flux: receiver.density_per_flux,
            receivers: 0,
        })
    };
    let pieces = match facts.output.receiver {
        Some(Receiver::Floor(_)) => vec![one(0)],
        Some(Receiver::Object(object)) => {
            vec![one(1
                + object as usize * layers
                + facts.output.receiver_layer as usize)]
        }
        None => {
            let maps = MapLayout::of(facts);
            let objects = (!facts.receivers.objects.is_empty()).then(|| Piece {
                first_texel: maps.flux_of(0, 0),
                texels: u32::try_from(maps.object_texels()).unwrap_or(u32::MAX),
                first_output: maps.irradiance_of(light, 0, 0),
                density_per_flux: 0.0,
                receivers: (all.len() - 1) as u32,
            });
            vec![one(0), objects]
        }
    };
    let wanted = pieces.into_iter().flatten();
    wanted.filter(|piece| piece.texels > 0).collect()
}

/// One dispatch per requested range of a light's flux sums.
fn resolve_steps(facts: &SceneFacts, set: BeamSetRun) -> Vec<Step> {
    let index = set.index;
    let mut steps = Vec::new();
    for piece in pieces(facts, index) {
        let is_floor = piece.first_texel == 0 && facts.receivers.floor_map.is_some();
        let resolve = Resolve {
            power: vec4(facts.lights.beam_sets[index].power, 0.0),
            first_texel: piece.first_texel,
            texel_count: piece.texels,
            first_output: piece.first_output,
            // All beam sets add to the floor's map; the beam sets of a light add to its maps of objects.
            adds: u32::from(if is_floor {
                index > 0
            } else {
                !facts.lights.is_first_of_light(index)
            }),
            density_per_flux: piece.density_per_flux,
            receiver_count: piece.receivers,
            ..Resolve::default()
        };
        let groups = piece.texels.div_ceil(64);
        steps.push(Step::compute(
            "irradiance_main",
            in_columns(groups),
            vec![
                ("light", light_uniform(facts, set)),
                ("resolve", bytemuck::bytes_of(&resolve).to_vec()),
            ],
        ));
    }
    steps
}
