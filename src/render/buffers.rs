//! What a frame holds on the GPU: its slots' buffers, and what the host puts into them.

use std::collections::BTreeMap;

use super::{RenderError, Renderer, slot_name};
use crate::facts::SceneFacts;
use crate::facts::placement::LevelMapKey;
use crate::gpu::Binding;
use crate::gpu::uniforms::Placed;
use crate::passes::desc::Step;
use crate::passes::gpu_data::{Comparison, Receiver, Wave};
use crate::passes::slot::{SPLIT_HEAD_WORDS, Slot, WIDE_GROUPS};
use crate::passes::{estimate, light};
use crate::plan::Plan;
use crate::scene::ResolvedScene;

/// Names of the buffers beside the slots'.
pub(super) const EMPTY_LIST: &str = "empty list";
pub(super) const QUEUE_HEADS: &str = "queue heads";
pub(super) const INDIRECT: &str = "indirect";

/// The buffers of one frame, by slot name.
pub(super) struct FrameBuffers {
    pub(super) by_name: BTreeMap<&'static str, wgpu::Buffer>,
    pub(super) empty: wgpu::Buffer,
    pub(super) queue_heads: wgpu::Buffer,
    pub(super) indirect: wgpu::Buffer,
    pub(super) slices: Option<SliceTargets>,
}

/// Images of the slices of the object at work, one per plane, and the depth they are drawn with.
pub(super) struct SliceTargets {
    pub(super) colors: Vec<wgpu::TextureView>,
    pub(super) depth: wgpu::TextureView,
}

impl FrameBuffers {
    /// The buffer of a slot; lists that hold nothing in this scene are one zero element.
    pub(super) fn get(&self, name: &str) -> &wgpu::Buffer {
        self.by_name.get(name).unwrap_or(&self.empty)
    }

    /// The image of a plane's slice.
    pub(super) fn slice(&self, plane: u32) -> Option<wgpu::TextureView> {
        let slices = self.slices.as_ref()?;
        slices.colors.get(plane as usize).cloned()
    }
}

