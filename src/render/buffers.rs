//! Memory of a frame on the GPU: its slots, and the data that the host uploads into them.

use std::collections::BTreeMap;

use super::geometry::instances;
use super::{RenderError, Renderer};
use crate::facts::SceneFacts;
use crate::gpu::uniforms::Placed;
use crate::gpu::{Binding, GpuError};
use crate::graph::plan::Phase;
use crate::graph::{Allocation, Clear, Kind};
use crate::plan::{self, EMPTY_LIST_BYTES, FramePlan, INDIRECT_BYTES};
use crate::scene::ResolvedScene;
use crate::stages::estimate::{self, COMPARISONS, Comparison};
use crate::stages::level_map::LEVEL_MAPS;
use crate::stages::light_field::{self, LIGHT_FIELD, LIGHT_FIELDS};
use crate::stages::objects::{GEOMETRY, INSTANCES};
use crate::stages::receivers::{self, ALL_RECEIVERS, RECEIVERS, Receiver};
use crate::stages::surface::WAVES;
use crate::stages::{Pass, Slot};

/// Names of the buffers that are no slots.
const EMPTY_LIST: &str = "empty list";
const QUEUE_HEADS: &str = "queue heads";
const INDIRECT: &str = "indirect";

/// The slots of one frame.
pub(super) struct FrameSlots {
    held: BTreeMap<&'static Slot, Held>,
    /// The buffers that slots share, each under the name of the largest of them.
    shared: Vec<(&'static str, wgpu::Buffer)>,
    /// Slots that are cleared before each beam set, in the order of the queue heads.
    cleared: Vec<&'static Slot>,
    texture_peak_bytes: u64,
    empty: wgpu::Buffer,
    queue_heads: wgpu::Buffer,
    pub(super) indirect: wgpu::Buffer,
}

/// A slot on the GPU.
enum Held {
    /// The first bytes of a buffer.
    Buffer { buffer: wgpu::Buffer, bytes: u64 },
    /// A texture, seen as a whole.
    Texture {
        texture: wgpu::Texture,
        whole: wgpu::TextureView,
    },
}

impl FrameSlots {
    /// Buffer and bytes of a slot; a list without elements in this scene is one zero element.
    pub(super) fn buffer(&self, slot: &Slot) -> (&wgpu::Buffer, u64) {
        match self.held.get(slot) {
            Some(Held::Buffer { buffer, bytes }) => (buffer, *bytes),
            _ => (&self.empty, self.empty.size()),
        }
    }

    /// Buffer and bytes of a slot that the frame holds.
    pub(super) fn held_buffer(&self, slot: &Slot) -> Option<(&wgpu::Buffer, u64)> {
        match self.held.get(slot)? {
            Held::Buffer { buffer, bytes } => Some((buffer, *bytes)),
            Held::Texture { .. } => None,
        }
    }

    /// The binding of a variable of this name in a pass: the slot of that name that the pass declares.
    pub(super) fn binding(&self, pass: &Pass, name: &str) -> Option<Binding<'_>> {
        let slot = pass.slots().find(|slot| slot.name == name)?;
        match self.held.get(slot) {
            Some(Held::Texture { whole, .. }) => Some(Binding::Texture(whole)),
            _ => {
                let (buffer, bytes) = self.buffer(slot);
                Some(Binding::Buffer { buffer, bytes })
            }
        }
    }

    /// One layer of a texture.
    pub(super) fn layer(&self, slot: &Slot, layer: u32) -> Result<wgpu::TextureView, GpuError> {
        let Some(Held::Texture { texture, .. }) = self.held.get(slot) else {
            return Err(GpuError::Validation(format!(
                "{slot:?} is a render target or is sampled, but the frame holds no texture of it"
            )));
        };
        Ok(texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..wgpu::TextureViewDescriptor::default()
        }))
    }

    /// Format of a texture.
    pub(super) fn format(&self, slot: &Slot) -> Option<wgpu::TextureFormat> {
        match self.held.get(slot)? {
            Held::Texture { texture, .. } => Some(texture.format()),
            Held::Buffer { .. } => None,
        }
    }

    /// The most that its textures took at one time.
    pub(super) fn texture_peak_bytes(&self) -> u64 {
        self.texture_peak_bytes
    }

    /// Empties queues, the account and the flux sums before a beam set.
    pub(super) fn clear_for_beam_set(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        facts: &SceneFacts,
        wide_sums: bool,
    ) {
        let mut head_at = 0;
        for slot in &self.cleared {
            let (buffer, _) = self.buffer(slot);
            match slot.clear {
                Clear::Nothing => {}
                Clear::Zero(bytes) => {
                    encoder.clear_buffer(buffer, 0, Some(bytes(facts, wide_sums)));
                }
                Clear::Head(words) => {
                    let bytes = 4 * words.len() as u64;
                    encoder.copy_buffer_to_buffer(&self.queue_heads, head_at, buffer, 0, bytes);
                    head_at += bytes;
                }
            }
        }
    }
}