/// Where the uniforms of a step lie, by name.
pub(super) struct PlacedUniforms(Vec<(&'static str, Placed)>);

impl PlacedUniforms {
    /// What a variable of this name is bound to: the step's uniform, or else the frame's buffer.
    pub(super) fn or_buffer<'a>(&'a self, name: &str, buffers: &'a FrameBuffers) -> Binding<'a> {
        let own = self.0.iter().find(|(own, _)| *own == name);
        own.map_or_else(
            || Binding::Buffer(buffers.get(name)),
            |(_, placed)| Binding::Uniform(placed),
        )
    }
}

/// Textures a level map is drawn into before it goes to the arena.
pub(super) struct DrawTargets {
    pub(super) front: wgpu::TextureView,
    pub(super) back: wgpu::TextureView,
    pub(super) normal: wgpu::TextureView,
    pub(super) scratch_normal: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
    /// Depth and normal of each further layer.
    pub(super) layers: Vec<[wgpu::TextureView; 2]>,
}

impl DrawTargets {
    /// What a pass that takes in a drawn level map binds; `layer` is the further layer it is about, if any.
    pub(super) fn by_name(&self, name: &str, layer: u32) -> Option<wgpu::TextureView> {
        let further = |which: usize| {
            let layer = self.layers.get((layer as usize).checked_sub(1)?)?;
            Some(layer[which].clone())
        };
        match name {
            "layer_depth" => further(0),
            "layer_normal" => further(1),
            "front_depth" => Some(self.front.clone()),
            "back_depth" => Some(self.back.clone()),
            "front_normal" => Some(self.normal.clone()),
            _ => None,
        }
    }
}

impl Renderer {
    /// Lends the plan's buffers and uploads what the host provides.
    pub(super) fn prepare(
        &mut self,
        resolved: &ResolvedScene,
        facts: &SceneFacts,
        plan: &Plan,
    ) -> Result<FrameBuffers, RenderError> {
        use wgpu::BufferUsages as U;
        let device = self.gpu.device.clone();
        let mut by_name = BTreeMap::new();
        let mut slices = None;
        for planned in &plan.slots {
            let Some(slot) = Slot::by_name(&planned.name) else {
                continue;
            };
            match slot {
                Slot::Geometry => {
                    if let Some(buffer) = self.geometry_buffer(resolved) {
                        by_name.insert(slot_name(slot), buffer);
                    }
                }
                Slot::LevelMaps => {
                    if facts.wet_objects().next().is_some() {
                        by_name.insert(slot_name(slot), self.arena_buffer());
                    }
                }
                Slot::Slices => slices = Some(self.slice_targets(facts)),
                _ => {
                    let usage = U::STORAGE | U::COPY_DST | U::COPY_SRC;
                    let buffer = self
                        .pool
                        .lend(&device, slot_name(slot), planned.bytes, usage);
                    by_name.insert(slot_name(slot), buffer);
                }
            }
        }
        let queue_heads = self
            .pool
            .lend(&device, QUEUE_HEADS, 32, U::COPY_SRC | U::COPY_DST);
        let heads: [[u32; 4]; 2] = [[0, 1, 1, 0], [0, WIDE_GROUPS, 1, 0]];
        self.gpu
            .queue
            .write_buffer(&queue_heads, 0, bytemuck::cast_slice(&heads));
        let empty = self
            .pool
            .lend(&device, EMPTY_LIST, 256, U::STORAGE | U::COPY_DST);
        self.gpu.queue.write_buffer(&empty, 0, &[0; 256]);
        let buffers = FrameBuffers {
            by_name,
            empty,
            queue_heads,
            slices,
            indirect: self.pool.lend(
                &device,
                INDIRECT,
                12,
                U::INDIRECT | U::COPY_DST | U::COPY_SRC,
            ),
        };
        self.upload(facts, &buffers);
        self.gpu.check()?;
        Ok(buffers)
    }

    pub(super) fn upload(&self, facts: &SceneFacts, buffers: &FrameBuffers) {
        let write = |slot: Slot, bytes: &[u8]| {
            if let Some(buffer) = buffers.by_name.get(slot_name(slot))
                && !bytes.is_empty()
            {
                self.gpu.queue.write_buffer(buffer, 0, bytes);
            }
        };
        let waves: Vec<Wave> = facts
            .surface
            .components
            .iter()
            .map(|c| Wave {
                amplitude_m: c.amplitude_m as f32,
                frequency_x_per_m: c.frequency_per_m.x as f32,
                frequency_z_per_m: c.frequency_per_m.y as f32,
                phase_turns: c.phase_turns as f32,
            })
            .collect();
        write(Slot::Waves, bytemuck::cast_slice(&waves));
        if let Some(geometry) = self.geometry.in_use()
            && buffers.by_name.contains_key(slot_name(Slot::Instances))
        {
            write(
                Slot::Instances,
                bytemuck::cast_slice(&geometry.instances(facts)),
            );
        }
        let all: Vec<Receiver> = (0..facts.lights.len())
            .flat_map(|light| self.receivers(facts, light))
            .collect();
        write(Slot::AllReceivers, bytemuck::cast_slice(&all));
        if buffers.by_name.contains_key(slot_name(Slot::Comparisons)) {
            let compared = estimate::compared(facts);
            let all: Vec<Comparison> = compared.iter().map(|map| map.comparison).collect();
            write(Slot::Comparisons, bytemuck::cast_slice(&all));
        }
    }

    pub(super) fn receivers(&self, facts: &SceneFacts, light: usize) -> Vec<Receiver> {
        light::receivers(facts, light, |object| {
            let key = facts.lights[light].boxes[object].as_ref().map(|b| &b.key);
            let offset = key
                .and_then(|key| self.level_maps.offset(key))
                .unwrap_or_default();
            u32::try_from(offset / 4).unwrap_or(u32::MAX)
        })
    }

    pub(super) fn geometry_buffer(&mut self, resolved: &ResolvedScene) -> Option<wgpu::Buffer> {
        if resolved.meshes.is_empty() {
            return None;
        }
        let geometry = self.geometry.hold(&self.gpu, &resolved.meshes);
        Some(geometry.buffer.clone())
    }

    pub(super) fn arena_buffer(&mut self) -> wgpu::Buffer {
        let size = self.level_maps.stats().budget_bytes;
        self.arena
            .get_or_insert_with(|| {
                self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("level maps"),
                    size,
                    usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                })
            })
            .clone()
    }

    pub(super) fn draw_targets(&self, key: &LevelMapKey) -> DrawTargets {
        let texture = |label, format| self.target_texture(label, format, key.texels);
        DrawTargets {
            front: texture("front depth", wgpu::TextureFormat::R32Float),
            back: texture("back depth", wgpu::TextureFormat::R32Float),
            normal: texture("front normal", wgpu::TextureFormat::R32Uint),
            scratch_normal: texture("back normal", wgpu::TextureFormat::R32Uint),
            depth: texture("depth", wgpu::TextureFormat::Depth32Float),
            layers: (1..key.layers)
                .map(|_| {
                    [
                        texture("layer's depth", wgpu::TextureFormat::R32Float),
                        texture("layer's normal", wgpu::TextureFormat::R32Uint),
                    ]
                })
                .collect(),
        }
    }

    /// Images for the slices of the largest object, and a depth.
    fn slice_targets(&self, facts: &SceneFacts) -> SliceTargets {
        let wet = facts.wet_objects();
        let texels = wet.map(|o| facts.objects[o].map_texels).max().unwrap_or(1);
        let texture = |label, format| self.target_texture(label, format, texels);
        SliceTargets {
            colors: (0..facts.quality.planes)
                .map(|_| texture("slice", wgpu::TextureFormat::Rgba8Unorm))
                .collect(),
            depth: texture("slice depth", wgpu::TextureFormat::Depth32Float),
        }
    }

    fn target_texture(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        texels: u32,
    ) -> wgpu::TextureView {
        self.gpu
            .device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: texels,
                    height: texels,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default())
    }

    pub(super) fn place_uniforms(&mut self, step: &Step) -> PlacedUniforms {
        let placed = step.uniforms.iter();
        let placed = placed.map(|(name, bytes)| (*name, self.uniforms.get(&self.gpu, bytes)));
        PlacedUniforms(placed.collect())
    }
}

/// Empties queues, the account, and so many bytes of the flux sums before a light's turn.
pub(super) fn clear_for_light(
    encoder: &mut wgpu::CommandEncoder,
    buffers: &FrameBuffers,
    flux_bytes: u64,
) {
    for (name, buffer) in &buffers.by_name {
        let Some(slot) = Slot::by_name(name) else {
            continue;
        };
        if slot.info().is_queue {
            let head = if slot == Slot::WideQueue { 16 } else { 0 };
            if slot == Slot::SplitQueue {
                encoder.clear_buffer(buffer, 0, Some(4 * SPLIT_HEAD_WORDS));
            }
            encoder.copy_buffer_to_buffer(&buffers.queue_heads, head, buffer, 0, 16);
        } else if slot == Slot::Flux {
            encoder.clear_buffer(buffer, 0, Some(flux_bytes));
        } else if [Slot::Energy, Slot::PlaneLists].contains(&slot) {
            encoder.clear_buffer(buffer, 0, None);
        }
    }
}