/// Where uniforms lie, by name.
pub(super) struct PlacedUniforms(Vec<(&'static str, Placed)>);

impl PlacedUniforms {
    /// The uniform of this name.
    pub(super) fn find(&self, name: &str) -> Option<Binding<'_>> {
        let own = self.0.iter().find(|(own, _)| *own == name);
        own.map(|(_, placed)| Binding::Uniform(placed))
    }
}

impl Renderer {
    /// Takes the plan's buffers from the pool, makes its textures, and uploads the host's data.
    pub(super) fn prepare(
        &mut self,
        resolved: &ResolvedScene,
        facts: &SceneFacts,
        plan: &FramePlan,
    ) -> Result<FrameSlots, RenderError> {
        use wgpu::BufferUsages as U;
        let device = self.gpu.device.clone();
        let usage = U::STORAGE | U::COPY_DST | U::COPY_SRC;
        let mut shared = Vec::with_capacity(plan.graph.buffers.len());
        for (number, bytes) in plan.graph.buffers.iter().enumerate() {
            let label = plan.graph.owner(number).map_or("slots", |slot| slot.name);
            shared.push((label, self.pool.lend(&device, label, *bytes, usage)));
        }
        let mut held = BTreeMap::new();
        for planned in &plan.graph.slots {
            let slot = planned.slot;
            let found = match planned.allocation {
                Allocation::Buffer(number) => Some(Held::Buffer {
                    buffer: shared[number].1.clone(),
                    bytes: planned.bytes,
                }),
                Allocation::Textures => None,
                Allocation::Kept if planned.bytes == 0 => None,
                Allocation::Kept => self.kept(slot, resolved),
            };
            held.extend(found.map(|found| (slot, found)));
        }
        let heads = plan::queue_heads(&plan.graph);
        let planned = plan.graph.slots.iter().map(|planned| planned.slot);
        let cleared = planned.filter(|slot| !matches!(slot.clear, Clear::Nothing));
        let heads_bytes = 4 * heads.len().max(1) as u64;
        let queue_heads =
            self.pool
                .lend(&device, QUEUE_HEADS, heads_bytes, U::COPY_SRC | U::COPY_DST);
        if !heads.is_empty() {
            self.gpu
                .queue
                .write_buffer(&queue_heads, 0, bytemuck::cast_slice(&heads));
        }
        let empty = self.pool.lend(
            &device,
            EMPTY_LIST,
            EMPTY_LIST_BYTES,
            U::STORAGE | U::COPY_DST,
        );
        let zeros = [0; EMPTY_LIST_BYTES as usize];
        self.gpu.queue.write_buffer(&empty, 0, &zeros);
        let indirect_usage = U::INDIRECT | U::COPY_DST | U::COPY_SRC;
        let mut slots = FrameSlots {
            held,
            shared,
            cleared: cleared.collect(),
            texture_peak_bytes: 0,
            empty,
            queue_heads,
            indirect: self
                .pool
                .lend(&device, INDIRECT, INDIRECT_BYTES, indirect_usage),
        };
        self.next_phase(&mut slots, facts, plan, Phase::Preparation);
        self.upload(facts, &slots);
        self.gpu.check()?;
        Ok(slots)
    }

    /// Drops the textures that a phase no longer needs, and makes those that it needs first.
    pub(super) fn next_phase(
        &self,
        slots: &mut FrameSlots,
        facts: &SceneFacts,
        plan: &FramePlan,
        phase: Phase,
    ) {
        for planned in &plan.graph.slots {
            if planned.allocation == Allocation::Textures && !planned.has_texture(phase) {
                slots.held.remove(planned.slot);
            }
        }
        for planned in &plan.graph.slots {
            if planned.has_texture(phase) && !slots.held.contains_key(planned.slot) {
                let made = self.texture(planned.slot, facts);
                slots.held.extend(made.map(|made| (planned.slot, made)));
            }
        }
        let bytes = slots.held.iter().filter_map(|(slot, held)| match held {
            Held::Texture { .. } => Some(slot.bytes(facts)),
            Held::Buffer { .. } => None,
        });
        slots.texture_peak_bytes = slots.texture_peak_bytes.max(bytes.sum());
    }

    /// Returns the buffers of a frame to the pool.
    pub(super) fn give_back(&mut self, slots: FrameSlots) {
        for (label, buffer) in slots.shared {
            self.pool.give_back(label, buffer);
        }
        for (label, buffer) in [
            (EMPTY_LIST, slots.empty),
            (QUEUE_HEADS, slots.queue_heads),
            (INDIRECT, slots.indirect),
        ] {
            self.pool.give_back(label, buffer);
        }
    }

    /// A slot that a cache keeps.
    fn kept(&mut self, slot: &Slot, resolved: &ResolvedScene) -> Option<Held> {
        let buffer = if *slot == GEOMETRY {
            if resolved.meshes.is_empty() {
                return None;
            }
            let geometry = self.geometry.hold(&self.gpu, &resolved.meshes);
            geometry.buffer.clone()
        } else if *slot == LEVEL_MAPS {
            self.arena_buffer()
        } else if *slot == LIGHT_FIELD {
            self.field_arena_buffer()
        } else {
            return None;
        };
        let bytes = buffer.size();
        Some(Held::Buffer { buffer, bytes })
    }

    /// A slot's texture; `None` where it has no texels in this scene.
    fn texture(&self, slot: &Slot, facts: &SceneFacts) -> Option<Held> {
        let Kind::Texture(texture) = &slot.kind else {
            return None;
        };
        let [width, height, depth_or_array_layers] = (texture.extent)(facts);
        if width == 0 || height == 0 || depth_or_array_layers == 0 {
            return None;
        }
        let made = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(slot.name),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: texture.dimension.compatible_texture_dimension(),
            format: texture.format,
            usage: texture.usage | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let whole = made.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(if depth_or_array_layers == 1 {
                texture.dimension
            } else {
                match texture.dimension {
                    wgpu::TextureViewDimension::D2 => wgpu::TextureViewDimension::D2Array,
                    other => other,
                }
            }),
            ..wgpu::TextureViewDescriptor::default()
        });
        Some(Held::Texture {
            texture: made,
            whole,
        })
    }

    fn upload(&self, facts: &SceneFacts, slots: &FrameSlots) {
        let write = |slot: &Slot, bytes: &dyn Fn() -> Vec<u8>| {
            if let Some((buffer, _)) = slots.held_buffer(slot) {
                let bytes = bytes();
                if !bytes.is_empty() {
                    self.gpu.queue.write_buffer(buffer, 0, &bytes);
                }
            }
        };
        write(&WAVES, &|| {
            bytemuck::cast_slice(&facts.water.surface.gpu_elements()).to_vec()
        });
        write(&INSTANCES, &|| {
            bytemuck::cast_slice(&instances(self.geometry.in_use(), facts)).to_vec()
        });
        write(&ALL_RECEIVERS, &|| {
            let lights = 0..facts.lights.lit.len();
            let all: Vec<Receiver> = lights
                .flat_map(|light| self.receivers(facts, light))
                .collect();
            bytemuck::cast_slice(&all).to_vec()
        });
        write(&LIGHT_FIELDS, &|| {
            let first_word = |set: usize| {
                let key = facts.lights.beam_sets[set].field.as_ref();
                let offset = key.and_then(|key| self.fields.offset(key));
                u32::try_from(offset.unwrap_or_default() / 4).unwrap_or(u32::MAX)
            };
            bytemuck::cast_slice(&light_field::light_fields(facts, first_word)).to_vec()
        });
        write(&COMPARISONS, &|| {
            let compared = estimate::compared(facts);
            let all: Vec<Comparison> = compared.iter().map(|map| map.comparison).collect();
            bytemuck::cast_slice(&all).to_vec()
        });
    }

    /// Uploads the receivers of a beam set's light; they apply to everything submitted from now on.
    pub(super) fn set_receivers(&self, facts: &SceneFacts, index: usize, slots: &FrameSlots) {
        if let Some((buffer, _)) = slots.held_buffer(&RECEIVERS) {
            let receivers = self.receivers(facts, facts.lights.beam_sets[index].light);
            let bytes = bytemuck::cast_slice(&receivers);
            self.gpu.queue.write_buffer(buffer, 0, bytes);
        }
    }

    fn receivers(&self, facts: &SceneFacts, light: usize) -> Vec<Receiver> {
        receivers::receivers(facts, light, |object| {
            let level_box = facts.lights.lit[light].boxes[object].as_ref();
            let offset = level_box.and_then(|b| self.level_maps.offset(&b.key));
            u32::try_from(offset.unwrap_or_default() / 4).unwrap_or(u32::MAX)
        })
    }

    pub(super) fn arena_buffer(&mut self) -> wgpu::Buffer {
        let size = self.level_maps.stats().budget_bytes;
        let device = &self.gpu.device;
        let arena = self
            .arena
            .get_or_insert_with(|| arena(device, "level maps", size));
        arena.clone()
    }

    fn field_arena_buffer(&mut self) -> wgpu::Buffer {
        let size = self.fields.stats().budget_bytes;
        let device = &self.gpu.device;
        let made = self
            .field_arena
            .get_or_insert_with(|| arena(device, "fields of light", size));
        made.clone()
    }

    pub(super) fn place_uniforms<'a>(
        &mut self,
        uniforms: impl Iterator<Item = &'a (&'static str, Vec<u8>)>,
    ) -> PlacedUniforms {
        let placed = uniforms.map(|(name, bytes)| (*name, self.uniforms.get(&self.gpu, bytes)));
        PlacedUniforms(placed.collect())
    }
}

/// The buffer in which a cache keeps its things.
fn arena(device: &wgpu::Device, label: &'static str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}
